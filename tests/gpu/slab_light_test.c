/* Light of uniform slabs in the presets, against discrete ordinates (tests/data/slab_radiance.csv). */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "reference_slab.h"

enum { ROWS_MAX = 256, SETTLE = 17 };

static int compare(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static void expect_preset(int32_t quality, const char *name) {
    static slab_rig rig;
    char line[256];
    FILE *file = slab_table("slab_radiance.csv");
    slab_rig_init_preset(&rig, quality);
    double errors[ROWS_MAX], worst = 0.0;
    int count = 0;
    char worst_row[256] = "";
    while (fgets(line, sizeof line, file)) {
        slab_case c;
        if (!slab_case_parse(line, &c)) {
            continue;
        }
        assert_true(count < ROWS_MAX);
        slab_rig_layer(&rig, &c, 240.0);
        const double found = slab_rig_settle(&rig, &c, 240.0, SETTLE);
        errors[count] = fabs(found / c.expected - 1.0);
        if (errors[count] > worst) {
            worst = errors[count];
            line[strcspn(line, "\n")] = 0;
            snprintf(worst_row, sizeof worst_row, "%.200s: found %.6f", line, found);
        }
        count++;
    }
    fclose(file);
    slab_rig_finish(&rig);
    assert_int_equal(count, 192);
    qsort(errors, (size_t)count, sizeof errors[0], compare);
    print_message("%s, %d radiances of slabs: median error %.2f %%, 90th percentile %.2f %%, largest %.2f %% (%s)\n",
                  name, count, 100.0 * errors[count / 2], 100.0 * errors[count * 9 / 10], 100.0 * worst, worst_row);
    assert_true(errors[count / 2] <= 0.03);
    assert_true(errors[count * 9 / 10] <= 0.10);
}

static void low_radiates_as_discrete_ordinates_say(void **state) {
    (void)state;
    expect_preset(VELUM_QUALITY_LOW, "low");
}

static void medium_radiates_as_discrete_ordinates_say(void **state) {
    (void)state;
    expect_preset(VELUM_QUALITY_MEDIUM, "medium");
}

static void ultra_radiates_as_discrete_ordinates_say(void **state) {
    (void)state;
    expect_preset(VELUM_QUALITY_ULTRA, "ultra");
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(low_radiates_as_discrete_ordinates_say),
                                       cmocka_unit_test(medium_radiates_as_discrete_ordinates_say),
                                       cmocka_unit_test(ultra_radiates_as_discrete_ordinates_say)};
    return cmocka_run_group_tests(tests, NULL, fixture_shared_finish);
}
