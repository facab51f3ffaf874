/* Doubles for cmocka, whose own comparison takes floats. Include after cmocka.h. */
#ifndef VELUM_TESTS_WEATHER_NEAR_H
#define VELUM_TESTS_WEATHER_NEAR_H

#include <math.h>

#define assert_near(found, expected, epsilon)                                                                          \
    do {                                                                                                               \
        const double near_found = (found), near_expected = (expected), near_epsilon = (epsilon);                       \
        if (!(fabs(near_found - near_expected) <= near_epsilon)) {                                                     \
            fail_msg("%s: found %.12g, expected %.12g within %.3g", #found, near_found, near_expected, near_epsilon);  \
        }                                                                                                              \
    } while (0)

#endif
