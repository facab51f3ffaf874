#include "program.h"

#include <stdlib.h>
#include <string.h>

double program_error(const program *p, const measurement *m) {
    return p->by_pixel ? m->m.error : m->m_8.error;
}

bool program_wants(const program *p, const scene_row *scene) {
    for (uint32_t i = 0; i < p->scene_count; i++) {
        if (strcmp(p->scenes[i], scene->name) == 0) {
            return true;
        }
    }
    return p->scene_count == 0;
}

static bool keep(program *p, const measurement *m) {
    if (p->result_count == p->result_capacity) {
        uint32_t capacity = p->result_capacity ? 2 * p->result_capacity : 64;
        measurement *grown = realloc(p->results, capacity * sizeof *grown);
        if (!grown) {
            return false;
        }
        p->results = grown;
        p->result_capacity = capacity;
    }
    p->results[p->result_count++] = *m;
    return true;
}

static void compare_one(program *p, const char *scene, const stage_camera *c, const method_row *row, double value,
                        int32_t quality, const reference *r, const picture *limit, picture *found) {
    measurement m;
    if (!measure(&p->s, scene, c, row, value, quality, r, limit, found, &m) || !keep(p, &m) ||
        (p->on_picture && !p->on_picture(p, &m, found, r))) {
        p->failed++;
        return;
    }
    if (m.invalid) {
        p->failed++;
    }
    if (p->log) {
        measure_print_json(p->log, &m);
        fflush(p->log);
    }
    if (p->json) {
        measure_print_json(stdout, &m);
    } else {
        if (p->result_count == 1) {
            printf("on %s, %u x %u pixels\n", p->s.device_name, p->reference.width, p->reference.height);
            measure_print_head();
        }
        measure_print(&m);
    }
}

static bool any_row(const program *p, bool blown) {
    for (const method_row *row = method_rows; p->method && row->group; row++) {
        if ((row->motion == MOTION_WIND) == blown && method_matches(row, p->method)) {
            return true;
        }
    }
    return false;
}

/* With the scene's own wind, or with the motion's more. STAGE_*. */
static int enter(program *p, const scene_row *scene, bool blown, stage_camera *camera) {
    int status = stage_load(&p->s, scene, blown ? measure_wind(MOTION_WIND) : 0.0f);
    if (status == STAGE_OK) {
        stage_camera_init(&p->s, p->reference.width, p->reference.height, camera);
        status = stage_prepare(&p->s, camera, p->reference.width, 0.0) ? STAGE_OK : STAGE_FAILED;
    }
    if (status != STAGE_OK) {
        *(status == STAGE_SKIPPED ? &p->skipped : &p->failed) += 1;
    }
    return status;
}

static void run_methods(program *p, const scene_row *scene, const stage_camera *camera, bool blown, const reference *r,
                        picture *found) {
    const char *group = "";
    const method_row *limit = NULL;
    picture fine;
    if (!p->method || !picture_init(&fine, found->width, found->height)) {
        return;
    }
    for (const method_row *row = method_rows; row->group; row++) {
        if ((row->motion == MOTION_WIND) != blown || !method_matches(row, p->method)) {
            continue;
        }
        if (strcmp(group, row->group) != 0) {
            measurement unused;
            group = row->group;
            limit = method_limit(group);
            if (limit && !measure(&p->s, scene->name, camera, limit, limit->values[0], limit->quality, r, NULL, &fine,
                                  &unused)) {
                p->failed++;
                limit = NULL;
            }
        }
        for (uint32_t i = 0; i < row->count; i++) {
            if (p->value == 0.0 || p->value == row->values[i]) {
                compare_one(p, scene->name, camera, row, row->values[i], row->quality, r, limit ? &fine : NULL, found);
            }
        }
    }
    picture_finish(&fine);
}

static void run_pass(program *p, const scene_row *scene, bool presets, bool blown) {
    reference r;
    picture found;
    stage_camera camera;
    if (enter(p, scene, blown, &camera) != STAGE_OK) {
        return;
    }
    if (!stage_cast_shadow(&p->s, &camera) || !picture_init(&found, p->reference.width, p->reference.height)) {
        p->failed++;
        return;
    }
    const float wind_m_s = blown ? measure_wind(MOTION_WIND) : 0.0f;
    if (reference_get(&p->s, scene->name, &camera, wind_m_s, &p->reference, &r) != STAGE_OK) {
        *(p->at_hand ? &p->skipped : &p->failed) += 1;
        picture_finish(&found);
        return;
    }
    for (uint32_t i = 0; presets && i < p->preset_count; i++) {
        compare_one(p, scene->name, &camera, NULL, p->presets[i], p->presets[i], &r, NULL, &found);
    }
    run_methods(p, scene, &camera, blown, &r, &found);
    reference_finish(&r);
    picture_finish(&found);
}

void program_run_scene(program *p, const scene_row *scene, bool presets) {
    if (presets || any_row(p, false)) {
        run_pass(p, scene, presets, false);
    }
    if (any_row(p, true)) {
        run_pass(p, scene, false, true);
    }
}

/* True: good enough, or never to be. */
static bool visit(program *p, const scene_row *scene, bool blown) {
    stage_camera camera;
    reference r;
    const float wind_m_s = blown ? measure_wind(MOTION_WIND) : 0.0f;
    reference_options options = p->reference;
    if (enter(p, scene, blown, &camera) != STAGE_OK) {
        return true;
    }
    double before = 0.0;
    options.patience = 100.0;
    options.seconds = 1e30;
    bool enough = false;
    if (reference_load(&p->s, scene->name, &camera, wind_m_s, &options, &r)) {
        enough = reference_is_enough(&r, &options);
        before = r.seconds;
        if (!enough) {
            reference_finish(&r);
        }
    }
    options.seconds = before + p->reference.seconds;
    if (!enough && reference_get(&p->s, scene->name, &camera, wind_m_s, &options, &r) != STAGE_OK) {
        p->failed++;
        return true;
    }
    options.seconds = 1e30;
    bool done = reference_is_enough(&r, &options);
    printf("%-22s%s %7.0f s %7.0f paths in %2u parts, noise %.4f, of means over 8 x 8 %.4f%s\n", scene->name,
           blown ? " blown" : "      ", r.seconds, r.paths, r.parts, r.noise, r.noise_8, done ? ", done" : "");
    fflush(stdout);
    done = done || r.seconds <= before; /* nothing could be added */
    reference_finish(&r);
    return done;
}

int program_make_references(program *p) {
    enum { SCENES_MAX = 64 };
    bool done[SCENES_MAX][2] = {{false}};
    double start_ms = stage_now_ms();
    for (bool left = true; left;) {
        left = false;
        for (uint32_t i = 0; i < SCENES_MAX && scene_rows[i].name; i++) {
            const scene_row *scene = &scene_rows[i];
            for (int blown = 0; blown < (scene->sweep ? 2 : 1) && program_wants(p, scene); blown++) {
                if (p->minutes > 0.0 && stage_now_ms() - start_ms > 6e4 * p->minutes) {
                    return p->failed ? 1 : 0;
                }
                done[i][blown] = done[i][blown] || visit(p, scene, blown != 0);
                if (reference_is_stopped()) {
                    return 1;
                }
                left = left || !done[i][blown];
            }
        }
    }
    return p->failed ? 1 : 0;
}
