/* Figures of other works beside ours. Times of different machines do not compare: both are ratios to each one's own
 * base. They gave no errors; ours stand beside. */
#include <math.h>
#include <string.h>

#include "program.h"

typedef struct published_row {
    const char *what;
    double ms;
    const char *group, *name; /* our curve; null: nothing like it */
    double value;             /* on it */
} published_row;

typedef struct published_table {
    const char *title;
    const char *base; /* how ours differs */
    uint32_t count;   /* rows; the first is the base */
    published_row rows[8];
} published_table;

static const published_table tables[] = {
    {"P. Ford 2024, section 5.4: a ladder of optimisations, each on top of those above",
     "Ours the same, from preset high with a ray for each pixel and at most 4096 steps in it; an adapted step is "
     "longer "
     "in empty air, and passes at once what is surely empty.",
     8,
     {{"none, steps of 9", 1558.0, "ladder", "Ford's ladder", 0.0},
      {"early exit at transmittance 0.075", 373.0, "ladder", "Ford's ladder", 1.0},
      {"densities below 0.01 skipped", 34.6, "ladder", "Ford's ladder", 2.0},
      {"steps of 100 over 8 frames", 6.5, "ladder", "Ford's ladder", 3.0},
      {"step adapted", 6.0, "ladder", "Ford's ladder", 4.0},
      {"half resolution", 2.7, "ladder", "Ford's ladder", 5.0},
      {"quarter resolution", 1.8, "ladder", "Ford's ladder", 6.0},
      {NULL, 0.0, NULL, NULL, 0.0}}},
    {"F. Haggstrom 2018, table 1: samples towards the sun",
     "Ours with 32 for the base instead of 100.",
     6,
     {{"100", 60.0, "sun", "samples towards the sun", 32.0},
      {"1", 1.9, "sun", "samples towards the sun", 1.0},
      {"2", 2.8, "sun", "samples towards the sun", 2.0},
      {"3", 3.35, "sun", "samples towards the sun", 3.0},
      {"4", 3.85, "sun", "samples towards the sun", 4.0},
      {"5", 4.4, "sun", "samples towards the sun", 5.0}}},
    {"F. Haggstrom 2018, table 2: growth of steps with distance",
     "Ours from steps of preset high.",
     5,
     {{"none", 15.0, "growth", "growth of steps", 0.0},
      {"0.1", 1.3, "growth", "growth of steps", 0.1},
      {"0.0667", 1.7, "growth", "growth of steps", 0.0667},
      {"0.05", 2.1, "growth", "growth of steps", 0.05},
      {"0.04", 2.45, "growth", "growth of steps", 0.04}}},
    {"F. Haggstrom 2018, table 3: least factor of steps where coverage is low",
     "Velum's steps do not depend on coverage: coverage is met by construction.",
     4,
     {{"none", 2.0, NULL, NULL, 0.0},
      {"0.1", 8.0, NULL, NULL, 0.0},
      {"0.3", 3.3, NULL, NULL, 0.0},
      {"0.5", 2.3, NULL, NULL, 0.0}}},
    {"F. Haggstrom 2018, table 4: least divisor of steps where density is low",
     "Ours: steps longer by one over that where there is no cloud; for none, steps all alike.",
     5,
     {{"none", 5.0, "empty", "long steps in empty air", 0.0},
      {"0.1", 0.9, "empty", "long steps in empty air", 10.0},
      {"0.2", 1.5, "empty", "long steps in empty air", 5.0},
      {"0.3", 2.0, "empty", "long steps in empty air", 3.3333},
      {"0.4", 2.5, "empty", "long steps in empty air", 2.5}}},
};

/* Over the scenes: mean time, root mean square error. */
static bool ours(const program *p, const published_row *row, double *ms, double *error) {
    uint32_t count = 0;
    *ms = *error = 0.0;
    for (uint32_t i = 0; row->group && i < p->result_count; i++) {
        const measurement *m = &p->results[i];
        if (strcmp(m->group, row->group) == 0 && strcmp(m->name, row->name) == 0 &&
            fabs(m->value - row->value) <= 1e-6 * fabs(row->value)) {
            *ms += m->ms_per_megapixel;
            *error += program_error(p, m) * program_error(p, m);
            count++;
        }
    }
    *ms /= count ? count : 1;
    *error = sqrt(*error / (count ? count : 1));
    return count > 0;
}

void tables_write(const program *p, FILE *file) {
    for (size_t t = 0; t < sizeof tables / sizeof tables[0]; t++) {
        const published_table *table = &tables[t];
        double base_ms = 0.0, base_error;
        bool has_base = ours(p, &table->rows[0], &base_ms, &base_error) && base_ms > 0.0;
        fprintf(file,
                "\n### %s\n\n%s\n\n| | published, ms | of its base | ours, ms/megapixel | of its base | our error |\n"
                "| --- | --- | --- | --- | --- | --- |\n",
                table->title, table->base);
        for (uint32_t i = 0; i < table->count && table->rows[i].what; i++) {
            const published_row *row = &table->rows[i];
            double ms, error;
            fprintf(file, "| %s | %g | %.3f |", row->what, row->ms, row->ms / table->rows[0].ms);
            if (!ours(p, row, &ms, &error)) {
                fprintf(file, " - | - | - |\n");
            } else if (has_base) {
                fprintf(file, " %.1f | %.3f | %.4f |\n", ms, ms / base_ms, error);
            } else {
                fprintf(file, " %.1f | - | %.4f |\n", ms, error);
            }
        }
    }
}
