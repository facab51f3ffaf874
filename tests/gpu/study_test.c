/* VELUM_EYE_STUDY: what each method does to a picture is what its theory says. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fixture.h"

enum { W = 48, H = 32, PIXELS = W * H };
#define LAT_DEG 50.0
#define LON_DEG 8.5

typedef struct rig {
    fixture f;
    velum_eye *eye;
    velum_view *view;
    velum_frame_info frame;
    velum_view_frame camera;
    double position[3], east[3], north[3], up[3];
    float light[PIXELS * 3], through[PIXELS * 3];
    velum_view_stats stats;
} rig;

static void look(rig *r, double height_m, const double forward[3], float tan_x, double sun_mu, int32_t atmosphere) {
    double sun[3];
    for (int i = 0; i < 3; i++) {
        sun[i] = sun_mu * r->up[i] + sqrt(1.0 - sun_mu * sun_mu) * r->east[i];
    }
    fixture_position(LAT_DEG, LON_DEG, height_m, r->position);
    r->camera = fixture_camera(r->position, forward, r->north, tan_x, tan_x * H / W);
    r->frame = fixture_frame(sun, 0.0, atmosphere);
}

/* From under clouds, eastward and up. */
static void look_up(rig *r, double elevation_rad, int32_t atmosphere) {
    double ahead[3];
    for (int i = 0; i < 3; i++) {
        ahead[i] = cos(elevation_rad) * r->east[i] + sin(elevation_rad) * r->up[i];
    }
    look(r, 300.0, ahead, 0.6f, 0.6, atmosphere);
}

/* On the engine of `f`, which the test has made or borrowed. */
static void rig_open(rig *r) {
    const velum_eye_desc desc = {.struct_size = sizeof desc, .flags = VELUM_EYE_STUDY};
    assert_int_equal(r->f.engine_api->create_eye(r->f.engine, &desc, &r->eye), VELUM_OK);
    r->view = fixture_view(&r->f, r->eye, W, H);
    fixture_axes(LAT_DEG, LON_DEG, r->east, r->north, r->up);
}

static void rig_close(rig *r) {
    assert_int_equal(r->f.engine_api->destroy_view(r->view), VELUM_OK);
    assert_int_equal(r->f.engine_api->destroy_eye(r->eye), VELUM_OK);
}

static void rig_init(rig *r) {
    memset(r, 0, sizeof *r);
    fixture_borrow(&r->f);
    rig_open(r);
}

static void rig_finish(rig *r) {
    rig_close(r);
    fixture_give_back(&r->f);
}

static void draw(rig *r, velum_eye *at, velum_view *view, uint32_t frames) {
    velum_eye_frame eye = {.struct_size = sizeof eye, .eye = at, .flags = VELUM_EYE_RESET};
    memcpy(eye.position_ecef_m, r->position, sizeof eye.position_ecef_m);
    const velum_pixels pixels = {.struct_size = sizeof pixels,
                                 .view = view,
                                 .frame = &r->camera,
                                 .luminance_rgb = r->light,
                                 .transmittance_rgb = r->through,
                                 .width = W,
                                 .height = H};
    for (uint32_t i = 0; i < frames; i++) {
        assert_true(r->f.standalone_api->render(r->f.engine, &r->frame, &eye, 1, 0, &pixels, 1, 0) >= 0);
        eye.flags = 0;
    }
    r->stats = (velum_view_stats){.struct_size = sizeof r->stats};
    assert_int_equal(r->f.engine_api->get_stats(view, &r->stats), VELUM_OK);
    for (int i = 0; i < 3 * PIXELS; i++) {
        assert_true(r->light[i] >= 0.0f && r->light[i] < 1e9f && r->through[i] >= 0.0f && r->through[i] <= 1.0f);
    }
}

/* A ray for each pixel, steps enough: what differs is what a test changes. */
static velum_plan plan_of(void) {
    return (velum_plan){.struct_size = sizeof(velum_plan),
                        .active_layers = (1u << 8) - 1u,
                        .march_steps = 2048,
                        .light_steps = 6,
                        .ray_rate = 1,
                        .octaves = 4,
                        .step_m = 100.0f,
                        .step_growth = 0.004f,
                        .distance_m = 30000.0f};
}

static void draw_plan(rig *r, const velum_plan *plan, uint32_t frames) {
    assert_int_equal(r->f.engine_api->set_plan(r->eye, plan), VELUM_OK);
    draw(r, r->eye, r->view, frames);
}

