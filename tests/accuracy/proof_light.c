/* White furnace, reciprocity, and the ends of extinction. */
#include "proof.h"

static double random_unit(uint64_t *random) {
    *random = *random * 6364136223846793005u + 1442695040888963407u;
    return (double)(*random >> 11) * 0x1p-53;
}

/* One round: suns all over the sky, turned by chance as one. Luminance of the picture over the sky's. In the middle of
 * their shares of height: shifted ones would be off by the slope of the light over height, which no error tells. */
static double furnace_round(proof *p, const double position[3], const velum_view_frame *camera, uint32_t paths,
                            uint64_t *random, double *error) {
    double east[3], north[3], up[3];
    fixture_axes(50.0, 8.5, east, north, up);
    double turn = random_unit(random);
    double sum = 0.0, squares = 0.0;
    for (uint32_t k = 0; k < p->suns; k++) {
        double mu = (k + 0.5) / p->suns;
        double angle = 2.0 * PROOF_PI * fmod(k * 0.6180339887498949 + turn, 1.0);
        double across = sqrt(fmax(1.0 - mu * mu, 0.0));
        double sun[3];
        for (int i = 0; i < 3; i++) {
            sun[i] = mu * up[i] + across * (cos(angle) * east[i] + sin(angle) * north[i]);
        }
        velum_frame_info frame = fixture_frame(sun, p->rig.time_s, VELUM_ATMOSPHERE_NONE);
        p->rig.time_s += 1e-3;
        for (int i = 0; i < 3; i++) {
            frame.ground_albedo[i] = 1.0f;
        }
        slab_rig_render(&p->rig, &frame, position, camera, true, paths);
        for (int i = 0; i < SLAB_PIXELS; i++) {
            sum += (double)p->rig.light[3 * i + 1] / SLAB_PIXELS;
            squares += (double)p->rig.variance[i] / SLAB_PIXELS / SLAB_PIXELS;
        }
    }
    *error = 2.0 * PROOF_PI * sqrt(squares) / p->suns;
    return 2.0 * PROOF_PI * sum / p->suns;
}

/* Light from all of the sky, a white cloud over white ground: everything is as bright as the sky. Known to half of the
 * bound, by the spread of rounds. */
static void furnace(proof *p, const char *name, double pitch, double bound) {
    double east[3], north[3], up[3], position[3], ahead[3], right[3];
    fixture_axes(50.0, 8.5, east, north, up);
    fixture_position(50.0, 8.5, 2600.0, position);
    for (int i = 0; i < 3; i++) {
        ahead[i] = cos(pitch) * east[i] + sin(pitch) * up[i];
        right[i] = -north[i];
    }
    velum_view_frame camera = fixture_camera(position, ahead, right, 0.3f, 0.3f);
    camera.flags = VELUM_VIEW_GROUND;
    uint64_t random = 1;
    proof_mean m = {0};
    double start_s = proof_now_s();
    double squares = 0.0, found, error;
    uint32_t rounds = 0;
    do {
        double own_error;
        double own = furnace_round(p, position, &camera, 4, &random, &own_error) - 1.0;
        rounds++;
        proof_add(&m, own, own_error, 1.0);
        squares += own * own;
        found = proof_value(&m);
        error = rounds < 2 ? INFINITY : sqrt(fmax(squares / rounds - found * found, 0.0) / (rounds - 1));
    } while ((rounds < 16 || error > 0.4 * bound) && proof_now_s() - start_s < 20.0 * p->seconds);
    proof_tell(p, fabs(found) <= bound && error <= 0.5 * bound,
               "white furnace, %s, %u rounds of %u suns: %.5f +- %.5f (by the pixels' variance %.5f), 1 within %g %% "
               "known to %g %%",
               name, rounds, p->suns, 1.0 + found, error, proof_error(&m), 100.0 * bound, 50.0 * bound);
}

void proof_furnace(void **state) {
    proof *p = *state;
    slab_rig_init(&p->rig);
    slab_case c = {.albedo = 1.0, .g = 0.0, .tau = 4.0};
    if (proof_wants(p, 1)) {
        slab_rig_layer(&p->rig, &c, PROOF_SLAB_M);
        furnace(p, "slab of tau 4, isotropic", -0.5 * PROOF_PI, 0.001);
    }
    if (proof_wants(p, 2)) {
        c.g = 0.85;
        slab_rig_layer(&p->rig, &c, PROOF_SLAB_M);
        furnace(p, "slab of tau 4, g 0.85", -0.5 * PROOF_PI, 0.001);
    }
    /* Droplets turn most light by a degree: a single sun is rarely met, and noise is what bounds this one. */
    if (proof_wants(p, 3)) {
        const velum_layer cloud = fixture_cumulus();
        fixture_commit(&p->rig.f, &cloud, 1);
        furnace(p, "cumulus", -0.6, 0.02);
    }
    slab_rig_finish(&p->rig);
}

