/* The law by which an eye keeps a time, on made-up scenes: what a ray costs, frame by frame. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "plugin/governor.h"
#include "plugin/preset_figures.h"

enum { FRAMES = 2000, STORM = 400, RAMP = 600, FLIGHTS = 16 };
#define BUDGET_MS 40.0
#define REST_MS 5.0
#define TOLERANCE 0.1
/* A change of quality that turns by less is not seen: of march time, 19 %. */
#define SEEN_OCTAVES 0.25

typedef double scene_cost(uint32_t frame); /* ms of march: one ray for 64 pixels, preset low */

typedef struct device {
    double power; /* march time goes with this power of a preset's samples: the governor does not know */
    double noise; /* of what is measured: +- this share, uniform */
    uint32_t delay;
    scene_cost *cost;
    uint32_t slow_frame; /* takes ten times as long; 0: none */
    uint32_t seed;
} device;

static governor_setting settings[FRAMES];
static governor_doing doings[FRAMES];
static double march_ms[FRAMES], total_ms[FRAMES];
static double quality[FRAMES]; /* octaves of march time over the least */

static const governor_setting best = {.ray_rate = 1, .preset = 3.0f};

static double steady(uint32_t frame) {
    (void)frame;
    return 1.0;
}

static double storm_at_once(uint32_t frame) {
    return frame < STORM ? 0.05 : 2.0;
}

static double storm_comes(uint32_t frame) {
    double share = frame < STORM ? 0.0 : frame < STORM + RAMP ? (frame - (double)STORM) / RAMP : 1.0;
    return 0.05 * pow(60.0, share);
}

static double storm_goes(uint32_t frame) {
    return 0.15 / storm_comes(frame);
}

static double dear(uint32_t frame) {
    (void)frame;
    return 200.0;
}

static double cheap(uint32_t frame) {
    (void)frame;
    return 0.01;
}

/* At a power of 0.3, with 1 ray for 16 pixels at most 0.81 of the budget, with 1 for 8 at least 1.14. */
static double between_rays(uint32_t frame) {
    (void)frame;
    return 5.1;
}

static double samples_of(float preset) {
    uint32_t below = preset >= 2.0f ? 2 : (uint32_t)preset;
    double a = log((double)preset_figures_of[below].samples);
    double b = log((double)preset_figures_of[below + 1].samples);
    return exp(a + ((double)preset - below) * (b - a)) / (double)preset_figures_of[0].samples;
}

/* -1..1; the same sequence each time. */
static double random_of(uint32_t *state) {
    *state = *state * 1664525u + 1013904223u;
    return (double)(*state >> 8) / (double)(1u << 23) - 1.0;
}

static void play(governor *g, const device *d) {
    uint32_t seed = d->seed;
    for (uint32_t i = 0; i < FRAMES; i++) {
        if (i > d->delay) {
            uint32_t done = i - d->delay - 1;
            const governor_frame frame = {settings[done], (float)(march_ms[done] * (1.0 + d->noise * random_of(&seed))),
                                          (float)(REST_MS * (1.0 + d->noise * random_of(&seed)))};
            governor_learn(g, &frame);
        }
        settings[i] = governor_next(g);
        doings[i] = g->doing;
        double rays = 64.0 / settings[i].ray_rate * (1.0 + 3.0 * settings[i].finer / 64.0);
        double work = d->cost(i) * (i > 0 && i == d->slow_frame ? 10.0 : 1.0);
        march_ms[i] = work * rays * pow(samples_of(settings[i].preset), d->power);
        total_ms[i] = march_ms[i] + REST_MS;
        quality[i] = log2(march_ms[i] / work);
    }
}

static governor begin(void) {
    governor g;
    governor_init(&g, (float)BUDGET_MS, 1, best);
    return g;
}

static void fly(const device *d) {
    governor g = begin();
    play(&g, d);
}

