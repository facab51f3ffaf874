/* Eyes with budgets: their plans follow the times of their frames, can be repeated, and cost no history. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fixture.h"
#include "plugin/preset_figures.h"

enum { W = 48, H = 32, PIXELS = W * H, FRAMES = 60 };
#define LAT_DEG 50.0
#define LON_DEG 8.5
/* Shorter and longer than any frame of so few pixels. */
#define NO_TIME_MS 0.001f
#define ALL_TIME_MS 10000.0f

typedef struct picture {
    float light[PIXELS * 3], through[PIXELS * 3];
} picture;

typedef struct rig {
    fixture f;
    velum_frame_info frame;
    double east[3], north[3], up[3], forward[3];
    double height_m, east_m;
} rig;

/* An eye with its view, of a rig's engine. */
typedef struct watcher {
    velum_eye *eye;
    velum_view *view;
    uint32_t flags; /* of its next frame */
    velum_plan plan;
    const char *reasons;
} watcher;

static void rig_init(rig *r) {
    memset(r, 0, sizeof *r);
    fixture_init(&r->f, false);
    const velum_layer layer = fixture_cumulus();
    fixture_commit(&r->f, &layer, 1);
    fixture_axes(LAT_DEG, LON_DEG, r->east, r->north, r->up);
    double sun[3];
    for (int i = 0; i < 3; i++) {
        sun[i] = 0.6 * r->up[i] + 0.8 * r->east[i];
        r->forward[i] = cos(0.25) * r->east[i] + sin(0.25) * r->up[i];
    }
    r->frame = fixture_frame(sun, 0.0, VELUM_ATMOSPHERE_EARTH);
    r->height_m = 300.0;
}

static watcher watch(rig *r, int32_t quality, float budget_ms, float budget_error) {
    watcher w = {.flags = VELUM_EYE_RESET, .plan = {.struct_size = sizeof w.plan}};
    const velum_eye_desc desc = {
        .struct_size = sizeof desc, .quality = quality, .budget_ms = budget_ms, .budget_error = budget_error};
    assert_int_equal(r->f.engine_api->create_eye(r->f.engine, &desc, &w.eye), VELUM_OK);
    w.view = fixture_view(&r->f, w.eye, W, H);
    return w;
}

static void leave(rig *r, watcher *w) {
    assert_int_equal(r->f.engine_api->destroy_view(w->view), VELUM_OK);
    assert_int_equal(r->f.engine_api->destroy_eye(w->eye), VELUM_OK);
}

static void draw(rig *r, watcher *w, picture *out) {
    velum_eye_frame eye = {.struct_size = sizeof eye, .eye = w->eye, .flags = w->flags};
    fixture_position(LAT_DEG, LON_DEG, r->height_m, eye.position_ecef_m);
    for (int i = 0; i < 3; i++) {
        eye.position_ecef_m[i] += r->east_m * r->east[i];
    }
    velum_view_frame camera = fixture_camera(eye.position_ecef_m, r->forward, r->north, 0.6f, 0.6f * H / W);
    const velum_pixels pixels = {.struct_size = sizeof pixels,
                                 .view = w->view,
                                 .frame = &camera,
                                 .luminance_rgb = out->light,
                                 .transmittance_rgb = out->through,
                                 .width = W,
                                 .height = H};
    assert_true(r->f.standalone_api->render(r->f.engine, &r->frame, &eye, 1, 0, &pixels, 1, 0) >= 0);
    assert_int_equal(r->f.engine_api->get_plan(w->eye, &w->plan, &w->reasons), VELUM_OK);
    w->flags = 0;
}

static void draw_plan(rig *r, watcher *w, const velum_plan *plan, uint32_t frames, picture *out) {
    assert_int_equal(r->f.engine_api->set_plan(w->eye, plan), VELUM_OK);
    for (uint32_t i = 0; i < frames; i++) {
        draw(r, w, out);
    }
}

/* Mean difference of light over its mean. */
static double apart(const picture *a, const picture *b) {
    double sum = 0.0, mean = 0.0;
    for (int i = 0; i < 3 * PIXELS; i++) {
        assert_true(isfinite(a->light[i]));
        sum += fabs((double)a->light[i] - (double)b->light[i]);
        mean += (double)b->light[i];
    }
    return sum / mean;
}

static void expect_reason(const watcher *w, const char *text) {
    if (!strstr(w->reasons, text)) {
        print_message("expected '%s' in: %s\n", text, w->reasons);
    }
    assert_non_null(strstr(w->reasons, text));
}

