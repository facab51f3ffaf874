#include "scattering_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Adding and doubling (van de Hulst 1963; Hansen 1971), azimuth by azimuth mode, with the forward peak taken out
 * (Wiscombe 1977). Radiances at the nodes of Gauss and Legendre of each half space; a beam of the sun is light in one
 * of them. The first order by the sun is left out: whoever asks adds it with the whole phase function (Nakajima &
 * Tanaka 1988). */
enum {
    N = VELUM_SCATTERING_STREAMS,
    MOMENTS = VELUM_SCATTERING_MOMENTS,
    DEPTHS = VELUM_SCATTERING_DEPTHS,
    MUS = VELUM_SCATTERING_MUS,
    SUNS = VELUM_SCATTERING_SUNS,
    AZIMUTHS = 16,
    FIRST_OCTAVE = -14 /* of the layer from which doubling starts */
};
static const double pi = 3.14159265358979323846;
/* As dark as it gets. */
static const double least = 1e-12;

typedef double matrix[N][N];

typedef struct solver {
    double mu[N], weight[N];   /* of a half space */
    double moment[MOMENTS];    /* without the peak */
    double albedo, peak;       /* of the whole function */
    double albedo_rest, scale; /* without it: albedo; optical depth over the true one */
    double mus[MUS];           /* of the table */
    double suns[SUNS][N];      /* shares of the nodes in the table's suns */
    double cosine[4][AZIMUTHS];
    matrix reflects[DEPTHS], transmits[DEPTHS];
    double sun[DEPTHS][DEPTHS][N][MUS][AZIMUTHS];
    double sky[DEPTHS][DEPTHS][MUS]; /* from beyond the lit face */
} solver;

/* Newton's method (Press et al. 1992, section 4.5), moved to 0..1. */
static void fill_nodes(solver *s) {
    for (int i = 0; i < N; i++) {
        double z = cos(pi * (i + 0.75) / (N + 0.5));
        double slope = 1.0;
        for (int round = 0; round < 20; round++) {
            double p = 1.0, before = 0.0;
            for (int j = 0; j < N; j++) {
                double older = before;
                before = p;
                p = ((2 * j + 1) * z * before - j * older) / (j + 1);
            }
            slope = N * (z * p - before) / (z * z - 1.0);
            z -= p / slope;
        }
        s->mu[i] = 0.5 * (1.0 - z);
        s->weight[i] = 1.0 / ((1.0 - z * z) * slope * slope);
    }
}

static void multiply(matrix a, matrix b, matrix out) {
    matrix product;
    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            double sum = 0.0;
            for (int k = 0; k < N; k++) {
                sum += a[i][k] * b[k][j];
            }
            product[i][j] = sum;
        }
    }
    memcpy(out, product, sizeof product);
}

/* b becomes a^-1 b, a is used up: Gauss, rows exchanged. */
static void solve(int n, int columns, double *a, double *b) {
    for (int i = 0; i < n; i++) {
        int pivot = i;
        for (int k = i + 1; k < n; k++) {
            pivot = fabs(a[k * n + i]) > fabs(a[pivot * n + i]) ? k : pivot;
        }
        for (int k = 0; k < n && pivot != i; k++) {
            double t = a[i * n + k];
            a[i * n + k] = a[pivot * n + k];
            a[pivot * n + k] = t;
        }
        for (int k = 0; k < columns && pivot != i; k++) {
            double t = b[i * columns + k];
            b[i * columns + k] = b[pivot * columns + k];
            b[pivot * columns + k] = t;
        }
        for (int k = i + 1; k < n; k++) {
            double share = a[k * n + i] / a[i * n + i];
            for (int j = i; j < n; j++) {
                a[k * n + j] -= share * a[i * n + j];
            }
            for (int j = 0; j < columns; j++) {
                b[k * columns + j] -= share * b[i * columns + j];
            }
        }
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int j = 0; j < columns; j++) {
            double sum = b[i * columns + j];
            for (int k = i + 1; k < n; k++) {
                sum -= a[i * n + k] * b[k * columns + j];
            }
            b[i * columns + j] = sum / a[i * n + i];
        }
    }
}