/* Share of the frames that keep the time; the best plan may be under it, the least over it. */
static double kept(uint32_t first, uint32_t last) {
    uint32_t count = 0;
    for (uint32_t i = first; i < last; i++) {
        double off = total_ms[i] / BUDGET_MS - 1.0;
        count += fabs(off) <= TOLERANCE || (doings[i] == GOVERNOR_MOST && off < 0.0) ||
                 (doings[i] == GOVERNOR_LEAST && off > 0.0);
    }
    return (double)count / (last - first);
}

static uint32_t turns(uint32_t first, uint32_t last, double seen_octaves) {
    uint32_t count = 0;
    int direction = 0;
    double extreme = quality[first];
    for (uint32_t i = first; i < last; i++) {
        double up = quality[i] - extreme;
        if (direction != 0 && up * direction > 0.0) {
            extreme = quality[i];
        } else if (fabs(up) > seen_octaves) {
            count += direction != 0;
            direction = up > 0.0 ? 1 : -1;
            extreme = quality[i];
        }
    }
    return count;
}

/* Means over flights with noise of +- 20 %, from a frame on; turns of the whole flight. */
static void fly_in_noise(const device *still, uint32_t first, double *out_kept, double *out_turns) {
    device d = *still;
    *out_kept = *out_turns = 0.0;
    d.noise = 0.2;
    for (d.seed = 0; d.seed < FLIGHTS; d.seed++) {
        fly(&d);
        *out_kept += kept(first, FRAMES) / FLIGHTS;
        *out_turns += (double)turns(0, FRAMES, SEEN_OCTAVES) / FLIGHTS;
    }
}

static const double powers[] = {0.65, 1.0};
#define EACH_DEVICE(d, scene)                                                                                          \
    for (uint32_t power_ = 0; power_ < 2; power_++)                                                                    \
        for (device d = {.power = powers[power_], .delay = 1, .cost = (scene)}; d.delay <= 3; d.delay++)

static void comes_to_the_time_and_stays(void **state) {
    (void)state;
    EACH_DEVICE(d, steady) {
        fly(&d);
        assert_int_equal(turns(0, FRAMES, SEEN_OCTAVES), 0);
        assert_true(kept(150, FRAMES) == 1.0);
        for (uint32_t i = 150; i < FRAMES; i++) {
            assert_memory_equal(&settings[i], &settings[149], sizeof settings[i]);
            assert_int_equal(doings[i], GOVERNOR_KEEPS);
        }
    }
}

static void noise_does_not_pump(void **state) {
    (void)state;
    EACH_DEVICE(d, steady) {
        double share, count;
        fly_in_noise(&d, 150, &share, &count);
        assert_true(share > 0.98);
        assert_true(count < 2.0);
    }
}

/* Two rounds of measuring: what steps save on this device is not known beforehand. */
static void a_storm_at_once_costs_few_frames(void **state) {
    (void)state;
    EACH_DEVICE(d, storm_at_once) {
        fly(&d);
        uint32_t over = 0;
        for (uint32_t i = 0; i < FRAMES; i++) {
            over += total_ms[i] > (1.0 + TOLERANCE) * BUDGET_MS;
        }
        assert_in_range(over, 1, 2 * (d.delay + 1) + 2);
        assert_true(kept(STORM + 60, FRAMES) == 1.0);
        assert_true(turns(0, FRAMES, SEEN_OCTAVES) <= 2);
    }
    EACH_DEVICE(d, storm_at_once) {
        double share, count;
        fly_in_noise(&d, STORM + 60, &share, &count);
        assert_true(share > 0.98);
        assert_true(count < 4.0);
    }
}

