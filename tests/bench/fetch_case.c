/* Samples that the march fetches a second, against the most that the device gives from the same textures. */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "../gpu/values/noise_textures.h"
#include "core/noise.h"
#include "fetch_pages.spv.h"
#include "fetch_volume.spv.h"
#include "scene.h"
#include "shared/tile_address.h"

enum { WIDTH = 640, HEIGHT = 360, RAYS_ACROSS = WIDTH / 4, PAGES = 64, REPEATS = 3 };

#define PLAY_STEP_S (1.0 / 60.0)
/* Of medium's rays: four pixels apart, 60 degrees in all. */
#define RAY_ANGLE (1.155f * 4.0f / WIDTH)
/* Steps over the period: 70 m in a cumulus field's shape (10.5 km); 13 m, as in cloud, in its lumps (2.1 km); of a
 * page of some 10 km 70 m. See shaders/shared/density.h and plugin/plan.c. */
#define SHAPE_STEP (70.0f / 10500.0f)
#define DETAIL_STEP (13.0f / 2100.0f)
#define PAGE_STEP (70.0f / 10000.0f)

#define SHARE_BOUND 0.6

typedef enum kind { SHAPE, DETAIL, OTHER, KINDS } kind;
static const char *const kind_names[KINDS] = {"shape 128^3", "detail 64^3", "tiles and tables"};

/* What is fetched from. */
typedef struct bank {
    compute_device device;
    compute_texture textures[KINDS];
    uint32_t rays, fetches_a_ray;
    uint32_t *out;
} bank;

static void bank_finish(bank *k) {
    if (k->device.device) {
        for (int i = 0; i < KINDS; i++) {
            compute_texture_destroy(&k->device, &k->textures[i]);
        }
        compute_close(&k->device);
    }
    free(k->out);
    *k = (bank){.out = NULL};
}

static bool create_pages(bank *k) {
    const size_t bytes = (size_t)PAGES * VELUM_TILE_SIDE * VELUM_TILE_SIDE * 4 * sizeof(uint16_t);
    uint16_t *texels = malloc(bytes);
    for (size_t i = 0; texels && i < bytes / sizeof *texels; i++) {
        texels[i] = (uint16_t)(i * 40503u);
    }
    bool ok = texels && compute_array_create(&k->device, VK_FORMAT_R16G16B16A16_UNORM, VELUM_TILE_SIDE, PAGES, texels,
                                             bytes, &k->textures[OTHER]);
    free(texels);
    return ok;
}

static bool bank_init(bank *k, const bench *b) {
    const vulkan_device *d = &b->device;
    /* A GPU is timed from outside: enough work that a submission's own milliseconds are little of it. */
    *k = d->is_processor ? (bank){.rays = RAYS_ACROSS * 96, .fetches_a_ray = 256}
                         : (bank){.rays = RAYS_ACROSS * 6144, .fetches_a_ray = 4096};
    k->out = malloc(k->rays * sizeof *k->out);
    const core_noise *noise = core_noise_built();
    bool ok = k->out && compute_borrow(&k->device, d->instance, d->physical, d->device, d->family) &&
              noise_texture_create(&k->device, VK_FORMAT_R16_UNORM, CORE_NOISE_SHAPE_SIDE, noise->shape,
                                   &k->textures[SHAPE]) &&
              noise_texture_create(&k->device, VK_FORMAT_R16_UNORM, CORE_NOISE_DETAIL_SIDE, noise->detail,
                                   &k->textures[DETAIL]) &&
              create_pages(k);
    if (!ok) {
        bank_finish(k);
        bench_fail(b, "textures", VELUM_ERROR_OUT_OF_MEMORY);
    }
    return ok;
}

/* Millions of samples a second, the quickest of a few runs. */
static bool limit_of(bank *k, kind which, double *out_m_s) {
    const float steps[KINDS] = {SHAPE_STEP, DETAIL_STEP, PAGE_STEP}, angle = RAY_ANGLE;
    uint32_t words[4] = {RAYS_ACROSS, k->fetches_a_ray / 4};
    memcpy(&words[2], &steps[which], sizeof words[2]);
    memcpy(&words[3], &angle, sizeof words[3]);
    const bool flat = which == OTHER;
    compute_job job = {.spirv = flat ? fetch_pages_spirv : fetch_volume_spirv,
                       .spirv_bytes = flat ? sizeof fetch_pages_spirv : sizeof fetch_volume_spirv,
                       .input = words,
                       .input_bytes = sizeof words,
                       .output = k->out,
                       .output_bytes = k->rays * sizeof *k->out,
                       .invocations = k->rays,
                       .textures = {&k->textures[which]},
                       .repeats = REPEATS};
    bool ok = compute_run(&k->device, &job);
    *out_m_s = ok ? 1e-6 * k->rays * k->fetches_a_ray / job.seconds : 0.0;
    return ok;
}

/* A scene with its eye, settled; of the plugin that a host has open. */
typedef struct player {
    bench b;
    scene s;
    scene_eye eye;
} player;

static void player_finish(player *p) {
    if (p->eye.eye) {
        scene_eye_finish(&p->eye, &p->s);
    }
    if (p->s.world) {
        scene_finish(&p->s);
    }
    if (p->b.has_device) {
        vulkan_device_close(&p->b.device);
    }
    test_host_close(&p->b.host);
}

