/* The oracle against closed forms, against the density function itself, and against brute force. */
#include "synthetic.h"

#include <math.h>
#include <string.h>

#include "core/geodesy.h"
#include "shared/hash.h"
#include "shared/sample.h"

typedef struct fixture {
    const core_noise *noise;
    core_tile_cache *cache;
    core_state *cumulus, *windy, *slab;
} fixture;

static int set_up(void **state) {
    static fixture f;
    f.noise = core_noise_built();
    f.cache = core_tile_cache_create(0);
    velum_layer layer = layer_of(VELUM_GENUS_CU, 0.5f, 1000.0f, 2400.0f);
    f.cumulus = state_of_layer(layer, 1);
    layer.wind_east_m_s = 12.0f;
    layer.wind_north_m_s = -5.0f;
    f.windy = state_of_layer(layer, 2);
    layer = layer_of(VELUM_GENUS_ST, 1.0f, 500.0f, 900.0f);
    layer.flags = VELUM_LAYER_UNIFORM | VELUM_LAYER_EXTINCTION;
    layer.extinction_1_m = 0.01f;
    f.slab = state_of_layer(layer, 3);
    *state = &f;
    return f.cache ? 0 : -1;
}

static int tear_down(void **state) {
    fixture *f = *state;
    core_state_unref(f->cumulus);
    core_state_unref(f->windy);
    core_state_unref(f->slab);
    core_tile_cache_destroy(f->cache);
    return 0;
}

static core_oracle oracle_of(const fixture *f, const core_state *a, const core_state *b, double time_s) {
    return oracle_over(f->noise, f->cache, a, b, time_s);
}

static void point_at(double lat_deg, double lon_deg, double height_m, double ecef_m[3]) {
    const core_geodetic place = {lat_deg, lon_deg, height_m};
    assert_true(core_ecef_from_geodetic(&place, ecef_m));
}

static float extinction_at(const core_oracle *oracle, const double ecef_m[3]) {
    float extinction = -1.0f;
    assert_int_equal(core_oracle_extinction(oracle, ecef_m, 0.0, &extinction, NULL), VELUM_OK);
    assert_true(isfinite(extinction) && extinction >= 0.0f);
    return extinction;
}

static void slab_has_its_optical_depth(void **state) {
    const fixture *f = *state;
    const core_oracle oracle = oracle_of(f, f->slab, f->slab, 0.0);
    static const double lats[] = {0.0, 45.0, 90.0, -30.0};
    for (int i = 0; i < 4; i++) {
        double from[3];
        double to[3];
        core_oracle_line line;
        point_at(lats[i], 179.9999, 0.0, from);
        point_at(lats[i], 179.9999, 20000.0, to);
        assert_int_equal(core_oracle_along(&oracle, from, to, 0.0, 0.0f, &line, NULL), VELUM_OK);
        assert_true(fabs(line.optical_depth - 4.0) < 0.004 + 0.01);
        assert_true(line.has_contact && fabs(line.first_contact_m - 500.0) < 1.0);
        assert_int_equal(core_oracle_along(&oracle, to, from, 0.0, 0.0f, &line, NULL), VELUM_OK);
        assert_true(line.has_contact && fabs(line.first_contact_m - 19100.0) < 1.0);
        /* From within to within: no clouds beyond the ends. */
        point_at(lats[i], 179.9999, 600.0, from);
        point_at(lats[i], 179.9999, 650.0, to);
        assert_int_equal(core_oracle_along(&oracle, from, to, 0.0, 0.0f, &line, NULL), VELUM_OK);
        assert_true(fabs(line.optical_depth - 0.5) < 1e-3 && line.has_contact && line.first_contact_m == 0.0);
    }
}

static void slanted_slab_follows_the_sphere(void **state) {
    const fixture *f = *state;
    const core_oracle oracle = oracle_of(f, f->slab, f->slab, 0.0);
    /* Over the equator, eastward: the equator is a circle, so chords are exact. */
    double from[3];
    point_at(0.0, 20.0, 0.0, from);
    double up[3];
    double east[3];
    double north[3];
    core_normal(0.0, 20.0, up);
    core_east_north(up, east, north);
    const double mu = 0.1;
    double to[3];
    for (int axis = 0; axis < 3; axis++) {
        to[axis] = from[axis] + 3e5 * (mu * up[axis] + sqrt(1.0 - mu * mu) * east[axis]);
    }
    const double a = CORE_WGS84_A_M;
    double at[2];
    for (int i = 0; i < 2; i++) {
        double r = a + (i ? 900.0 : 500.0);
        at[i] = -a * mu + sqrt(a * a * (mu * mu - 1.0) + r * r);
    }
    core_oracle_line line;
    assert_int_equal(core_oracle_along(&oracle, from, to, 0.0, 0.0f, &line, NULL), VELUM_OK);
    assert_true(fabs(line.optical_depth / (0.01 * (at[1] - at[0])) - 1.0) < 4e-3);
    assert_true(line.has_contact && fabs(line.first_contact_m - at[0]) < 5.0);
}

