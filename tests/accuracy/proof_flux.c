/* What a slab sends up and lets through: radiance of all of the hemisphere, in five views of one point. */
#include <stdlib.h>
#include <string.h>

#include "proof.h"

enum { SIDE = 32, PIXELS = SIDE * SIDE, FACES = 5 };

#define LAT_DEG 50.0
#define LON_DEG 8.5
#define HEIGHT_STEP_M (27000.0 / 65535.0)
#define BASE_M (-1000.0 + 4854 * HEIGHT_STEP_M)

typedef struct panorama {
    velum_view *view;
    velum_view_frame face[FACES];
    double weight[FACES][PIXELS]; /* cosine times solid angle; pi in all */
    float light[PIXELS * 3], variance[PIXELS];
} panorama;

static void cross(const double a[3], const double b[3], double out[3]) {
    for (int i = 0; i < 3; i++) {
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
    }
}

/* Straight along `axis`, then half of each side. */
static void panorama_place(panorama *o, const double position[3], const double axis[3], const double east[3],
                           const double north[3]) {
    double total = 0.0;
    for (int f = 0; f < FACES; f++) {
        double forward[3], right[3];
        const double *first = f == 1 || f == 2 ? east : north;
        for (int i = 0; i < 3; i++) {
            forward[i] = f == 0 ? axis[i] : f % 2 ? first[i] : -first[i];
        }
        if (f == 0) {
            memcpy(right, east, sizeof right);
        } else {
            cross(forward, axis, right);
        }
        o->face[f] = fixture_camera(position, forward, right, 1.0f, 1.0f);
        for (int i = 0; i < 3 && f > 0; i++) {
            o->face[f].up_ecef[i] = axis[i];
        }
        o->face[f].tan_bottom = f == 0 ? -1.0f : 0.0f;
        double area = (f == 0 ? 4.0 : 2.0) / PIXELS;
        for (int k = 0; k < PIXELS; k++) {
            double x = (2 * (k % SIDE) + 1.0) / SIDE - 1.0;
            double down = (k / SIDE + 0.5) / SIDE;
            double y = f == 0 ? 1.0 - 2.0 * down : 1.0 - down;
            double square = 1.0 + x * x + y * y;
            o->weight[f][k] = (f == 0 ? 1.0 : y) * area / square / square;
            total += o->weight[f][k];
        }
    }
    for (int f = 0; f < FACES; f++) {
        for (int k = 0; k < PIXELS; k++) {
            o->weight[f][k] *= PROOF_PI / total;
        }
    }
}

/* Flux across a horizontal plane, of so many paths a pixel. */
static double panorama_flux(proof *p, panorama *o, const velum_frame_info *frame, uint32_t paths, double *error) {
    const fixture *f = &p->rig.f;
    double flux = 0.0;
    double square = 0.0;
    for (int k = 0; k < FACES; k++) {
        velum_view_frame view = o->face[k];
        view.path_limit = paths;
        velum_eye_frame eye = {.struct_size = sizeof eye, .eye = p->rig.eye, .flags = VELUM_EYE_RESET};
        memcpy(eye.position_ecef_m, view.position_ecef_m, sizeof eye.position_ecef_m);
        const velum_pixels pixels = {.struct_size = sizeof pixels,
                                     .view = o->view,
                                     .frame = &view,
                                     .luminance_rgb = o->light,
                                     .variance = o->variance,
                                     .width = SIDE,
                                     .height = SIDE};
        velum_view_stats stats = {.struct_size = sizeof stats};
        for (int i = 0; i < 1000000 && (i == 0 || stats.paths_per_pixel < paths); i++) {
            assert_int_equal(f->standalone_api->render(f->engine, frame, &eye, 1, 0, &pixels, 1, 0), VELUM_OK);
            assert_int_equal(f->engine_api->get_stats(o->view, &stats), VELUM_OK);
            eye.flags = 0;
        }
        for (int i = 0; i < PIXELS; i++) {
            flux += o->weight[k][i] * (double)o->light[3 * i + 1];
            square += o->weight[k][i] * o->weight[k][i] * (double)o->variance[i];
        }
    }
    *error = sqrt(square);
    return flux;
}