/* b becomes (1 - x y)^-1 b: all that goes to and fro between two layers. */
static void between(matrix x, matrix y, matrix b) {
    matrix rest;
    multiply(x, y, rest);
    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            rest[i][j] = (i == j ? 1.0 : 0.0) - rest[i][j];
        }
    }
    solve(N, N, &rest[0][0], &b[0][0]);
}

/* Associated Legendre functions of mode m, normalised so that sums of (2 l + 1) moment Y Y give the phase function's
 * modes, for l up to MOMENTS - 1. */
static void fill_legendre(int m, double mu, double out[MOMENTS]) {
    memset(out, 0, MOMENTS * sizeof *out);
    double first = pow(fmax(1.0 - mu * mu, 0.0), 0.5 * m);
    for (int k = 1; k <= m; k++) {
        first *= sqrt((2.0 * k - 1.0) / (2.0 * k));
    }
    out[m] = first;
    if (m + 1 < MOMENTS) {
        out[m + 1] = mu * sqrt(2.0 * m + 1.0) * first;
    }
    for (int l = m + 2; l < MOMENTS; l++) {
        out[l] = ((2.0 * l - 1.0) * mu * out[l - 1] - sqrt((double)(l + m - 1) * (l - m - 1)) * out[l - 2]) /
                 sqrt((double)(l - m) * (l + m));
    }
}

/* Mode m of the phase function, 4 pi times, between two directions on the same side, and on opposite ones. */
static void scatter(const solver *s, int m, const double *a, const double *b, double *same, double *opposite) {
    double even = 0.0, odd = 0.0;
    for (int l = m; l < MOMENTS; l++) {
        double term = (2 * l + 1) * s->moment[l] * a[l] * b[l];
        even += (l - m) % 2 == 0 ? term : 0.0;
        odd += (l - m) % 2 == 0 ? 0.0 : term;
    }
    *same = even + odd;
    *opposite = even - odd;
}

/* Reflection and transmission of layers of all depths. The thinnest is crossed by one implicit step. */
static void fill_layers(solver *s, int m, double nodes[N][MOMENTS]) {
    const double depth = s->scale * exp2(FIRST_OCTAVE);
    double a[2 * N][2 * N], b[2 * N][N];
    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            double same, opposite;
            scatter(s, m, nodes[i], nodes[j], &same, &opposite);
            const double one = i == j ? 1.0 : 0.0;
            const double half = 0.5 * depth / s->mu[i];
            const double loss = half * (one - 0.5 * s->albedo_rest * same * s->weight[j]);
            const double gain = half * 0.5 * s->albedo_rest * opposite * s->weight[j];
            a[i][j] = a[N + i][N + j] = one + loss;
            a[i][N + j] = a[N + i][j] = -gain;
            b[i][j] = one - loss;
            b[N + i][j] = gain;
        }
    }
    solve(2 * N, N, &a[0][0], &b[0][0]);
    matrix t, r;
    memcpy(t, b, sizeof t);
    memcpy(r, b + N, sizeof r);
    for (int octave = FIRST_OCTAVE; octave < VELUM_SCATTERING_DEPTH_LOW + DEPTHS; octave++) {
        if (octave >= VELUM_SCATTERING_DEPTH_LOW) {
            memcpy(s->transmits[octave - VELUM_SCATTERING_DEPTH_LOW], t, sizeof t);
            memcpy(s->reflects[octave - VELUM_SCATTERING_DEPTH_LOW], r, sizeof r);
        }
        matrix within, back;
        memcpy(within, t, sizeof within);
        between(r, r, within);
        multiply(r, within, back);
        multiply(t, back, back);
        multiply(t, within, t);
        for (int i = 0; i < N; i++) {
            for (int j = 0; j < N; j++) {
                r[i][j] += back[i][j];
            }
        }
    }
}

