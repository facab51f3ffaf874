#include "metar_cell.h"

#include "genus.h"

#include <math.h>
#include <string.h>

static const float nominal_cover[5] = {0.0f, 1.5f / 8.0f, 3.5f / 8.0f, 6.0f / 8.0f, 1.0f};
static const float greatest_cover[5] = {0.0f, 2.0f / 8.0f, 4.0f / 8.0f, 7.0f / 8.0f, 1.0f};

static const float least_thickness_m = 100.0f;
static const float tower_thickness_m = 3000.0f;
static const float limit_m = 25000.0f;

static float surface_temperature_k(const metar_report *report, float elevation_m) {
    return report->has_temperature ? report->temperature_k : 288.15f - 0.0065f * elevation_m;
}

/* Espy's rule (1836): 125 m for each kelvin between temperature and dew point. */
static int is_at_condensation_level(const metar_report *report, float height_m) {
    if (!report->has_temperature || !report->has_dew_point) {
        return 1;
    }
    const float level_m = 125.0f * (report->temperature_k - report->dew_point_k);
    return report->temperature_k > 273.15f && level_m >= 200.0f && fabsf(height_m - level_m) <= 0.3f * level_m + 100.0f;
}

/* carries_rain: the highest broken or overcast group below 3,000 m under steady rain or snow. */
static int32_t genus_of(const metar_report *report, const metar_cloud *cloud, int carries_rain) {
    const int is_broken = cloud->amount >= METAR_BKN;
    if (cloud->genus) {
        return cloud->genus;
    }
    if (cloud->height_m >= 6000.0f) {
        return cloud->amount == METAR_OVC ? VELUM_GENUS_CS : VELUM_GENUS_CI;
    }
    if (carries_rain) {
        return VELUM_GENUS_NS;
    }
    if (cloud->height_m >= 2000.0f) {
        return cloud->amount == METAR_OVC ? VELUM_GENUS_AS : VELUM_GENUS_AC;
    }
    if (!is_broken && report->weather & METAR_SHOWER) {
        return VELUM_GENUS_CU;
    }
    if (is_broken) {
        return cloud->height_m < 450.0f ? VELUM_GENUS_ST : VELUM_GENUS_SC;
    }
    if (is_at_condensation_level(report, cloud->height_m)) {
        return VELUM_GENUS_CU;
    }
    return cloud->height_m < 450.0f ? VELUM_GENUS_ST : VELUM_GENUS_SC;
}

/* Known heights only, from below; equal heights stay in their order. */
static uint32_t sorted_clouds(const metar_report *report, metar_cloud clouds[METAR_MAX_CLOUDS]) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < report->cloud_count; ++i) {
        if (isnan(report->clouds[i].height_m)) {
            continue;
        }
        uint32_t j = count++;
        for (; j > 0 && clouds[j - 1].height_m > report->clouds[i].height_m; --j) {
            clouds[j] = clouds[j - 1];
        }
        clouds[j] = report->clouds[i];
    }
    return count;
}

/* A thunderstorm without a CB group: the group of most cloud below 3,000 m is its base. */
static void find_storm(const metar_report *report, metar_cloud *clouds, uint32_t count) {
    metar_cloud *best = NULL;
    if (!(report->weather & METAR_THUNDER)) {
        return;
    }
    for (uint32_t i = 0; i < count; ++i) {
        if (clouds[i].genus == VELUM_GENUS_CB) {
            return;
        }
        if (clouds[i].height_m < 3000.0f && (!best || clouds[i].amount > best->amount)) {
            best = &clouds[i];
        }
    }
    if (best) {
        best->genus = VELUM_GENUS_CB;
    }
}

static int rain_group(const metar_report *report, const metar_cloud *clouds, uint32_t count) {
    int found = -1;
    for (uint32_t i = 0; i < count && report->weather & METAR_STEADY; ++i) {
        if (clouds[i].amount >= METAR_BKN && clouds[i].height_m < 3000.0f && !clouds[i].genus) {
            found = (int)i;
        }
    }
    return found;
}