static double mean(const float *values) {
    double sum = 0.0;
    for (int i = 0; i < PIXELS; i++) {
        sum += (double)values[3 * i + 1] / PIXELS;
    }
    return sum;
}

/* Mean difference over the mean. */
static double apart(const float *a, const float *b) {
    double sum = 0.0;
    for (int i = 0; i < PIXELS; i++) {
        sum += fabs((double)a[3 * i + 1] - (double)b[3 * i + 1]) / PIXELS;
    }
    return sum / fmax(mean(b), 1e-30);
}

static void expect_near(double found, double expected, double share, const char *what) {
    if (!(fabs(found - expected) <= share * fabs(expected))) {
        print_message("%s: found %.6g, expected %.6g within %g %%\n", what, found, expected, 100.0 * share);
    }
    assert_true(fabs(found - expected) <= share * fabs(expected));
}

/* Henyey-Greenstein, conservative, over black ground, without air. */
static void slab(rig *r, float tau, float g) {
    velum_layer layer = fixture_slab(tau);
    layer.flags |= VELUM_LAYER_PHASE_HG | VELUM_LAYER_ALBEDO;
    layer.hg_asymmetry = g;
    layer.albedo = 1.0f;
    fixture_commit(&r->f, &layer, 1);
}

static void clouds(rig *r) {
    const velum_layer layer = fixture_cumulus();
    fixture_commit(&r->f, &layer, 1);
    look_up(r, 0.25, VELUM_ATMOSPHERE_EARTH);
}

static void needs_an_eye_made_for_it(void **state) {
    (void)state;
    rig r = {0};
    fixture_init(&r.f, false);
    rig_open(&r);
    const velum_plan plans[] = {{.flags = VELUM_PLAN_LIGHT_ALL},
                                {.integrator = 1},
                                {.scattering = 1},
                                {.sun_depth = 1},
                                {.long_step = 1.0f},
                                {.thin_density = 0.01f},
                                {.exit_transmittance = 0.01f},
                                {.volume_cell_m = 200.0f},
                                {.integrator = 0}};
    const char *const names[] = {"plan.flags",
                                 "plan.integrator",
                                 "plan.scattering",
                                 "plan.sun_depth",
                                 "plan.long_step",
                                 "plan.thin_density",
                                 "plan.exit_transmittance",
                                 "plan.volume_cell_m",
                                 NULL};
    for (size_t i = 0; i < sizeof plans / sizeof plans[0]; i++) {
        velum_plan plan = plan_of();
        plan.flags = plans[i].flags;
        plan.integrator = plans[i].integrator;
        plan.scattering = plans[i].scattering;
        plan.sun_depth = plans[i].sun_depth;
        plan.long_step = plans[i].long_step;
        plan.thin_density = plans[i].thin_density;
        plan.exit_transmittance = plans[i].exit_transmittance;
        plan.volume_cell_m = plans[i].volume_cell_m;
        velum_result expected = names[i] ? VELUM_ERROR_STATE : VELUM_OK;
        assert_int_equal(r.f.engine_api->set_plan(r.f.eye, &plan), expected);
        assert_true(!names[i] || strstr(r.f.newest, names[i]));
        assert_int_equal(r.f.engine_api->set_plan(r.eye, &plan), VELUM_OK);
    }
    velum_eye *eye = NULL;
    const velum_eye_desc desc = {
        .struct_size = sizeof desc, .flags = VELUM_EYE_STUDY, .quality = VELUM_QUALITY_REFERENCE};
    assert_int_equal(r.f.engine_api->create_eye(r.f.engine, &desc, &eye), VELUM_ERROR_FLAGS);
    rig_close(&r);
    fixture_finish(&r.f);
}

/* A plan that asks for nothing gets the ordinary picture. The other pipeline with nothing to do sends the same rays and
 * lights all that they meet, where the ordinary one draws places by their share of the picture: the mean is the same.
 */
