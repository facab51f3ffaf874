/* An eye in motion keeps its sky until a change would show; at rest it has the exact one. Before a surface of the
 * host's it tells of the air as that is. */
#include <math.h>
#include <string.h>

#include "fixture.h"
#include "shared/air.h"

enum { W = 48, H = 36, PIXELS = W * H, FRAMES = 60, REST = 20 };
#define FRAME_S (1.0 / 60.0)
#define SPEED_M_S 250.0

typedef struct flight {
    double height_m, climb_m_s, sun_deg, sun_deg_s;
} flight;

typedef struct rig {
    fixture f;
    velum_eye *eyes[2]; /* one that keeps its sky; one that has it drawn in every frame */
    velum_view *views[2];
    float light[2][PIXELS * 3], through[2][PIXELS * 3];
} rig;

static void rig_init(rig *r) {
    memset(r, 0, sizeof *r);
    fixture_borrow(&r->f);
    fixture_commit(&r->f, NULL, 0);
    r->eyes[0] = r->f.eye;
    const velum_eye_desc desc = {.struct_size = sizeof desc, .quality = VELUM_QUALITY_MEDIUM};
    assert_int_equal(r->f.engine_api->create_eye(r->f.engine, &desc, &r->eyes[1]), VELUM_OK);
    for (int k = 0; k < 2; k++) {
        r->views[k] = fixture_view(&r->f, r->eyes[k], W, H);
    }
}

static void rig_finish(rig *r) {
    for (int k = 0; k < 2; k++) {
        assert_int_equal(r->f.engine_api->destroy_view(r->views[k]), VELUM_OK);
    }
    assert_int_equal(r->f.engine_api->destroy_eye(r->eyes[1]), VELUM_OK);
    fixture_give_back(&r->f);
}

/* Both views by one camera, each with its eye at a position and with flags of its own. `depth`: the host's; null: none.
 */
static void render(rig *r, const velum_frame_info *frame, const velum_view_frame *camera, double positions[2][3],
                   const uint32_t flags[2], const float *depth) {
    velum_eye_frame eyes[2];
    velum_pixels pixels[2];
    for (int k = 0; k < 2; k++) {
        eyes[k] = (velum_eye_frame){.struct_size = sizeof eyes[k], .flags = flags[k], .eye = r->eyes[k]};
        memcpy(eyes[k].position_ecef_m, positions[k], sizeof eyes[k].position_ecef_m);
        pixels[k] = (velum_pixels){.struct_size = sizeof pixels[k],
                                   .view = r->views[k],
                                   .frame = camera,
                                   .luminance_rgb = r->light[k],
                                   .transmittance_rgb = r->through[k],
                                   .depth = depth,
                                   .width = W,
                                   .height = H};
    }
    assert_int_equal(r->f.standalone_api->render(r->f.engine, frame, eyes, 2, 0, pixels, 2, 0), VELUM_OK);
}

/* `moves`: since the frame before; else the other's sky is exact already. */
static void draw(rig *r, const flight *at, double time_s, bool moves) {
    const double rad = acos(-1.0) / 180.0;
    const double lat_deg = 50.0 + SPEED_M_S * time_s / 111200.0;
    double east[3], north[3], up[3], sun[3], forward[3], positions[2][3];
    fixture_axes(50.0, 8.5, east, north, up);
    const double elevation = (at->sun_deg + at->sun_deg_s * time_s) * rad;
    for (int i = 0; i < 3; i++) {
        sun[i] = sin(elevation) * up[i] + cos(elevation) * (0.6 * east[i] + 0.8 * north[i]);
        forward[i] = 0.995 * north[i] + sqrt(1.0 - 0.995 * 0.995) * up[i];
    }
    fixture_position(lat_deg, 8.5, at->height_m + at->climb_m_s * time_s, positions[0]);
    const velum_frame_info frame = fixture_frame(sun, time_s, VELUM_ATMOSPHERE_EARTH);
    const velum_view_frame camera = fixture_camera(positions[0], forward, east, 1.2f, 0.9f);
    memcpy(positions[1], positions[0], sizeof positions[1]);
    render(r, &frame, &camera, positions, (const uint32_t[2]){0, moves ? VELUM_EYE_RESET : 0}, NULL);
}

