#include "grib_column.h"

#include "genus.h"

#include <math.h>
#include <string.h>

#define GRAVITY_M_S2 9.80665f

static const float least_cover = 0.01f;
static const float least_thickness_m = 100.0f;
static const float top_limit_m = 25000.0f;

typedef struct deck_shape {
    float cover, base_m, top_m, base_k, middle_k, top_k;
    float base_pa, middle_pa, top_pa;
    float lapse_k_km;
    float path_g_m2; /* in cloud; NaN: not known */
} deck_shape;

float grib_geometric_height_m(float geopotential_m) {
    const float radius_m = 6356766.0f;
    return radius_m * geopotential_m / (radius_m - geopotential_m);
}

void grib_standard_profile(grib_profile *profile) {
    static const float levels_hpa[] = {1100, 1000, 925, 850, 700, 600, 500, 400, 300,
                                       250,  200,  150, 100, 70,  50,  30,  20,  10};
    memset(profile, 0, sizeof(*profile));
    profile->count = sizeof(levels_hpa) / sizeof(levels_hpa[0]);
    for (uint32_t i = 0; i < profile->count; ++i) {
        const float pressure_pa = levels_hpa[i] * 100.0f;
        const float tropopause_pa = 22632.06f;
        float geopotential_m, temperature_k;
        if (pressure_pa > tropopause_pa) {
            temperature_k = 288.15f * powf(pressure_pa / 101325.0f, 0.190263f);
            geopotential_m = (288.15f - temperature_k) / 0.0065f;
        } else if (pressure_pa > 5474.889f) {
            temperature_k = 216.65f;
            geopotential_m = 11000.0f + 6341.62f * logf(tropopause_pa / pressure_pa);
        } else {
            temperature_k = 216.65f * powf(pressure_pa / 5474.889f, -0.029271f);
            geopotential_m = 20000.0f + (temperature_k - 216.65f) / 0.001f;
        }
        profile->pressure_pa[i] = pressure_pa;
        profile->log_pressure[i] = logf(pressure_pa);
        profile->height_m[i] = grib_geometric_height_m(geopotential_m);
        profile->temperature_k[i] = temperature_k;
        profile->wind_east_m_s[i] = NAN;
        profile->wind_north_m_s[i] = NAN;
        profile->water_kg_kg[i] = NAN;
    }
}

/* The segment that holds the pressure and the place in it: 0 at its lower end, outside 0..1 beyond the profile. */
static uint32_t segment(const grib_profile *profile, float pressure_pa, float *fraction) {
    uint32_t i = 0;
    while (i + 2 < profile->count && profile->pressure_pa[i + 1] > pressure_pa) {
        ++i;
    }
    *fraction =
        (logf(pressure_pa) - profile->log_pressure[i]) / (profile->log_pressure[i + 1] - profile->log_pressure[i]);
    return i;
}

static float held(float fraction, const float pair[2]) {
    const float f = fminf(fmaxf(fraction, 0.0f), 1.0f);
    if (isnan(pair[0]) || isnan(pair[1])) {
        return isnan(pair[0]) ? pair[1] : pair[0];
    }
    return pair[0] + f * (pair[1] - pair[0]);
}

float grib_profile_height_m(const grib_profile *profile, float pressure_pa) {
    float fraction;
    const uint32_t i = segment(profile, pressure_pa, &fraction);
    return profile->height_m[i] + fraction * (profile->height_m[i + 1] - profile->height_m[i]);
}

float grib_profile_temperature_k(const grib_profile *profile, float pressure_pa) {
    float fraction;
    const uint32_t i = segment(profile, pressure_pa, &fraction);
    return held(fraction, &profile->temperature_k[i]);
}

static float water_or_0(float water_kg_kg) {
    return water_kg_kg > 0.0f ? water_kg_kg : 0.0f;
}

/* Integral of q dp / g, q linear in p between levels, held below the lowest and 0 above the highest. */
float grib_profile_water_path_g_m2(const grib_profile *profile, float base_pa, float top_pa) {
    double path = 0.0;
    const float lowest_pa = profile->pressure_pa[0];
    if (base_pa > lowest_pa) {
        path += (double)(base_pa - fmaxf(lowest_pa, top_pa)) * (double)water_or_0(profile->water_kg_kg[0]);
    }
    for (uint32_t i = 0; i + 1 < profile->count; ++i) {
        const float below_pa = profile->pressure_pa[i], above_pa = profile->pressure_pa[i + 1];
        const float from_pa = fminf(below_pa, base_pa), to_pa = fmaxf(above_pa, top_pa);
        if (from_pa <= to_pa) {
            continue;
        }
        const float q0 = water_or_0(profile->water_kg_kg[i]), q1 = water_or_0(profile->water_kg_kg[i + 1]);
        const float middle = 0.5f * (from_pa + to_pa);
        const float q = q0 + (below_pa - middle) / (below_pa - above_pa) * (q1 - q0);
        path += (double)(from_pa - to_pa) * (double)q;
    }
    return (float)(path / (double)GRAVITY_M_S2 * 1000.0);
}