static void changes_nothing_unasked(void **state) {
    (void)state;
    static float light[PIXELS * 3], through[PIXELS * 3];
    rig r;
    rig_init(&r);
    clouds(&r);
    velum_plan plan = plan_of();
    velum_view *ordinary = fixture_view(&r.f, r.f.eye, W, H);
    assert_int_equal(r.f.engine_api->set_plan(r.f.eye, &plan), VELUM_OK);
    draw(&r, r.f.eye, ordinary, 1);
    const velum_view_stats stats = r.stats;
    memcpy(light, r.light, sizeof light);
    memcpy(through, r.through, sizeof through);
    draw_plan(&r, &plan, 1);
    assert_memory_equal(r.light, light, sizeof light);
    assert_memory_equal(r.through, through, sizeof through);
    plan.exit_transmittance = 0.0015f;
    draw_plan(&r, &plan, 1);
    assert_true(apart(r.through, through) < 1e-4);
    expect_near((double)r.stats.samples, (double)stats.samples, 1e-3, "samples");
    assert_true(mean(through) > 0.05 && mean(through) < 0.95);
    plan.flags = VELUM_PLAN_LIGHT_ALL;
    draw_plan(&r, &plan, 32);
    memcpy(light, r.light, sizeof light);
    const uint64_t all = r.stats.light_samples;
    draw(&r, r.f.eye, ordinary, 32);
    expect_near(mean(r.light), mean(light), 0.005, "mean luminance of places drawn");
    assert_true(apart(r.light, light) < 0.01);
    /* Up to four places a ray, of what it meets: here 0.68 of all. */
    assert_true(4 * r.stats.light_samples < 3 * all);
    assert_int_equal(r.f.engine_api->destroy_view(ordinary), VELUM_OK);
    rig_finish(&r);
}

/* Of equal steps of depth x through uniform cloud, all samples shared: light before over the energy-conserving is
 * x / (1 - exp(-x)), after that times exp(-x), the trapezoid the mean of both. */
static void integrators_differ_as_they_should(void **state) {
    (void)state;
    static const float steps_m[] = {200.0f, 50.0f, 5.0f};
    const double sigma = 4.0 / 1000.0;
    rig r;
    rig_init(&r);
    slab(&r, 4.0f, 0.5f);
    look(&r, 999.0, r.up, 0.01f, 0.6, VELUM_ATMOSPHERE_NONE);
    velum_plan plan = plan_of();
    plan.flags = VELUM_PLAN_LIGHT_ALL;
    plan.step_growth = 0.0f;
    plan.exit_transmittance = 1e-6f;
    plan.long_step = 1.0f;
    for (int i = 0; i < 3; i++) {
        double found[4];
        plan.step_m = steps_m[i] / 0.18f;
        for (uint32_t k = 0; k < 4; k++) {
            plan.integrator = k;
            draw_plan(&r, &plan, 1);
            found[k] = mean(r.light);
            expect_near(mean(r.through), exp(-4.0), 0.02, "transmittance");
        }
        double x = sigma * (double)steps_m[i];
        double before = x / (1.0 - exp(-x));
        expect_near(found[VELUM_INTEGRATOR_BEFORE] / found[0], before, 0.02, "before");
        expect_near(found[VELUM_INTEGRATOR_AFTER] / found[0], before * exp(-x), 0.02, "after");
        expect_near(found[VELUM_INTEGRATOR_TRAPEZOID] / found[0], before * (1.0 + exp(-x)) / 2.0, 0.02, "trapezoid");
    }
    rig_finish(&r);
}

static double phase_hg(double c, double g) {
    return (1.0 - g * g) / (4.0 * 3.14159265358979 * pow(1.0 + g * g - 2.0 * g * c, 1.5));
}

/* Looking up through a slab of depth tau: the integral over t of exp(-t) sum a^i p_i exp(-b^i (tau - t) / mu0). */
static void octaves_are_as_published(void **state) {
    (void)state;
    static const uint32_t counts[] = {1, 2, 4, 8};
    const double tau = 2.0;
    const double mu0 = 0.6;
    const double g = 0.85;
    rig r;
    rig_init(&r);
    slab(&r, (float)tau, (float)g);
    look(&r, 999.0, r.up, 0.01f, mu0, VELUM_ATMOSPHERE_NONE);
    velum_plan plan = plan_of();
    plan.flags = VELUM_PLAN_LIGHT_ALL;
    plan.step_m = 30.0f;
    plan.scattering = VELUM_SCATTERING_OCTAVES;
    for (int k = 0; k < 4; k++) {
        double expected = 0.0;
        double share = 1.0;
        for (uint32_t i = 0; i < counts[k]; i++, share *= 0.5) {
            double rate = share / mu0 - 1.0;
            double integral = exp(-share * tau / mu0) * (fabs(rate) < 1e-9 ? tau : (exp(rate * tau) - 1.0) / rate);
            expected += share * phase_hg(mu0, g * share) * integral;
        }
        plan.octaves = counts[k];
        draw_plan(&r, &plan, 1);
        expect_near(mean(r.light), expected, 0.02, "octaves");
    }
    rig_finish(&r);
}