/* Greatest difference of a pixel, of the exact one. */
static double apart(const float *light, const float *exact) {
    double most = 0.0;
    for (int i = 0; i < PIXELS * 3; i++) {
        assert_true(isfinite(light[i]) && isfinite(exact[i]));
        if (exact[i] <= 0.0f) {
            assert_true(light[i] == exact[i]);
            continue;
        }
        most = fmax(most, fabs((double)light[i] / (double)exact[i] - 1.0));
    }
    return most;
}

static void fly(const char *name, const flight *path, double most) {
    static float first[PIXELS * 3];
    static rig r;
    rig_init(&r);
    double off = 0.0;
    for (int i = 0; i < FRAMES; i++) {
        draw(&r, path, i * FRAME_S, true);
        off = fmax(off, apart(r.light[0], r.light[1]));
        if (i == 0) {
            memcpy(first, r.light[1], sizeof first);
        }
    }
    const uint32_t drawn = fixture_skies_drawn(r.eyes[0]);
    print_message("%s: %u skies in %d frames, %.4f apart at most\n", name, drawn, (int)FRAMES, off);
    assert_in_range(drawn, 3, FRAMES / 2);
    assert_int_equal(fixture_skies_drawn(r.eyes[1]), FRAMES);
    assert_true(off < most);
    /* The first sky would not have done all the way. */
    assert_true(apart(first, r.light[1]) > most);
    for (int i = 0; i < REST; i++) {
        draw(&r, path, FRAMES * FRAME_S, i == 0);
    }
    assert_memory_equal(r.light[0], r.light[1], sizeof r.light[0]);
    rig_finish(&r);
}

static void a_kept_sky_is_the_sky(void **state) {
    (void)state;
    const struct {
        const char *name;
        flight path;
        double most;
    } cases[] = {
        {"climbing at noon", {3000.0, 60.0, 60.0, 0.004}, 0.01},
        {"climbing at sunset", {1500.0, 20.0, 2.0, -0.03}, 0.01},
        {"in twilight", {600.0, 1.0, -4.0, -0.03}, 0.01},
        {"above the air", {400000.0, 300.0, 20.0, 0.06}, 0.01},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        fly(cases[i].name, &cases[i].path, cases[i].most);
    }
}

/* Of an air: what it holds beside molecules, aerosol and ozone. */
typedef struct air {
    const char *name;
    float visibility_m, fog_top_m;
} air;

/* Optical depth along a ray that begins at a height with such a cosine of its zenith angle, by quadrature over a
 * sphere. */
static void depth_along(const air *a, double height_m, double mu, double way_m, double depth[3]) {
    enum { STEPS = 1000 };
    const double clean_1_m = (double)(VELUM_RAYLEIGH_G + VELUM_AEROSOL_EXTINCTION);
    const double added_1_m = fmax(-log(0.05) / (double)a->visibility_m - clean_1_m, 0.0);
    const bool fog = a->fog_top_m > 0.0f;
    const double r = VELUM_WGS84_A_M + height_m;
    const double over_m = (VELUM_AIR_TOP_M - height_m) * (r + VELUM_WGS84_A_M + VELUM_AIR_TOP_M);
    way_m = fmin(way_m, sqrt(r * r * mu * mu + over_m) - r * mu); /* there is none above */
    memset(depth, 0, 3 * sizeof *depth);
    for (int i = 0; i < STEPS; i++) {
        /* Finest at both ends. */
        const double u = acos(-1.0) * (i + 0.5) / STEPS;
        const double t = way_m * 0.5 * (1.0 - cos(u));
        const double dt = way_m * 0.5 * sin(u) * acos(-1.0) / STEPS;
        const double rise_m = t * (2.0 * r * mu + t);
        const double h = height_m + rise_m / (r + sqrt(r * r + rise_m));
        const double rayleigh = (double)velum_rayleigh_density((float)h);
        const double aerosol = (double)VELUM_AEROSOL_EXTINCTION * (double)velum_aerosol_density((float)h);
        const double ozone = (double)velum_ozone_density((float)h);
        const double dust =
            added_1_m * (fog ? (double)velum_fog_density((float)h, a->fog_top_m) : exp(-fmax(h, 0.0) / 1500.0));
        depth[0] += dt * ((double)VELUM_RAYLEIGH_R * rayleigh + aerosol + (double)VELUM_OZONE_R * ozone + dust);
        depth[1] += dt * ((double)VELUM_RAYLEIGH_G * rayleigh + aerosol + (double)VELUM_OZONE_G * ozone + dust);
        depth[2] += dt * ((double)VELUM_RAYLEIGH_B * rayleigh + aerosol + (double)VELUM_OZONE_B * ozone + dust);
    }
}