static bool player_init(player *p, const bench *b, const char *plugin) {
    *p = (player){.b = *b};
    p->b.host = (test_host){.library = NULL};
    p->b.has_device = false;
    if (!b->scenario) {
        p->b.scenario = BENCH_SCENES "/broken_sky.json";
    }
    char *kept = strdup(getenv("VELUM_PLUGIN"));
    setenv("VELUM_PLUGIN", plugin, 1);
    bool ok = kept && test_host_open(&p->b.host);
    setenv("VELUM_PLUGIN", kept ? kept : plugin, 1);
    free(kept);
    p->b.has_device = ok && vulkan_device_open(&p->b.device, &p->b.host, p->b.no_device);
    ok = p->b.has_device && scene_init(&p->s, &p->b) &&
         scene_eye_init(&p->s, &p->eye, VELUM_QUALITY_MEDIUM, 1, WIDTH, HEIGHT) && scene_settle(&p->s, &p->eye, 17);
    if (!ok) {
        player_finish(p);
    }
    return ok;
}

static bool find_counting_plugin(char *path, size_t size) {
    ssize_t length = readlink("/proc/self/exe", path, size - 64);
    if (length <= 0) {
        return false;
    }
    path[length] = '\0';
    char *slash = strrchr(path, '/');
    strcpy(slash ? slash : path, "/libvelum-counting.so");
    return access(path, R_OK) == 0;
}

/* Frames of the plugin that counts, one for each of the plugin's own, at the same times: what its counters have more.
 */
typedef struct tally {
    bench_series fetches[KINDS], samples, light_samples, rays, march_ms;
} tally;

static void add_frame(tally *t, const scene_frame *plain, const scene_frame *counted) {
    bench_add(&t->fetches[SHAPE], counted->rays - plain->rays);
    bench_add(&t->fetches[DETAIL], counted->samples - plain->samples);
    bench_add(&t->fetches[OTHER], counted->light_samples - plain->light_samples);
    bench_add(&t->samples, plain->samples);
    bench_add(&t->light_samples, plain->light_samples);
    bench_add(&t->rays, plain->rays);
    bench_add(&t->march_ms, plain->march_ms);
}

static void report(const bench *b, const tally *t, const bench_series limits[KINDS]) {
    static const char *const figures[KINDS] = {"fetches_shape", "fetches_detail", "fetches_other"};
    /* The quickest of each: what else the machine does slows both, and seldom both alike. */
    const double march_s = 1e-3 * bench_least(&t->march_ms), samples = bench_median(&t->samples);
    double volumes = 0.0, at_limit_s[KINDS];
    for (int i = 0; i < KINDS; i++) {
        bench_report(b, kind_names[i], "limit", "M/s", &limits[i]);
        bench_report(b, "march", figures[i], "1", &t->fetches[i]);
        at_limit_s[i] = bench_median(&t->fetches[i]) / (1e6 * bench_greatest(&limits[i]));
        volumes += i == OTHER ? 0.0 : bench_median(&t->fetches[i]);
    }
    bench_report(b, "march", "march", "ms", &t->march_ms);
    bench_report(b, "march", "rays", "1", &t->rays);
    bench_report(b, "march", "samples", "1", &t->samples);
    bench_report(b, "march", "light_samples", "1", &t->light_samples);
    bench_report_value(b, "march", "fetches_a_sample", "1", volumes / samples);
    bench_report_value(b, "march", "fetched", "M/s", 1e-6 * volumes / march_s);
    /* The time that the device needs for these fetches alone, of the time that the march takes. */
    bench_judge_value(b, "march", "share_of_limit", "1", (at_limit_s[SHAPE] + at_limit_s[DETAIL]) / march_s,
                      BENCH_AT_LEAST, SHARE_BOUND);
    bench_report_value(b, "march", "share_with_tiles", "1",
                       (at_limit_s[SHAPE] + at_limit_s[DETAIL] + at_limit_s[OTHER]) / march_s);
}

static bool fetch(bench *b) {
    char counting[1024];
    if (!find_counting_plugin(counting, sizeof counting)) {
        bench_skip(b, "no libvelum-counting.so beside this program");
        return true;
    }
    static tally t;
    static bench_series limits[KINDS];
    static player plain, counted;
    bank k = {.out = NULL};
    memset(&t, 0, sizeof t);
    memset(limits, 0, sizeof limits);
    bool ok = bank_init(&k, b) && player_init(&plain, b, getenv("VELUM_PLUGIN"));
    if (ok && !player_init(&counted, b, counting)) {
        player_finish(&plain);
        ok = false;
    }
    if (!ok) {
        bank_finish(&k);
        return false;
    }
    for (uint32_t round = 0; round < b->rounds && ok; round++) {
        for (uint32_t i = 0; i <= b->frames && ok; i++) {
            scene_frame frame, with_counts;
            plain.s.time_s = counted.s.time_s += PLAY_STEP_S;
            ok = scene_draw(&plain.s, &plain.eye, &frame) && scene_draw(&counted.s, &counted.eye, &with_counts);
            if (ok && i > 0) {
                add_frame(&t, &frame, &with_counts);
            }
        }
        for (int i = 0; i < KINDS && ok; i++) {
            double m_s;
            ok = limit_of(&k, (kind)i, &m_s);
            bench_add(&limits[i], m_s);
        }
    }
    if (ok) {
        report(b, &t, limits);
    }
    player_finish(&counted);
    player_finish(&plain);
    bank_finish(&k);
    return ok;
}

const bench_case bench_fetch_cases[] = {
    {"fetch", "filtered samples a second that the march fetches, of the most that the device gives from its textures",
     fetch},
    {NULL, NULL, NULL},
};
