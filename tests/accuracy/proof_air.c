/* Clear air, scattered once, by quadrature over the ellipsoid: molecules, aerosol and ozone in three colours at once.
 * Coefficients are the presets' (shaders/shared/air.h), heights GeographicLib's. */
#include <stddef.h>

#include "proof.h"
#include "shared/air.h"

#define LAT_DEG 50.0
#define LON_DEG 8.5
#define DEG (PROOF_PI / 180.0)

typedef struct air_case {
    double visibility_m;
    double height_m, view_deg, sun_deg, azimuth_deg; /* elevations; azimuth from the sun's */
} air_case;

/* What a visibility adds to clear air at the surface, by Koschmieder's law for a contrast of 5 % (WMO-No. 8), thins out
 * upward over 1500 m, absorbs nothing and scatters by Henyey and Greenstein's function of 0.7. */
#define HAZE_SCALE_M 1500.0
#define HAZE_G 0.7

static double rayleigh_1_m(double height_m, int colour) {
    static const double sea_level[3] = {(double)VELUM_RAYLEIGH_R, (double)VELUM_RAYLEIGH_G, (double)VELUM_RAYLEIGH_B};
    return sea_level[colour] * (double)velum_rayleigh_density((float)height_m);
}

static double aerosol_1_m(double height_m) {
    return (double)VELUM_AEROSOL_SCATTERING * (double)velum_aerosol_density((float)height_m);
}

static double haze_1_m(double visibility_m, double height_m) {
    const double clear = (double)(VELUM_RAYLEIGH_G + VELUM_AEROSOL_EXTINCTION);
    return fmax(-log(0.05) / visibility_m - clear, 0.0) * exp(-fmax(height_m, 0.0) / HAZE_SCALE_M);
}

static double extinction_1_m(double visibility_m, double height_m, int colour) {
    static const double ozone[3] = {(double)VELUM_OZONE_R, (double)VELUM_OZONE_G, (double)VELUM_OZONE_B};
    return rayleigh_1_m(height_m, colour) + haze_1_m(visibility_m, height_m) +
           aerosol_1_m(height_m) * (double)(VELUM_AEROSOL_EXTINCTION / VELUM_AEROSOL_SCATTERING) +
           ozone[colour] * (double)velum_ozone_density((float)height_m);
}

/* Where a ray leaves the air, or meets the ground: the first height out of the range, by halving. */
static double end_of(const double from[3], const double to[3], double from_m, bool *ground) {
    const double top_m = (double)VELUM_AIR_TOP_M;
    double t = from_m, last = from_m;
    double h = proof_height_at(from, to, t);
    while (h >= 0.0 && (h <= top_m || t == from_m)) {
        last = t;
        t += 500.0 + 0.02 * fabs(h);
        h = proof_height_at(from, to, t);
    }
    *ground = h < 0.0;
    for (int i = 0; i < 50; i++) {
        const double middle = 0.5 * (last + t);
        const double at = proof_height_at(from, to, middle);
        *(at < 0.0 || at > top_m ? &t : &last) = middle;
    }
    return last;
}

/* Optical depths between two places of a ray; panels grow from the near end. */
static void depths(double visibility_m, const double from[3], const double to[3], double start, double end,
                   double out[3]) {
    enum { PANELS = 24 };
    out[0] = out[1] = out[2] = 0.0;
    double left = start;
    for (int k = 0; k < PANELS; k++) {
        const double share = (k + 1.0) / PANELS;
        const double right = start + (end - start) * share * share;
        for (int j = 0; j < 5; j++) {
            const double h = proof_height_at(from, to, 0.5 * (left + right) + 0.5 * (right - left) * proof_node[j]);
            for (int c = 0; c < 3; c++) {
                out[c] += 0.5 * (right - left) * proof_weight[j] * extinction_1_m(visibility_m, h, c);
            }
        }
        left = right;
    }
}

