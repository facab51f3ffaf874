/* Light that is scattered once, by quadrature over the ellipsoid; and what plane-parallel is wrong by. Nothing of the
 * plugin's geometry: heights are GeographicLib's. */
#include <stddef.h>

#include "proof.h"

#define LAT_DEG 50.0
#define LON_DEG 8.5
#define HEIGHT_STEP_M (27000.0 / 65535.0)
#define BASE_M (-1000.0 + 4854 * HEIGHT_STEP_M)

typedef struct ray {
    double from[3], to[3]; /* ECEF, direction */
} ray;

static void point_on(const ray *r, double t, double out[3]) {
    for (int i = 0; i < 3; i++) {
        out[i] = r->from[i] + t * r->to[i];
    }
}

static double height_at(const ray *r, double t) {
    return proof_height_at(r->from, r->to, t);
}

/* Where the height crosses `level` between `low` and `high`, over which it only rises or only falls. */
static double crossing(const ray *r, double level, double low, double high) {
    bool rises = height_at(r, high) > height_at(r, low);
    for (int i = 0; i < 60; i++) {
        double middle = 0.5 * (low + high);
        if ((height_at(r, middle) > level) == rises) {
            high = middle;
        } else {
            low = middle;
        }
    }
    return 0.5 * (low + high);
}

static double cosine_of(const slab_case *c) {
    return (c->up ? -1.0 : 1.0) * c->mu * c->mu0 +
           sqrt(fmax((1.0 - c->mu * c->mu) * (1.0 - c->mu0 * c->mu0), 0.0)) * cos(c->phi_deg * PROOF_PI / 180.0);
}

/* pi I / (mu0 F0) of first order, plane-parallel (Chandrasekhar 1950, chapter III). */
static double plane_parallel(const slab_case *c) {
    double factor;
    if (c->up) {
        factor = (1.0 - exp(-c->tau * (1.0 / c->mu + 1.0 / c->mu0))) / (c->mu0 + c->mu);
    } else if (fabs(c->mu0 - c->mu) < 1e-9) {
        factor = c->tau * exp(-c->tau / c->mu) / (c->mu * c->mu);
    } else {
        factor = (exp(-c->tau / c->mu0) - exp(-c->tau / c->mu)) / (c->mu0 - c->mu);
    }
    return PROOF_PI * c->albedo * proof_phase(c->g, cosine_of(c)) * factor;
}

/* The same over the planet. The eye stands and looks as slab_rig_measure has it; the ray crosses the layer once. */
static double over_planet(const slab_case *c, double thickness_m) {
    double thick = round(thickness_m / HEIGHT_STEP_M) * HEIGHT_STEP_M;
    double top_m = BASE_M + thick;
    double extinction = c->tau / thick;
    double east[3], north[3], up[3], sun[3];
    ray view;
    fixture_axes(LAT_DEG, LON_DEG, east, north, up);
    double turn = c->phi_deg * PROOF_PI / 180.0;
    for (int i = 0; i < 3; i++) {
        double side = cos(turn) * east[i] + sin(turn) * north[i];
        sun[i] = c->mu0 * up[i] + sqrt(fmax(1.0 - c->mu0 * c->mu0, 0.0)) * east[i];
        view.to[i] = (c->up ? -c->mu : c->mu) * up[i] + sqrt(fmax(1.0 - c->mu * c->mu, 0.0)) * side;
    }
    fixture_position(LAT_DEG, LON_DEG, c->up ? BASE_M + thickness_m + 5.0 : BASE_M - 5.0, view.from);
    double far_m = 3.0 * (thick + 100.0) / c->mu;
    double enter_m = crossing(&view, c->up ? top_m : BASE_M, 0.0, far_m);
    double leave_m = crossing(&view, c->up ? BASE_M : top_m, 0.0, far_m);
    double cosine = 0.0;
    for (int i = 0; i < 3; i++) {
        cosine += view.to[i] * sun[i];
    }
    enum { PANELS = 60 };
    double sum = 0.0;
    double left = enter_m;
    for (int k = 0; k < PANELS; k++) {
        /* Panels grow towards the far end: light falls off as exp. */
        double share = (k + 1.0) / PANELS;
        double right = enter_m + (leave_m - enter_m) * share * share;
        for (int j = 0; j < 5; j++) {
            double t = 0.5 * (left + right) + 0.5 * (right - left) * proof_node[j];
            ray sunward;
            point_on(&view, t, sunward.from);
            for (int i = 0; i < 3; i++) {
                sunward.to[i] = sun[i];
            }
            double to_sun = crossing(&sunward, top_m, 0.0, 40.0 * (thick + 100.0) / fmax(c->mu0, 0.02));
            sum += 0.5 * (right - left) * proof_weight[j] * exp(-extinction * (t - enter_m + to_sun));
        }
        left = right;
    }
    return PROOF_PI / c->mu0 * c->albedo * extinction * proof_phase(c->g, cosine) * sum;
}