/* What goes from cell to cell is nothing where cloud is thin, the same at every run, and the less of cells' size the
 * smaller they are. */
static void light_goes_from_cell_to_cell(void **state) {
    (void)state;
    static float coarse[PIXELS * 3], medium[PIXELS * 3];
    rig r;
    rig_init(&r);
    look_up(&r, 0.25, VELUM_ATMOSPHERE_NONE);
    velum_layer layer = fixture_cumulus();
    layer.flags |= VELUM_LAYER_EXTINCTION;
    layer.extinction_1_m = 1e-6f;
    fixture_commit(&r.f, &layer, 1);
    velum_plan plan = plan_of();
    plan.flags = VELUM_PLAN_LIGHT_ALL;
    plan.volume_cell_m = 800.0f; /* fewer cells than what comes later: the volume grows */
    plan.scattering = VELUM_SCATTERING_OCTAVES;
    plan.octaves = 1;
    draw_plan(&r, &plan, 4);
    const double single = mean(r.light);
    assert_true(single > 0.0);
    plan.scattering = VELUM_SCATTERING_VOLUME;
    draw_plan(&r, &plan, 4);
    expect_near(mean(r.light), single, 0.02, "thin cloud's light");

    clouds(&r);
    /* Steeply up: what is seen lies within all of these volumes. */
    look_up(&r, 1.0, VELUM_ATMOSPHERE_EARTH);
    const float cells_m[] = {1600.0f, 800.0f, 400.0f};
    float *const kept[] = {coarse, medium, r.light};
    for (int i = 0; i < 3; i++) {
        plan.volume_cell_m = cells_m[i];
        draw_plan(&r, &plan, 4);
        memmove(kept[i], r.light, sizeof r.light);
    }
    const double first = apart(coarse, r.light), then = apart(medium, r.light);
    print_message("from cells of %g and %g m to %g m: %.4f, %.4f\n", (double)cells_m[0], (double)cells_m[1],
                  (double)cells_m[2], first, then);
    assert_true(then > 0.001 && then < 0.8 * first);
    plan.volume_cell_m = cells_m[1];
    draw_plan(&r, &plan, 4);
    assert_memory_equal(r.light, medium, sizeof medium);
    /* Another sun: what the view has is made anew. */
    for (int i = 0; i < 3; i++) {
        r.frame.sun_direction_ecef[i] = 0.4 * r.up[i] + sqrt(1.0 - 0.16) * r.north[i];
    }
    draw_plan(&r, &plan, 4);
    memcpy(medium, r.light, sizeof medium);
    velum_view *fresh = fixture_view(&r.f, r.eye, W, H);
    draw(&r, r.eye, fresh, 4);
    assert_memory_equal(r.light, medium, sizeof medium);
    assert_int_equal(r.f.engine_api->destroy_view(fresh), VELUM_OK);

    plan.scattering = VELUM_SCATTERING_CLOSURE;
    plan.volume_cell_m = 0.0f;
    /* What it does not hold has our own light to the bit. */
    layer = fixture_cumulus();
    layer.genus = VELUM_GENUS_CI;
    layer.base_m = 8000.0f;
    layer.top_m = 9000.0f;
    fixture_commit(&r.f, &layer, 1);
    draw_plan(&r, &plan, 4);
    memcpy(medium, r.light, sizeof medium);
    plan.scattering = VELUM_SCATTERING_VOLUME;
    draw_plan(&r, &plan, 4);
    assert_memory_equal(r.light, medium, sizeof medium);
    rig_finish(&r);
}

