#include "reference.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "metric.h"

enum { KEY_MAX = 2048, LEAST_PATHS = 4 };

#define SAVE_MS 30000.0
#define LOOK_MS 500.0
/* What stops `velum-accuracy reference`: what has been done is kept. */
static volatile sig_atomic_t told_to_stop;

void reference_stop(int signal_number) {
    told_to_stop = signal_number;
}

bool reference_is_stopped(void) {
    return told_to_stop != 0;
}

/* Of the time of a part, by which it has random numbers of its own: nothing moves in it. */
#define PART_S 1e-6

static void make_key(const stage *s, const char *name, const stage_camera *c, float wind_east_m_s,
                     const reference_options *options, char key[KEY_MAX]) {
    uint64_t camera = stage_hash(0, c, sizeof *c);
    snprintf(key, KEY_MAX,
             "velum-accuracy reference 5\nscene %s %016llx\ncamera %016llx\nwind %g\nsize %u %u\nrevision %016llx\n",
             name, (unsigned long long)s->scenario_hash, (unsigned long long)camera, (double)wind_east_m_s,
             options->width, options->height, (unsigned long long)s->revision);
}

static void make_path(const char *name, const char *key, const char *folder, char path[1024]) {
    snprintf(path, 1024, "%s/%s-%016llx.ref", folder, name, (unsigned long long)stage_hash(0, key, strlen(key)));
}

static void look(reference *r) {
    picture_update_luminance(&r->picture);
    metric_noise(r->picture.luminance, r->picture.variance, r->picture.width, r->picture.height, &r->noise,
                 &r->noise_8);
}

static bool move(FILE *file, bool out, void *data, size_t size, uint64_t *hash) {
    bool ok = (out ? fwrite(data, 1, size, file) : fread(data, 1, size, file)) == size;
    *hash = stage_hash(*hash, data, size);
    return ok;
}

/* The same for reading and writing: what there is, then its hash. */
static bool move_body(FILE *file, bool out, reference *r) {
    picture *p = &r->picture;
    double figures[4] = {r->seconds, r->paths, r->parts, p->count};
    size_t floats = p->count * sizeof(float);
    uint64_t hash = 0, unused = 0;
    bool ok = move(file, out, r->made_on, sizeof r->made_on, &hash) &&
              move(file, out, figures, sizeof figures, &hash) && figures[3] == (double)p->count &&
              move(file, out, p->rgb, 3 * floats, &hash) && move(file, out, p->transmittance, 3 * floats, &hash) &&
              move(file, out, p->distance, floats, &hash) && move(file, out, p->variance, floats, &hash);
    uint64_t told = hash;
    ok = ok && move(file, out, &told, sizeof told, &unused) && told == hash;
    r->seconds = figures[0];
    r->paths = figures[1];
    r->parts = (uint32_t)figures[2];
    return ok;
}

/* Whatever wrote the file. */
static bool is_sound(const reference *r) {
    const picture *p = &r->picture;
    double sum = 0.0;
    for (uint32_t i = 0; i < p->count; i++) {
        sum += p->variance[i] < 0.0f ? NAN : (double)p->variance[i] + (double)p->distance[i];
        for (uint32_t k = 0; k < 3; k++) {
            sum += (double)p->rgb[3 * i + k] + (double)p->transmittance[3 * i + k];
        }
    }
    return r->made_on[sizeof r->made_on - 1] == '\0' && isfinite(sum) && r->paths >= 1.0 && r->seconds >= 0.0 &&
           isfinite(r->paths + r->seconds);
}

static bool load(const char *path, const char *key, reference *r) {
    char found[KEY_MAX];
    FILE *file = fopen(path, "rb");
    size_t length = strlen(key) + 1;
    bool ok = file && fread(found, 1, length, file) == length && memcmp(found, key, length) == 0 &&
              move_body(file, false, r) && is_sound(r);
    if (file) {
        fclose(file);
    }
    if (ok) {
        look(r);
    } else {
        r->seconds = r->paths = 0.0;
        r->parts = 0;
    }
    return ok;
}

/* path: in the cache. */
static bool find(const char *name, const char *key, const reference_options *options, char path[1024], reference *r) {
    char kept[1024];
    make_path(name, key, options->cache, path);
    make_path(name, key, options->kept, kept);
    return load(path, key, r) || load(kept, key, r);
}

static bool save(const char *path, const char *key, reference *r) {
    char temporary[1100];
    snprintf(temporary, sizeof temporary, "%s.%ld", path, (long)getpid());
    FILE *file = fopen(temporary, "wb");
    bool ok = file && fwrite(key, 1, strlen(key) + 1, file) == strlen(key) + 1 && move_body(file, true, r);
    if (file && fclose(file) != 0) {
        ok = false;
    }
    if (!ok || rename(temporary, path) != 0) {
        fprintf(stderr, "velum-accuracy: %s: cannot be kept: %s\n", path, strerror(errno));
        remove(temporary);
        return false;
    }
    return true;
}

static void copy_picture(picture *to, const picture *from) {
    memcpy(to->rgb, from->rgb, 3 * sizeof(float) * from->count);
    memcpy(to->transmittance, from->transmittance, 3 * sizeof(float) * from->count);
    memcpy(to->distance, from->distance, sizeof(float) * from->count);
    memcpy(to->variance, from->variance, sizeof(float) * from->count);
}

bool reference_is_enough(const reference *r, const reference_options *options) {
    return r->paths >= LEAST_PATHS && (r->noise_8 <= options->error || r->seconds >= 0.99 * options->seconds ||
                                       (options->paths > 0.0 && r->paths >= options->paths));
}

/* Where one part stands: before it, `base`; itself, `now`; both, `out`. */
typedef struct part {
    reference base;
    picture now;
    double paths;
} part;

