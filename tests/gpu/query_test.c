/* CPU queries agree with the picture: transmittance, distance, first contact. */
#include <math.h>
#include <stdlib.h>

#include "fixture.h"

enum { WIDTH = 32, HEIGHT = 20, PIXELS = WIDTH * HEIGHT, SETTLE = 256 };

static velum_layer layer_of(int32_t genus, float coverage, float base_m, float top_m, float water_g_m3,
                            float radius_um) {
    return (velum_layer){.struct_size = sizeof(velum_layer),
                         .genus = genus,
                         .water = genus <= VELUM_GENUS_CS ? VELUM_WATER_ICE : VELUM_WATER_LIQUID,
                         .coverage = coverage,
                         .base_m = base_m,
                         .top_m = top_m,
                         .water_g_m3 = water_g_m3,
                         .radius_um = radius_um};
}

typedef struct picture {
    float transmittance[PIXELS * 3], distance[PIXELS];
    double eye[3];
    velum_view_frame camera;
} picture;

/* Looks towards the north at a pitch; quality ultra, settled. Rays end at depth_m, which may be null. */
static void look(fixture *f, double height_m, double pitch_deg, float tan_half, const float *depth_m, picture *out) {
    velum_eye *eye = NULL;
    const velum_eye_desc desc = {.struct_size = sizeof desc, .quality = VELUM_QUALITY_ULTRA};
    assert_int_equal(f->engine_api->create_eye(f->engine, &desc, &eye), VELUM_OK);
    velum_view *view = fixture_view(f, eye, WIDTH, HEIGHT);
    double east[3], north[3], up[3], forward[3];
    fixture_axes(50.0, 8.5, east, north, up);
    double pitch = pitch_deg * acos(-1.0) / 180.0;
    for (int i = 0; i < 3; i++) {
        forward[i] = cos(pitch) * north[i] + sin(pitch) * up[i];
    }
    fixture_position(50.0, 8.5, height_m, out->eye);
    out->camera = fixture_camera(out->eye, forward, east, tan_half, tan_half * HEIGHT / WIDTH);
    out->camera.depth_convention = VELUM_DEPTH_DISTANCE;
    const velum_frame_info frame = fixture_frame(up, 0.0, VELUM_ATMOSPHERE_NONE);
    velum_eye_frame at = {.struct_size = sizeof at, .flags = VELUM_EYE_RESET, .eye = eye};
    for (int i = 0; i < 3; i++) {
        at.position_ecef_m[i] = out->eye[i];
    }
    const velum_pixels pixels = {.struct_size = sizeof pixels,
                                 .view = view,
                                 .frame = &out->camera,
                                 .transmittance_rgb = out->transmittance,
                                 .distance_m = out->distance,
                                 .depth = depth_m,
                                 .width = WIDTH,
                                 .height = HEIGHT};
    for (int i = 0; i < SETTLE; i++) {
        assert_int_equal(f->standalone_api->render(f->engine, &frame, &at, 1, 0, &pixels, 1, 0), VELUM_OK);
        at.flags = 0;
    }
    assert_int_equal(f->engine_api->destroy_view(view), VELUM_OK);
    assert_int_equal(f->engine_api->destroy_eye(eye), VELUM_OK);
}

static void pixel_direction(const picture *p, int x, int y, double out[3]) {
    const velum_view_frame *c = &p->camera;
    double u = (double)c->tan_left + (x + 0.5) / WIDTH * ((double)c->tan_right - (double)c->tan_left);
    double v = (double)c->tan_top + (y + 0.5) / HEIGHT * ((double)c->tan_bottom - (double)c->tan_top);
    double length = sqrt(1.0 + u * u + v * v);
    for (int i = 0; i < 3; i++) {
        out[i] = (c->forward_ecef[i] + c->right_ecef[i] * u + c->up_ecef[i] * v) / length;
    }
}

static velum_line_answer along(const fixture *f, const picture *p, const double unit[3], double begin_m, double end_m) {
    velum_line_query query = {.struct_size = sizeof query};
    for (int i = 0; i < 3; i++) {
        query.from_ecef_m[i] = p->eye[i] + unit[i] * begin_m;
        query.to_ecef_m[i] = p->eye[i] + unit[i] * end_m;
    }
    velum_line_answer answer = {.struct_size = sizeof answer};
    assert_int_equal(f->world_api->query_line(f->world, &query, &answer), VELUM_OK);
    return answer;
}