/* Of mu0 F0, through the top or the bottom. */
static void measure_flux(proof *p, panorama *o, const slab_case *c, bool up, proof_mean *out) {
    double east[3], north[3], zenith[3], axis[3], sun[3], position[3];
    fixture_axes(LAT_DEG, LON_DEG, east, north, zenith);
    for (int i = 0; i < 3; i++) {
        sun[i] = c->mu0 * zenith[i] + sqrt(fmax(1.0 - c->mu0 * c->mu0, 0.0)) * east[i];
        axis[i] = up ? -zenith[i] : zenith[i];
    }
    fixture_position(LAT_DEG, LON_DEG, up ? BASE_M + PROOF_SLAB_M + 5.0 : BASE_M - 5.0, position);
    panorama_place(o, position, axis, east, north);
    velum_frame_info frame = fixture_frame(sun, 0.0, VELUM_ATMOSPHERE_NONE);
    frame.sun_angular_radius_rad = 1e-5f;
    double start_s = proof_now_s();
    *out = (proof_mean){0};
    for (uint32_t paths = 4;; paths = paths < 64 ? 2 * paths : paths) {
        double error;
        frame.time_s = p->rig.time_s;
        p->rig.time_s += 1.0;
        double flux = panorama_flux(p, o, &frame, paths, &error);
        proof_add(out, flux / c->mu0, error / c->mu0, paths);
        double relative = proof_error(out) / proof_value(out);
        if ((relative <= p->error && paths >= 8) || proof_now_s() - start_s > p->seconds) {
            break;
        }
    }
}

static panorama *panorama_create(proof *p) {
    panorama *o = calloc(1, sizeof *o);
    assert_non_null(o);
    o->view = fixture_view(&p->rig.f, p->rig.eye, SIDE, SIDE);
    return o;
}

static void panorama_destroy(proof *p, panorama *o) {
    assert_int_equal(p->rig.f.engine_api->destroy_view(o->view), VELUM_OK);
    free(o);
}

void proof_flux(void **state) {
    proof *p = *state;
    char line[256];
    FILE *file = proof_table(p, "slab_flux.csv");
    slab_rig_init(&p->rig);
    panorama *o = panorama_create(p);
    double chi2 = 0.0;
    int row = 0, count = 0;
    while (fgets(line, sizeof line, file)) {
        slab_case c = {0};
        double expected[2];
        if (sscanf(line, "%lf,%lf,%lf,%lf,%lf,%lf", &c.albedo, &c.g, &c.tau, &c.mu0, &expected[0], &expected[1]) != 6 ||
            !proof_wants(p, ++row)) {
            continue;
        }
        slab_rig_layer(&p->rig, &c, PROOF_SLAB_M);
        for (int side = 0; side < 2; side++) {
            proof_mean m;
            measure_flux(p, o, &c, side == 0, &m);
            double found = proof_value(&m), error = proof_error(&m);
            double off = found - expected[side];
            proof_tell(p, proof_meets(found, error, expected[side]),
                       "flux row %d, albedo %g, g %g, tau %g, mu0 %g, %s: %.6f +- %.6f, table %.6f: %+.3f %% of %.3f "
                       "%%, %+.2f sigma of 4",
                       row, c.albedo, c.g, c.tau, c.mu0, side == 0 ? "back" : "through", found, error, expected[side],
                       100.0 * off / expected[side], 100.0 * error / expected[side], off / error);
            chi2 += off * off / error / error;
            count++;
        }
    }
    fclose(file);
    panorama_destroy(p, o);
    slab_rig_finish(&p->rig);
    proof_tell_chi2(p, "flux", count, chi2);
}

void proof_energy(void **state) {
    proof *p = *state;
    static const slab_case cases[] = {{.albedo = 1.0, .g = 0.85, .tau = 1.0, .mu0 = 1.0},
                                      {.albedo = 1.0, .g = 0.85, .tau = 4.0, .mu0 = 0.5},
                                      {.albedo = 1.0, .g = 0.85, .tau = 16.0, .mu0 = 0.8},
                                      {.albedo = 1.0, .g = 0.0, .tau = 8.0, .mu0 = 1.0}};
    slab_rig_init(&p->rig);
    panorama *o = panorama_create(p);
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        proof_mean back, through;
        slab_rig_layer(&p->rig, &cases[k], PROOF_SLAB_M);
        measure_flux(p, o, &cases[k], true, &back);
        measure_flux(p, o, &cases[k], false, &through);
        double direct = exp(-cases[k].tau / cases[k].mu0);
        double sum = proof_value(&back) + proof_value(&through) + direct;
        double error = hypot(proof_error(&back), proof_error(&through));
        proof_tell(p, proof_meets(sum, error, 1.0),
                   "energy, g %g, tau %g, mu0 %g: back %.5f + through %.5f + direct %.5f = %.5f +- %.5f, 1 within 4 "
                   "sigma and 0.5 %%",
                   cases[k].g, cases[k].tau, cases[k].mu0, proof_value(&back), proof_value(&through), direct, sum,
                   error);
    }
    panorama_destroy(p, o);
    slab_rig_finish(&p->rig);
}