/* A flight of plans that fall or rise, and the same imposed on another eye. */
static void plans_are_repeated_bit_for_bit(void **state) {
    (void)state;
    static const float budgets_ms[] = {NO_TIME_MS, ALL_TIME_MS};
    static picture seen[FRAMES], again;
    static velum_plan plans[FRAMES];
    rig r;
    rig_init(&r);
    for (int b = 0; b < 2; b++) {
        watcher w = watch(&r, VELUM_QUALITY_LOW, budgets_ms[b], 0.0f);
        uint32_t changes = 0;
        for (uint32_t i = 0; i < FRAMES; i++) {
            r.east_m = 40.0 * (i < FRAMES / 2 ? i : FRAMES / 2); /* it flies, then stands */
            draw(&r, &w, &seen[i]);
            plans[i] = w.plan;
            changes += i > 0 && memcmp(&plans[i], &plans[i - 1], sizeof plans[i]) != 0;
        }
        assert_int_equal(plans[0].ray_rate, 16);
        assert_true(b == 0 ? plans[FRAMES - 1].ray_rate == 64 : plans[FRAMES - 1].ray_rate < 16);
        assert_true(changes >= (b == 0 ? 1 : 40));
        leave(&r, &w);

        watcher other = watch(&r, VELUM_QUALITY_ULTRA, 0.0f, 0.0f);
        for (uint32_t i = 0; i < FRAMES; i++) {
            r.east_m = 40.0 * (i < FRAMES / 2 ? i : FRAMES / 2);
            draw_plan(&r, &other, &plans[i], 1, &again);
            assert_memory_equal(&again, &seen[i], sizeof again);
            assert_memory_equal(&other.plan, &plans[i], sizeof plans[i]);
        }
        leave(&r, &other);
    }
    fixture_finish(&r.f);
}

/* The same frames with other rays: nothing jumps, and what comes of them is what they would come to alone. */
static void other_rays_keep_the_history(void **state) {
    (void)state;
    static picture settled, now, alone;
    static const uint32_t rates[] = {64, 16, 32, 8, 4, 2, 1, 64};
    rig r;
    rig_init(&r);
    watcher w = watch(&r, VELUM_QUALITY_HIGH, 0.0f, 0.0f);
    draw(&r, &w, &settled);
    velum_plan plan = w.plan;
    plan.ray_rate = 1;
    draw_plan(&r, &w, &plan, 32, &settled);
    /* What a history begun anew would show. */
    plan.ray_rate = 64;
    w.flags = VELUM_EYE_RESET;
    draw_plan(&r, &w, &plan, 1, &now);
    double jump = apart(&now, &settled);
    assert_true(jump > 0.05);

    w.flags = VELUM_EYE_RESET;
    plan.ray_rate = 4;
    draw_plan(&r, &w, &plan, 128, &now);
    for (size_t i = 0; i < sizeof rates / sizeof rates[0]; i++) {
        const picture before = now;
        plan.ray_rate = rates[i];
        draw_plan(&r, &w, &plan, 1, &now);
        assert_true(apart(&now, &before) < 0.1 * jump);
        draw_plan(&r, &w, &plan, rates[i] - 1, &now);
        assert_true(apart(&now, &settled) < 0.3 * jump);
    }
    plan.ray_rate = 1;
    draw_plan(&r, &w, &plan, 96, &now);
    w.flags = VELUM_EYE_RESET;
    draw_plan(&r, &w, &plan, 128, &alone);
    assert_true(apart(&now, &alone) < 0.02 * jump);
    leave(&r, &w);
    fixture_finish(&r.f);
}

static void other_steps_take_over(void **state) {
    (void)state;
    static picture now, coarse, fine;
    rig r;
    rig_init(&r);
    watcher w = watch(&r, VELUM_QUALITY_ULTRA, 0.0f, 0.0f);
    draw(&r, &w, &now);
    velum_plan better = w.plan;
    better.ray_rate = 1;
    velum_plan worse = better;
    worse.march_steps = 60;
    worse.light_steps = 1;
    worse.step_m = 600.0f;
    draw_plan(&r, &w, &better, 64, &fine);
    w.flags = VELUM_EYE_RESET;
    draw_plan(&r, &w, &worse, 64, &coarse);
    double whole = apart(&coarse, &fine);
    assert_true(whole > 0.02);
    draw_plan(&r, &w, &better, 1, &now);
    assert_true(apart(&now, &coarse) < 0.3 * whole);
    draw_plan(&r, &w, &better, 96, &now);
    assert_true(apart(&now, &fine) < 0.15 * whole);
    leave(&r, &w);
    fixture_finish(&r.f);
}