/* The picture's mean distance, from the query: pieces of the line weighted by the light that they take. */
static double mean_distance_m(const fixture *f, const picture *p, const double unit[3], double begin_m, double end_m) {
    const double piece_m = 10.0;
    double through = 1.0;
    double weighted = 0.0;
    for (double t = begin_m; t < end_m && through > 1e-3; t += piece_m) {
        double next = through * along(f, p, unit, t, fmin(t + piece_m, end_m)).transmittance;
        weighted += (through - next) * (t + 0.5 * piece_m);
        through = next;
    }
    return weighted / (1.0 - through);
}

static void uniform_layers(void **state) {
    (void)state;
    fixture f;
    fixture_borrow(&f);
    const velum_layer slab = fixture_slab(0.7f);
    fixture_commit(&f, &slab, 1);
    static picture p;
    look(&f, 300.0, 35.0, 0.3f, NULL, &p);
    double worst = 0.0;
    double worst_m = 0.0;
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++) {
            double unit[3];
            pixel_direction(&p, x, y, unit);
            const velum_line_answer a = along(&f, &p, unit, 0.0, 20000.0);
            const int i = y * WIDTH + x;
            worst = fmax(worst, fabs(a.transmittance - (double)p.transmittance[3 * i]));
            assert_true(a.has_contact);
            assert_true(a.optical_depth > 0.7);
            /* Mean depth within a slab of optical depth tau over length l (Beer-Lambert): l (1/tau - 1/(e^tau - 1)). */
            double length_m = a.optical_depth / 0.0007;
            double mean_m = a.first_contact_m + length_m * (1.0 / a.optical_depth - 1.0 / expm1(a.optical_depth));
            worst_m = fmax(worst_m, fabs(mean_m - (double)p.distance[i]));
        }
    }
    assert_true(worst <= 1e-3);
    /* History keeps distance in 16 bits: steps of 1.6 m at 2 km, in which its running mean can come to rest. */
    assert_true(worst_m <= 15.0);
    print_message("uniform layer: transmittance within %.5f, distance within %.2f m\n", worst, worst_m);
    fixture_give_back(&f);
}

/* Rays that end at the query's first contact, less a metre, meet nothing; those that go a little further lose what the
 * query says. A dense layer has no fringe: there the picture's distance is that of the contact. */
