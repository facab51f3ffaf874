/* Light and shade of whole scenes, where a mistake shows at once. */
#include <math.h>

#include "fixture.h"

enum { WIDTH = 48, HEIGHT = 36, PIXELS = WIDTH * HEIGHT, REFERENCE_PATHS = 4 };
static const double lat_deg = 50.0, lon_deg = 8.5;

typedef struct scene {
    double height_m, pitch_deg, sun_deg; /* of the eye; over the horizon; looking east, the sun in the south-west */
    float albedo;
    int32_t quality, atmosphere;
    bool every_pixel;     /* has a ray */
    uint32_t light_steps; /* 0: as many as the quality has */
    uint32_t paths;       /* of a reference; 0: REFERENCE_PATHS */
} scene;

typedef struct answer {
    double luminance, transmittance; /* mean */
    double most, spread;             /* of luminance; standard deviation */
} answer;

static void draw(fixture *f, const scene *s, int frames, float *light, float *through) {
    double east[3], north[3], up[3], forward[3], sun[3];
    const double deg = acos(-1.0) / 180.0;
    velum_eye *eye = NULL;
    const velum_eye_desc desc = {.struct_size = sizeof desc, .quality = s->quality};
    assert_int_equal(f->engine_api->create_eye(f->engine, &desc, &eye), VELUM_OK);
    velum_view *view = fixture_view(f, eye, WIDTH, HEIGHT);
    fixture_axes(lat_deg, lon_deg, east, north, up);
    for (int i = 0; i < 3; i++) {
        forward[i] = cos(s->pitch_deg * deg) * east[i] + sin(s->pitch_deg * deg) * up[i];
        sun[i] = sin(s->sun_deg * deg) * up[i] - cos(s->sun_deg * deg) * (0.6 * east[i] + 0.8 * north[i]);
    }
    double right[3];
    for (int i = 0; i < 3; i++) {
        right[i] = -north[i];
    }
    velum_frame_info frame = fixture_frame(sun, 0.0, s->atmosphere);
    for (int i = 0; i < 3; i++) {
        frame.ground_albedo[i] = s->albedo;
    }
    velum_eye_frame at = {.struct_size = sizeof at, .eye = eye};
    fixture_position(lat_deg, lon_deg, s->height_m, at.position_ecef_m);
    velum_view_frame camera = fixture_camera(at.position_ecef_m, forward, right, 0.4f, 0.3f);
    camera.flags |= s->atmosphere == VELUM_ATMOSPHERE_EARTH ? VELUM_VIEW_GROUND : 0u;
    const velum_pixels pixels = {.struct_size = sizeof pixels,
                                 .view = view,
                                 .frame = &camera,
                                 .luminance_rgb = light,
                                 .transmittance_rgb = through,
                                 .width = WIDTH,
                                 .height = HEIGHT};
    velum_view_stats stats = {.struct_size = sizeof stats};
    const uint32_t paths = s->paths > 0 ? s->paths : REFERENCE_PATHS;
    for (int i = 0; s->quality == VELUM_QUALITY_REFERENCE ? stats.paths_per_pixel < paths : i < frames; i++) {
        assert_int_equal(f->standalone_api->render(f->engine, &frame, &at, 1, 0, &pixels, 1, 0), VELUM_OK);
        assert_int_equal(f->engine_api->get_stats(view, &stats), VELUM_OK);
        if (i == 0 && s->every_pixel) {
            velum_plan plan = {.struct_size = sizeof plan};
            assert_int_equal(f->engine_api->get_plan(eye, &plan, NULL), VELUM_OK);
            plan.light_steps = s->light_steps > 0 ? s->light_steps : plan.light_steps;
            plan.ray_rate = 1;
            assert_int_equal(f->engine_api->set_plan(eye, &plan), VELUM_OK);
        }
    }
    assert_int_equal(f->engine_api->destroy_view(view), VELUM_OK);
    assert_int_equal(f->engine_api->destroy_eye(eye), VELUM_OK);
}