/* A radiance of the field between the nodes; `up`: mu > 0. */
static double field_at(const solver *s, const double down[N], const double up[N], double mu) {
    const double *from = mu > 0.0 ? up : down;
    const double x = fabs(mu);
    int i = 0;
    while (i < N - 2 && s->mu[i + 1] < x) {
        i++;
    }
    double t = (x - s->mu[i]) / (s->mu[i + 1] - s->mu[i]);
    return from[i] + (from[i + 1] - from[i]) * fmin(fmax(t, 0.0), 1.0);
}

/* Source function towards table direction o, from such a field. */
static double source(const solver *s, double same[MUS][N], double opposite[MUS][N], int o, const double down[N],
                     const double up[N]) {
    double sum = 0.0;
    for (int j = 0; j < N; j++) {
        sum += s->weight[j] * (same[o][j] * up[j] + opposite[o][j] * down[j]);
    }
    return s->albedo * (0.5 * (1.0 - s->peak) * sum + s->peak * field_at(s, down, up, s->mus[o]));
}

/* Adds what mode m brings, between each two layers. */
static void add_mode(solver *s, int m) {
    double nodes[N][MOMENTS], same[MUS][N], opposite[MUS][N], cosine[AZIMUTHS];
    for (int i = 0; i < N; i++) {
        fill_legendre(m, s->mu[i], nodes[i]);
    }
    for (int k = 0; k < AZIMUTHS; k++) {
        cosine[k] = cos(m * pi * (k + 0.5) / AZIMUTHS);
    }
    for (int o = 0; o < MUS; o++) {
        double own[MOMENTS];
        fill_legendre(m, s->mus[o], own);
        for (int j = 0; j < N; j++) {
            scatter(s, m, own, nodes[j], &same[o][j], &opposite[o][j]);
        }
    }
    fill_layers(s, m, nodes);
    for (int above = 0; above < DEPTHS; above++) {
        for (int below = 0; below < DEPTHS; below++) {
            matrix downward, upward;
            memcpy(downward, s->transmits[above], sizeof downward);
            between(s->reflects[above], s->reflects[below], downward);
            multiply(s->reflects[below], downward, upward);
            double sky_down[N] = {0}, sky_up[N] = {0};
            for (int from = 0; from < N; from++) {
                double down[N], up[N];
                const double beam = (m == 0 ? 1.0 : 2.0) / (2.0 * pi * s->weight[from]);
                const double direct = exp(-exp2(VELUM_SCATTERING_DEPTH_LOW + above) * s->scale / s->mu[from]);
                for (int i = 0; i < N; i++) {
                    down[i] = (downward[i][from] - (i == from ? direct : 0.0)) * beam;
                    up[i] = upward[i][from] * beam;
                    sky_down[i] += downward[i][from];
                    sky_up[i] += upward[i][from];
                }
                for (int o = 0; o < MUS; o++) {
                    const double value = source(s, same, opposite, o, down, up);
                    double *to = s->sun[above][below][from][o];
                    for (int k = 0; k < AZIMUTHS; k++) {
                        to[k] += value * cosine[k];
                    }
                }
            }
            for (int o = 0; o < MUS && m == 0; o++) {
                s->sky[above][below][o] = source(s, same, opposite, o, sky_down, sky_up);
            }
        }
    }
}

/* Lagrange's polynomials through the four nodes about an angle (three at the ends), angles being those of
 * velum_scattering_sun_node. */
static void sun_weights(const solver *s, int sun, double out[N]) {
    const double angle = pi * sun / (SUNS - 1);
    double angles[N];
    int first = 0;
    for (int i = 0; i < N; i++) {
        angles[i] = acos(1.0 - 2.0 * s->mu[i]);
        first = angles[i] < angle ? i - 1 : first;
        out[i] = 0.0;
    }
    const int count = first < 0 || first > N - 4 ? 3 : 4;
    first = first < 0 ? 0 : first > N - count ? N - count : first;
    for (int i = first; i < first + count; i++) {
        out[i] = 1.0;
        for (int k = first; k < first + count; k++) {
            out[i] *= k == i ? 1.0 : (angle - angles[k]) / (angles[i] - angles[k]);
        }
    }
}