static void a_storm_that_comes_is_followed(void **state) {
    (void)state;
    static scene_cost *const scenes[] = {storm_comes, storm_goes};
    for (uint32_t s = 0; s < 2; s++) {
        EACH_DEVICE(d, scenes[s]) {
            fly(&d);
            assert_true(kept(300, FRAMES) > 0.96);
            assert_true(turns(300, FRAMES, SEEN_OCTAVES) <= 1);
        }
        EACH_DEVICE(d, scenes[s]) {
            double share, count;
            fly_in_noise(&d, 300, &share, &count);
            assert_true(share > 0.9);
            assert_true(count < 2.0);
        }
    }
}

static void finer_blocks_fill_what_rays_leave(void **state) {
    (void)state;
    for (device d = {.power = 0.3, .delay = 1, .cost = between_rays}; d.delay <= 3; d.delay++) {
        fly(&d);
        assert_true(kept(300, FRAMES) > 0.99);
        assert_true(turns(300, FRAMES, SEEN_OCTAVES) <= 1);
        assert_int_equal(settings[FRAMES - 1].ray_rate, 16);
        assert_in_range(settings[FRAMES - 1].finer, 1, GOVERNOR_FINER_MOST);
        for (uint32_t i = 0; i < FRAMES; i++) {
            assert_true(settings[i].finer <= GOVERNOR_FINER_MOST);
            assert_true(settings[i].finer == 0 || settings[i].ray_rate >= 4);
            assert_true(settings[i].finer <= 1 || settings[i].preset > 2.5f);
        }
    }
}

static double storm_passes(uint32_t frame) {
    return frame > 300 && frame < 800 ? 12.0 : 0.5;
}

/* After a storm an eye comes back to all that its error lets it have, and to no finer blocks in place of steps. */
static void a_limit_is_come_back_to(void **state) {
    (void)state;
    for (uint32_t preset = 0; preset < PRESETS; preset++) {
        EACH_DEVICE(d, storm_passes) {
            governor g;
            governor_init(&g, (float)BUDGET_MS, preset, (governor_setting){.ray_rate = 16, .preset = (float)preset});
            play(&g, &d);
            assert_false(settings[799].ray_rate == 16 && settings[799].finer != 0);
            assert_true(settings[799].ray_rate > 16 || settings[799].preset < (float)preset);
            assert_int_equal(settings[FRAMES - 1].ray_rate, 16);
            assert_float_equal((double)settings[FRAMES - 1].preset, (double)preset, 1e-3);
            assert_int_equal(settings[FRAMES - 1].finer, 0);
        }
    }
}

static void rises_slowly(void **state) {
    (void)state;
    const device d = {.power = 1.0, .delay = 1, .cost = steady};
    fly(&d);
    uint32_t risen = 0;
    for (uint32_t i = 1; i < FRAMES; i++) {
        assert_true(total_ms[i] <= 1.04 * total_ms[i - 1]);
        risen += total_ms[i] > total_ms[i - 1];
    }
    assert_true(risen > 20);
}

static void a_lone_slow_frame_changes_nothing(void **state) {
    (void)state;
    static governor_setting before[FRAMES];
    device d = {.power = 0.65, .delay = 1, .cost = steady};
    fly(&d);
    memcpy(before, settings, sizeof before);
    d.slow_frame = 1000;
    fly(&d);
    assert_true(total_ms[1000] > 5.0 * BUDGET_MS);
    assert_memory_equal(before, settings, sizeof before);
}

static void ends_are_told(void **state) {
    (void)state;
    device d = {.power = 1.0, .noise = 0.2, .delay = 2, .cost = dear};
    fly(&d);
    assert_true(total_ms[FRAMES - 1] > BUDGET_MS);
    for (uint32_t i = 20; i < FRAMES; i++) {
        assert_int_equal(doings[i], GOVERNOR_LEAST);
        assert_int_equal(settings[i].ray_rate, 64);
        assert_true(settings[i].preset == 0.0f);
    }
    d.cost = cheap;
    fly(&d);
    assert_true(total_ms[FRAMES - 1] < BUDGET_MS);
    for (uint32_t i = 300; i < FRAMES; i++) {
        assert_int_equal(doings[i], GOVERNOR_MOST);
        assert_int_equal(settings[i].ray_rate, 1);
        assert_float_equal((double)settings[i].preset, 3.0, 1e-3);
    }
    /* Never better than is asked for. */
    governor g;
    const governor_setting medium = {.ray_rate = 16, .preset = 1.0f};
    governor_init(&g, (float)BUDGET_MS, 3, medium);
    play(&g, &d);
    for (uint32_t i = 0; i < FRAMES; i++) {
        assert_int_equal(settings[i].ray_rate, 16);
        assert_float_equal((double)settings[i].preset, 1.0, 1e-3);
        assert_true(i < 20 || doings[i] == GOVERNOR_MOST);
    }
}