/* Whether a ray that begins so is under the ground before that distance. */
static bool is_buried(double height_m, double mu, double way_m) {
    const double r = VELUM_WGS84_A_M + height_m;
    const double lowest_m = fmin(fmax(-r * mu, 0.0), way_m);
    return lowest_m * (2.0 * r * mu + lowest_m) / (2.0 * r) < fmin(-height_m, 0.0);
}

/* Where a level view stands over its eye, how far it sees up and down, and how far off the surfaces are that stand in
 * its stripes; 0: none. Another eye stands aside, so that the same view has air of its own before it. */
typedef struct surfaces {
    double height_m, over_m, tan_y;
    double distance_m[4];
} surfaces;

typedef struct errors {
    double transmittance[2]; /* greatest, of each eye; */
    double light[2]; /* that is taken for the surfaces' share, of the light of all the way and the mean of that */
} errors;

static errors look_at_surfaces(rig *r, const air *a, const surfaces *s, double sun_deg) {
    static float depth_m[PIXELS], whole[2][PIXELS * 3], whole_through[2][PIXELS * 3];
    const double rad = acos(-1.0) / 180.0;
    double east[3], north[3], up[3], sun[3], positions[2][3], view[3];
    fixture_axes(50.0, 8.5, east, north, up);
    fixture_position(50.0, 8.5, s->height_m, positions[0]);
    fixture_position(50.0, 8.5, s->height_m + s->over_m, view);
    for (int i = 0; i < 3; i++) {
        sun[i] = sin(sun_deg * rad) * up[i] + cos(sun_deg * rad) * (0.6 * east[i] + 0.8 * north[i]);
        positions[1][i] = positions[0][i] + 60.0 * east[i];
    }
    for (int i = 0; i < PIXELS; i++) {
        depth_m[i] = (float)s->distance_m[i % W / 4 % 4];
    }
    const velum_frame_info frame = fixture_frame(sun, 0.0, VELUM_ATMOSPHERE_EARTH);
    velum_view_frame camera = fixture_camera(view, north, east, 1.2f, (float)s->tan_y);
    const uint32_t anew[2] = {VELUM_EYE_RESET, VELUM_EYE_RESET};
    render(r, &frame, &camera, positions, anew, NULL);
    memcpy(whole, r->light, sizeof whole);
    memcpy(whole_through, r->through, sizeof whole_through);
    camera.depth_convention = VELUM_DEPTH_DISTANCE;
    camera.flags |= VELUM_VIEW_CUT;
    render(r, &frame, &camera, positions, (const uint32_t[2]){0, 0}, depth_m);

    double mean[2] = {0.0};
    for (int k = 0; k < 2; k++) {
        for (int i = 0; i < PIXELS * 3; i++) {
            assert_true(isfinite(r->light[k][i]) && isfinite(r->through[k][i]) && isfinite(whole[k][i]));
            mean[k] += (double)whole[k][i] / (PIXELS * 3);
        }
        assert_true(mean[k] > 0.0);
    }
    errors found = {{0.0}, {0.0}};
    for (int i = 1; i < PIXELS; i += 4) {
        const double x = 1.2 * (2.0 * (i % W + 0.5) / W - 1.0);
        const double y = s->tan_y * (1.0 - 2.0 * (i / W + 0.5) / H);
        const double mu = y / sqrt(1.0 + x * x + y * y);
        if (depth_m[i] == 0.0f || is_buried(s->height_m + s->over_m, mu, (double)depth_m[i])) {
            continue;
        }
        double depth[3];
        depth_along(a, s->height_m + s->over_m, mu, (double)depth_m[i], depth);
        for (int k = 0; k < 2; k++) {
            for (int c = 0; c < 3; c++) {
                const int at = 3 * i + c;
                const double through = exp(-depth[c]);
                found.transmittance[k] = fmax(found.transmittance[k], fabs((double)r->through[k][at] - through));
                const double share = (1.0 - through) / fmax(1.0 - (double)whole_through[k][at], 1e-4);
                const double light = (double)whole[k][at] * fmin(share, 1.0);
                const double off = fabs((double)r->light[k][at] - light) / ((double)whole[k][at] + mean[k]);
                found.light[k] = fmax(found.light[k], off);
            }
        }
    }
    return found;
}

