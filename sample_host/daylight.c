#include "daylight.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

static double luminance_of(const float rgb[3]) {
    return 0.2126 * (double)rgb[0] + 0.7152 * (double)rgb[1] + 0.0722 * (double)rgb[2];
}

static double degrees_of_sine(double sine) {
    return asin(fmin(fmax(sine, -1), 1)) * 180 / pi;
}

/* F. Kasten and A. T. Young 1989, "Revised optical air mass tables". */
static double air_mass(double elevation_deg) {
    double h = fmax(elevation_deg, 0);
    return 1 / (sin(h * pi / 180) + 0.50572 * pow(h + 6.07995, -1.6364));
}

/* Diffuse illuminance of a clear sky over that of the sun outside the air; P. K. Seidelmann (ed.) 1992, Explanatory
 * Supplement to the Astronomical Almanac, for the twilights, usual clear skies above. Log-linear between. */
static double clear_sky_share(double elevation_deg) {
    static const double table[][2] = {{-18, 5e-9}, {-12, 6e-8}, {-6, 2.7e-5}, {0, 0.005},
                                      {10, 0.04},  {30, 0.085}, {60, 0.12},   {90, 0.13}};
    enum { COUNT = sizeof table / sizeof table[0] };
    if (elevation_deg <= table[0][0]) {
        return table[0][1];
    }
    for (int i = 1; i < COUNT; i++) {
        if (elevation_deg <= table[i][0]) {
            double share = (elevation_deg - table[i - 1][0]) / (table[i][0] - table[i - 1][0]);
            return table[i - 1][1] * pow(table[i][1] / table[i - 1][1], share);
        }
    }
    return table[COUNT - 1][1];
}

static double open_sky(const struct cloud_cover *cover) {
    return 1 - fmin(fmax(cover->coverage, 0), 1);
}

/* Two streams, no absorption, asymmetry 0.85 (C. F. Bohren 1987, "Multiple scattering of light and some of its
 * observable consequences"). */
static double cloud_transmittance(const struct cloud_cover *cover) {
    double coverage = fmin(fmax(cover->coverage, 0), 1);
    if (!(coverage > 1e-3) || !(cover->optical_depth > 0)) {
        return 1;
    }
    return 1 - coverage + coverage / (1 + 0.5 * (1 - 0.85) * cover->optical_depth / coverage);
}

/* Of what broken cloud turns back, by its gaps: sunlit sides shine on the ground in its shadow. As Velum has it
 * (VELUM_ASIDE_SHARE), fitted to its reference. */
static const double aside_share = 0.64;

void daylight_compute(double sun_sine, const float illuminance_lx[3], bool atmosphere, const struct cloud_cover *cover,
                      struct daylight *out) {
    /* Zenith optical depth of Rec. 709 primaries: Rayleigh of 8 km scale height, ozone of 15 km (S. Hillaire 2020,
     * "A scalable and production ready sky and atmosphere rendering technique"), and thin haze. */
    static const double depth[3] = {0.0464 + 0.0098 + 0.05, 0.1085 + 0.0282 + 0.055, 0.2648 + 0.0013 + 0.06};
    static const double blue[3] = {0.72, 1.0, 1.55};
    double elevation = degrees_of_sine(sun_sine);
    double mass = air_mass(elevation);
    double through = cloud_transmittance(cover);
    double open = open_sky(cover);
    double aside = aside_share * open * (1 - through);
    double level = fmax(sun_sine, 0);
    for (int i = 0; i < 3; i++) {
        double top = (double)illuminance_lx[i];
        double sun = atmosphere ? top * exp(-depth[i] * mass) : top;
        double clear = atmosphere ? blue[i] * clear_sky_share(elevation) * top : 0;
        double total = sun * level + clear;
        out->sun_lx[i] = (float)(sun_sine > -0.01 ? sun : 0);
        out->sky_lx[i] = (float)(clear * open + total * (fmax(through - open, 0) + aside));
    }
}

/* What shows of the sky, by its mean: by day a few times as much; in twilight it is bright over the sun alone, the more
 * so the deeper that is (by the sky that Velum draws, 9 times at -3 degrees, 25 at -6). */
static double sky_brightest(double elevation_deg) {
    return 3 * exp2(fmin(fmax(-elevation_deg, 0), 6) / 2);
}

double daylight_exposure(double sun_sine, const float illuminance_lx[3], bool atmosphere,
                         const struct cloud_cover *cover) {
    static const struct cloud_cover none = {0, 0};
    struct daylight light;
    daylight_compute(sun_sine, illuminance_lx, atmosphere, &none, &light);
    /* What faces the sun is what must not burn out, however low the sun stands; at twilight the sky takes over. Under
     * broken cloud and a low sun little of what is seen does: its light comes through several gaps or none. */
    double open = open_sky(cover);
    double more_gaps = fmin(fmax(1 / fmax(sun_sine, 0.01) - 2, 0), 4);
    double lit = pow(fmax(open, 0.1), 0.5 * more_gaps);
    double sky_lx = sky_brightest(degrees_of_sine(sun_sine)) * luminance_of(light.sky_lx);
    double clear_lx = luminance_of(light.sun_lx) + sky_lx;
    double level_lx = luminance_of(light.sun_lx) * lit + sky_lx;
    /* Thin or broken cloud is as bright as anything in the sky; under a third of the light the eye follows. It never
     * makes up for all that is lost along the way: overcast stays duller than sunshine, and cloud beneath the eye
     * takes none. */
    const struct cloud_cover slant = {1 - pow(open, 1 + more_gaps), cover->optical_depth};
    double followed = fmin(1, pow(3 * cloud_transmittance(cover), 0.9));
    level_lx = fmax(level_lx * followed, clear_lx * pow(cloud_transmittance(&slant), 0.9));
    /* A floor at deep twilight: night stays night. */
    level_lx = fmax(level_lx, 1e-5 * luminance_of(illuminance_lx));
    return level_lx > 0 ? pi / level_lx : 1;
}