void proof_first_order(void **state) {
    proof *p = *state;
    static const double thickness_m[] = {PROOF_SLAB_M, 8000.0};
    static const slab_case cases[] = {
        {.albedo = 0.7, .g = 0.6, .tau = 1.5, .mu0 = 0.8, .up = true, .mu = 0.6, .phi_deg = 0.0},
        {.albedo = 0.7, .g = 0.6, .tau = 1.5, .mu0 = 0.8, .up = false, .mu = 0.6, .phi_deg = 0.0},
        {.albedo = 1.0, .g = 0.85, .tau = 8.0, .mu0 = 0.5, .up = true, .mu = 1.0, .phi_deg = 0.0},
        {.albedo = 1.0, .g = 0.85, .tau = 0.5, .mu0 = 0.5, .up = false, .mu = 0.5, .phi_deg = 180.0},
        {.albedo = 1.0, .g = 0.0, .tau = 0.5, .mu0 = 0.05, .up = true, .mu = 0.5, .phi_deg = 90.0},
        {.albedo = 1.0, .g = 0.85, .tau = 1.0, .mu0 = 0.05, .up = true, .mu = 0.15, .phi_deg = 0.0},
        {.albedo = 1.0, .g = 0.85, .tau = 1.0, .mu0 = 0.1, .up = true, .mu = 0.1, .phi_deg = 180.0},
        {.albedo = 1.0, .g = -0.5, .tau = 2.0, .mu0 = 0.3, .up = false, .mu = 0.2, .phi_deg = 45.0}};
    double chi2 = 0.0;
    int count = 0;
    slab_rig_init(&p->rig);
    slab_rig_order(&p->rig, 1);
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        for (int thick = 0; thick < 2; thick++) {
            proof_mean m;
            slab_rig_layer(&p->rig, &cases[k], thickness_m[thick]);
            proof_measure(p, &cases[k], thickness_m[thick], &m);
            double expected = over_planet(&cases[k], thickness_m[thick]);
            double found = proof_value(&m), error = proof_error(&m);
            proof_tell(p, proof_meets(found, error, expected),
                       "first order, g %g, tau %g, mu0 %g, %s at mu %g, phi %g, %g m thick: %.6f +- %.6f, quadrature "
                       "%.6f (plane-parallel %.6f): %+.3f %%, %+.2f sigma of 4",
                       cases[k].g, cases[k].tau, cases[k].mu0, cases[k].up ? "back" : "through", cases[k].mu,
                       cases[k].phi_deg, thickness_m[thick], found, error, expected, plane_parallel(&cases[k]),
                       100.0 * (found / expected - 1.0), (found - expected) / error);
            chi2 += (found - expected) * (found - expected) / error / error;
            count++;
        }
    }
    slab_rig_finish(&p->rig);
    proof_tell_chi2(p, "first order", count, chi2);
}

void proof_curvature(void **state) {
    proof *p = *state;
    static const double thickness_m[] = {60.0, PROOF_SLAB_M, 1000.0, 8000.0};
    double worst = 0.0;
    printf("curvature costs, first order, tau 1, g 0.85, phi 90, largest over up and down:\n");
    printf("  mu0   mu  |   60 m    240 m   1000 m   8000 m\n");
    for (int k = 0; k < 6; k++) {
        const double mu0 = k % 3 == 0 ? 1.0 : k % 3 == 1 ? 0.5 : 0.1;
        const double mu = k < 3 ? 1.0 : 0.5;
        printf("  %3.1f  %3.1f  |", mu0, mu);
        for (int t = 0; t < 4; t++) {
            double most = 0.0;
            for (int side = 0; side < 2; side++) {
                const slab_case c = {
                    .albedo = 1.0, .g = 0.85, .tau = 1.0, .mu0 = mu0, .up = side == 0, .mu = mu, .phi_deg = 90.0};
                double cost = over_planet(&c, thickness_m[t]) / plane_parallel(&c) - 1.0;
                most = fabs(cost) > fabs(most) ? cost : most;
            }
            printf(" %+7.4f%%", 100.0 * most);
            if (t == 1 && mu0 >= 0.5) {
                worst = fmax(worst, fabs(most));
            }
        }
        printf("\n");
    }
    proof_tell(p, worst <= 1e-3, "curvature, slabs of %g m under the tables' suns and views: %.4f %% of 0.1 %%",
               PROOF_SLAB_M, 100.0 * worst);
    slab_rig_init(&p->rig);
    slab_case c = {.albedo = 1.0, .g = 0.0, .tau = 4.0, .mu0 = 0.5, .up = true, .mu = 1.0, .expected = 7.059764e-01};
    for (int t = 0; t < 4; t++) {
        proof_mean m;
        slab_rig_layer(&p->rig, &c, thickness_m[t]);
        proof_measure(p, &c, thickness_m[t], &m);
        printf("curvature, all orders, isotropic, tau 4, %5.0f m thick: %.5f +- %.5f, plane-parallel %.5f: %+.3f %%\n",
               thickness_m[t], proof_value(&m), proof_error(&m), c.expected,
               100.0 * (proof_value(&m) / c.expected - 1.0));
        fflush(stdout);
    }
    slab_rig_finish(&p->rig);
}
