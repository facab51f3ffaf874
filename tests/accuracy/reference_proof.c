/* The long proof of the reference, on demand, in pieces.
 *     velum-reference-proof [PART]... [--shared DIR] [--rows FIRST:LAST] [--error E] [--seconds N] [--suns N]
 * PART: radiance flux energy furnace reciprocity extinction first-order curvature air; none: all. DIR (VELUM_SHARED)
 * holds accuracy/slab_radiance.csv and slab_flux.csv. One line a figure; exit status 0 only if all hold, 77 if tables
 * are missing. */
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/geodesy.h"
#include "proof.h"

enum { PATHS_LEAST = 64, PATHS_MOST = 1024 };

bool proof_wants(const proof *p, int row) {
    return row >= p->first && row <= p->last;
}

const double proof_node[5] = {-0.9061798459386640, -0.5384693101056831, 0.0, 0.5384693101056831, 0.9061798459386640};
const double proof_weight[5] = {0.2369268850561891, 0.4786286704993665, 0.5688888888888889, 0.4786286704993665,
                                0.2369268850561891};

double proof_height_at(const double from[3], const double to[3], double t) {
    double point[3];
    core_geodetic place;
    for (int i = 0; i < 3; i++) {
        point[i] = from[i] + t * to[i];
    }
    assert_true(core_geodetic_from_ecef(point, &place));
    return place.height_m;
}

double proof_phase(double g, double cosine) {
    return (1.0 - g * g) / (4.0 * PROOF_PI * pow(1.0 + g * g - 2.0 * g * cosine, 1.5));
}