static float (*texel(float out[CORE_SCATTERING_TEXELS][4], int above, int below, int block, int o))[4] {
    return &out[((block * MUS + o) * DEPTHS + below) * DEPTHS + above];
}

static void write_suns(const solver *s, int above, int below, int o, float out[CORE_SCATTERING_TEXELS][4]) {
    const float depth = exp2f((float)(VELUM_SCATTERING_DEPTH_LOW + above));
    double own[N][4] = {{0.0}};
    for (int i = 0; i < N; i++) {
        const double sines = sqrt((1.0 - s->mus[o] * s->mus[o]) * (1.0 - s->mu[i] * s->mu[i]));
        const float turning = velum_scattering_turning(depth, (float)s->mu[i], (float)s->scale);
        for (int k = 0; k < AZIMUTHS; k++) {
            const double cos_sun = sines * s->cosine[1][k] - s->mus[o] * s->mu[i];
            const double shape = (double)velum_scattering_shape((float)cos_sun, (float)s->moment[1], turning);
            const double value = log2(fmax(s->sun[above][below][i][o][k], least) / shape);
            for (int c = 0; c < 4; c++) {
                own[i][c] += value * s->cosine[c][k] * (c == 0 ? 1.0 : 2.0) / AZIMUTHS;
            }
        }
    }
    for (int sun = 0; sun < SUNS; sun++) {
        for (int c = 0; c < 4; c++) {
            double sum = 0.0;
            for (int i = 0; i < N; i++) {
                sum += s->suns[sun][i] * own[i][c];
            }
            /* Straight up there is no azimuth. Polynomials may leave what is possible. */
            sum = sun == SUNS - 1 && c > 0 ? 0.0 : fmin(fmax(sum, log2(least)), -log2(least));
            (*texel(out, above, below, sun, o))[c] = (float)sum;
        }
    }
}

bool core_scattering_table(velum_phase_lobes phase, float albedo, float out[CORE_SCATTERING_TEXELS][4]) {
    solver *s = calloc(1, sizeof *s);
    if (!s) {
        return false;
    }
    fill_nodes(s);
    s->albedo = (double)albedo;
    s->peak = (double)velum_scattering_peak(phase);
    s->scale = 1.0 - s->albedo * s->peak;
    s->albedo_rest = s->albedo * (1.0 - s->peak) / s->scale;
    for (int l = 0; l < MOMENTS; l++) {
        s->moment[l] = ((double)velum_phase_lobes_moment(phase, l) - s->peak) / (1.0 - s->peak);
    }
    for (int o = 0; o < MUS; o++) {
        s->mus[o] = 2.0 * o / (MUS - 1) - 1.0;
    }
    for (int sun = 0; sun < SUNS; sun++) {
        sun_weights(s, sun, s->suns[sun]);
    }
    for (int i = 0; i < 4 * AZIMUTHS; i++) {
        s->cosine[i / AZIMUTHS][i % AZIMUTHS] = cos(i / AZIMUTHS * pi * (i % AZIMUTHS + 0.5) / AZIMUTHS);
    }
    for (int m = 0; m < MOMENTS; m++) {
        add_mode(s, m);
    }
    for (int above = 0; above < DEPTHS; above++) {
        for (int below = 0; below < DEPTHS; below++) {
            for (int o = 0; o < MUS; o++) {
                write_suns(s, above, below, o, out);
                float *sky = *texel(out, above, below, SUNS, o);
                sky[0] = (float)log2(fmax(s->sky[above][below][o], least));
                sky[1] = (float)log2(fmax(s->sky[below][above][MUS - 1 - o], least));
                sky[2] = sky[3] = 0.0f;
            }
        }
    }
    free(s);
    return true;
}
