/* Skies of many layers that lie higher here and lower there: what a picture lets through, ray by ray, against the CPU's
 * query. Rays that are neighbours, and so lanes of one subgroup, meet other layers in other steps. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/oracle.h"
#include "fixture.h"

enum { WIDTH = 32, HEIGHT = 16, PIXELS = WIDTH * HEIGHT, SETTLE = 6 };
enum { ACROSS = 5, CELLS = ACROSS * ACROSS, KINDS = 4, LAYERS = 4 };

static const double lat_deg = 50.0, lon_deg = 8.5;

/* No layer, and nothing that hangs from one, has more. */
static const double most_1_m = 3e-4;
/* Steps that look for cloud, and those in it (velum_plan.step_m). */
static const double long_m = 60.0, short_m = 0.18 * 60.0;
/* History keeps 16 bits: its last place from a half on. */
static const double rounding = 1.0 / 2048.0;

static velum_layer thin(int32_t genus, float base_m, float top_m) {
    return (velum_layer){.struct_size = sizeof(velum_layer),
                         .flags = VELUM_LAYER_EXTINCTION,
                         .genus = genus,
                         .water = genus <= VELUM_GENUS_CS ? VELUM_WATER_ICE : VELUM_WATER_LIQUID,
                         .coverage = 0.9f,
                         .base_m = base_m,
                         .top_m = top_m,
                         .extinction_1_m = (float)most_1_m,
                         .wind_east_m_s = 8.0f};
}

/* Every kind of cell has its layers at heights of its own, and other fringes. Returns how many layers. */
static uint32_t layers_of(int kind, bool fringed, velum_layer out[LAYERS]) {
    static const uint32_t counts[KINDS] = {3, 4, 2, 3};
    const float up_m = 150.0f * (float)(2 * kind % 5);
    out[0] = kind == 3 ? thin(VELUM_GENUS_CB, 1000.0f + up_m, 2600.0f + up_m)
                       : thin(VELUM_GENUS_ST, 700.0f + up_m, 1100.0f + up_m);
    out[1] = thin(kind % 2 ? VELUM_GENUS_AS : VELUM_GENUS_NS, 1600.0f + 1.5f * up_m, 2200.0f + 1.5f * up_m);
    out[2] = thin(kind % 2 ? VELUM_GENUS_CS : VELUM_GENUS_CI, 2600.0f + up_m, 3000.0f + 1.5f * up_m);
    out[3] = thin(VELUM_GENUS_CU, 900.0f + up_m, 1500.0f + up_m);
    out[0].scud = fringed && kind % 2 ? 0.4f : 0.0f;
    out[1].precipitation_mm_h = fringed && kind % 2 ? 0.3f : 0.0f;
    out[2].transition_m = !fringed || kind % 2 ? 0.0f : 300.0f;
    return counts[kind];
}

static velum_cell square(uint64_t id, double north_deg, double east_deg, const velum_layer *layers, uint32_t count) {
    velum_cell cell = fixture_cell(layers, count);
    cell.id = id;
    cell.kind = VELUM_CELL_RECTANGLE;
    cell.lat_deg = lat_deg + north_deg;
    cell.lon_deg = lon_deg + east_deg;
    cell.half_east_m = cell.half_north_m = 2500.0;
    cell.transition_m = 5000.0;
    return cell;
}

static void commit(fixture *f, const velum_cell *cells, uint32_t count) {
    const velum_state_desc desc = {.struct_size = sizeof desc, .cells = cells, .cell_count = count};
    uint64_t id = 0;
    assert_int_equal(f->world_api->commit(f->world, &desc, &id), VELUM_OK);
}

/* Squares side by side, each going over into the next, from the eye's place on to the north. */
static void commit_mosaic(fixture *f, bool fringed) {
    velum_layer layers[KINDS][LAYERS];
    velum_cell cells[1 + CELLS];
    uint32_t counts[KINDS];
    for (int kind = 0; kind < KINDS; kind++) {
        counts[kind] = layers_of(kind, fringed, layers[kind]);
    }
    cells[0] = fixture_cell(layers[0], counts[0]);
    for (int i = 0; i < CELLS; i++) {
        const int kind = (i + i / ACROSS) % KINDS;
        cells[1 + i] =
            square(2 + (uint64_t)i, 0.06 * (i / ACROSS), 0.09 * (i % ACROSS - ACROSS / 2), layers[kind], counts[kind]);
    }
    commit(f, cells, 1 + CELLS);
}