static void gather(const part *t, double seconds, reference *out) {
    copy_picture(&out->picture, t->base.parts > 0 ? &t->base.picture : &t->now);
    if (t->base.parts > 0) {
        picture_merge(&out->picture, t->base.paths, &t->now, t->paths);
    }
    out->paths = t->base.paths + t->paths;
    out->parts = t->base.parts + 1;
    out->seconds = t->base.seconds + seconds;
    look(out);
}

static void tell(const char *name, const reference *r, bool done) {
    if (isatty(STDERR_FILENO)) {
        fprintf(stderr, "\r%-22s reference: %5.1f s, %.0f paths, noise %.4f, of blocks %.4f%s", name, r->seconds,
                r->paths, r->noise, r->noise_8, done ? "\n" : "");
    }
}

static velum_result add_paths(stage *s, part *t, stage_view *v, const char *name, const stage_camera *c,
                              const reference_options *options, const char *path, const char *key, reference *out,
                              bool *kept) {
    double start_ms = stage_now_ms(), looked_ms = start_ms, saved_ms = start_ms;
    uint32_t flags = VELUM_VIEW_CUT;
    velum_result result = VELUM_OK;
    for (bool done = false; !done && result >= 0; flags = 0) {
        velum_view_stats stats = {.struct_size = sizeof stats};
        result = stage_draw(s, v, c, PART_S * t->base.parts, flags, &t->now, NULL);
        if (result >= 0 && s->host.engine->get_stats(v->view, &stats) == VELUM_OK) {
            t->paths = (double)stats.paths_per_pixel;
        }
        double now_ms = stage_now_ms();
        bool at_limit = options->paths > 0.0 && t->base.paths + t->paths >= options->paths;
        double seconds = 1e-3 * (now_ms - start_ms);
        /* A few paths do not tell their variance: the clock stops nothing before there are more. */
        double left_s = options->seconds - t->base.seconds;
        bool late = told_to_stop || seconds >= (t->paths < LEAST_PATHS ? options->patience : 1.0) * left_s;
        if (result < 0 || (now_ms - looked_ms < LOOK_MS && !at_limit && !late)) {
            continue;
        }
        looked_ms = now_ms;
        if (t->paths >= LEAST_PATHS) {
            gather(t, seconds, out);
            snprintf(out->made_on, sizeof out->made_on, "%s", s->device_name);
        }
        done = late || (t->paths >= LEAST_PATHS && reference_is_enough(out, options));
        if (t->paths >= LEAST_PATHS && (done || now_ms - saved_ms > SAVE_MS)) {
            saved_ms = now_ms;
            *kept = save(path, key, out);
            if (!*kept) {
                return VELUM_OK;
            }
        }
        tell(name, out, done);
    }
    return result;
}

static int render(stage *s, const char *name, const stage_camera *c, const reference_options *options, const char *path,
                  const char *key, reference *out) {
    stage_view v = {0};
    part t = {.base = *out};
    int status = STAGE_FAILED;
    bool kept = true;
    t.base.picture = (picture){0};
    velum_result result = VELUM_ERROR_OUT_OF_MEMORY;
    if (picture_init(&t.base.picture, options->width, options->height) &&
        picture_init(&t.now, options->width, options->height)) {
        copy_picture(&t.base.picture, &out->picture);
        result = stage_view_init(s, &v, VELUM_QUALITY_REFERENCE, options->width, options->height);
    }
    if (result >= 0) {
        result = add_paths(s, &t, &v, name, c, options, path, key, out, &kept);
    }
    if (result < 0) {
        stage_fail(s, "reference", result);
    } else if (told_to_stop && out->parts == 0) {
        fprintf(stderr, "velum-accuracy: %s: stopped before there were %d paths a pixel: nothing is kept\n", name,
                LEAST_PATHS);
    } else if (out->parts == 0) {
        fprintf(stderr, "velum-accuracy: %s: %.0f paths a pixel in %.0f s are no reference; --seconds\n", name, t.paths,
                options->patience * options->seconds);
    } else if (kept) {
        status = STAGE_OK;
    }
    stage_view_finish(&v, s);
    picture_finish(&t.now);
    picture_finish(&t.base.picture);
    return status;
}

bool reference_load(stage *s, const char *name, const stage_camera *c, float wind_east_m_s,
                    const reference_options *options, reference *out) {
    char key[KEY_MAX], path[1024];
    *out = (reference){.parts = 0};
    if (!picture_init(&out->picture, options->width, options->height)) {
        return false;
    }
    make_key(s, name, c, wind_east_m_s, options, key);
    if (!find(name, key, options, path, out)) {
        reference_finish(out);
    }
    return out->parts > 0;
}

int reference_get(stage *s, const char *name, const stage_camera *c, float wind_east_m_s,
                  const reference_options *options, reference *out) {
    char key[KEY_MAX], path[1024];
    *out = (reference){.parts = 0};
    if (!picture_init(&out->picture, options->width, options->height)) {
        return STAGE_FAILED;
    }
    make_key(s, name, c, wind_east_m_s, options, key);
    if (find(name, key, options, path, out) && (options->cached || reference_is_enough(out, options))) {
        return STAGE_OK;
    }
    if (options->cached) {
        fprintf(stderr, "velum-accuracy: %s: %s is not there, or not sound\n", name, path);
        reference_finish(out);
        return STAGE_FAILED;
    }
    int status = render(s, name, c, options, path, key, out);
    if (status != STAGE_OK) {
        reference_finish(out);
    }
    return status;
}

void reference_finish(reference *r) {
    picture_finish(&r->picture);
    *r = (reference){.parts = 0};
}
