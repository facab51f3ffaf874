#include "reference.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "metric.h"

enum { KEY_MAX = 2048, STAND_IN_FRAMES = 16, LEAST_PATHS = 16, PATIENCE = 4 };

static void make_key(const stage *s, const char *name, const stage_camera *c, float wind_east_m_s,
                     const reference_options *options, char key[KEY_MAX]) {
    uint64_t camera = stage_hash(0, c, sizeof *c);
    snprintf(key, KEY_MAX,
             "velum-accuracy reference 2\nscene %s %016llx\ncamera %016llx\nwind %g\nsize %u %u\nplugin %016llx\n"
             "device %s\n",
             name, (unsigned long long)s->scenario_hash, (unsigned long long)camera, (double)wind_east_m_s,
             options->width, options->height, (unsigned long long)s->plugin_hash, s->device_name);
}

static void make_path(const char *name, const char *key, const char *cache, char path[1024]) {
    snprintf(path, 1024, "%s/%s-%016llx.ref", cache, name, (unsigned long long)stage_hash(0, key, strlen(key)));
}

/* Noise of 8 x 8 means from the variance of pixels, which are independent. */
void reference_noise(const picture *p, double *out_noise, double *out_noise_8) {
    metric m;
    *out_noise = *out_noise_8 = INFINITY;
    uint32_t blocks = ((p->width + 7) / 8) * ((p->height + 7) / 8);
    float *mean = calloc(2u * blocks, sizeof *mean);
    if (mean && metric_compute(p->luminance, p->luminance, p->variance, p->count, &m)) {
        *out_noise = m.noise;
        metric_blocks(p->luminance, p->variance, p->width, p->height, 8, mean, mean + blocks);
        if (metric_compute(mean, mean, mean + blocks, blocks, &m)) {
            *out_noise_8 = m.noise;
        }
    }
    free(mean);
}

static bool move(FILE *file, bool out, void *data, size_t size) {
    return (out ? fwrite(data, 1, size, file) : fread(data, 1, size, file)) == size;
}

/* The same for reading and writing. */
static bool move_body(FILE *file, bool out, reference *r) {
    picture *p = &r->picture;
    double figures[5] = {r->seconds, r->paths, r->frames, r->stand_in ? 1.0 : 0.0, p->count};
    size_t floats = p->count * sizeof(float);
    bool ok = move(file, out, figures, sizeof figures) && figures[4] == (double)p->count &&
              move(file, out, p->rgb, 3 * floats) && move(file, out, p->transmittance, 3 * floats) &&
              move(file, out, p->distance, floats) && move(file, out, p->variance, floats);
    r->seconds = figures[0];
    r->paths = figures[1];
    r->frames = (uint32_t)figures[2];
    r->stand_in = figures[3] != 0.0;
    return ok;
}

static bool load(const char *path, const char *key, reference *r) {
    char found[KEY_MAX];
    FILE *file = fopen(path, "rb");
    size_t length = strlen(key) + 1;
    bool ok =
        file && fread(found, 1, length, file) == length && memcmp(found, key, length) == 0 && move_body(file, false, r);
    if (file) {
        fclose(file);
    }
    if (ok) {
        picture_update_luminance(&r->picture);
        reference_noise(&r->picture, &r->noise, &r->noise_8);
        r->cached = true;
    }
    return ok;
}

static void save(const char *cache, const char *path, const char *key, reference *r) {
    char temporary[1100];
    snprintf(temporary, sizeof temporary, "%s.%ld", path, (long)getpid());
    mkdir(cache, 0777);
    FILE *file = fopen(temporary, "wb");
    bool ok = file && fwrite(key, 1, strlen(key) + 1, file) == strlen(key) + 1 && move_body(file, true, r);
    if (file && fclose(file) != 0) {
        ok = false;
    }
    if (!ok || rename(temporary, path) != 0) {
        fprintf(stderr, "velum-accuracy: %s: cannot be kept: %s\n", path, strerror(errno));
        remove(temporary);
    }
}