static answer look(fixture *f, const scene *s) {
    float light[3 * PIXELS], through[3 * PIXELS];
    draw(f, s, 32, light, through);
    answer a = {0};
    double squares = 0.0;
    for (int i = 0; i < 3 * PIXELS; i++) {
        double luminance = (double)light[i];
        assert_true(isfinite(luminance) && luminance >= 0.0 && through[i] >= 0.0f && through[i] <= 1.0f);
        a.luminance += luminance / (3 * PIXELS);
        a.transmittance += (double)through[i] / (3 * PIXELS);
        a.most = fmax(a.most, luminance);
        squares += luminance * luminance / (3 * PIXELS);
    }
    a.spread = sqrt(fmax(squares - a.luminance * a.luminance, 0.0));
    return a;
}

/* The sea lies up to 107 m below the ellipsoid (EGM96). */
static void the_sea_below_the_ellipsoid_is_like_any(void **state) {
    (void)state;
    fixture f;
    fixture_borrow(&f);
    velum_layer cumulus = fixture_cumulus();
    fixture_commit(&f, &cumulus, 1);
    scene s = {.height_m = 2.0, .sun_deg = 40.0, .albedo = 0.1f, .atmosphere = VELUM_ATMOSPHERE_EARTH};
    s.quality = VELUM_QUALITY_LOW;
    const answer above = look(&f, &s);
    assert_true(above.luminance > 500.0);
    const double heights_m[] = {0.0, -1.0, -105.0, -430.0};
    for (int i = 0; i < 4; i++) {
        s.height_m = heights_m[i];
        assert_float_equal(look(&f, &s).luminance, above.luminance, 0.08 * above.luminance);
    }
    fixture_give_back(&f);
}

/* Between white ground and white cloud light goes to and fro, but no more comes out than went in: nothing is brighter
 * than a white sheet in the sun, save toward it. */
static void white_ground_under_deep_cloud_gains_nothing(void **state) {
    (void)state;
    fixture f;
    fixture_borrow(&f);
    velum_layer layers[3];
    for (int i = 0; i < 3; i++) {
        layers[i] = fixture_cumulus();
        layers[i].genus = i == 0 ? VELUM_GENUS_ST : i == 1 ? VELUM_GENUS_SC : VELUM_GENUS_NS;
        layers[i].coverage = 1.0f;
        layers[i].base_m = 600.0f + 2000.0f * (float)i;
        layers[i].top_m = layers[i].base_m + 1500.0f;
        layers[i].water_g_m3 = 0.8f;
    }
    fixture_commit(&f, layers, 3);
    for (int k = 0; k < 3; k++) {
        const scene s = {.height_m = k == 0   ? 100.0
                                     : k == 1 ? 2300.0
                                              : 12000.0,
                         .pitch_deg = k == 2 ? -30.0 : 0.0,
                         .sun_deg = 40.0,
                         .albedo = 1.0f,
                         .quality = VELUM_QUALITY_LOW,
                         .atmosphere = VELUM_ATMOSPHERE_EARTH};
        const answer a = look(&f, &s);
        const double white = 128000.0 * sin(40.0 / 57.29578) / acos(-1.0);
        assert_true(a.most > 0.0 && a.most < 2.0 * white);
    }
    fixture_give_back(&f);
}

/* A deep sheet without gaps is dark, and evenly so, from below, and lets as much light through as a uniform layer of
 * its optical depth; wherever the sun stands, though its way through the sheet be longer than any march. */