static void first_contact(void **state) {
    (void)state;
    fixture f;
    fixture_borrow(&f);
    velum_layer layers[2] = {layer_of(VELUM_GENUS_CU, 0.5f, 1000.0f, 2000.0f, 0.3f, 10.0f), fixture_slab(2000.0f)};
    static picture whole, before, beyond;
    static float contact_m[PIXELS], end_m[PIXELS], depth[PIXELS];
    for (int k = 0; k < 2; k++) {
        const bool is_dense = k == 1;
        const double further_m = is_dense ? 1.0 : 60.0;
        fixture_commit(&f, &layers[k], 1);
        look(&f, 300.0, 50.0, 0.5f, NULL, &whole);
        for (int i = 0; i < PIXELS; i++) {
            double unit[3];
            pixel_direction(&whole, i % WIDTH, i / WIDTH, unit);
            const velum_line_answer a = along(&f, &whole, unit, 0.0, 12000.0);
            contact_m[i] = a.has_contact ? (float)a.first_contact_m : 0.0f;
            depth[i] = (float)a.optical_depth;
            end_m[i] = a.has_contact ? contact_m[i] - 1.0f : 1.0f;
        }
        look(&f, 300.0, 50.0, 0.5f, end_m, &before);
        for (int i = 0; i < PIXELS; i++) {
            end_m[i] = contact_m[i] > 0.0f ? contact_m[i] + (float)further_m : 1.0f;
        }
        look(&f, 300.0, 50.0, 0.5f, end_m, &beyond);
        int contacts = 0;
        int owed = 0;
        int met = 0;
        int passed_over = 0;
        double worst = 0.0;
        double worst_beyond = 0.0;
        double worst_m = 0.0;
        double least_m = 1e9;
        for (int i = 0; i < PIXELS; i++) {
            if (contact_m[i] <= 0.0f) {
                assert_true(whole.transmittance[3 * i] > 0.99f);
                continue;
            }
            double unit[3];
            pixel_direction(&whole, i % WIDTH, i / WIDTH, unit);
            const velum_line_answer a = along(&f, &whole, unit, 0.0, (double)end_m[i]);
            contacts++;
            if (a.transmittance < 0.98) {
                owed++;
                met += beyond.transmittance[3 * i] < 0.99f;
            }
            worst = fmax(worst, 1.0 - (double)before.transmittance[3 * i]);
            worst_beyond = fmax(worst_beyond, fabs(a.transmittance - (double)beyond.transmittance[3 * i]));
            /* Steps may pass over a sliver: then the picture shows no cloud, and no distance. */
            if (whole.distance[i] == 0.0f) {
                passed_over++;
                assert_true(depth[i] < 0.1f);
                continue;
            }
            /* History weighs distance by opacity, of which it keeps 11 bits. */
            if (depth[i] < 4.0f / 2048.0f) {
                continue;
            }
            worst_m = fmax(worst_m, fabs((double)(whole.distance[i] - contact_m[i])));
            least_m = fmin(least_m, (double)(whole.distance[i] - contact_m[i]));
        }
        print_message("%s: %d contacts: 1 m before %.5f is lost; %g m beyond: %d of %d lose 1 %%, transmittance within "
                      "%.5f; distance less contact from %.2f m, at most %.2f m\n",
                      is_dense ? "dense layer" : "Cu", contacts, worst, further_m, met, owed, worst_beyond, least_m,
                      worst_m);
        assert_true(contacts > PIXELS / 10);
        assert_true(worst <= 0.002);
        assert_true(owed > contacts / 2);
        assert_true(met >= owed * 99 / 100);
        assert_true(passed_over <= (is_dense ? 0 : contacts / 100));
        /* Steps of 35 m sample a cloud's rim; history keeps distance in 16 bits. */
        assert_true(worst_beyond <= (is_dense ? 1e-3 : 0.06));
        assert_true(least_m >= -3.0);
        assert_true(!is_dense || worst_m <= 15.0);
    }
    fixture_give_back(&f);
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a;
    double y = *(const double *)b;
    return (x > y) - (x < y);
}

typedef struct figures {
    int count;
    double bias, median, p95, worst, p95_m; /* optical depth: bias is signed, relative to the mean depth */
} figures;

static figures compare(const velum_layer *layer, double height_m, double pitch_deg, float tan_half, double end_m,
                       const char *what) {
    fixture f;
    fixture_borrow(&f);
    fixture_commit(&f, layer, 1);
    static picture p;
    look(&f, height_m, pitch_deg, tan_half, NULL, &p);
    static double off[PIXELS], off_m[PIXELS];
    figures out = {0};
    double sum = 0.0;
    double depths = 0.0;
    int looked = 0;
    int contacts = 0;
    int disagree = 0;
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = (y & 1); x < WIDTH; x += 2) {
            double unit[3];
            pixel_direction(&p, x, y, unit);
            const int i = y * WIDTH + x;
            const double t = (double)p.transmittance[3 * i];
            const velum_line_answer a = along(&f, &p, unit, 0.0, end_m);
            looked++;
            contacts += a.has_contact != 0;
            disagree += (a.transmittance < 0.98) != (t < 0.99) && fabs(a.transmittance - t) > 0.05;
            if (t > 0.05 && t < 0.95) {
                double d = -log(t) - a.optical_depth;
                sum += d;
                depths += a.optical_depth;
                off[out.count] = fabs(d);
                off_m[out.count] =
                    a.has_contact ? fabs((double)p.distance[i] - mean_distance_m(&f, &p, unit, 0.0, end_m)) : 1e9;
                out.count++;
            }
        }
    }
    assert_true(out.count > 10);
    qsort(off, (size_t)out.count, sizeof *off, ascending);
    qsort(off_m, (size_t)out.count, sizeof *off_m, ascending);
    out.bias = sum / depths;
    out.median = off[out.count / 2];
    out.p95 = off[out.count * 95 / 100];
    out.worst = off[out.count - 1];
    out.p95_m = off_m[out.count * 95 / 100];
    assert_int_equal(disagree, 0);
    print_message("%s: %d of %d rays (contact %d, disagree %d), mean depth %.3f: bias %+.4f, |difference| median %.4f, "
                  "95 %% %.4f, worst %.4f; distance median %.1f, 95 %% %.1f, worst %.1f m\n",
                  what, out.count, looked, contacts, disagree, depths / out.count, out.bias, out.median, out.p95,
                  out.worst, off_m[out.count / 2], off_m[out.count * 95 / 100], off_m[out.count - 1]);
    fixture_give_back(&f);
    return out;
}