/* As 16 bits hold it. */
static float stored(float share) {
    return roundf(share * 65535.0f) / 65535.0f;
}

/* The density function step by step (fields, drift, noise, profile), without the oracle's own code. */
static float direct_extinction(const fixture *f, const core_drift *drift, double lat_deg, double lon_deg,
                               double height_m, const float wind[3]) {
    const velum_layer layer = layer_of(VELUM_GENUS_CU, 0.5f, 1000.0f, 2400.0f);
    const int slot = VELUM_SLOT_CUMULUS;
    const velum_slot_noise noise = velum_noise_of(slot);
    double foot[3];
    double point[3];
    /* Columns turn with height over their base. */
    const float base_m = velum_texel_height_m(stored(velum_texel_from_height(layer.base_m)));
    const double over_base_m = fmax(height_m - (double)base_m, 0.0);
    point_at(lat_deg, lon_deg, (double)velum_turrets(slot) * over_base_m, foot);
    point_at(lat_deg, lon_deg, height_m, point);
    float value[3][2];
    for (int kind = 0; kind < 3; kind++) {
        const double *p = kind == 0 ? foot : point;
        double period = (double)(kind == 0   ? noise.shape_period_m
                                 : kind == 1 ? noise.lump_period_m
                                             : noise.fine_period_m);
        for (int life = 0; life < 2; life++) {
            double tau = (double)drift->tau_s[life];
            const double q[3] = {p[0] - (double)wind[0] * tau, p[1] - (double)wind[1] * tau,
                                 p[2] - (double)wind[2] * tau};
            const double row[3][3] = {{VELUM_NOISE_AX, VELUM_NOISE_AY, VELUM_NOISE_AZ},
                                      {VELUM_NOISE_BX, VELUM_NOISE_BY, VELUM_NOISE_BZ},
                                      {VELUM_NOISE_CX, VELUM_NOISE_CY, VELUM_NOISE_CZ}};
            float at[3];
            for (uint32_t axis = 0; axis < 3; axis++) {
                double turn = (row[axis][0] * q[0] + row[axis][1] * q[1] + row[axis][2] * q[2]) / period +
                              (double)velum_hash_unit(velum_hash_3((uint32_t)slot, (uint32_t)kind, axis)) +
                              (double)drift->offset[life][axis];
                at[axis] = (float)(turn - floor(turn));
            }
            value[kind][life] = kind == 0 ? core_noise_shape(f->noise, at[0], at[1], at[2])
                                          : core_noise_detail(f->noise, at[0], at[1], at[2]);
        }
    }
    const float w = drift->weight[1];
    velum_slot_fields fields = {.coverage = stored(layer.coverage),
                                .base_m = base_m,
                                .top_m = velum_texel_height_m(stored(velum_texel_from_height(layer.top_m))),
                                .extinction_1_m = velum_texel_extinction_1_m(
                                    stored(velum_texel_from_extinction(3.0f * 0.3f / (2.0f * 1e6f * 10e-6f)))),
                                .kind = 0.5f};
    core_column column;
    double normal[3];
    core_normal(lat_deg, lon_deg, normal);
    core_column_layers(f->cumulus, normal, 76.0, &column);
    fields.kind = column.slot[slot].kind;
    return velum_slot_extinction(slot, fields, (float)height_m, velum_rank_mix(value[0][0], value[0][1], w),
                                 2.0f * velum_detail_mix(value[1][0], value[1][1], w) - 1.0f,
                                 velum_detail_mix(value[2][0], value[2][1], w));
}

static void points_agree_with_the_density_function(void **state) {
    const fixture *f = *state;
    static const float calm[3] = {0.0f, 0.0f, 0.0f};
    /* 900 s: one drift phase; 5900 s: in the midst of a fade. */
    static const double times_s[] = {900.0, 5900.0, 1e9};
    int inside = 0;
    for (uint32_t i = 0; i < 3000; i++) {
        double lat = -90.0 + 180.0 * (double)velum_hash_unit(velum_hash_2(i, 1));
        double lon = -180.0 + 360.0 * (double)velum_hash_unit(velum_hash_2(i, 2));
        double height_m = 990.0 + 1420.0 * (double)velum_hash_unit(velum_hash_2(i, 3));
        const core_oracle oracle = oracle_of(f, f->cumulus, f->cumulus, times_s[i % 3]);
        double point[3];
        point_at(lat, lon, height_m, point);
        float found = extinction_at(&oracle, point);
        float expected = direct_extinction(f, &oracle.drift, lat, lon, height_m, calm);
        assert_true(fabsf(found - expected) < 1e-3f * expected + 1e-3f * 0.045f);
        inside += expected > 0.0f;
    }
    assert_true(inside > 300);
}