static void a_closed_sheet_lets_light_through_as_a_slab_does(void **state) {
    (void)state;
    fixture f;
    fixture_borrow(&f);
    const float depth = 60.0f;
    velum_layer slab = fixture_slab(depth);
    slab.flags |= VELUM_LAYER_PHASE_HG;
    slab.hg_asymmetry = 0.879f; /* mean cosine of droplets: velum_phase_lobes_cloud */
    velum_layer sheet = fixture_layer(VELUM_GENUS_NS, 1.0f, 1000.0f, 4000.0f);
    sheet.flags |= VELUM_LAYER_EXTINCTION;
    sheet.extinction_1_m = depth / 3000.0f;
    const double suns_deg[] = {58.0, 15.0};
    for (int i = 0; i < 2; i++) {
        const scene s = {.height_m = 120.0,
                         .pitch_deg = 50.0,
                         .sun_deg = suns_deg[i],
                         .quality = VELUM_QUALITY_HIGH,
                         .atmosphere = VELUM_ATMOSPHERE_NONE};
        fixture_commit(&f, &slab, 1);
        const answer even = look(&f, &s);
        fixture_commit(&f, &sheet, 1);
        const answer found = look(&f, &s);
        print_message("sun at %g degrees: slab %.4g cd/m2, sheet %.4g, standard deviation %.3f of it\n", suns_deg[i],
                      even.luminance, found.luminance, found.spread / found.luminance);
        assert_float_equal(found.luminance, even.luminance, 0.2 * even.luminance);
        assert_true(found.spread < 0.12 * found.luminance);
    }
    fixture_give_back(&f);
}

/* What a picture of four rays a pixel is off by from that of many, over the mean light. */
static double grain(fixture *f, const scene *s) {
    float few[3 * PIXELS], many[3 * PIXELS], through[3 * PIXELS];
    draw(f, s, 64, few, through);
    draw(f, s, 512, many, through);
    double squares = 0.0, mean = 0.0;
    for (int i = 0; i < 3 * PIXELS; i++) {
        const double apart = (double)few[i] - (double)many[i];
        squares += apart * apart / (3 * PIXELS);
        mean += (double)many[i] / (3 * PIXELS);
    }
    return sqrt(squares) / mean;
}

static void expect_no_grain(fixture *f, double height_m, double pitch_deg, double bound) {
    const scene s = {.height_m = height_m,
                     .pitch_deg = pitch_deg,
                     .sun_deg = 45.0,
                     .albedo = 0.1f,
                     .quality = VELUM_QUALITY_MEDIUM,
                     .atmosphere = VELUM_ATMOSPHERE_EARTH};
    const double found = grain(f, &s);
    print_message("from %g m up by %g degrees: four rays a pixel are off by %.4f of the mean light\n", height_m,
                  pitch_deg, found);
    assert_true(found < bound);
}

/* Of near rims and what lies behind them each ray shows both, not now one and now the other: few rays tell the picture
 * that many come to. */
static void rims_before_far_cloud_have_no_grain(void **state) {
    (void)state;
    fixture f;
    fixture_borrow(&f);
    const velum_layer rolls = fixture_layer(VELUM_GENUS_SC, 0.75f, 900.0f, 1500.0f);
    fixture_commit(&f, &rolls, 1);
    expect_no_grain(&f, 600.0, 10.0, 0.02);
    expect_no_grain(&f, 600.0, 20.0, 0.02);
    fixture_give_back(&f);
}

/* Among cumulus, tongues in the sun stand close before walls in the shade: each ray shows both. */
static void tongues_before_near_walls_have_no_sparks(void **state) {
    (void)state;
    fixture f;
    fixture_borrow(&f);
    const velum_layer heaps = fixture_layer(VELUM_GENUS_CU, 0.5f, 1000.0f, 1900.0f);
    fixture_commit(&f, &heaps, 1);
    expect_no_grain(&f, 1250.0, 5.0, 0.0055);
    expect_no_grain(&f, 1550.0, 5.0, 0.0055);
    fixture_give_back(&f);
}

/* What a picture of one ray a pixel is off by from that of many, over its light: where that differs from `dry` and is
 * even. */
static double grain_of_rain(fixture *f, const scene *s, const float *dry, int *pixels) {
    float few[3 * PIXELS], many[3 * PIXELS], through[3 * PIXELS];
    draw(f, s, 16, few, through);
    draw(f, s, 256, many, through);
    double squares = 0.0;
    *pixels = 0;
    for (int y = 1; y < HEIGHT - 1; y++) {
        for (int x = 1; x < WIDTH - 1; x++) {
            const int at = 3 * (y * WIDTH + x) + 1;
            double most = 0.0;
            for (int i = 0; i < 9; i++) {
                const int beside = at + 3 * ((i / 3 - 1) * WIDTH + i % 3 - 1);
                most = fmax(most, fabs((double)many[beside] / (double)many[at] - 1.0));
            }
            const bool rain = most < 0.1 && fabs((double)dry[at] / (double)many[at] - 1.0) > 0.2;
            const double apart = (double)few[at] / (double)many[at] - 1.0;
            squares += rain ? apart * apart : 0.0;
            *pixels += rain;
        }
    }
    return sqrt(squares / fmax(*pixels, 1.0));
}