/* Luminance for a sun of illuminance 1 in each colour, over black ground. */
static void sky(double visibility_m, const double from[3], const double ahead[3], const double sun[3], double out[3]) {
    enum { PANELS = 80 };
    bool ground, shaded;
    double start = 0.0;
    while (proof_height_at(from, ahead, start) > (double)VELUM_AIR_TOP_M) {
        start += 100.0;
    }
    const double end = end_of(from, ahead, start, &ground);
    const double cosine = ahead[0] * sun[0] + ahead[1] * sun[1] + ahead[2] * sun[2];
    const double molecules = 3.0 / (16.0 * PROOF_PI) * (1.0 + cosine * cosine);
    const double dust = proof_phase((double)VELUM_AEROSOL_G, cosine);
    const double haze = proof_phase(HAZE_G, cosine);
    double before[3] = {0.0}, left = start;
    out[0] = out[1] = out[2] = 0.0;
    for (int k = 0; k < PANELS; k++) {
        /* Finest at the ground, where that is met. */
        const double share = (k + 1.0) / PANELS;
        const double bent = ground ? 1.0 - (1.0 - share) * (1.0 - share) : share * share;
        const double right = start + (end - start) * bent;
        double through[3];
        for (int j = 0; j < 5; j++) {
            const double t = 0.5 * (left + right) + 0.5 * (right - left) * proof_node[j];
            double here[3], sunward[3], point[3];
            for (int i = 0; i < 3; i++) {
                point[i] = from[i] + t * ahead[i];
            }
            const double h = proof_height_at(from, ahead, t);
            const double leave = end_of(point, sun, 0.0, &shaded);
            if (shaded) {
                continue;
            }
            depths(visibility_m, from, ahead, left, t, here);
            depths(visibility_m, point, sun, 0.0, leave, sunward);
            for (int i = 0; i < 3; i++) {
                out[i] += 0.5 * (right - left) * proof_weight[j] * exp(-before[i] - here[i] - sunward[i]) *
                          (rayleigh_1_m(h, i) * molecules + aerosol_1_m(h) * dust + haze_1_m(visibility_m, h) * haze);
            }
        }
        depths(visibility_m, from, ahead, left, right, through);
        for (int i = 0; i < 3; i++) {
            before[i] += through[i];
        }
        left = right;
    }
}

static void commit_visibility(fixture *f, float visibility_m) {
    const velum_cell cell = {.struct_size = sizeof cell,
                             .flags = VELUM_CELL_HAS_VISIBILITY,
                             .id = 1,
                             .kind = VELUM_CELL_GLOBAL,
                             .visibility_m = visibility_m};
    const velum_state_desc state = {.struct_size = sizeof state, .cells = &cell, .cell_count = 1};
    const uint64_t before = f->state;
    assert_int_equal(f->world_api->commit(f->world, &state, &f->state), VELUM_OK);
    if (before) {
        f->world_api->retire(f->world, before);
    }
}