/* Whether there is contact. */
static bool agrees_with_brute_force(const core_oracle *oracle, const double from[3], const double to[3]) {
    double length = sqrt((to[0] - from[0]) * (to[0] - from[0]) + (to[1] - from[1]) * (to[1] - from[1]) +
                         (to[2] - from[2]) * (to[2] - from[2]));
    core_oracle_line line;
    assert_int_equal(core_oracle_along(oracle, from, to, 0.0, 0.0f, &line, NULL), VELUM_OK);
    double depth = 0.0;
    double contact = -1.0;
    const int steps = (int)(length / 0.5);
    for (int k = 0; k < steps; k++) {
        double t = (k + 0.5) / steps;
        const double p[3] = {from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1]),
                             from[2] + t * (to[2] - from[2])};
        double extinction = (double)extinction_at(oracle, p);
        depth += extinction * length / steps;
        if (contact < 0.0 && extinction > 1e-4) {
            contact = t * length;
        }
    }
    assert_true(fabs(line.optical_depth - depth) < 1e-3 * fmax(depth, 1.0));
    assert_int_equal(line.has_contact, contact >= 0.0);
    assert_true(!line.has_contact || fabs(line.first_contact_m - contact) < 1.0);
    return line.has_contact;
}

static void lines_agree_with_brute_force(void **state) {
    const fixture *f = *state;
    const core_oracle oracle = oracle_of(f, f->windy, f->windy, 3000.0);
    int contacts = 0;
    for (int i = 0; i < 6; i++) {
        double from[3];
        double to[3];
        point_at(50.0 + 0.1 * i, 8.0, 300.0 + 500.0 * i, from);
        point_at(50.0 + 0.1 * i, 8.06, 2600.0 - 450.0 * i, to);
        contacts += agrees_with_brute_force(&oracle, from, to);
    }
    assert_true(contacts > 0);
}

/* Two layers that end within the lines' reach, the lower with rain and scud, under which it goes on for long; alone,
 * and where the weather changes to one that is the same everywhere. */
static void lines_pass_over_what_lies_elsewhere(void **state) {
    const fixture *f = *state;
    velum_layer layers[2] = {layer_of(VELUM_GENUS_NS, 0.8f, 1400.0f, 2200.0f),
                             layer_of(VELUM_GENUS_CU, 0.6f, 2600.0f, 3900.0f)};
    layers[0].precipitation = VELUM_PRECIPITATION_RAIN;
    layers[0].precipitation_mm_h = 3.0f;
    layers[0].scud = 0.5f;
    velum_cell cells[2] = {cell_of(VELUM_CELL_RECTANGLE, 1, &layers[0], 1),
                           cell_of(VELUM_CELL_RECTANGLE, 2, &layers[1], 1)};
    for (int i = 0; i < 2; i++) {
        cells[i].lat_deg = 50.0;
        cells[i].lon_deg = 8.0 + 0.12 * i;
        cells[i].half_east_m = cells[i].half_north_m = 5000.0;
        cells[i].transition_m = 2000.0;
    }
    const velum_state_desc desc = desc_of(cells, 2);
    core_state *uneven = state_of(&desc, NULL, 9);
    const core_oracle alone = oracle_of(f, uneven, uneven, 500.0);
    core_oracle changing = oracle_of(f, uneven, f->windy, 500.0);
    changing.blend = 0.4f;
    int contacts = 0;
    for (int i = 0; i < 5; i++) {
        static const double east_deg[] = {0.0, 0.02, 0.1, 0.25, -0.2};
        double from[3];
        double to[3];
        point_at(50.0, 8.03 + 0.02 * i, i == 4 ? 5000.0 : 10.0, from);
        point_at(50.01, 8.03 + 0.02 * i + east_deg[i], i == 4 ? 0.0 : 5000.0, to);
        contacts += agrees_with_brute_force(&alone, from, to);
        contacts += agrees_with_brute_force(&changing, from, to);
    }
    assert_true(contacts > 4);
    core_state_unref(uneven);
}