/* What one radiance is when view and sun change places. */
void proof_reciprocity(void **state) {
    proof *p = *state;
    static const struct {
        slab_case c;
        double other;
    } cases[] = {{{.albedo = 1.0, .g = 0.0, .tau = 4.0, .mu0 = 0.4, .up = true, .mu = 0.9}, 0.0},
                 {{.albedo = 1.0, .g = 0.85, .tau = 4.0, .mu0 = 0.4, .up = true, .mu = 0.9}, 0.0},
                 {{.albedo = 0.9, .g = 0.85, .tau = 1.0, .mu0 = 0.3, .up = true, .mu = 0.8, .phi_deg = 120.0}, 0.0},
                 /* Through the slab: from above at mu0 and out at mu, or the other way. */
                 {{.albedo = 1.0, .g = 0.85, .tau = 2.0, .mu0 = 0.5, .up = false, .mu = 0.9, .phi_deg = 60.0}, 0.0}};
    slab_rig_init(&p->rig);
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        slab_case c = cases[k].c;
        proof_mean m[2];
        slab_rig_layer(&p->rig, &c, PROOF_SLAB_M);
        proof_measure(p, &c, PROOF_SLAB_M, &m[0]);
        double kept = c.mu0;
        c.mu0 = c.mu;
        c.mu = kept;
        proof_measure(p, &c, PROOF_SLAB_M, &m[1]);
        double off = proof_value(&m[0]) / proof_value(&m[1]) - 1.0;
        double error = hypot(proof_error(&m[0]) / proof_value(&m[0]), proof_error(&m[1]) / proof_value(&m[1]));
        proof_tell(p, proof_meets(1.0 + off, error, 1.0),
                   "reciprocity, %s, albedo %g, g %g, tau %g, mu %g and %g: %+.3f %% of %.3f %%, %+.2f sigma of 4",
                   c.up ? "back" : "through", c.albedo, c.g, c.tau, c.mu, c.mu0, 100.0 * off, 100.0 * error,
                   off / error);
    }
    slab_rig_finish(&p->rig);
}

/* H of a conservative half-space of isotropic scatterers, by its integral equation (Chandrasekhar 1950, chapter V):
 * 1 / H(mu) = 1/2 integral x H(x) / (x + mu) dx, 0..1, in the form without the root at albedo 1. */
static double chandrasekhar_h(double at) {
    enum { NODES = 400 };
    static double h[NODES];
    double found = 1.0;
    for (int i = 0; i < NODES; i++) {
        h[i] = 1.0;
    }
    for (int round = 0; round < 400; round++) {
        for (int k = 0; k <= NODES; k++) {
            double mu = k < NODES ? (k + 0.5) / NODES : at;
            double sum = 0.0;
            for (int i = 0; i < NODES; i++) {
                double x = (i + 0.5) / NODES;
                sum += 0.5 * x * h[i] / (x + mu) / NODES;
            }
            if (k < NODES) {
                h[k] = 0.5 * (h[k] + 1.0 / sum);
            } else {
                found = 1.0 / sum;
            }
        }
    }
    return found;
}

/* pi I / (mu0 F0) = H(mu) H(mu0) / (4 (mu + mu0)). */
static double half_space(const slab_case *c) {
    return chandrasekhar_h(c->mu) * chandrasekhar_h(c->mu0) / (4.0 * (c->mu + c->mu0));
}

void proof_extinction(void **state) {
    proof *p = *state;
    slab_rig_init(&p->rig);
    double error, through;
    for (int k = 0; k < 2; k++) {
        const slab_case none = {
            .albedo = 1.0, .g = 0.85, .tau = k == 0 ? 0.0 : 1e-7, .mu0 = 0.5, .up = true, .mu = 0.5};
        slab_rig_layer(&p->rig, &none, PROOF_SLAB_M);
        double found = slab_rig_measure(&p->rig, &none, PROOF_SLAB_M, 64, &error, &through);
        proof_tell(p, found <= 1e-3 && through >= 0.9999,
                   "extinction, tau %g: light %.6f of 0, transmittance %.6f of 1", none.tau, found, through);
    }
    /* A wall: nothing comes through, and what comes back is a half-space's within 4 / (3 * 2000). */
    const slab_case wall = {.albedo = 1.0, .g = 0.0, .tau = 2000.0, .mu0 = 0.5, .up = true, .mu = 1.0};
    slab_rig_layer(&p->rig, &wall, PROOF_SLAB_M);
    double found = slab_rig_measure(&p->rig, &wall, PROOF_SLAB_M, 16, &error, &through);
    proof_tell(p, through <= 0.0 && fabs(found - half_space(&wall)) <= 4.0 * error + 0.002 && error <= 0.03,
               "extinction, tau %g: %.4f +- %.4f, half-space %.4f, transmittance %.6f of 0", wall.tau, found, error,
               half_space(&wall), through);
    /* Thick: the half-space's, less what leaks (van de Hulst 1980): 4 K(mu) K(mu0) / (3 (tau + 1.4209)), with the
     * escape function K(mu) = sqrt(3) / 4 H(mu). Exact to 1e-6 from tau 32 on. */
    for (int k = 0; k < 2; k++) {
        const slab_case thick = {
            .albedo = 1.0, .g = 0.0, .tau = 100.0, .mu0 = k == 0 ? 0.5 : 0.2, .up = true, .mu = k == 0 ? 1.0 : 0.4};
        proof_mean m;
        slab_rig_layer(&p->rig, &thick, PROOF_SLAB_M);
        double leak = 0.25 * chandrasekhar_h(thick.mu) * chandrasekhar_h(thick.mu0) / (thick.tau + 1.4209);
        double expected = half_space(&thick) - leak;
        proof_measure(p, &thick, PROOF_SLAB_M, &m);
        proof_tell(p, proof_meets(proof_value(&m), proof_error(&m), expected),
                   "extinction, tau %g, mu0 %g, mu %g: %.5f +- %.5f, half-space less its leak %.5f: %+.3f %%, %+.2f "
                   "sigma of 4",
                   thick.tau, thick.mu0, thick.mu, proof_value(&m), proof_error(&m), expected,
                   100.0 * (proof_value(&m) / expected - 1.0), (proof_value(&m) - expected) / proof_error(&m));
    }
    slab_rig_finish(&p->rig);
}