static int has_water(const grib_profile *profile) {
    for (uint32_t i = 0; i < profile->count; ++i) {
        if (!isnan(profile->water_kg_kg[i])) {
            return 1;
        }
    }
    return 0;
}

static deck_shape shape_of(const grib_profile *profile, const grib_deck *deck, float elevation_m) {
    deck_shape shape = {.cover = fminf(deck->cover, 1.0f)};
    const float base_pa = fmaxf(deck->base_pa, deck->top_pa), top_pa = fminf(deck->base_pa, deck->top_pa);
    const float base_m = grib_profile_height_m(profile, base_pa), top_m = grib_profile_height_m(profile, top_pa);
    shape.base_pa = base_pa;
    shape.middle_pa = sqrtf(base_pa * top_pa);
    shape.top_pa = top_pa;
    shape.base_k = grib_profile_temperature_k(profile, base_pa);
    shape.middle_k = grib_profile_temperature_k(profile, shape.middle_pa);
    shape.top_k = grib_profile_temperature_k(profile, top_pa);
    shape.lapse_k_km = top_m - base_m > 1.0f ? 1000.0f * (shape.base_k - shape.top_k) / (top_m - base_m) : 0.0f;
    shape.base_m = fminf(fmaxf(base_m, elevation_m + 30.0f), top_limit_m - least_thickness_m);
    shape.top_m = fminf(fmaxf(top_m, shape.base_m + least_thickness_m), top_limit_m);
    shape.path_g_m2 = NAN;
    if (has_water(profile)) {
        shape.path_g_m2 = grib_profile_water_path_g_m2(profile, base_pa, top_pa) / shape.cover;
    }
    return shape;
}

static void limit_thickness(deck_shape *shape, const grib_profile *profile, int32_t genus) {
    const float thickness_m = shape->top_m - shape->base_m;
    const float limit_m = weather_thickness_limit_m(genus, shape->cover);
    if (thickness_m > limit_m) {
        const float half = 0.5f * limit_m / thickness_m;
        shape->top_m = shape->base_m + limit_m;
        shape->middle_pa = shape->base_pa * powf(shape->top_pa / shape->base_pa, half);
        shape->middle_k = grib_profile_temperature_k(profile, shape->middle_pa);
    }
}

static int32_t low_genus(const deck_shape *low, const deck_shape *middle, const grib_surface *surface,
                         float large_mm_h) {
    const float thickness_m = low->top_m - low->base_m;
    if (low->cover >= 0.75f && large_mm_h >= 0.2f && (thickness_m >= 1500.0f || middle->cover >= 0.75f)) {
        return VELUM_GENUS_NS;
    }
    if (low->cover < 0.5f && surface->cape_j_kg >= 50.0f && low->lapse_k_km >= 5.0f) {
        return VELUM_GENUS_CU;
    }
    return low->base_m - surface->elevation_m < 450.0f && thickness_m < 1000.0f ? VELUM_GENUS_ST : VELUM_GENUS_SC;
}

static int32_t middle_genus(const deck_shape *middle, int32_t low, float large_mm_h) {
    if (low != VELUM_GENUS_NS && middle->cover >= 0.75f && large_mm_h >= 0.2f &&
        middle->top_m - middle->base_m >= 1500.0f) {
        return VELUM_GENUS_NS;
    }
    return middle->cover < 0.6f || (middle->lapse_k_km >= 6.5f && middle->cover < 0.85f) ? VELUM_GENUS_AC
                                                                                         : VELUM_GENUS_AS;
}

static int32_t high_genus(const deck_shape *high) {
    if (high->top_m - high->base_m < 1000.0f && high->lapse_k_km >= 7.5f && high->cover < 0.7f) {
        return VELUM_GENUS_CC;
    }
    return high->cover >= 0.6f ? VELUM_GENUS_CS : VELUM_GENUS_CI;
}

static int32_t convective_genus(const deck_shape *tower, const grib_surface *surface) {
    const int is_deep = tower->top_m - tower->base_m >= 4000.0f && tower->top_k < 253.15f;
    const int is_strong = isnan(surface->cape_j_kg) || surface->cape_j_kg >= 200.0f || surface->convective_mm_h >= 0.5f;
    return is_deep && is_strong ? VELUM_GENUS_CB : VELUM_GENUS_CU;
}