static void long_lines_end(void **state) {
    const fixture *f = *state;
    const core_oracle oracle = oracle_of(f, f->cumulus, f->cumulus, 0.0);
    double from[3];
    double up[3];
    core_oracle_line line;
    point_at(10.0, 10.0, 0.0, from);
    core_normal(10.0, 10.0, up);
    const double to[3] = {from[0] + 1e11 * up[0], from[1] + 1e11 * up[1], from[2] + 1e11 * up[2]};
    assert_int_equal(core_oracle_along(&oracle, from, to, 0.0, 0.0f, &line, NULL), VELUM_OK);
    core_oracle_line near;
    const double close[3] = {from[0] + 1e4 * up[0], from[1] + 1e4 * up[1], from[2] + 1e4 * up[2]};
    assert_int_equal(core_oracle_along(&oracle, from, close, 0.0, 0.0f, &near, NULL), VELUM_OK);
    assert_true(fabs(line.optical_depth - near.optical_depth) < 2e-3 * fmax(near.optical_depth, 1.0));
    /* Through the earth and out again. */
    const double through[3] = {-to[0], -to[1], -to[2]};
    assert_int_equal(core_oracle_along(&oracle, close, through, 0.0, 0.0f, &line, NULL), VELUM_OK);
    assert_true(isfinite(line.optical_depth));
}

static void same_question_same_answer(void **state) {
    const fixture *f = *state;
    for (int i = 0; i < 50; i++) {
        const core_oracle oracle = oracle_of(f, f->windy, f->windy, i % 2 ? 1e9 + 0.3 * i : 100.0 * i);
        core_tile_cache *fresh = core_tile_cache_create(0);
        core_oracle again = oracle;
        again.tile_context = fresh;
        double point[3];
        point_at(-89.9 + 3.6 * i, 7.3 * i, 1100.0 + 10.0 * i, point);
        assert_true(extinction_at(&oracle, point) == extinction_at(&again, point));
        core_tile_cache_destroy(fresh);
    }
}

/* What was at a place is downwind later: at 1e9 s too, where one phase of the drift holds. */
static void clouds_go_with_the_wind(void **state) {
    const fixture *f = *state;
    static const double times_s[] = {3000.0, 1e9};
    int inside = 0;
    for (int k = 0; k < 2; k++) {
        /* A time at which phases do not fade. */
        double time_s = times_s[k];
        while (core_drift_at(time_s, 7).weight[0] * core_drift_at(time_s + 60.0, 7).weight[0] +
                   core_drift_at(time_s, 7).weight[1] * core_drift_at(time_s + 60.0, 7).weight[1] <
               1.0f) {
            time_s += 100.0;
        }
        const core_oracle before = oracle_of(f, f->windy, f->windy, time_s);
        const core_oracle after = oracle_of(f, f->windy, f->windy, time_s + 60.0);
        double sum = 0.0;
        double moved = 0.0;
        double still = 0.0;
        for (int i = 0; i < 400; i++) {
            double lat = 40.0 + 0.01 * (i / 20);
            double lon = 5.0 + 0.01 * (i % 20);
            double p[3];
            double q[3];
            double up[3];
            double east[3];
            double north[3];
            point_at(lat, lon, 1400.0, p);
            core_normal(lat, lon, up);
            core_east_north(up, east, north);
            for (int axis = 0; axis < 3; axis++) {
                q[axis] = p[axis] + 60.0 * (12.0 * east[axis] - 5.0 * north[axis]);
            }
            float here = extinction_at(&before, p);
            sum += (double)here;
            moved += (double)fabsf(extinction_at(&after, q) - here);
            still += (double)fabsf(extinction_at(&after, p) - here);
            inside += here > 0.0f;
        }
        assert_true(sum > 0.0 && moved < 0.1 * still);
    }
    assert_true(inside > 40);
}

static void blends_begin_and_end_with_a_state_alone(void **state) {
    const fixture *f = *state;
    const core_oracle a = oracle_of(f, f->windy, f->windy, 50.0);
    const core_oracle b = oracle_of(f, f->slab, f->slab, 50.0);
    core_oracle both = oracle_of(f, f->windy, f->slab, 50.0);
    for (int i = 0; i < 60; i++) {
        double point[3];
        point_at(30.0 + 0.02 * i, 0.0, 520.0 + 30.0 * i, point);
        both.blend = 0.0f;
        assert_true(fabsf(extinction_at(&both, point) - extinction_at(&a, point)) < 1e-6f);
        both.blend = 1.0f;
        assert_true(fabsf(extinction_at(&both, point) - extinction_at(&b, point)) < 1e-6f);
    }
}

