/* What the plugin takes its presets to be is what the committed chart says. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "plugin/preset_figures.h"

static const char *const names[PRESETS] = {"low", "medium", "high", "ultra"};

/* Columns of the chart's table of presets: name, error of 8 x 8, of pixels, bias, largest, 99 %, ms, samples, scenes.
 */
enum { COLUMN_NAME, COLUMN_ERROR, COLUMN_SAMPLES = 7, COLUMNS = 9 };

static void figures_are_the_charts(void **state) {
    (void)state;
    char path[1024], line[4096];
    const char *source = getenv("VELUM_SOURCE");
    assert_non_null(source);
    snprintf(path, sizeof path, "%s/tests/report/accuracy/README.md", source);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    uint32_t found = 0;
    while (found < PRESETS && fgets(line, sizeof line, file)) {
        const char *cells[COLUMNS];
        uint32_t count = 0;
        for (char *cell = strtok(line, "|\n"); cell && count < COLUMNS; cell = strtok(NULL, "|\n")) {
            cells[count++] = cell + strspn(cell, " ");
        }
        size_t length = strlen(names[found]);
        if (count == COLUMNS && strncmp(cells[COLUMN_NAME], names[found], length) == 0) {
            assert_float_equal(strtod(cells[COLUMN_ERROR], NULL), (double)preset_figures_of[found].error, 1e-6);
            assert_float_equal(strtod(cells[COLUMN_SAMPLES], NULL), (double)preset_figures_of[found].samples, 1e-6);
            found++;
        }
    }
    fclose(file);
    assert_int_equal(found, PRESETS);
}

static void the_cheapest_that_is_good_enough(void **state) {
    (void)state;
    for (uint32_t i = 0; i < PRESETS; i++) {
        uint32_t chosen = preset_for_error(preset_figures_of[i].error);
        assert_true(chosen <= i && preset_figures_of[chosen].error <= preset_figures_of[i].error);
        for (uint32_t k = 0; k < chosen; k++) {
            assert_true(preset_figures_of[k].error > preset_figures_of[i].error);
        }
    }
    assert_int_equal(preset_for_error(1.0f), 0);
    uint32_t best = preset_for_error(1e-3f);
    for (uint32_t i = 0; i < PRESETS; i++) {
        assert_true(preset_figures_of[best].error <= preset_figures_of[i].error);
        assert_true(i >= best || preset_figures_of[best].error < preset_figures_of[i].error);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(figures_are_the_charts),
                                       cmocka_unit_test(the_cheapest_that_is_good_enough)};
    return cmocka_run_group_tests_name("preset figures", tests, NULL, NULL);
}