static bool refine(stage *s, stage_view *v) {
    velum_plan plan = {.struct_size = sizeof plan};
    const char *reasons = NULL;
    velum_result result = s->host.engine->get_plan(v->eye, &plan, &reasons);
    if (result >= 0) {
        plan.march_steps = 4096;
        plan.light_steps = 32;
        plan.step_m = 10.0f;
        plan.step_growth = 0.002f;
        plan.ray_rate = 1;
        result = s->host.engine->set_plan(v->eye, &plan);
    }
    if (result < 0) {
        stage_fail(s, "plan", result);
    }
    return result >= 0;
}

static int render(stage *s, const char *name, const stage_camera *c, const reference_options *options, reference *r) {
    stage_view v;
    velum_result result = stage_view_init(s, &v, VELUM_QUALITY_REFERENCE, options->width, options->height);
    if (result == VELUM_ERROR_UNSUPPORTED) {
        r->stand_in = true;
        result = stage_view_init(s, &v, VELUM_QUALITY_ULTRA, options->width, options->height);
    }
    double start_ms = stage_now_ms(), told_ms = start_ms;
    bool done = false;
    for (r->frames = 0; result >= 0 && !done; r->frames++) {
        stage_cost cost;
        result = stage_draw(s, &v, c, 0.0, r->frames == 0 ? VELUM_VIEW_CUT : 0, &r->picture, &cost);
        if (result >= 0 && r->stand_in && r->frames == 0 && !refine(s, &v)) {
            stage_view_finish(&v, s);
            return STAGE_FAILED;
        }
        r->seconds = 1e-3 * (stage_now_ms() - start_ms);
        reference_noise(&r->picture, &r->noise, &r->noise_8);
        velum_view_stats stats = {.struct_size = sizeof stats};
        if (s->host.engine->get_stats(v.view, &stats) == VELUM_OK) {
            r->paths = (double)stats.paths_per_pixel;
        }
        /* A slice may not reach all pixels, and a few paths do not tell their variance. */
        if (r->stand_in) {
            done = r->frames + 1 >= STAND_IN_FRAMES;
        } else if (r->paths >= LEAST_PATHS) {
            done = r->noise_8 <= options->error || r->seconds >= options->seconds;
        } else {
            done = r->seconds >= PATIENCE * options->seconds;
        }
        if (isatty(STDERR_FILENO) && (done || stage_now_ms() - told_ms > 500.0)) {
            told_ms = stage_now_ms();
            fprintf(stderr, "\r%-22s reference: %5.1f s, %.0f paths, noise %.4f, of blocks %.4f%s", name, r->seconds,
                    r->paths, r->noise, r->noise_8, done ? "\n" : "");
        }
    }
    bool starved = !r->stand_in && r->paths < 2.0;
    if (result < 0) {
        stage_fail(s, "reference", result);
    } else if (starved) {
        fprintf(stderr, "velum-accuracy: %s: %.0f paths a pixel in %.0f s are no reference; --seconds\n", name,
                r->paths, r->seconds);
    }
    stage_view_finish(&v, s);
    return result < 0 || starved ? STAGE_FAILED : STAGE_OK;
}

int reference_get(stage *s, const char *name, const stage_camera *c, float wind_east_m_s,
                  const reference_options *options, reference *out) {
    char key[KEY_MAX], path[1024];
    *out = (reference){.frames = 0};
    if (!picture_init(&out->picture, options->width, options->height)) {
        return STAGE_FAILED;
    }
    make_key(s, name, c, wind_east_m_s, options, key);
    make_path(name, key, options->cache, path);
    if (load(path, key, out)) {
        if (out->stand_in || out->noise_8 <= options->error || out->seconds >= 0.99 * options->seconds) {
            return STAGE_OK;
        }
        out->cached = false;
    }
    out->stand_in = false;
    int status = render(s, name, c, options, out);
    if (status == STAGE_OK) {
        save(options->cache, path, key, out);
    } else {
        reference_finish(out);
    }
    return status;
}

void reference_finish(reference *r) {
    picture_finish(&r->picture);
    *r = (reference){.frames = 0};
}