/* From above, where what comes first is brightest, a ray that ends at a transmittance of E keeps 1 - E of the light. */
static void early_exits_lose_what_they_leave(void **state) {
    (void)state;
    rig r;
    double down[3];
    rig_init(&r);
    for (int i = 0; i < 3; i++) {
        down[i] = -r.up[i];
    }
    slab(&r, 8.0f, 0.85f);
    look(&r, 2001.0, down, 0.01f, 0.6, VELUM_ATMOSPHERE_NONE);
    velum_plan plan = plan_of();
    plan.flags = VELUM_PLAN_LIGHT_ALL;
    plan.step_m = 30.0f;
    plan.scattering = VELUM_SCATTERING_OCTAVES;
    plan.octaves = 1;
    plan.exit_transmittance = 1e-6f;
    draw_plan(&r, &plan, 1);
    double whole = mean(r.light);
    double samples = (double)r.stats.light_samples;
    expect_near(mean(r.through), exp(-8.0), 0.05, "transmittance");
    static const float exits[] = {0.075f, 0.5f};
    for (int i = 0; i < 2; i++) {
        plan.exit_transmittance = exits[i];
        draw_plan(&r, &plan, 1);
        assert_true(mean(r.through) == 0.0);
        assert_true(mean(r.light) < whole && mean(r.light) > (1.0 - (double)exits[i]) * whole);
        assert_true((double)r.stats.light_samples < samples);
        samples = (double)r.stats.light_samples;
    }
    rig_finish(&r);
}

static void steps_through_air_cost_samples(void **state) {
    (void)state;
    static float light[PIXELS * 3];
    rig r;
    rig_init(&r);
    clouds(&r);
    velum_plan plan = plan_of();
    draw_plan(&r, &plan, 4);
    memcpy(light, r.light, sizeof light);
    double samples = (double)r.stats.samples;

    plan.flags = VELUM_PLAN_STEP_THROUGH;
    plan.long_step = 1.0f;
    draw_plan(&r, &plan, 4);
    assert_true((double)r.stats.samples > 2.0 * samples);
    assert_true(apart(r.light, light) < 0.1);
    expect_near(mean(r.light), mean(light), 0.05, "light");
    double fixed = (double)r.stats.samples;
    plan.flags = 0;
    draw_plan(&r, &plan, 4);
    assert_true((double)r.stats.samples < fixed);
    plan.long_step = 2.0f;
    draw_plan(&r, &plan, 4);
    double twice = (double)r.stats.samples;
    plan.long_step = 8.0f;
    draw_plan(&r, &plan, 4);
    assert_true((double)r.stats.samples < twice);
    assert_true(apart(r.light, light) < 0.1);
    expect_near(mean(r.light), mean(light), 0.05, "light");

    plan.flags = VELUM_PLAN_BASE_SEARCH;
    plan.long_step = 0.0f;
    draw_plan(&r, &plan, 4);
    assert_true(apart(r.light, light) < 0.1);
    expect_near(mean(r.light), mean(light), 0.05, "light");
    assert_true(apart(r.light, light) > 0.0);
    rig_finish(&r);
}

static void thin_samples_let_light_through(void **state) {
    (void)state;
    rig r;
    rig_init(&r);
    clouds(&r);
    velum_plan plan = plan_of();
    double before = 0.0;
    static const float shares[] = {0.0f, 0.01f, 0.3f, 1.0f};
    for (int i = 0; i < 4; i++) {
        plan.thin_density = shares[i];
        draw_plan(&r, &plan, 2);
        double now = mean(r.through);
        assert_true(now >= before - 1e-3);
        assert_true(i != 1 || now < before + 0.02);
        assert_true(i != 3 || now > before + 0.002);
        before = now;
    }
    rig_finish(&r);
}