static void points_tell_what_the_weather_is(void **state) {
    const fixture *f = *state;
    const core_oracle oracle = oracle_of(f, f->windy, f->windy, 50.0);
    double ecef_m[3];
    core_oracle_point point;
    point_at(48.0, 11.0, 1500.0, ecef_m);
    assert_int_equal(core_oracle_at(&oracle, ecef_m, 0.0, &point, NULL), VELUM_OK);
    assert_true(fabs(point.place.lat_deg - 48.0) < 1e-9 && fabs(point.place.height_m - 1500.0) < 1e-3);
    assert_true(fabsf(point.coverage - 0.5f) < 1e-3f);
    assert_true(fabsf(point.base_m - 1000.0f) < 1.0f && fabsf(point.top_m - 2400.0f) < 1.0f);
    assert_int_equal(point.genus, VELUM_GENUS_CU);
    assert_true(point.extinction_1_m == extinction_at(&oracle, ecef_m));
    double speed = sqrt((double)(point.wind_ecef_m_s[0] * point.wind_ecef_m_s[0] +
                                 point.wind_ecef_m_s[1] * point.wind_ecef_m_s[1] +
                                 point.wind_ecef_m_s[2] * point.wind_ecef_m_s[2]));
    assert_true(speed > 5.0 && speed < 13.1);
    assert_true(point.visibility_m > 0.0f && point.visibility_m < 3e5f);
    /* Clear above, with nothing of it. */
    point_at(48.0, 11.0, 9000.0, ecef_m);
    assert_int_equal(core_oracle_at(&oracle, ecef_m, 0.0, &point, NULL), VELUM_OK);
    assert_true(point.extinction_1_m == 0.0f && point.water_g_m3 == 0.0f && point.visibility_m > 5e4f);
    /* No weather at all. */
    const core_oracle empty = oracle_of(f, NULL, NULL, 0.0);
    assert_int_equal(core_oracle_at(&empty, ecef_m, 0.0, &point, NULL), VELUM_OK);
    assert_true(point.extinction_1_m == 0.0f && point.coverage == 0.0f && point.genus == 0);
}

static void careless_questions_are_refused(void **state) {
    const fixture *f = *state;
    const core_oracle oracle = oracle_of(f, f->cumulus, f->cumulus, NAN);
    const double good[3] = {6378137.0 + 1500.0, 0.0, 0.0};
    const double bad[][3] = {{NAN, 0.0, 0.0}, {INFINITY, 0.0, 0.0}, {0.0, 0.0, 0.0}, {1e300, 1.0, 1.0}};
    core_oracle_point point;
    core_oracle_line line;
    core_error error;
    float extinction;
    for (int i = 0; i < 4; i++) {
        memset(&error, 0, sizeof error);
        assert_int_equal(core_oracle_at(&oracle, bad[i], 0.0, &point, &error), VELUM_ERROR_ARGUMENT);
        assert_true(strlen(error.text) > 0);
        assert_int_equal(core_oracle_extinction(&oracle, bad[i], 0.0, &extinction, NULL), VELUM_ERROR_ARGUMENT);
        velum_result result = core_oracle_along(&oracle, good, bad[i], 0.0, 0.0f, &line, NULL);
        assert_int_equal(result, i == 2 ? VELUM_OK : VELUM_ERROR_ARGUMENT);
    }
    assert_int_equal(core_oracle_at(&oracle, good, NAN, &point, NULL), VELUM_ERROR_ARGUMENT);
    assert_int_equal(core_oracle_along(&oracle, good, good, -1.0, 0.0f, &line, NULL), VELUM_ERROR_ARGUMENT);
    assert_int_equal(core_oracle_along(&oracle, good, good, 0.0, 0.0f, &line, NULL), VELUM_OK);
    assert_true(line.optical_depth == 0.0 && !line.has_contact);
    assert_int_equal(core_oracle_at(&oracle, good, 1e300, &point, NULL), VELUM_OK);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slab_has_its_optical_depth),
        cmocka_unit_test(slanted_slab_follows_the_sphere),
        cmocka_unit_test(points_agree_with_the_density_function),
        cmocka_unit_test(lines_agree_with_brute_force),
        cmocka_unit_test(lines_pass_over_what_lies_elsewhere),
        cmocka_unit_test(long_lines_end),
        cmocka_unit_test(same_question_same_answer),
        cmocka_unit_test(clouds_go_with_the_wind),
        cmocka_unit_test(blends_begin_and_end_with_a_state_alone),
        cmocka_unit_test(points_tell_what_the_weather_is),
        cmocka_unit_test(careless_questions_are_refused),
    };
    return cmocka_run_group_tests_name("oracle", tests, set_up, tear_down);
}