/* Where steps save next to nothing, twice the rays may be too dear and half as many too cheap: it is not tried for
 * ever. */
static void gives_up_what_fails(void **state) {
    (void)state;
    const device d = {.power = 0.02, .delay = 1, .cost = steady};
    fly(&d);
    uint32_t late = 0, early = 0;
    for (uint32_t i = 1; i < FRAMES; i++) {
        uint32_t changed = settings[i].ray_rate != settings[i - 1].ray_rate;
        *(i < FRAMES / 2 ? &early : &late) += changed;
    }
    assert_true(early > 2);
    assert_true(late <= 2);
    assert_true(total_ms[FRAMES - 1] < (1.0 + TOLERANCE) * BUDGET_MS);
}

static void another_scene_is_begun_anew(void **state) {
    (void)state;
    device d = {.power = 1.0, .delay = 1, .cost = cheap};
    governor g = begin();
    const governor_setting first = governor_next(&g);
    assert_int_equal(first.ray_rate, 16);
    assert_float_equal((double)first.preset, 1.0, 1e-3);
    g = begin();
    play(&g, &d);
    const governor_setting old = settings[FRAMES - 1];
    assert_int_equal(old.ray_rate, 1);
    governor_reset(&g);
    governor_setting now = governor_next(&g);
    assert_int_equal(now.ray_rate, first.ray_rate);
    assert_float_equal((double)now.preset, (double)first.preset, 1e-3);
    /* Frames of the old scene that finish late teach nothing. */
    for (int i = 0; i < 10; i++) {
        const governor_frame late = {old, 1000.0f, 1.0f};
        governor_learn(&g, &late);
        now = governor_next(&g);
        assert_int_equal(g.doing, GOVERNOR_BEGINS);
        assert_int_equal(now.ray_rate, first.ray_rate);
    }
    /* Where it was worse than at first, it stays. */
    d.cost = dear;
    play(&g, &d);
    governor_reset(&g);
    assert_int_equal(governor_next(&g).ray_rate, 64);
}

static void the_same_times_give_the_same_settings(void **state) {
    (void)state;
    static governor_setting before[FRAMES];
    const device d = {.power = 0.8, .noise = 0.2, .delay = 3, .cost = storm_comes};
    fly(&d);
    memcpy(before, settings, sizeof before);
    fly(&d);
    assert_memory_equal(before, settings, sizeof before);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(comes_to_the_time_and_stays),
        cmocka_unit_test(noise_does_not_pump),
        cmocka_unit_test(a_storm_at_once_costs_few_frames),
        cmocka_unit_test(a_storm_that_comes_is_followed),
        cmocka_unit_test(finer_blocks_fill_what_rays_leave),
        cmocka_unit_test(a_limit_is_come_back_to),
        cmocka_unit_test(rises_slowly),
        cmocka_unit_test(a_lone_slow_frame_changes_nothing),
        cmocka_unit_test(ends_are_told),
        cmocka_unit_test(gives_up_what_fails),
        cmocka_unit_test(another_scene_is_begun_anew),
        cmocka_unit_test(the_same_times_give_the_same_settings),
    };
    return cmocka_run_group_tests_name("governor", tests, NULL, NULL);
}