/* A shaft of rain lies in the sun here, in its cloud's shade there: each ray shows the mean of its way through it. */
static void shafts_half_in_the_sun_have_no_grain(void **state) {
    (void)state;
    fixture f;
    fixture_borrow(&f);
    const double suns_deg[] = {20.0, 40.0}, bounds[] = {0.03, 0.04};
    for (int k = 0; k < 2; k++) {
        velum_layer storms = fixture_layer(VELUM_GENUS_CB, 0.25f, 1200.0f, 9000.0f);
        const scene s = {.height_m = 500.0,
                         .sun_deg = suns_deg[k],
                         .albedo = 0.1f,
                         .quality = VELUM_QUALITY_MEDIUM,
                         .atmosphere = VELUM_ATMOSPHERE_EARTH};
        float dry[3 * PIXELS], through[3 * PIXELS];
        fixture_commit(&f, &storms, 1);
        draw(&f, &s, 32, dry, through);
        storms.precipitation = VELUM_PRECIPITATION_RAIN;
        storms.precipitation_mm_h = 10.0f;
        fixture_commit(&f, &storms, 1);
        int pixels;
        const double found = grain_of_rain(&f, &s, dry, &pixels);
        print_message("sun at %g degrees: one ray a pixel is off by %.4f of the light at %d even pixels of rain\n",
                      suns_deg[k], found, pixels);
        assert_true(pixels > PIXELS / 12);
        assert_true(found < bounds[k]);
    }
    fixture_give_back(&f);
}

/* Of a veil a low sun lights the skin alone, which is little of a ray's opacity: that little has a place of its own, or
 * the few rays that draw it would stand in the picture as sparks. */
static void veils_under_a_low_sun_have_no_sparks(void **state) {
    (void)state;
    fixture f;
    fixture_borrow(&f);
    const int32_t genera[] = {VELUM_GENUS_CS, VELUM_GENUS_CI};
    const double bounds[] = {0.032, 0.043};
    for (int k = 0; k < 2; k++) {
        const velum_layer veil = fixture_layer(genera[k], k == 0 ? 0.95f : 0.5f, 7500.0f, 9000.0f);
        fixture_commit(&f, &veil, 1);
        const scene s = {.height_m = 9900.0,
                         .pitch_deg = -20.0,
                         .sun_deg = 3.0,
                         .albedo = 0.1f,
                         .quality = VELUM_QUALITY_MEDIUM,
                         .atmosphere = VELUM_ATMOSPHERE_EARTH};
        const double found = grain(&f, &s);
        print_message("%s: four rays a pixel are off by %.4f of the mean light\n", k == 0 ? "Cs" : "Ci", found);
        assert_true(found < bounds[k]);
    }
    fixture_give_back(&f);
}

/* Standard deviation of light about its mean over 5 x 5 pixels, over that mean, where none comes through. */
static double relief(fixture *f, const scene *s, int *pixels) {
    float light[3 * PIXELS], through[3 * PIXELS];
    draw(f, s, 64, light, through);
    double squares = 0.0;
    *pixels = 0;
    for (int y = 2; y < HEIGHT - 2; y++) {
        for (int x = 2; x < WIDTH - 2; x++) {
            double mean = 0.0;
            bool opaque = true;
            for (int i = 0; i < 25; i++) {
                const int at = 3 * ((y - 2 + i / 5) * WIDTH + x - 2 + i % 5) + 1;
                opaque = opaque && through[at] < 0.01f;
                mean += (double)light[at] / 25.0;
            }
            const double apart = (double)light[3 * (y * WIDTH + x) + 1] / mean - 1.0;
            squares += opaque ? apart * apart : 0.0;
            *pixels += opaque;
        }
    }
    return sqrt(squares / fmax(*pixels, 1.0));
}