typedef struct picture {
    float transmittance[PIXELS * 3];
    double eye[3];
    velum_view_frame camera;
    bool uneven;
} picture;

/* Towards the north from that height; rays of end_m. */
static void look(fixture *f, double height_m, double pitch_deg, double end_m, picture *out) {
    velum_eye_frame at = {.struct_size = sizeof at, .flags = VELUM_EYE_RESET};
    const velum_eye_desc desc = {.struct_size = sizeof desc, .quality = VELUM_QUALITY_ULTRA};
    assert_int_equal(f->engine_api->create_eye(f->engine, &desc, &at.eye), VELUM_OK);
    /* Through thin layers a ray has many steps, and none may run out of them. */
    const velum_plan plan = {.struct_size = sizeof plan,
                             .active_layers = 0xff,
                             .march_steps = 4096,
                             .light_steps = 1,
                             .ray_rate = 1,
                             .octaves = 1,
                             .step_m = (float)long_m,
                             .distance_m = (float)end_m};
    assert_int_equal(f->engine_api->set_plan(at.eye, &plan), VELUM_OK);
    velum_view *view = fixture_view(f, at.eye, WIDTH, HEIGHT);
    double east[3], north[3], up[3], forward[3];
    fixture_axes(lat_deg, lon_deg, east, north, up);
    const double pitch = pitch_deg * acos(-1.0) / 180.0;
    for (int i = 0; i < 3; i++) {
        forward[i] = cos(pitch) * north[i] + sin(pitch) * up[i];
    }
    fixture_position(lat_deg, lon_deg, height_m, out->eye);
    memcpy(at.position_ecef_m, out->eye, sizeof out->eye);
    out->camera = fixture_camera(out->eye, forward, east, 0.6f, 0.6f * HEIGHT / WIDTH);
    out->camera.depth_convention = VELUM_DEPTH_DISTANCE;
    float ends_m[PIXELS];
    for (int i = 0; i < PIXELS; i++) {
        ends_m[i] = (float)end_m;
    }
    const velum_frame_info frame = fixture_frame(up, 0.0, VELUM_ATMOSPHERE_NONE);
    const velum_pixels pixels = {.struct_size = sizeof pixels,
                                 .view = view,
                                 .frame = &out->camera,
                                 .transmittance_rgb = out->transmittance,
                                 .depth = ends_m,
                                 .width = WIDTH,
                                 .height = HEIGHT};
    for (int i = 0; i < SETTLE; i++) {
        assert_int_equal(f->standalone_api->render(f->engine, &frame, &at, 1, 0, &pixels, 1, 0), VELUM_OK);
        at.flags = 0;
    }
    out->uneven = fixture_weather_is_uneven(at.eye);
    assert_int_equal(f->engine_api->destroy_view(view), VELUM_OK);
    assert_int_equal(f->engine_api->destroy_eye(at.eye), VELUM_OK);
}

/* What the query lets through along a pixel's ray: with the tiles and the detail of the distance, as pictures have
 * them. */
static double queried(const fixture *f, const picture *p, int pixel, double end_m) {
    const velum_view_frame *c = &p->camera;
    const double u = (double)c->tan_right * (2.0 * (pixel % WIDTH + 0.5) / WIDTH - 1.0);
    const double v = (double)c->tan_top * (1.0 - 2.0 * (pixel / WIDTH + 0.5) / HEIGHT);
    const double length = sqrt(1.0 + u * u + v * v);
    const double piece_m = 500.0;
    double depth = 0.0;
    for (double t = 0.0; t < end_m; t += piece_m) {
        velum_line_query q = {.struct_size = sizeof q, .footprint_m = CORE_ORACLE_PIXEL_RAD * (t + 0.5 * piece_m)};
        for (int i = 0; i < 3; i++) {
            const double unit = (c->forward_ecef[i] + c->right_ecef[i] * u + c->up_ecef[i] * v) / length;
            q.from_ecef_m[i] = p->eye[i] + unit * t;
            q.to_ecef_m[i] = p->eye[i] + unit * fmin(t + piece_m, end_m);
        }
        velum_line_answer a = {.struct_size = sizeof a};
        assert_int_equal(f->world_api->query_line(f->world, &q, &a), VELUM_OK);
        depth += a.optical_depth;
    }
    return exp(-depth);
}

