#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "program.h"
#include "sample_host/files.h"

static int usage(int status) {
    fprintf(
        status ? stderr : stdout,
        "velum-accuracy list\n"
        "velum-accuracy run [--scene S]... [--preset P]... [--method M [--value V]] [--json]\n"
        "velum-accuracy chart DIR [--scene S]... [--method M]\n"
        "velum-accuracy reference [--scene S]... [--minutes N]   adds to what is in the cache, scene by scene, until\n"
        "                  all are good enough; can be stopped at any time\n"
        "velum-accuracy bounds   presets low, medium and high and the volume of light against their bounds, by "
        "references at hand\n"
        "velum-accuracy genera DIR   ten genera by three suns from three places, preset high beside the reference\n"
        "velum-accuracy flight DIR   a strip of pictures from a flight through broken cloud, preset medium\n"
        "velum-accuracy stability [--scene CASE]...\n"
        "  --size WxH      of pictures (160x90)\n"
        "  --pixels        charts by the error of pixels; without it by that of means over 8 x 8, which the noise of\n"
        "                  a reference of seconds does not drown\n"
        "  --error E       a reference is good enough at this noise of means over 8 x 8 pixels (0.01)...\n"
        "  --paths N       ... or at so many paths a pixel...\n"
        "  --seconds N     ... or after so long (60), all that went into it; for `reference`: of one visit\n"
        "  --cached        references as they are in the cache, good enough or not; nothing is added\n"
        "  --cache DIR     of references (VELUM_ACCURACY_CACHE, else accuracy-cache beside the program); what it lacks "
        "is\n"
        "                  looked for in tests/data/references\n"
        "  --method M      a group or a curve of `list`, or all; without it `run` measures presets\n"
        "  --value V       of a method's values this alone\n"
        "  --device auto|cpu|INDEX   --plugin PATH (VELUM_PLUGIN)   --shared DIR (VELUM_SHARED)\n"
        "Error: see tests/accuracy/metric.h. Exit status 0 only if everything asked for was done; 77: what is missing "
        "was skipped.\n");
    return status;
}

static void list(void) {
    printf("scenes\n");
    for (const scene_row *row = scene_rows; row->name; row++) {
        printf("  %-22s %s%s\n", row->name, row->about, row->sweep ? " (methods)" : "");
    }
    printf("presets\n  low\n  medium\n  high\n  ultra\nmethods: group, curve, values\n");
    for (const method_row *row = method_rows; row->group; row++) {
        printf("  %-12s %-26s", row->group, row->name);
        for (uint32_t i = 0; i < row->count; i++) {
            printf(" %g", row->values[i]);
        }
        printf(" %s\n", row->unit);
    }
}

static bool parse_number(const char *text, double least, double most, double *out) {
    char *end = NULL;
    *out = strtod(text, &end);
    if (end == text || *end != '\0' || !(*out >= least && *out <= most)) {
        fprintf(stderr, "velum-accuracy: found '%s', expected %g..%g\n", text, least, most);
        return false;
    }
    return true;
}

static bool parse_preset(program *p, const char *text) {
    for (int32_t q = VELUM_QUALITY_LOW; q <= VELUM_QUALITY_ULTRA; q++) {
        if (strcmp(text, measure_preset(q)) == 0 && p->preset_count < 8) {
            p->presets[p->preset_count++] = q;
            return true;
        }
    }
    fprintf(stderr, "velum-accuracy: found preset '%s', expected low, medium, high or ultra\n", text);
    return false;
}

static bool parse_size(program *p, const char *text) {
    unsigned width = 0, height = 0;
    char rest = '\0';
    if (sscanf(text, "%ux%u%c", &width, &height, &rest) != 2 || width < 1 || width > 4096 || height < 1 ||
        height > 4096) {
        fprintf(stderr, "velum-accuracy: found size '%s', expected WxH\n", text);
        return false;
    }
    p->reference.width = width;
    p->reference.height = height;
    return true;
}

static bool parse_device(const char *text, int32_t *out) {
    double index;
    if (strcmp(text, "auto") == 0) {
        *out = VELUM_DEVICE_AUTO;
    } else if (strcmp(text, "cpu") == 0) {
        *out = VELUM_DEVICE_CPU;
    } else if (parse_number(text, 0.0, 63.0, &index)) {
        *out = (int32_t)index;
    } else {
        return false;
    }
    return true;
}

static bool parse_option(program *p, const char *name, const char *value, bool cases, int32_t *device) {
    if (strcmp(name, "--scene") == 0) {
        if (p->scene_count == PROGRAM_NAMES || (!cases && !scene_find(value))) {
            fprintf(stderr, "velum-accuracy: found scene '%s', expected one of `velum-accuracy list`\n", value);
            return false;
        }
        p->scenes[p->scene_count++] = value;
        return true;
    }
    if (strcmp(name, "--method") == 0) {
        bool known = strcmp(value, "all") == 0;
        for (const method_row *row = method_rows; row->group; row++) {
            known = known || method_matches(row, value);
        }
        if (!known) {
            fprintf(stderr, "velum-accuracy: found method '%s', expected one of `velum-accuracy list`\n", value);
        }
        p->method = value;
        return known;
    }
    if (strcmp(name, "--value") == 0) {
        return parse_number(value, 1e-9, 1e9, &p->value);
    }
    if (strcmp(name, "--error") == 0) {
        return parse_number(value, 1e-6, 1.0, &p->reference.error);
    }
    if (strcmp(name, "--paths") == 0) {
        return parse_number(value, 1.0, 1e9, &p->reference.paths);
    }
    if (strcmp(name, "--minutes") == 0) {
        return parse_number(value, 1e-3, 1e6, &p->minutes);
    }
    if (strcmp(name, "--seconds") == 0) {
        return parse_number(value, 0.0, 1e6, &p->reference.seconds);
    }
    if (strcmp(name, "--cache") == 0) {
        p->reference.cache = value;
        return true;
    }
    if (strcmp(name, "--plugin") == 0 || strcmp(name, "--shared") == 0) {
        return setenv(strcmp(name, "--plugin") == 0 ? "VELUM_PLUGIN" : "VELUM_SHARED", value, 1) == 0;
    }
    if (strcmp(name, "--preset") == 0) {
        return parse_preset(p, value);
    }
    if (strcmp(name, "--size") == 0) {
        return parse_size(p, value);
    }
    if (strcmp(name, "--device") == 0) {
        return parse_device(value, device);
    }
    usage(2);
    return false;
}