/* A storm's wall in the shade is no paper: its lumps are brighter where they are turned up than where they are turned
 * down. */
static void walls_of_storms_show_their_lumps_in_the_shade(void **state) {
    (void)state;
    fixture f;
    fixture_borrow(&f);
    const velum_layer storms = fixture_layer(VELUM_GENUS_CB, 0.35f, 900.0f, 11500.0f);
    fixture_commit(&f, &storms, 1);
    const scene s = {.height_m = 2000.0,
                     .sun_deg = 180.0 - 40.0, /* before the eye */
                     .albedo = 0.1f,
                     .quality = VELUM_QUALITY_MEDIUM,
                     .atmosphere = VELUM_ATMOSPHERE_EARTH};
    int pixels;
    const double found = relief(&f, &s, &pixels);
    print_message("%d pixels of wall, relief %.4f\n", pixels, found);
    assert_true(pixels > PIXELS / 2);
    assert_true(found > 0.02);
    fixture_give_back(&f);
}

/* How unevenly a preset's steps towards the sun tell the light where none comes through: mean change, from each pixel
 * to the next, of the light's ratio to that of as many steps as there may be. */
static double blotches(fixture *f, scene s, int *pixels) {
    float few[3 * PIXELS], many[3 * PIXELS], through[3 * PIXELS];
    s.every_pixel = true;
    draw(f, &s, 64, few, through);
    s.light_steps = 64;
    draw(f, &s, 64, many, through);
    double sum = 0.0;
    *pixels = 0;
    for (int i = 0; i < PIXELS - 1; i++) {
        const int here = 3 * i + 1, next = here + 3;
        if (i % WIDTH < WIDTH - 1 && through[here] < 0.01f && through[next] < 0.01f) {
            sum += fabs((double)few[here] / (double)many[here] - (double)few[next] / (double)many[next]);
            ++*pixels;
        }
    }
    return sum / fmax(*pixels, 1.0);
}

/* Too few steps leave a base dark or light by what happens to stand at one place of each. */
static void bases_of_cumulus_have_no_blotches(void **state) {
    (void)state;
    fixture f;
    fixture_borrow(&f);
    const velum_layer heaps = fixture_layer(VELUM_GENUS_CU, 0.3f, 1200.0f, 1900.0f);
    fixture_commit(&f, &heaps, 1);
    const int32_t qualities[] = {VELUM_QUALITY_LOW, VELUM_QUALITY_MEDIUM, VELUM_QUALITY_HIGH};
    const double bounds[] = {0.035, 0.02, 0.008};
    for (int q = 0; q < 3; q++) {
        const scene s = {.height_m = 700.0,
                         .pitch_deg = 22.0,
                         .sun_deg = 48.0,
                         .albedo = 0.1f,
                         .quality = qualities[q],
                         .atmosphere = VELUM_ATMOSPHERE_EARTH};
        int pixels;
        const double found = blotches(&f, s, &pixels);
        print_message("preset %d: %d pixels of cumulus from below, from one to the next %.4f apart in what few steps "
                      "are off by\n",
                      (int)qualities[q], pixels, found);
        assert_true(pixels > PIXELS / 5);
        assert_true(found < bounds[q]);
    }
    fixture_give_back(&f);
}

/* A step from far above may not pass over a layer. */
static void cloud_is_met_from_any_height(void **state) {
    (void)state;
    fixture f;
    fixture_borrow(&f);
    velum_layer cumulus = fixture_cumulus();
    cumulus.coverage = 0.5f;
    fixture_commit(&f, &cumulus, 1);
    const int32_t qualities[] = {VELUM_QUALITY_LOW, VELUM_QUALITY_MEDIUM, VELUM_QUALITY_HIGH};
    const double heights_m[] = {20000.0, 120000.0, 400000.0};
    for (int q = 0; q < 3; q++) {
        for (int h = 0; h < 3; h++) {
            const scene s = {.height_m = heights_m[h],
                             .pitch_deg = -90.0,
                             .sun_deg = 40.0,
                             .quality = qualities[q],
                             .atmosphere = VELUM_ATMOSPHERE_NONE};
            assert_float_equal(look(&f, &s).transmittance, 0.5, 0.15);
        }
    }
    fixture_give_back(&f);
}