static void thin_cloud(void **state) {
    (void)state;
    const velum_layer ci = layer_of(VELUM_GENUS_CI, 0.6f, 8000.0f, 9000.0f, 0.02f, 40.0f);
    const velum_layer as = layer_of(VELUM_GENUS_AS, 0.8f, 3000.0f, 4000.0f, 0.02f, 12.0f);
    const velum_layer cu = layer_of(VELUM_GENUS_CU, 0.4f, 1000.0f, 2000.0f, 0.1f, 12.0f);
    const figures found[] = {compare(&ci, 4000.0, 60.0, 0.6f, 12000.0, "Ci"),
                             compare(&as, 300.0, 60.0, 0.6f, 12000.0, "As"),
                             compare(&cu, 300.0, 60.0, 0.6f, 8000.0, "Cu")};
    for (int i = 0; i < 3; i++) {
        /* Of a cumulus only the rim is thin, and a step of 35 m is long there. */
        const bool is_rim = i == 2;
        assert_true(fabs(found[i].bias) <= 0.01);
        assert_true(found[i].p95 <= (is_rim ? 0.03 : 0.005));
        assert_true(found[i].worst <= (is_rim ? 0.05 : 0.01));
        assert_true(found[i].p95_m <= 5.0);
    }
}

/* Every ray of a level view, to 2.5 km. */
static void compare_whole(fixture *f, double height_m, float tan_half, double most_bias, double most_p95,
                          const char *what) {
    static picture p;
    static float end_m[PIXELS];
    static double off[PIXELS];
    const double length_m = 2500.0;
    for (int i = 0; i < PIXELS; i++) {
        end_m[i] = (float)length_m;
    }
    look(f, height_m, 0.0, tan_half, end_m, &p);
    double sum = 0.0;
    double least = 1.0;
    for (int i = 0; i < PIXELS; i++) {
        double unit[3];
        pixel_direction(&p, i % WIDTH, i / WIDTH, unit);
        const velum_line_answer a = along(f, &p, unit, 0.0, length_m);
        off[i] = fabs(a.transmittance - (double)p.transmittance[3 * i]);
        sum += a.transmittance - (double)p.transmittance[3 * i];
        least = fmin(least, a.transmittance);
    }
    qsort(off, PIXELS, sizeof *off, ascending);
    print_message("%s: transmittance from %.3f, bias %+.5f, |difference| median %.5f, 95 %% %.5f, worst %.5f\n", what,
                  least, sum / PIXELS, off[PIXELS / 2], off[PIXELS * 95 / 100], off[PIXELS - 1]);
    assert_true(least < 0.5);
    assert_true(fabs(sum / PIXELS) <= most_bias);
    assert_true(off[PIXELS * 95 / 100] <= most_p95);
}

static velum_layer rain_layer(float base_m, float top_m, float rate_mm_h) {
    velum_layer layer = layer_of(VELUM_GENUS_NS, 0.9f, base_m, top_m, 0.3f, 10.0f);
    layer.wind_east_m_s = 10.0f;
    layer.precipitation_mm_h = rate_mm_h;
    layer.precipitation = rate_mm_h > 0.0f ? VELUM_PRECIPITATION_RAIN : VELUM_PRECIPITATION_NONE;
    return layer;
}