static void set_wind(velum_layer *layer, const grib_profile *profile, float pressure_pa) {
    float fraction;
    const uint32_t i = segment(profile, pressure_pa, &fraction);
    const float east = held(fraction, &profile->wind_east_m_s[i]), north = held(fraction, &profile->wind_north_m_s[i]);
    layer->wind_east_m_s = isnan(east) ? 0.0f : east;
    layer->wind_north_m_s = isnan(north) ? 0.0f : north;
}

static void sort_by_base(velum_layer *layers, uint32_t count) {
    for (uint32_t i = 1; i < count; ++i) {
        const velum_layer layer = layers[i];
        uint32_t j = i;
        for (; j > 0 && layers[j - 1].base_m > layer.base_m; --j) {
            layers[j] = layers[j - 1];
        }
        layers[j] = layer;
    }
}

uint32_t grib_column_layers(const grib_profile *profile, const grib_deck decks[GRIB_DECKS], const grib_surface *surface,
                            velum_layer layers[GRIB_DECKS]) {
    deck_shape shapes[GRIB_DECKS] = {{0}};
    int32_t genera[GRIB_DECKS] = {0};
    for (int i = 0; i < GRIB_DECKS; ++i) {
        if (decks[i].cover >= least_cover && decks[i].base_pa > 0.0f && decks[i].top_pa > 0.0f) {
            shapes[i] = shape_of(profile, &decks[i], surface->elevation_m);
        }
    }
    const deck_shape *tower = &shapes[GRIB_DECK_CONVECTIVE];
    deck_shape *low = &shapes[GRIB_DECK_LOW];
    const float large_mm_h = fmaxf(surface->precipitation_mm_h - surface->convective_mm_h, 0.0f);
    if (low->cover > 0.0f) {
        genera[GRIB_DECK_LOW] = low_genus(low, &shapes[GRIB_DECK_MIDDLE], surface, large_mm_h);
    }
    if (shapes[GRIB_DECK_MIDDLE].cover > 0.0f) {
        genera[GRIB_DECK_MIDDLE] = middle_genus(&shapes[GRIB_DECK_MIDDLE], genera[GRIB_DECK_LOW], large_mm_h);
    }
    if (shapes[GRIB_DECK_HIGH].cover > 0.0f) {
        genera[GRIB_DECK_HIGH] = high_genus(&shapes[GRIB_DECK_HIGH]);
    }
    if (tower->cover > 0.0f) {
        genera[GRIB_DECK_CONVECTIVE] = convective_genus(tower, surface);
    }
    /* Both in one interval: laid over each other at random they cover what the greater of the two covers alone. */
    if (low->cover > 0.0f && tower->cover > 0.0f && low->base_m < tower->top_m && tower->base_m < low->top_m) {
        low->cover = tower->cover < 1.0f ? fmaxf(low->cover - tower->cover, 0.0f) / (1.0f - tower->cover) : 0.0f;
    }

    uint32_t count = 0;
    int rain_bearer = -1;
    for (int i = 0; i < GRIB_DECKS; ++i) {
        deck_shape *shape = &shapes[i];
        if (shape->cover < least_cover) {
            continue;
        }
        if (genera[i] != VELUM_GENUS_CU || surface->convective_mm_h < 0.1f) {
            limit_thickness(shape, profile, genera[i]);
        }
        velum_layer *layer = &layers[count++];
        memset(layer, 0, sizeof(*layer));
        layer->struct_size = sizeof(*layer);
        layer->genus = genera[i];
        layer->coverage = shape->cover;
        layer->base_m = shape->base_m;
        layer->top_m = shape->top_m;
        weather_genus_fill(layer, shape->middle_k, shape->base_k,
                           i == GRIB_DECK_CONVECTIVE ? NAN : shape->path_g_m2 / (shape->top_m - shape->base_m));
        set_wind(layer, profile, shape->middle_pa);
        if (i == GRIB_DECK_CONVECTIVE && surface->convective_mm_h > 0.01f) {
            layer->precipitation_mm_h = fminf(surface->convective_mm_h / shape->cover, 100.0f);
            layer->precipitation = surface->precipitation;
        } else if (i != GRIB_DECK_CONVECTIVE && i != GRIB_DECK_HIGH &&
                   (rain_bearer < 0 || layer->genus == VELUM_GENUS_NS)) {
            rain_bearer = (int)count - 1;
        }
    }
    if (rain_bearer >= 0 && large_mm_h > 0.01f) {
        velum_layer *layer = &layers[rain_bearer];
        layer->precipitation_mm_h = fminf(large_mm_h / layer->coverage, 100.0f);
        layer->precipitation = surface->precipitation;
    }
    sort_by_base(layers, count);
    return count;
}