/* Under a low sun lines of sight to it are few between the clouds, and the haze below is dim; above them it is not. */
static void cloud_shades_the_air_under_a_low_sun(void **state) {
    (void)state;
    fixture f;
    fixture_borrow(&f);
    scene s = {.height_m = 50.0, .pitch_deg = -6.0, .sun_deg = 3.0, .albedo = 0.1f};
    s.quality = VELUM_QUALITY_LOW;
    s.atmosphere = VELUM_ATMOSPHERE_EARTH;
    scene over = s;
    over.height_m = 9000.0;
    over.pitch_deg = 20.0;
    velum_layer cumulus = fixture_cumulus();
    cumulus.coverage = 0.0f;
    fixture_commit(&f, &cumulus, 1);
    const double clear = look(&f, &s).luminance;
    const double clear_over = look(&f, &over).luminance;
    cumulus.coverage = 0.5f;
    fixture_commit(&f, &cumulus, 1);
    const double shaded = look(&f, &s).luminance;
    print_message("under a low sun: %.3f of clear air\n", shaded / clear);
    assert_true(shaded < 0.6 * clear);
    assert_float_equal(look(&f, &over).luminance, clear_over, 0.2 * clear_over);
    fixture_give_back(&f);
}

/* It meets straight those flanks that an eye with the sun behind it sees. */
static void cumulus_shine_under_a_low_sun(void **state) {
    (void)state;
    fixture f;
    fixture_borrow(&f);
    velum_layer cumulus = fixture_cumulus();
    cumulus.coverage = 0.25f;
    cumulus.top_m = 1700.0f;
    fixture_commit(&f, &cumulus, 1);
    scene s = {.height_m = 500.0, .pitch_deg = 6.0, .sun_deg = 12.0, .albedo = 0.1f, .paths = 2};
    s.quality = VELUM_QUALITY_REFERENCE;
    s.atmosphere = VELUM_ATMOSPHERE_EARTH;
    const answer expected = look(&f, &s);
    s.quality = VELUM_QUALITY_MEDIUM;
    const answer found = look(&f, &s);
    print_message("cumulus under a low sun: %.3f of the reference\n", found.luminance / expected.luminance);
    assert_float_equal(found.luminance, expected.luminance, 0.08 * expected.luminance);
    fixture_give_back(&f);
}

/* Of fog up to 150 m from within, under a sheet too; of clear air and of haze, over dark ground and over snow, which
 * the air and it light in turn. */
