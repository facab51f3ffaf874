/* velum-coverage: what is asked for against what is there, over 50 km squares of constant input. An
 * area with coverage c is covered c of it, its mean water path is coverage x water content x thickness, base and top
 * are percentiles over covered columns. Usage:
 * velum-coverage [columns a side] [further places] [genus] */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "columns.h"
#include "shared/hash.h"

int main(int argc, char **argv) {
    static const double places[][2] = {{0.3, 10.2}, {45.0, 8.0}, {90.0, 0.0}, {20.0, 180.0}, {-62.0, -75.0}};
    const int oktas[] = {1, 3, 5, 7, 8};
    int n = argc > 1 ? atoi(argv[1]) : 100;
    int more = argc > 2 ? atoi(argv[2]) : 0;
    n = n < 8 ? 8 : n > 1000 ? 1000 : n;
    more = more < 0 ? 0 : more > 10000 ? 10000 : more;
    const core_noise *noise = core_noise_built();
    printf("genus okta  coverage  worst-error  water/asked (min max)  base-error (min max) m  top-error (min max) m\n");
    int failures = 0;
    int rows = 0;
    for (int k = 0; k < COLUMN_CASES; k++) {
        if (argc > 3 && strcmp(argv[3], column_cases[k].name) != 0) {
            continue;
        }
        for (int o = 0; o < 5; o++) {
            float coverage = (float)oktas[o] / 8.0f;
            double sum = 0.0;
            double worst = 0.0;
            double low[3] = {1e9, 1e9, 1e9};
            double high[3] = {-1e9, -1e9, -1e9};
            for (int p = 0; p < 5 + more; p++) {
                uint32_t i = (uint32_t)p;
                double lat = p < 5 ? places[p][0]
                                   : asin(2.0 * (double)velum_hash_unit(velum_hash_2(i, 1)) - 1.0) * 57.29577951308232;
                double lon = p < 5 ? places[p][1] : 360.0 * (double)velum_hash_unit(velum_hash_2(i, 2)) - 180.0;
                column_stats s;
                if (!columns_measure(noise, &column_cases[k], coverage, lat, lon, 50000.0, n, 64, &s)) {
                    return 1;
                }
                sum += s.coverage;
                double error = s.coverage - (double)coverage;
                worst = fabs(error) > fabs(worst) ? error : worst;
                const double values[3] = {s.water, s.base_error_m, s.top_error_m};
                for (int v = 0; v < 3; v++) {
                    low[v] = fmin(low[v], values[v]);
                    high[v] = fmax(high[v], values[v]);
                }
            }
            int bad = fabs(worst) >= 0.02 || low[0] < 0.95 || high[0] > 1.05 || low[1] < -10.0 || high[1] > 10.0 ||
                      low[2] < -10.0 || high[2] > 10.0;
            failures += bad;
            rows++;
            printf("%-5s %d     %.3f     %+.4f      %.3f %.3f   %+7.1f %+7.1f   %+8.1f %+8.1f %s\n",
                   column_cases[k].name, oktas[o], sum / (5 + more), worst, low[0], high[0], low[1], high[1], low[2],
                   high[2], bad ? "*" : "");
            fflush(stdout);
        }
    }
    printf("%d of %d outside the bounds (0.02, 5 %%, 10 m)\n", failures, rows);
    return failures > 0 || rows == 0;
}