/* Wind rises as the 1/7 power of height up to 1,000 m (Justus 1978) and is held above. */
static void set_wind(const metar_report *report, velum_layer *layer, float height_m) {
    const float factor = powf(fminf(fmaxf(height_m, 10.0f), 1000.0f) / 10.0f, 1.0f / 7.0f);
    const float from_rad = report->wind_from_deg * (3.14159265f / 180.0f);
    const float speed = report->has_wind && !report->is_variable ? report->wind_m_s * factor : 0.0f;
    layer->wind_east_m_s = -speed * sinf(from_rad);
    layer->wind_north_m_s = -speed * cosf(from_rad);
}

static int is_tower(const velum_layer *layer) {
    return layer->genus == VELUM_GENUS_CB || layer->genus == VELUM_GENUS_CU;
}

static void finish_layer(const metar_report *report, const metar_cloud *cloud, float elevation_m, float ceiling_m,
                         velum_layer *layer) {
    float thickness_m = weather_genus_of(layer->genus)->thickness_m;
    if (cloud->towering) {
        thickness_m = tower_thickness_m;
    } else if (layer->genus == VELUM_GENUS_CU && report->weather & METAR_SHOWER) {
        thickness_m *= 2.5f;
    }
    if (!is_tower(layer)) {
        thickness_m = fminf(thickness_m, weather_thickness_limit_m(layer->genus, layer->coverage));
    }
    const float low_m = fminf(elevation_m + cloud->height_m, limit_m - least_thickness_m);
    float top_m = low_m + thickness_m;
    if (!is_tower(layer) && top_m > ceiling_m) {
        top_m = ceiling_m;
    }
    layer->base_m = low_m;
    layer->top_m = fminf(fmaxf(top_m, low_m + least_thickness_m), limit_m);
    const float surface_k = surface_temperature_k(report, elevation_m);
    const float middle_m = 0.5f * (layer->base_m + layer->top_m) - elevation_m;
    weather_genus_fill(layer, fmaxf(surface_k - 0.0065f * middle_m, 210.0f),
                       fmaxf(surface_k - 0.0065f * cloud->height_m, 210.0f), 0.0f);
    set_wind(report, layer, cloud->height_m);
}

static velum_layer *rain_bearer(velum_layer *layers, uint32_t count) {
    velum_layer *best = NULL;
    int best_rank = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const velum_layer *layer = &layers[i];
        const int rank =
            layer->genus == VELUM_GENUS_CB   ? 4
            : layer->genus == VELUM_GENUS_NS ? 3
            : layer->genus == VELUM_GENUS_CI || layer->genus == VELUM_GENUS_CC || layer->genus == VELUM_GENUS_CS
                ? 0
                : 1 + (layer->coverage >= 0.5f);
        if (rank > best_rank) {
            best = &layers[i];
            best_rank = rank;
        }
    }
    return best;
}

/* The sky hidden by snow or rain: a nimbostratus from the height of vertical visibility up. */
static uint32_t obscuring_layer(const metar_report *report, float elevation_m, velum_layer *layer) {
    metar_cloud cloud = {.amount = METAR_OVC, .height_m = report->vertical_visibility_m, .genus = VELUM_GENUS_NS};
    if (isnan(cloud.height_m)) {
        cloud.height_m = 150.0f;
    }
    memset(layer, 0, sizeof(*layer));
    layer->struct_size = sizeof(*layer);
    layer->genus = VELUM_GENUS_NS;
    layer->coverage = 1.0f;
    finish_layer(report, &cloud, elevation_m, limit_m, layer);
    return 1;
}