static void measure(proof *p, const air_case *c, proof_mean found[3], double expected[3]) {
    double east[3], north[3], up[3], sun[3], ahead[3], right[3], position[3];
    fixture_axes(LAT_DEG, LON_DEG, east, north, up);
    fixture_position(LAT_DEG, LON_DEG, c->height_m, position);
    for (int i = 0; i < 3; i++) {
        const double side = cos(c->azimuth_deg * DEG) * east[i] + sin(c->azimuth_deg * DEG) * north[i];
        sun[i] = sin(c->sun_deg * DEG) * up[i] + cos(c->sun_deg * DEG) * east[i];
        ahead[i] = sin(c->view_deg * DEG) * up[i] + cos(c->view_deg * DEG) * side;
        right[i] = sin(c->azimuth_deg * DEG) * east[i] - cos(c->azimuth_deg * DEG) * north[i];
    }
    velum_view_frame camera = fixture_camera(position, ahead, right, 0.0005f, 0.0005f);
    camera.flags = VELUM_VIEW_GROUND;
    const double start_s = proof_now_s();
    for (uint32_t paths = 64;; paths = paths < 1024 ? 2 * paths : paths) {
        velum_frame_info frame = fixture_frame(sun, p->rig.time_s, VELUM_ATMOSPHERE_EARTH);
        p->rig.time_s += 1.0;
        frame.sun_angular_radius_rad = 1e-5f;
        for (int i = 0; i < 3; i++) {
            frame.sun_illuminance_lx[i] = 1.0f;
            frame.ground_albedo[i] = 0.0f;
        }
        slab_rig_render(&p->rig, &frame, position, &camera, true, paths);
        for (int k = 0; k < 3; k++) {
            /* Colours share their paths, but the variance told is of the mean: each colour's is of its pixels. */
            double sum = 0.0, squares = 0.0;
            for (int i = 0; i < SLAB_PIXELS; i++) {
                const double value = (double)p->rig.light[3 * i + k];
                sum += value / SLAB_PIXELS;
                squares += value * value / SLAB_PIXELS;
            }
            proof_add(&found[k], sum, sqrt(fmax(squares - sum * sum, 0.0) / (SLAB_PIXELS - 1)), paths);
        }
        if (proof_error(&found[1]) <= p->error * proof_value(&found[1]) || proof_now_s() - start_s > p->seconds) {
            break;
        }
    }
    sky(c->visibility_m, position, ahead, sun, expected);
}

void proof_air(void **state) {
    proof *p = *state;
    static const air_case cases[] = {
        {1e6, 0.0, 90.0, 45.0, 0.0},        {1e6, 0.0, 45.0, 45.0, 90.0},         {1e6, 0.0, 10.0, 10.0, 90.0},
        {1e6, 0.0, 2.0, 2.0, 90.0},         {1e6, 0.0, 10.0, -2.0, 0.0},          {1e6, 0.0, 20.0, 30.0, 10.0},
        {1e6, 10000.0, -10.0, 45.0, 90.0},  {1e6, 10000.0, -1.0, 2.0, 180.0},     {1e6, 400000.0, -90.0, 60.0, 0.0},
        {1e6, 400000.0, -19.3, 10.0, 30.0}, {30000.0, 0.0, 45.0, 45.0, 90.0},     {30000.0, 0.0, 10.0, 10.0, 90.0},
        {30000.0, 0.0, 20.0, 30.0, 10.0},   {30000.0, 400000.0, -90.0, 60.0, 0.0}};
    static const char *const colours[] = {"red", "green", "blue"};
    double chi2 = 0.0;
    int count = 0;
    slab_rig_init(&p->rig);
    slab_rig_order(&p->rig, 1);
    for (size_t n = 0; n < sizeof cases / sizeof cases[0]; n++) {
        proof_mean found[3] = {{0}};
        double expected[3];
        commit_visibility(&p->rig.f, (float)cases[n].visibility_m);
        measure(p, &cases[n], found, expected);
        for (int k = 0; k < 3; k++) {
            const double value = proof_value(&found[k]), error = proof_error(&found[k]);
            proof_tell(p, proof_meets(value, error, expected[k]),
                       "air, first order, visibility %g m, at %g m, view %g, sun %g, azimuth %g, %s: %.7f +- %.7f, "
                       "quadrature %.7f: "
                       "%+.3f %%, %+.2f sigma of 4",
                       cases[n].visibility_m, cases[n].height_m, cases[n].view_deg, cases[n].sun_deg,
                       cases[n].azimuth_deg, colours[k], value, error, expected[k], 100.0 * (value / expected[k] - 1.0),
                       (value - expected[k]) / error);
            chi2 += (value - expected[k]) * (value - expected[k]) / error / error;
            count++;
        }
    }
    slab_rig_finish(&p->rig);
    proof_tell_chi2(p, "air, first order", count, chi2);
}