static void reasons_say_what_came_of_a_time(void **state) {
    (void)state;
    static picture now;
    rig r;
    rig_init(&r);
    watcher poor = watch(&r, VELUM_QUALITY_DEFAULT, NO_TIME_MS, 0.0f);
    for (int i = 0; i < 12; i++) {
        draw(&r, &poor, &now);
        if (i == 0) {
            expect_reason(&poor, "too few frames");
        }
    }
    expect_reason(&poor, "even the least plan is too dear");
    const velum_plan least = poor.plan;
    assert_int_equal(least.ray_rate, 64);
    /* Another scene: as at the beginning, or worse. */
    poor.flags = VELUM_EYE_RESET;
    draw(&r, &poor, &now);
    expect_reason(&poor, "too few frames");
    assert_int_equal(poor.plan.ray_rate, 64);
    leave(&r, &poor);

    watcher rich = watch(&r, VELUM_QUALITY_HIGH, ALL_TIME_MS, preset_figures_of[1].error);
    const int32_t quality = VELUM_QUALITY_LOW + (int32_t)preset_for_error(preset_figures_of[1].error);
    watcher enough = watch(&r, quality, 0.0f, 0.0f);
    draw(&r, &enough, &now);
    for (int i = 0; i < 12; i++) {
        draw(&r, &rich, &now);
    }
    expect_reason(&rich, "the best plan is cheaper");
    expect_reason(&rich, "the cheapest that meets it; not better");
    assert_int_equal(rich.plan.ray_rate, 16);
    assert_int_equal(rich.plan.march_steps, enough.plan.march_steps);
    leave(&r, &rich);
    leave(&r, &enough);

    /* Nothing to gain where there is no cloud: it does not rise. */
    velum_layer none = fixture_cumulus();
    none.coverage = 0.0f;
    fixture_commit(&r.f, &none, 1);
    watcher clear = watch(&r, VELUM_QUALITY_DEFAULT, ALL_TIME_MS, 0.0f);
    for (int i = 0; i < 12; i++) {
        draw(&r, &clear, &now);
    }
    expect_reason(&clear, "no cloud to spend it on");
    assert_int_equal(clear.plan.ray_rate, 16);
    leave(&r, &clear);
    fixture_finish(&r.f);
}

static void an_error_takes_the_cheapest_preset(void **state) {
    (void)state;
    static picture now, expected;
    rig r;
    rig_init(&r);
    for (uint32_t i = 0; i <= PRESETS; i++) {
        const float least = 1e-3f;
        float error = i < PRESETS ? preset_figures_of[i].error : least;
        int32_t quality = VELUM_QUALITY_LOW + (int32_t)preset_for_error(error);
        watcher w = watch(&r, VELUM_QUALITY_ULTRA, 0.0f, error);
        watcher preset = watch(&r, quality, 0.0f, 0.0f);
        draw(&r, &w, &now);
        draw(&r, &preset, &expected);
        expect_reason(&w, i < PRESETS ? "the cheapest that meets it" : "none meets it");
        assert_memory_equal(&w.plan, &preset.plan, sizeof w.plan);
        assert_memory_equal(&now, &expected, sizeof now);
        leave(&r, &w);
        leave(&r, &preset);
    }
    fixture_finish(&r.f);
}

static void without_timestamps_the_quality_stays(void **state) {
    (void)state;
    static picture now;
    rig r;
    rig_init(&r);
    fixture_forget_timestamps(r.f.engine);
    watcher w = watch(&r, VELUM_QUALITY_HIGH, NO_TIME_MS, 0.0f);
    watcher preset = watch(&r, VELUM_QUALITY_HIGH, 0.0f, 0.0f);
    draw(&r, &preset, &now);
    for (int i = 0; i < 12; i++) {
        draw(&r, &w, &now);
    }
    expect_reason(&w, "not kept, the device has no timestamps");
    assert_memory_equal(&w.plan, &preset.plan, sizeof w.plan);
    leave(&r, &w);
    leave(&r, &preset);
    fixture_finish(&r.f);
}

/* From 12 km up, cloud 15 km high is seen 830 km off: a ray through clear air comes there without running out of steps.
 */
static void steps_reach_any_horizon(void **state) {
    (void)state;
    static picture now;
    rig r;
    rig_init(&r);
    for (int32_t quality = VELUM_QUALITY_LOW; quality <= VELUM_QUALITY_ULTRA; quality++) {
        watcher w = watch(&r, quality, 0.0f, 0.0f);
        draw(&r, &w, &now);
        double at_m = 0.0;
        for (uint32_t i = 0; i < w.plan.march_steps; i++) {
            at_m += fmax((double)w.plan.step_m, at_m * (double)w.plan.step_growth);
        }
        assert_true(at_m > 830e3);
        leave(&r, &w);
    }
    fixture_finish(&r.f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(steps_reach_any_horizon),
        cmocka_unit_test(plans_are_repeated_bit_for_bit),
        cmocka_unit_test(other_rays_keep_the_history),
        cmocka_unit_test(other_steps_take_over),
        cmocka_unit_test(reasons_say_what_came_of_a_time),
        cmocka_unit_test(an_error_takes_the_cheapest_preset),
        cmocka_unit_test(without_timestamps_the_quality_stays),
    };
    return cmocka_run_group_tests_name("budget", tests, NULL, NULL);
}