/* accuracy-cache beside the program. */
static const char *default_cache(char path[1024]) {
    const char *named = getenv("VELUM_ACCURACY_CACHE");
    ssize_t length = readlink("/proc/self/exe", path, 1000);
    char *slash = NULL;
    if (!named && length > 0) {
        path[length] = '\0';
        slash = strrchr(path, '/');
    }
    if (slash) {
        strcpy(slash, "/accuracy-cache");
    }
    return named ? named : slash ? path : "accuracy-cache";
}

/* Whether a row of the method has the value asked for. */
static bool value_is_known(const program *p) {
    bool known = p->value == 0.0;
    for (const method_row *row = method_rows; p->method && row->group; row++) {
        for (uint32_t i = 0; i < row->count && method_matches(row, p->method); i++) {
            known = known || row->values[i] == p->value;
        }
    }
    if (!known) {
        fprintf(stderr,
                "velum-accuracy: --value: found %g, expected one of the values that `velum-accuracy list` has "
                "of --method\n",
                p->value);
    }
    return known;
}

static int run_all(program *p) {
    bool presets = !p->method || p->preset_count > 0;
    if (p->preset_count == 0) {
        for (int32_t q = VELUM_QUALITY_LOW; q <= VELUM_QUALITY_ULTRA; q++) {
            p->presets[p->preset_count++] = q;
        }
    }
    for (const scene_row *row = scene_rows; row->name; row++) {
        bool chosen = p->scene_count > 0 || !p->method || row->sweep;
        if (chosen && program_wants(p, row)) {
            program_run_scene(p, row, presets);
        }
    }
    return p->failed ? 1 : 0;
}

static void tell_time(void) {
    struct rusage used;
    if (getrusage(RUSAGE_SELF, &used) == 0) {
        fprintf(stderr, "velum-accuracy: %.1f s of processor time\n",
                (double)(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
                    1e-6 * (double)(used.ru_utime.tv_usec + used.ru_stime.tv_usec));
    }
}

enum { LIST, RUN, CHART, STABILITY, REFERENCE, GENERA, FLIGHT, BOUNDS, COMMANDS };
static const char *const commands[COMMANDS] = {"list",      "run",    "chart",  "stability",
                                               "reference", "genera", "flight", "bounds"};

int main(int argc, char **argv) {
    char cache[1024];
    int command = -1, at = 2, status = 1;
    int32_t device = VELUM_DEVICE_AUTO;
    program p = {.reference = {.error = 0.01, .seconds = 60.0, .patience = 4.0, .width = 160, .height = 90}};
    p.reference.cache = default_cache(cache);
    p.reference.kept = ACCURACY_REFERENCES;
    for (int i = 0; i < COMMANDS && argc > 1; i++) {
        command = strcmp(argv[1], commands[i]) == 0 ? i : command;
    }
    if (command < 0) {
        return usage(argc > 1 && strcmp(argv[1], "--help") == 0 ? 0 : 2);
    }
    const bool writes = command == CHART || command == GENERA || command == FLIGHT;
    if (writes && (argc < 3 || argv[at][0] == '-')) {
        return usage(2);
    }
    p.folder = writes ? argv[at++] : NULL;
    while (at < argc) {
        if (strcmp(argv[at], "--json") == 0) {
            p.json = true;
            at++;
        } else if (strcmp(argv[at], "--pixels") == 0) {
            p.by_pixel = true;
            at++;
        } else if (strcmp(argv[at], "--cached") == 0) {
            p.reference.cached = true;
            at++;
        } else if (at + 1 < argc && parse_option(&p, argv[at], argv[at + 1], command == STABILITY, &device)) {
            at += 2;
        } else {
            return at + 1 < argc ? 2 : usage(2);
        }
    }
    if (!value_is_known(&p)) {
        return 2;
    }
    if (command == LIST) {
        list();
        return 0;
    }
    struct files_folder folder = {.made = 0};
    bool keeps = command != STABILITY;
    if (keeps && !files_prepare_folder(p.reference.cache, &folder)) {
        return 1;
    }
    if (!stage_init(&p.s, device)) {
        files_remove_empty(&folder);
        return 1;
    }
    if (command == REFERENCE || command == GENERA || command == FLIGHT) {
        signal(SIGINT, reference_stop);
        signal(SIGTERM, reference_stop);
    }
    status = command == RUN         ? run_all(&p)
             : command == CHART     ? chart_run(&p)
             : command == STABILITY ? stability_run(&p)
             : command == GENERA    ? genera_run(&p)
             : command == FLIGHT    ? flight_run(&p)
             : command == BOUNDS    ? bounds_run(&p)
                                    : program_make_references(&p);
    if (p.skipped || p.failed) {
        fprintf(stderr, "velum-accuracy: %u skipped, %u failed\n", p.skipped, p.failed);
    }
    status = status == 0 && p.skipped ? 77 : status;
    tell_time();
    stage_finish(&p.s);
    files_remove_empty(&folder);
    free(p.results);
    return status;
}