static int ascending(const void *a, const void *b) {
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Steps tell where a cloud begins and where it ends: to a short one each, and slivers, which long ones pass over, to a
 * long one. What they are off by differs from frame to frame: means are nearer. */
static void expect_alike(const picture *p, const double through[PIXELS], const char *what, const char *where) {
    double off[PIXELS];
    double least = 1.0;
    double sum = 0.0;
    for (int i = 0; i < PIXELS; i++) {
        const double d = (double)p->transmittance[3 * i] - through[i];
        off[i] = fabs(d);
        sum += d;
        least = fmin(least, through[i]);
    }
    qsort(off, PIXELS, sizeof *off, ascending);
    print_message("%s %s: through from %.3f; off by %+.5f in the mean, median %.5f, 95 %% %.5f, worst %.5f\n", what,
                  where, least, sum / PIXELS, off[PIXELS / 2], off[PIXELS * 95 / 100], off[PIXELS - 1]);
    assert_true(least < 0.7);
    assert_true(off[PIXELS * 95 / 100] <= 2.0 * short_m * most_1_m + rounding);
    assert_true(off[PIXELS - 1] <= 2.0 * long_m * most_1_m + rounding);
}

static void as_queried(void **state) {
    (void)state;
    static const struct {
        const char *name;
        double height_m, pitch_deg, end_m;
    } views[] = {{"from below", 300.0, 30.0, 3400.0},
                 {"level, low", 1300.0, 0.0, 1500.0},
                 {"level, high", 2500.0, 0.0, 1500.0},
                 {"from above", 4500.0, -35.0, 4000.0}};
    static picture p;
    double through[PIXELS];
    for (int fringed = 0; fringed < 2; fringed++) {
        fixture f;
        fixture_borrow(&f);
        commit_mosaic(&f, fringed);
        for (int k = 0; k < 4; k++) {
            look(&f, views[k].height_m, views[k].pitch_deg, views[k].end_m, &p);
            assert_true(p.uneven);
            for (int i = 0; i < PIXELS; i++) {
                through[i] = queried(&f, &p, i, views[k].end_m);
            }
            expect_alike(&p, through, fringed ? "clouds and fringes" : "clouds", views[k].name);
        }
        fixture_give_back(&f);
    }
}

/* The march for weather that differs from place to place, where it does so beyond the rays' ends alone, does as that
 * for weather that does not. */
static void as_where_all_is_even(void **state) {
    (void)state;
    static picture even, uneven;
    double through[PIXELS];
    for (int fringed = 0; fringed < 2; fringed++) {
        velum_layer here[LAYERS], beyond[LAYERS];
        fixture f;
        fixture_borrow(&f);
        const uint32_t count = layers_of(1, fringed, here);
        const uint32_t count_beyond = layers_of(2, fringed, beyond);
        const velum_cell cells[2] = {fixture_cell(here, count), square(2, 0.3, 0.0, beyond, count_beyond)};
        commit(&f, cells, 1);
        look(&f, 1300.0, 5.0, 3000.0, &even);
        commit(&f, cells, 2);
        look(&f, 1300.0, 5.0, 3000.0, &uneven);
        assert_true(!even.uneven && uneven.uneven);
        for (int i = 0; i < PIXELS; i++) {
            through[i] = (double)even.transmittance[3 * i];
        }
        expect_alike(&uneven, through, fringed ? "clouds and fringes" : "clouds", "before others");
        fixture_give_back(&f);
    }
}

/* A step that ends exactly where a layer begins does not meet it: the next one does. It is chance which rays have such
 * a step. */
static void no_ray_leaps_a_closed_sheet(void **state) {
    (void)state;
    enum { PICTURES = 128 };
    static picture p;
    fixture f;
    fixture_borrow(&f);
    int leapt = 0;
    for (int k = 0; k < PICTURES; k++) {
        velum_layer sheet = thin(VELUM_GENUS_ST, 1000.0f + 2.0f * (float)k, 1400.0f + 2.0f * (float)k);
        sheet.coverage = 1.0f;
        sheet.extinction_1_m = 0.05f;
        fixture_commit(&f, &sheet, 1);
        look(&f, 300.0, 25.0, 1e5, &p);
        for (int i = 0; i < PIXELS; i++) {
            leapt += p.transmittance[3 * i] > 0.01f;
        }
    }
    print_message("%d of %d rays are not held\n", leapt, PICTURES * PIXELS);
    assert_int_equal(leapt, 0);
    fixture_give_back(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(as_queried), cmocka_unit_test(as_where_all_is_even),
                                       cmocka_unit_test(no_ray_leaps_a_closed_sheet)};
    return cmocka_run_group_tests(tests, NULL, fixture_shared_finish);
}
