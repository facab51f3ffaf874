#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bench.h"
#include "sample_host/files.h"

static const bench_case *const tables[] = {bench_frame_cases,   bench_weather_cases, bench_fetch_cases,
                                           bench_scaling_cases, bench_motion_cases,  bench_flicker_cases,
                                           bench_budget_cases};

static int usage(int status) {
    fprintf(status ? stderr : stdout,
            "velum-bench [--list] [--case NAME]... [--json] [--rounds N] [--frames N] [--scenario FILE]\n"
            "            [--shared DIR] [--plugin PATH] [--out DIR] [--size WxH]\n"
            "Medians over N rounds (7) of N frames (4) of each variant in turn. Without --case: all cases.\n"
            "--case motion: all of which the name begins with motion_, where none is called so.\n"
            "--out: a folder for charts and pictures. --size: of motion, flicker and budget (320x180).\n"
            "--shared: real weather files (the environment's VELUM_SHARED). --plugin: VELUM_PLUGIN.\n");
    return status;
}

static bool parse_count(const char *text, uint32_t *out) {
    char *end = NULL;
    unsigned long value = strtoul(text, &end, 10);
    if (end == text || *end != '\0' || value < 1 || value > 128) {
        fprintf(stderr, "velum-bench: found '%s', expected 1..128\n", text);
        return false;
    }
    *out = (uint32_t)value;
    return true;
}

static bool parse_size(const char *text, bench *b) {
    char rest = '\0';
    if (sscanf(text, "%ux%u%c", &b->width, &b->height, &rest) != 2 || b->width < 16 || b->width > 4096 ||
        b->height < 16 || b->height > 4096) {
        fprintf(stderr, "velum-bench: --size: found '%s', expected WxH, each 16..4096\n", text);
        return false;
    }
    return true;
}

/* Beside the build tree's tests/bench. */
static void find_plugin(void) {
    char path[1024];
    ssize_t length = readlink("/proc/self/exe", path, sizeof path - 64);
    if (getenv("VELUM_PLUGIN") || length <= 0) {
        return;
    }
    path[length] = '\0';
    char *slash = strrchr(path, '/');
    if (slash) {
        strcpy(slash, "/../../plugin/libvelum.so");
        setenv("VELUM_PLUGIN", path, 0);
    }
}

/* By its name, else by what stands before a '_' in it. */
static bool is_named(const bench_case *c, const char *name, bool exactly) {
    size_t length = strlen(name);
    return exactly ? strcmp(c->name, name) == 0 : strncmp(c->name, name, length) == 0 && c->name[length] == '_';
}

static uint32_t choose(const char *name, const bench_case **out, uint32_t room) {
    uint32_t count = 0;
    for (int exactly = 1; exactly >= 0 && count == 0; exactly--) {
        for (size_t t = 0; t < sizeof tables / sizeof tables[0]; t++) {
            for (const bench_case *c = tables[t]; c->name; c++) {
                if (count < room && is_named(c, name, exactly)) {
                    out[count++] = c;
                }
            }
        }
    }
    return count;
}

/* Each on a device of its own. */
static bool run_case(bench *b, const bench_case *c) {
    b->case_name = c->name;
    b->has_device = vulkan_device_open(&b->device, &b->host, b->no_device);
    test_log_clear(&b->host.log);
    bool needs_device = strcmp(c->name, "reading") != 0;
    bool ok = true;
    if (needs_device && !b->has_device) {
        bench_skip(b, b->no_device);
    } else {
        ok = c->run(b);
    }
    if (b->has_device) {
        vulkan_device_close(&b->device);
    }
    return ok;
}

int main(int argc, char **argv) {
    bench b = {.rounds = 7, .frames = 4, .width = 320, .height = 180, .shared = getenv("VELUM_SHARED")};
    const bench_case *chosen[64];
    uint32_t chosen_count = 0;
    for (int i = 1; i < argc; i++) {
        const char *value = i + 1 < argc ? argv[i + 1] : NULL;
        if (strcmp(argv[i], "--list") == 0) {
            for (size_t t = 0; t < sizeof tables / sizeof tables[0]; t++) {
                for (const bench_case *c = tables[t]; c->name; c++) {
                    printf("%-20s %s\n", c->name, c->about);
                }
            }
            return 0;
        }
        if (strcmp(argv[i], "--help") == 0) {
            return usage(0);
        }
        if (strcmp(argv[i], "--json") == 0) {
            b.json = true;
            continue;
        }
        if (!value) {
            return usage(2);
        }
        i++;
        if (strcmp(argv[i - 1], "--case") == 0) {
            uint32_t found = choose(value, chosen + chosen_count, 64 - chosen_count);
            if (found == 0) {
                fprintf(stderr, "velum-bench: found case '%s', expected one of --list\n", value);
                return 2;
            }
            chosen_count += found;
        } else if (strcmp(argv[i - 1], "--rounds") == 0 || strcmp(argv[i - 1], "--frames") == 0) {
            if (!parse_count(value, argv[i - 1][2] == 'r' ? &b.rounds : &b.frames)) {
                return 2;
            }
        } else if (strcmp(argv[i - 1], "--scenario") == 0) {
            b.scenario = value;
        } else if (strcmp(argv[i - 1], "--out") == 0) {
            b.out = value;
        } else if (strcmp(argv[i - 1], "--size") == 0) {
            if (!parse_size(value, &b)) {
                return 2;
            }
        } else if (strcmp(argv[i - 1], "--shared") == 0) {
            b.shared = value;
        } else if (strcmp(argv[i - 1], "--plugin") == 0) {
            setenv("VELUM_PLUGIN", value, 1);
        } else {
            return usage(2);
        }
    }
    struct files_folder folder = {.made = 0};
    if (b.out && !files_prepare_folder(b.out, &folder)) {
        return 2;
    }
    if (!b.shared) {
        b.shared = "../shared";
    }
    find_plugin();
    if (!test_host_open(&b.host)) {
        files_remove_empty(&folder);
        return 1;
    }
    bool ok = true;
    for (size_t t = 0; t < sizeof tables / sizeof tables[0]; t++) {
        for (const bench_case *c = tables[t]; c->name; c++) {
            bool wanted = chosen_count == 0;
            for (uint32_t i = 0; i < chosen_count; i++) {
                wanted = wanted || chosen[i] == c;
            }
            if (wanted && !run_case(&b, c)) {
                ok = false;
            }
        }
    }
    test_host_close(&b.host);
    files_remove_empty(&folder);
    return ok ? 0 : 1;
}
