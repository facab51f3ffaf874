/* Two parts of a reference in one. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "metric.h"
#include "picture.h"

/* As if the first three paths and the next five had been of one picture. */
static void parts_make_the_whole(void **state) {
    (void)state;
    const double path[8] = {1.0, 5.0, 3.0, 2.0, 8.0, 4.0, 4.0, 7.0};
    picture first, second;
    double mean = 0.0;
    assert_true(picture_init(&first, 2, 1));
    assert_true(picture_init(&second, 2, 1));
    for (int i = 0; i < 8; i++) {
        picture *p = i < 3 ? &first : &second;
        double share = i < 3 ? 1.0 / 3.0 : 1.0 / 5.0;
        for (int c = 0; c < 3; c++) {
            p->rgb[c] += (float)(path[i] * share);
            p->transmittance[3 + c] += (float)(0.1 * path[i] * share);
        }
        p->distance[1] += (float)(100.0 * path[i] * share);
        mean += path[i] / 8.0;
    }
    first.variance[0] = 4.0f / 3.0f; /* of paths of variance 4 */
    second.variance[0] = 4.0f / 5.0f;
    picture_merge(&first, 3.0, &second, 5.0);
    for (int c = 0; c < 3; c++) {
        assert_float_equal(first.rgb[c], mean, 1e-5);
        assert_float_equal(first.transmittance[3 + c], 0.1 * mean, 1e-6);
    }
    assert_float_equal(first.distance[1], 100.0 * mean, 1e-3);
    assert_float_equal(first.luminance[0], mean, 1e-5);
    assert_float_equal(first.variance[0], 4.0 / 8.0, 1e-6);
    picture_finish(&first);
    picture_finish(&second);
}

/* What is even stays even to the edges, a lone pixel spreads alike to all sides, and light that is not a number is
 * none. */
static void what_is_enlarged_is_smoothed_evenly(void **state) {
    (void)state;
    picture from, to;
    assert_true(picture_init(&from, 15, 15));
    for (uint32_t i = 0; i < 3 * from.count; i++) {
        from.rgb[i] = 2.0f;
    }
    assert_true(picture_enlarge(&from, 3, &to));
    assert_int_equal(to.width, 45);
    assert_int_equal(to.height, 45);
    for (uint32_t i = 0; i < to.count; i++) {
        assert_float_equal(to.luminance[i], 2.0, 1e-5);
    }
    picture_finish(&to);
    memset(from.rgb, 0, 3 * from.count * sizeof *from.rgb);
    from.rgb[3 * (7 * 15 + 7)] = 1.0f;
    from.rgb[0] = NAN;
    assert_true(picture_enlarge(&from, 3, &to));
    const uint32_t middle = 22 * 45 + 22;
    for (uint32_t away = 0; away < 9; away++) {
        assert_float_equal(to.rgb[3 * (middle + away)], to.rgb[3 * (middle - away)], 1e-7);
        assert_float_equal(to.rgb[3 * (middle + away)], to.rgb[3 * (middle + 45 * away)], 1e-7);
    }
    assert_float_equal(to.rgb[3 * middle], 1.0 / (2.0 * 3.14159265), 2e-3); /* the peak of a Gaussian in the plane */
    assert_float_equal(to.rgb[3 * (middle + 3)], exp(-0.5) / (2.0 * 3.14159265), 2e-3);
    picture_finish(&to);
    /* Stripes two pixels wide, as bright as each other: their colours are even, where light of its own would not be. */
    for (uint32_t i = 0; i < from.count; i++) {
        const uint32_t c = i % 15 / 2 % 2;
        const float unit[3] = {c == 0 ? 1.0f : 0.0f, c == 1 ? 1.0f : 0.0f, 0.0f};
        for (uint32_t k = 0; k < 3; k++) {
            from.rgb[3 * i + k] = unit[k] / (float)metric_luminance(unit);
        }
    }
    assert_true(picture_enlarge(&from, 3, &to));
    for (uint32_t i = middle - 3; i < middle + 3; i++) {
        assert_float_equal(to.luminance[i], 1.0, 1e-5);
        assert_float_equal(to.rgb[3 * i] / to.rgb[3 * (middle - 6)], 1.0, 0.05);
    }
    picture_finish(&to);
    picture_finish(&from);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(parts_make_the_whole),
                                       cmocka_unit_test(what_is_enlarged_is_smoothed_evenly)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