uint32_t metar_layers(const metar_report *report, float elevation_m, velum_layer layers[METAR_MAX_CLOUDS + 1]) {
    metar_cloud clouds[METAR_MAX_CLOUDS];
    const uint32_t cloud_count = sorted_clouds(report, clouds);
    find_storm(report, clouds, cloud_count);
    const int carrier = rain_group(report, clouds, cloud_count);
    uint32_t count = 0;
    float below = 0.0f;
    for (uint32_t i = 0; i < cloud_count; ++i) {
        const metar_cloud *cloud = &clouds[i];
        const int is_convective = cloud->towering || cloud->genus == VELUM_GENUS_CB;
        float own = nominal_cover[cloud->amount];
        float sum = own;
        if (!is_convective) {
            sum = sum > below ? sum : fmaxf(below, 0.5f * (below + greatest_cover[cloud->amount]));
            own = below < 1.0f ? (sum - below) / (1.0f - below) : 0.0f;
        }
        below = fmaxf(below, sum);
        if (own < 0.01f) {
            continue;
        }
        float ceiling_m = limit_m;
        if (i + 1 < cloud_count) {
            ceiling_m = elevation_m + clouds[i + 1].height_m - 50.0f;
        }
        velum_layer *layer = &layers[count++];
        memset(layer, 0, sizeof(*layer));
        layer->struct_size = sizeof(*layer);
        layer->genus = genus_of(report, cloud, (int)i == carrier);
        layer->coverage = fminf(own, 1.0f);
        finish_layer(report, cloud, elevation_m, ceiling_m, layer);
    }
    if (report->is_obscured && !count && report->precipitation_mm_h > 0.2f) {
        count = obscuring_layer(report, elevation_m, layers);
    }
    velum_layer *bearer = report->precipitation_mm_h > 0.0f ? rain_bearer(layers, count) : NULL;
    if (bearer) {
        bearer->precipitation_mm_h = report->precipitation_mm_h;
        bearer->precipitation = report->precipitation;
    }
    return count;
}

static int knows_sky(const metar_report *report) {
    uint32_t unknown = 0;
    for (uint32_t i = 0; i < report->cloud_count; ++i) {
        unknown += isnan(report->clouds[i].height_m) != 0;
    }
    const int is_hidden = report->is_obscured && !report->cloud_count;
    /* Groups of which no height is known say nothing that could be drawn. */
    return (report->has_sky && (!report->cloud_count || unknown < report->cloud_count)) ||
           (is_hidden && report->precipitation_mm_h > 0.2f);
}

static void fill_visibility(const metar_report *report, velum_cell *cell) {
    const float vertical_m = report->vertical_visibility_m;
    if (!report->has_visibility && !(report->is_obscured && !isnan(vertical_m))) {
        return;
    }
    cell->flags |= VELUM_CELL_HAS_VISIBILITY;
    cell->visibility_m = report->has_visibility ? report->visibility_m : fmaxf(vertical_m, 50.0f);
    if (report->is_obscured && cell->visibility_m < 5000.0f) {
        cell->fog_top_m = cell->elevation_m + (isnan(vertical_m) ? 100.0f : fmaxf(1.5f * vertical_m, 60.0f));
    } else if (report->weather & METAR_FOG && cell->visibility_m < 1000.0f) {
        cell->fog_top_m = cell->elevation_m + (report->weather & METAR_SHALLOW ? 10.0f : 150.0f);
    } else if (report->weather & METAR_HAZE) {
        cell->fog_top_m = cell->elevation_m + 1500.0f;
    }
    /* 0 would mean "not given". */
    if (cell->fog_top_m == 0.0f && cell->elevation_m < 0.0f && report->weather & (METAR_FOG | METAR_HAZE)) {
        cell->fog_top_m = 1.0f;
    }
}

void metar_fill_cell(const metar_report *report, velum_cell *cell) {
    cell->flags = knows_sky(report) ? VELUM_CELL_HAS_LAYERS : 0;
    fill_visibility(report, cell);
    if (report->has_wind) {
        const float from_rad = report->wind_from_deg * (3.14159265f / 180.0f);
        const float speed = report->is_variable ? 0.0f : report->wind_m_s;
        cell->flags |= VELUM_CELL_HAS_WIND;
        cell->wind_east_m_s = -speed * sinf(from_rad);
        cell->wind_north_m_s = -speed * cosf(from_rad);
        cell->gust_m_s = report->is_variable ? fmaxf(report->wind_m_s, report->gust_m_s) : report->gust_m_s;
    }
    if (report->has_temperature) {
        cell->flags |= VELUM_CELL_HAS_TEMPERATURE;
        cell->temperature_k = report->temperature_k;
        cell->dew_point_k = report->has_dew_point ? report->dew_point_k : 0.0f;
    }
    cell->flags |= VELUM_CELL_HAS_PRECIPITATION;
    cell->precipitation_mm_h = report->precipitation_mm_h;
    cell->precipitation = report->precipitation;
    cell->thunderstorm = (report->weather & METAR_THUNDER) != 0;
}