/* Without a map no cloud dims the sun. */
static void depth_towards_the_sun(void **state) {
    (void)state;
    enum { TEXELS = 128, LEVELS = 3 };
    static float map[LEVELS * TEXELS * TEXELS];
    rig r;
    double light[4];
    rig_init(&r);
    clouds(&r);
    velum_plan plan = plan_of();
    /* One order alone: the closure has light that depth makes. */
    plan.scattering = VELUM_SCATTERING_OCTAVES;
    plan.octaves = 1;
    for (uint32_t i = 0; i < 4; i++) {
        plan.sun_depth = i;
        draw_plan(&r, &plan, 1);
        light[i] = mean(r.light);
        assert_true((r.stats.light_samples == 0) == (i == VELUM_SUN_DEPTH_MAP));
    }
    assert_true(light[VELUM_SUN_DEPTH_MAP] > light[VELUM_SUN_DEPTH_STEPS]);
    /* A sample in cloud stands in the midst of a lump, which without lumps casts no shadow on it. */
    assert_true(light[VELUM_SUN_DEPTH_COARSE] > light[VELUM_SUN_DEPTH_STEPS]);
    assert_true(light[VELUM_SUN_DEPTH_COARSE] < light[VELUM_SUN_DEPTH_MAP]);
    assert_true(light[VELUM_SUN_DEPTH_FINE] < light[VELUM_SUN_DEPTH_STEPS]);

    velum_shadow *shadow = NULL;
    const velum_shadow_desc desc = {.struct_size = sizeof desc, .levels = LEVELS, .texels = TEXELS};
    velum_shadow_frame where = {.struct_size = sizeof where};
    memcpy(where.centre_ecef_m, r.position, sizeof where.centre_ecef_m);
    assert_int_equal(r.f.engine_api->create_shadow(r.f.engine, &desc, &shadow), VELUM_OK);
    assert_true(
        r.f.standalone_api->render_shadow(r.f.engine, &r.frame, shadow, &where, map, sizeof map / sizeof map[0]) >= 0);
    draw_plan(&r, &plan, 1);
    assert_true(mean(r.light) < 0.4 * light[VELUM_SUN_DEPTH_MAP]);
    assert_true(mean(r.light) > 0.0);
    assert_int_equal(r.f.engine_api->destroy_shadow(shadow), VELUM_OK);
    rig_finish(&r);
}

/* Standing still, once every pixel has had a ray, all rates give one picture. */
static void rates_share_their_rays(void **state) {
    (void)state;
    static const uint32_t rates[] = {1, 2, 4, 8, 16, 32, 64};
    static float first[PIXELS * 3], light[PIXELS * 3];
    rig r;
    rig_init(&r);
    clouds(&r);
    velum_plan plan = plan_of();
    plan.ray_rate = 1;
    draw_plan(&r, &plan, 1);
    memcpy(first, r.light, sizeof first);
    /* Until rays have stepped from all of four places pixels are shown with those beside them. */
    for (int i = 0; i < 7; i++) {
        plan.ray_rate = rates[i];
        draw_plan(&r, &plan, 4 * rates[i]);
        assert_int_equal(r.stats.rays, PIXELS / rates[i]);
        if (i == 0) {
            memcpy(light, r.light, sizeof light);
        }
        assert_true(apart(r.light, light) < 1e-4);
    }
    /* After one frame half of the pixels are right, as on a checkerboard, and the others lie between. */
    plan.ray_rate = 2;
    draw_plan(&r, &plan, 1);
    for (int i = 0; i < PIXELS; i++) {
        const float now = r.light[3 * i + 1];
        const int x = i % W;
        if ((x & 1) == ((i / W) & 1)) {
            assert_true(fabs((double)now - (double)first[3 * i + 1]) <= 1e-4 * (double)now);
        } else if (x > 0 && x < W - 1) {
            const float a = r.light[3 * i - 2];
            const float b = r.light[3 * i + 4];
            assert_true(now >= 0.98f * fminf(a, b) && now <= 1.02f * fmaxf(a, b));
        }
    }
    /* So does a part of a larger view. */
    velum_view *roomy = fixture_view(&r.f, r.eye, 3 * W, 2 * H);
    plan.ray_rate = 16;
    assert_int_equal(r.f.engine_api->set_plan(r.eye, &plan), VELUM_OK);
    r.camera.width = W;
    r.camera.height = H;
    draw(&r, r.eye, roomy, 4 * 16);
    assert_true(apart(r.light, light) < 1e-4);
    assert_int_equal(r.f.engine_api->destroy_view(roomy), VELUM_OK);
    rig_finish(&r);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(needs_an_eye_made_for_it),
        cmocka_unit_test(changes_nothing_unasked),
        cmocka_unit_test(integrators_differ_as_they_should),
        cmocka_unit_test(octaves_are_as_published),
        cmocka_unit_test(light_goes_from_cell_to_cell),
        cmocka_unit_test(early_exits_lose_what_they_leave),
        cmocka_unit_test(steps_through_air_cost_samples),
        cmocka_unit_test(thin_samples_let_light_through),
        cmocka_unit_test(depth_towards_the_sun),
        cmocka_unit_test(rates_share_their_rays),
    };
    return cmocka_run_group_tests_name("study", tests, NULL, fixture_shared_finish);
}