static void the_eyes_sky_tells_of_air_before_surfaces(void **state) {
    (void)state;
    static rig r;
    rig_init(&r);
    const air airs[] = {{"clear air", 1e5f, 0.0f}, {"haze", 2.1e4f, 0.0f}, {"fog", 500.0f, 150.0f}};
    static const struct {
        surfaces of;
        errors most;
    } cases[] = {
        /* Near and far over the ground, which the steepest ray meets at 1.5 times the height. */
        {{30.0, 0.0, 0.9, {0.6, 9.0, 40.0, 0.0}}, {{0.001, 0.002}, {0.001, 0.008}}},
        {{1000.0, 0.0, 0.9, {20.0, 300.0, 1350.0, 0.0}}, {{0.001, 0.002}, {0.001, 0.008}}},
        {{11000.0, 0.0, 0.9, {200.0, 3300.0, 15000.0, 0.0}}, {{0.001, 0.002}, {0.001, 0.008}}},
        {{59000.0, 0.0, 0.9, {1200.0, 18000.0, 8e4, 0.0}}, {{0.001, 0.002}, {0.007, 0.008}}},
        /* About the horizon, and beyond the air. */
        {{2.0, 0.0, 0.01, {100.0, 2000.0, 3e4, 0.0}}, {{0.015, 0.045}, {0.015, 0.15}}},
        {{-97.0, 0.0, 0.01, {100.0, 2000.0, 3e4, 0.0}}, {{0.015, 0.045}, {0.015, 0.15}}},
        {{30.0, 0.0, 0.01, {1000.0, 10000.0, 6e4, 0.0}}, {{0.015, 0.045}, {0.015, 0.15}}},
        {{1000.0, 0.0, 0.05, {1000.0, 2e4, 1e5, 0.0}}, {{0.015, 0.045}, {0.015, 0.15}}},
        {{11000.0, 0.0, 0.1, {1e4, 1e5, 3e5, 0.0}}, {{0.015, 0.045}, {0.015, 0.15}}},
        {{100.0, 0.0, 0.9, {100.0, 4e5, 3.8e8, 0.0}}, {{0.015, 0.045}, {0.015, 0.15}}},
        /* A view over its eye, and under it. */
        {{2.0, 40.0, 0.01, {100.0, 2000.0, 3e4, 0.0}}, {{0.015, 0.045}, {0.015, 0.15}}},
        {{42.0, -40.0, 0.01, {100.0, 2000.0, 3e4, 0.0}}, {{0.015, 0.045}, {0.015, 0.15}}},
        {{170.0, -45.0, 0.1, {100.0, 500.0, 1000.0, 0.0}}, {{0.015, 0.045}, {0.015, 0.15}}},
    };
    const double suns_deg[] = {50.0, 3.0};
    for (int i = 0; i < 3; i++) {
        velum_cell cell = fixture_cell(NULL, 0);
        cell.flags |= VELUM_CELL_HAS_VISIBILITY;
        cell.visibility_m = airs[i].visibility_m;
        cell.fog_top_m = airs[i].fog_top_m;
        fixture_commit_cell(&r.f, &cell);
        for (size_t k = 0; k < 2 * sizeof cases / sizeof cases[0]; k++) {
            const surfaces *of = &cases[k / 2].of;
            const errors *most = &cases[k / 2].most;
            const errors off = look_at_surfaces(&r, &airs[i], of, suns_deg[k % 2]);
            print_message(
                "%s before surfaces up to %g m off, from %g m, %g m over the eye, sun at %.0f degrees: by the eye's "
                "sky %.4f of transmittance and %.4f of light off, by the view's own air %.4f and %.4f\n",
                airs[i].name, of->distance_m[2], of->height_m + of->over_m, of->over_m, suns_deg[k % 2],
                off.transmittance[0], off.light[0], off.transmittance[1], off.light[1]);
            for (int e = 0; e < 2; e++) {
                assert_true(off.transmittance[e] < most->transmittance[e] && off.light[e] < most->light[e]);
            }
        }
    }
    rig_finish(&r);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_kept_sky_is_the_sky),
                                       cmocka_unit_test(the_eyes_sky_tells_of_air_before_surfaces)};
    return cmocka_run_group_tests_name("gpu sky", tests, NULL, fixture_shared_finish);
}