/* From under the base through rain, scud and a transition band; and from over all tops through a band. */
static void fringes(void **state) {
    (void)state;
    static const char *const names[] = {"rain", "scud", "band under the base", "band over the tops"};
    static const double heights_m[] = {500.0, 1330.0, 1180.0, 4250.0};
    for (int kind = 0; kind < 4; kind++) {
        const bool rain = kind == 0;
        const bool scud = kind == 1;
        fixture f;
        fixture_borrow(&f);
        velum_layer layer = rain_layer(1500.0f, 4000.0f, rain ? 12.0f : 0.0f);
        layer.scud = scud ? 0.5f : 0.0f;
        layer.transition_m = rain || scud ? 0.0f : kind == 2 ? 400.0f : 900.0f;
        fixture_commit(&f, &layer, 1);
        /* Steps of 35 m pass over slivers of scud. */
        compare_whole(&f, heights_m[kind], rain ? 0.12f : 0.02f, scud ? 0.015 : 0.001, scud ? 0.04 : 0.001,
                      names[kind]);
        fixture_give_back(&f);
    }
}

static void stand_half_way(fixture *f, const uint64_t states[2]) {
    const velum_timeline_key keys[2] = {
        {.struct_size = sizeof keys[0], .time_s = -100.0, .state = states[0]},
        {.struct_size = sizeof keys[0], .time_s = 50.0, .transition_s = 100.0, .state = states[1]}};
    assert_int_equal(f->world_api->set_timeline(f->world, keys, 2, 0), VELUM_OK);
}

/* Half way from a dry state to one of low cloud with rain, the rain hangs from a base between theirs: far over that of
 * either's rain, in weather that is the same everywhere and where a region makes it differ. */
static void coming_rain(void **state) {
    (void)state;
    const velum_layer dry = rain_layer(2600.0f, 5000.0f, 0.0f);
    const velum_layer wet = rain_layer(800.0f, 3000.0f, 24.0f);
    const velum_layer far_layer = layer_of(VELUM_GENUS_CS, 1.0f, 9000.0f, 9500.0f, 0.01f, 40.0f);
    for (uint32_t count = 1; count <= 2; count++) {
        fixture f;
        fixture_borrow(&f);
        uint64_t states[2];
        for (int i = 0; i < 2; i++) {
            velum_cell cells[2] = {fixture_cell(i == 0 ? &dry : &wet, 1), fixture_cell(&far_layer, 1)};
            cells[1].flags |= VELUM_CELL_MERGE_LAYERS;
            cells[1].id = 2;
            cells[1].kind = VELUM_CELL_RECTANGLE;
            cells[1].lat_deg = 50.5;
            cells[1].lon_deg = 8.5;
            cells[1].half_east_m = cells[1].half_north_m = 20000.0;
            const velum_state_desc desc = {.struct_size = sizeof desc, .cells = cells, .cell_count = count};
            assert_int_equal(f.world_api->commit(f.world, &desc, &states[i]), VELUM_OK);
        }
        stand_half_way(&f, states);
        compare_whole(&f, 1400.0, 0.05f, 0.001, 0.001, count == 1 ? "coming rain" : "coming rain, a region beyond");
        fixture_give_back(&f);
    }
}

/* Half way from a west wind to an east wind anvils stand over their towers, as in calm air, everywhere alike. */
static void winds_that_turn(void **state) {
    (void)state;
    fixture f;
    fixture_borrow(&f);
    uint64_t states[2];
    for (int i = 0; i < 2; i++) {
        velum_layer layer = layer_of(VELUM_GENUS_CB, 0.95f, 900.0f, 11500.0f, 0.02f, 30.0f);
        layer.wind_east_m_s = i == 0 ? 20.0f : -20.0f;
        const velum_cell cell = fixture_cell(&layer, 1);
        const velum_state_desc desc = {.struct_size = sizeof desc, .cells = &cell, .cell_count = 1};
        assert_int_equal(f.world_api->commit(f.world, &desc, &states[i]), VELUM_OK);
    }
    stand_half_way(&f, states);
    compare_whole(&f, 9000.0, 0.8f, 0.002, 0.005, "winds that turn");
    fixture_give_back(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(uniform_layers), cmocka_unit_test(first_contact),
                                       cmocka_unit_test(thin_cloud),     cmocka_unit_test(fringes),
                                       cmocka_unit_test(coming_rain),    cmocka_unit_test(winds_that_turn)};
    return cmocka_run_group_tests(tests, NULL, fixture_shared_finish);
}
