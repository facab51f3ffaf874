#include "program.h"

#include <stdlib.h>
#include <string.h>

double program_error(const program *p, const measurement *m) {
    return p->by_pixel ? m->m.error_corrected : m->m_8.error_corrected;
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
                        int32_t quality, const reference *r, picture *found) {
    measurement m;
    if (!measure(&p->s, scene, c, row, value, quality, r, found, &m) || !keep(p, &m) ||
        (p->on_picture && !p->on_picture(p, &m, found, r))) {
        p->failed++;
        return;
    }
    if (m.invalid) {
        p->failed++;
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

/* With the scene's own wind, or with the motion's more. */
static void run_pass(program *p, const scene_row *scene, bool presets, bool blown) {
    reference r;
    picture found;
    stage_camera camera;
    const float wind_m_s = blown ? measure_wind(MOTION_WIND) : 0.0f;
    int status = stage_load(&p->s, scene, wind_m_s);
    if (status != STAGE_OK) {
        *(status == STAGE_SKIPPED ? &p->skipped : &p->failed) += 1;
        return;
    }
    stage_camera_init(&p->s, p->reference.width, p->reference.height, &camera);
    if (!stage_prepare(&p->s, &camera, p->reference.width, 0.0) || !stage_cast_shadow(&p->s, &camera) ||
        !picture_init(&found, p->reference.width, p->reference.height)) {
        p->failed++;
        return;
    }
    if (reference_get(&p->s, scene->name, &camera, wind_m_s, &p->reference, &r) != STAGE_OK) {
        p->failed++;
        picture_finish(&found);
        return;
    }
    for (uint32_t i = 0; presets && i < p->preset_count; i++) {
        compare_one(p, scene->name, &camera, NULL, p->presets[i], p->presets[i], &r, &found);
    }
    for (const method_row *row = method_rows; p->method && row->group; row++) {
        for (uint32_t i = 0; i < row->count; i++) {
            if ((row->motion == MOTION_WIND) == blown && method_matches(row, p->method)) {
                compare_one(p, scene->name, &camera, row, row->values[i], row->quality, &r, &found);
            }
        }
    }
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