double proof_now_s(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void proof_add(proof_mean *m, double value, double error, double weight) {
    m->sum += weight * value;
    m->square += weight * weight * error * error;
    m->weight += weight;
}

double proof_value(const proof_mean *m) {
    return m->sum / m->weight;
}

double proof_error(const proof_mean *m) {
    return sqrt(m->square) / m->weight;
}

void proof_tell(proof *p, bool ok, const char *figure_and_bound, ...) {
    va_list arguments;
    va_start(arguments, figure_and_bound);
    vprintf(figure_and_bound, arguments);
    va_end(arguments);
    printf(": %s\n", ok ? "holds" : "BROKEN");
    fflush(stdout);
    p->failures += ok ? 0 : 1;
}

bool proof_meets(double found, double error, double expected) {
    double off = fabs(found - expected);
    bool fine = error <= 0.0015 * expected;
    return error > 0.0 && off <= 4.0 * error && (!fine || off <= 0.005 * expected);
}

void proof_measure(proof *p, const slab_case *c, double thickness_m, proof_mean *out) {
    double start_s = proof_now_s();
    *out = (proof_mean){0};
    for (uint32_t paths = PATHS_LEAST;; paths = paths < PATHS_MOST ? 2 * paths : paths) {
        double error, through;
        double found = slab_rig_measure(&p->rig, c, thickness_m, paths, &error, &through);
        proof_add(out, found, error, paths);
        if (proof_error(out) <= p->error * proof_value(out) || proof_now_s() - start_s > p->seconds) {
            break;
        }
    }
}

void proof_tell_chi2(proof *p, const char *what, int count, double chi2) {
    double normal = sqrt(2.0 * chi2) - sqrt(fmax(2.0 * count - 1.0, 0.0));
    proof_tell(p, count > 0 && normal <= 3.0, "%s, %d figures: chi-squared %.1f, %.2f sigma of 3", what, count, chi2,
               normal);
}

FILE *proof_table(proof *p, const char *name) {
    char path[1024];
    snprintf(path, sizeof path, "%s/accuracy/%s", p->shared ? p->shared : "", name);
    FILE *file = p->shared ? fopen(path, "r") : NULL;
    if (!file) {
        print_message("skipped: no %s; --shared DIR names the folder that has it\n", p->shared ? path : "tables");
        p->skipped++;
        skip();
    }
    return file;
}

static void meets_radiances(void **state) {
    proof *p = *state;
    char line[256];
    FILE *file = proof_table(p, "slab_radiance.csv");
    slab_rig_init(&p->rig);
    double chi2 = 0.0, worst = 0.0, worst_fine = 0.0, weights = 0.0, bias = 0.0;
    int row = 0, count = 0, fine = 0;
    while (fgets(line, sizeof line, file)) {
        slab_case c;
        /* Straight up and straight down have no azimuth: one row is enough. */
        if (!slab_case_parse(line, &c) || (c.mu > 0.999 && c.phi_deg > 0.0) || !proof_wants(p, ++row)) {
            continue;
        }
        proof_mean m;
        slab_rig_layer(&p->rig, &c, PROOF_SLAB_M);
        proof_measure(p, &c, PROOF_SLAB_M, &m);
        double found = proof_value(&m), error = proof_error(&m);
        double off = found - c.expected;
        double relative = error / c.expected;
        proof_tell(p, proof_meets(found, error, c.expected),
                   "radiance row %d, albedo %g, g %g, tau %g, mu0 %g, %s at mu %g, phi %g: %.6f +- %.6f, table %.6f: "
                   "%+.3f %% of %.3f %%, %+.2f sigma of 4",
                   row, c.albedo, c.g, c.tau, c.mu0, c.up ? "back" : "through", c.mu, c.phi_deg, found, error,
                   c.expected, 100.0 * off / c.expected, 100.0 * relative, off / error);
        count++;
        chi2 += off * off / error / error;
        worst = fmax(worst, fabs(off / error));
        weights += 1.0 / relative / relative;
        bias += off / c.expected / relative / relative;
        if (relative <= 0.0015) {
            fine++;
            worst_fine = fmax(worst_fine, fabs(off) / c.expected);
        }
    }
    fclose(file);
    slab_rig_finish(&p->rig);
    proof_tell_chi2(p, "radiance", count, chi2);
    proof_tell(p, worst <= 4.0, "radiance, %d rows: largest deviation %.2f sigma of 4", count, worst);
    if (fine > 0) {
        proof_tell(p, worst_fine <= 0.005, "radiance, %d rows known to 0.15 %%: largest deviation %.3f %% of 0.5 %%",
                   fine, 100.0 * worst_fine);
    } else {
        print_message("radiance: no row is known to 0.15 %%, so none shows 0.5 %%; --seconds\n");
    }
    if (count > 0) {
        proof_tell(p, fabs(bias) <= 4.0 * sqrt(weights),
                   "radiance, %d rows: mean deviation %+.4f %% +- %.4f %%, 4 sigma", count, 100.0 * bias / weights,
                   100.0 / sqrt(weights));
    }
}

static const struct {
    const char *name;
    CMUnitTestFunction run;
} parts[] = {{"radiance", meets_radiances},
             {"flux", proof_flux},
             {"energy", proof_energy},
             {"furnace", proof_furnace},
             {"reciprocity", proof_reciprocity},
             {"extinction", proof_extinction},
             {"first-order", proof_first_order},
             {"curvature", proof_curvature},
             {"air", proof_air}};
enum { PARTS = sizeof parts / sizeof parts[0] };

static int usage(void) {
    fprintf(stderr, "velum-reference-proof [PART]... [--shared DIR] [--rows FIRST:LAST] [--error E] [--seconds N] "
                    "[--suns N]\nparts:");
    for (size_t i = 0; i < PARTS; i++) {
        fprintf(stderr, " %s", parts[i].name);
    }
    fprintf(stderr, "\n  --error    relative standard error at which a figure is known well enough (0.0015)...\n"
                    "  --seconds  ... or it has taken so long (30; the furnace 20 times that)\n");
    return 2;
}

static bool parse(proof *p, const char *name, const char *value) {
    char *end = NULL;
    if (strcmp(name, "--shared") == 0) {
        p->shared = value;
        return true;
    }
    if (strcmp(name, "--rows") == 0) {
        return sscanf(value, "%d:%d", &p->first, &p->last) == 2;
    }
    double number = strtod(value, &end);
    if (end == value || *end != '\0' || !(number > 0.0 && number < 1e9)) {
        return false;
    }
    if (strcmp(name, "--error") == 0) {
        p->error = number;
    } else if (strcmp(name, "--seconds") == 0) {
        p->seconds = number;
    } else if (strcmp(name, "--suns") == 0) {
        p->suns = (uint32_t)fmax(number, 1.0);
    } else {
        return false;
    }
    return true;
}

int main(int argc, char **argv) {
    static proof p = {.error = 0.0015, .seconds = 30.0, .first = 1, .last = 1 << 30, .suns = 100};
    struct CMUnitTest tests[PARTS];
    size_t count = 0;
    bool chosen[PARTS] = {false}, any = false;
    p.shared = getenv("VELUM_SHARED");
    for (int i = 1; i < argc; i++) {
        size_t k = 0;
        while (k < PARTS && strcmp(argv[i], parts[k].name) != 0) {
            k++;
        }
        if (k < PARTS) {
            chosen[k] = any = true;
        } else if (i + 1 >= argc || !parse(&p, argv[i], argv[i + 1])) {
            return usage();
        } else {
            i++;
        }
    }
    for (size_t k = 0; k < PARTS; k++) {
        if (chosen[k] || !any) {
            tests[count++] = (struct CMUnitTest){parts[k].name, parts[k].run, NULL, NULL, &p};
        }
    }
    int broken = _cmocka_run_group_tests("proof", tests, count, NULL, fixture_shared_finish);
    printf("%u figures broken\n", p.failures);
    return broken || p.failures ? 1 : p.skipped ? 77 : 0;
}