static void air_is_as_bright_as_its_reference(void **state) {
    (void)state;
    static const struct {
        float visibility_m, albedo;
        double height_m, pitch_deg, sun_deg, bound;
        uint32_t layers;
    } cases[] = {{300.0f, 0.2f, 60.0, 10.0, 50.0, 0.06, 0},    {300.0f, 0.2f, 60.0, 0.0, 50.0, 0.06, 0},
                 {300.0f, 0.2f, 60.0, -30.0, 50.0, 0.06, 0},   {300.0f, 0.2f, 60.0, 10.0, 15.0, 0.06, 0},
                 {300.0f, 0.2f, 60.0, 0.0, 15.0, 0.06, 0},     {300.0f, 0.2f, 60.0, -30.0, 15.0, 0.06, 0},
                 {1e5f, 0.2f, 60.0, 30.0, 50.0, 0.03, 0},      {1e5f, 0.2f, 60.0, 30.0, 15.0, 0.03, 0},
                 {1e5f, 0.2f, 60.0, 0.0, 15.0, 0.03, 0},       {300.0f, 0.2f, 60.0, 0.0, 50.0, 0.10, 1},
                 {300.0f, 0.2f, 60.0, 0.0, 15.0, 0.10, 1},     {1e5f, 0.9f, 60.0, 30.0, 50.0, 0.04, 0},
                 {1e5f, 0.9f, 60.0, 30.0, 15.0, 0.06, 0},      {1e5f, 0.9f, 6000.0, -30.0, 50.0, 0.06, 0},
                 {1e5f, 0.9f, 6000.0, -30.0, 15.0, 0.06, 0},   {25e3f, 0.9f, 60.0, 30.0, 50.0, 0.08, 0},
                 {25e3f, 0.9f, 6000.0, -30.0, 50.0, 0.08, 0},  {25e3f, 0.05f, 60.0, 30.0, 50.0, 0.08, 0},
                 {25e3f, 0.05f, 6000.0, -30.0, 50.0, 0.08, 0}, {25e3f, 0.05f, 60.0, 0.0, 15.0, 0.08, 0},
                 {25e3f, 0.9f, 60.0, 30.0, 15.0, 0.08, 0},     {25e3f, 0.9f, 6000.0, -30.0, 15.0, 0.08, 0},
                 {25e3f, 0.9f, 60.0, 30.0, 3.0, 0.08, 0},      {25e3f, 0.9f, 6000.0, -30.0, 3.0, 0.08, 0},
                 {1e5f, 0.9f, 60.0, 30.0, 2.0, 0.08, 0}};
    const velum_layer sheet = {.struct_size = sizeof sheet,
                               .genus = VELUM_GENUS_ST,
                               .coverage = 1.0f,
                               .base_m = 500.0f,
                               .top_m = 700.0f,
                               .water_g_m3 = 0.1f,
                               .radius_um = 9.0f};
    fixture f;
    fixture_borrow(&f);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        velum_cell cell = fixture_cell(&sheet, cases[i].layers);
        cell.flags |= VELUM_CELL_HAS_VISIBILITY;
        cell.visibility_m = cases[i].visibility_m;
        cell.fog_top_m = 150.0f;
        fixture_commit_cell(&f, &cell);
        scene s = {.height_m = cases[i].height_m,
                   .pitch_deg = cases[i].pitch_deg,
                   .sun_deg = cases[i].sun_deg,
                   .albedo = cases[i].albedo,
                   .quality = VELUM_QUALITY_REFERENCE,
                   .atmosphere = VELUM_ATMOSPHERE_EARTH,
                   .paths = cases[i].layers > 0 ? 2 * REFERENCE_PATHS : 0}; /* of hundreds of orders: noisier */
        const double expected = look(&f, &s).luminance;
        s.quality = VELUM_QUALITY_MEDIUM;
        const double found = look(&f, &s).luminance;
        print_message(
            "visibility %g m, %u layers, albedo %.2f, %g m high, pitch %g, sun %g degrees: %.3f of the reference\n",
            (double)cases[i].visibility_m, cases[i].layers, (double)s.albedo, s.height_m, s.pitch_deg, s.sun_deg,
            found / expected);
        assert_float_equal(found, expected, cases[i].bound * expected);
    }
    fixture_give_back(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_sea_below_the_ellipsoid_is_like_any),
                                       cmocka_unit_test(white_ground_under_deep_cloud_gains_nothing),
                                       cmocka_unit_test(a_closed_sheet_lets_light_through_as_a_slab_does),
                                       cmocka_unit_test(rims_before_far_cloud_have_no_grain),
                                       cmocka_unit_test(tongues_before_near_walls_have_no_sparks),
                                       cmocka_unit_test(shafts_half_in_the_sun_have_no_grain),
                                       cmocka_unit_test(veils_under_a_low_sun_have_no_sparks),
                                       cmocka_unit_test(walls_of_storms_show_their_lumps_in_the_shade),
                                       cmocka_unit_test(bases_of_cumulus_have_no_blotches),
                                       cmocka_unit_test(cloud_is_met_from_any_height),
                                       cmocka_unit_test(cloud_shades_the_air_under_a_low_sun),
                                       cmocka_unit_test(cumulus_shine_under_a_low_sun),
                                       cmocka_unit_test(air_is_as_bright_as_its_reference)};
    return cmocka_run_group_tests(tests, NULL, fixture_shared_finish);
}
