#include "tile_set.h"

#include "geodesy.h"
#include "tile_detail.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MAX_STATES 2u
#define HEIGHT_SPARE_M 500.0
/* The eye may move by 5 % of its distance; half a per cent more for the arithmetic of shaders. */
#define MOVE_SHARE 0.055

typedef struct wanted {
    uint32_t key, data_key;
    double nearest_m;
} wanted;

typedef struct list {
    uint32_t *items;
    uint32_t count, capacity;
} list;

typedef struct walk {
    double eye_m[3];
    double detail, distance_m;
    double low_m, high_m; /* HAE, of cloud */
    const core_state *states[MAX_STATES];
    uint32_t state_count;
    list cells[MAX_STATES]; /* a stack: a node's list begins where its parent's ends */
    wanted *found;
    uint32_t found_count, found_capacity;
} walk;

/* Distances at which velum_tile_level gives a level. */
static double level_from_m(const walk *w, uint32_t level) {
    return level >= VELUM_TILE_LEVEL_MAX ? 0.0 : 4.0 * w->detail * (double)VELUM_TILE_FACE_M / (double)(1u << level);
}
static double level_to_m(const walk *w, uint32_t level) {
    return level <= 1 ? INFINITY : 4.0 * w->detail * (double)VELUM_TILE_FACE_M / (double)(1u << (level - 1));
}

/* Least and greatest distance from the eye to the clouds over a cap: those of the column over its middle, widened by
 * the cap's size at the top. */
static void distances(const walk *w, const core_tile_cap *cap, double *least_m, double *most_m) {
    double low[3];
    double high[3];
    double along = 0.0;
    double square = 0.0;
    double low2 = 0.0;
    double high2 = 0.0;
    double nearest2 = 0.0;
    double widest2 = 0.0;
    core_position(cap->normal, w->low_m, low);
    core_position(cap->normal, w->high_m, high);
    for (int i = 0; i < 3; i++) {
        double d = high[i] - low[i];
        along += (w->eye_m[i] - low[i]) * d;
        square += d * d;
    }
    double t = square > 0.0 ? fmin(fmax(along / square, 0.0), 1.0) : 0.0;
    for (int i = 0; i < 3; i++) {
        double to_low = w->eye_m[i] - low[i];
        double to_high = w->eye_m[i] - high[i];
        double to_nearest = to_low - (high[i] - low[i]) * t;
        low2 += to_low * to_low;
        high2 += to_high * to_high;
        nearest2 += to_nearest * to_nearest;
    }
    for (uint32_t corner = 0; corner < 4; corner++) {
        double there[3];
        double d2 = 0.0;
        core_position(cap->corner[corner], w->high_m, there);
        for (int i = 0; i < 3; i++) {
            d2 += (there[i] - high[i]) * (there[i] - high[i]);
        }
        widest2 = fmax(widest2, d2);
    }
    double radius_m = sqrt(widest2) * 1.01;
    *least_m = fmax(sqrt(nearest2) - radius_m, 0.0) * (1.0 - MOVE_SHARE);
    *most_m = (sqrt(fmax(low2, high2)) + radius_m) * (1.0 + MOVE_SHARE);
}

static bool push(list *to, uint32_t item) {
    if (to->count == to->capacity) {
        uint32_t capacity = to->capacity ? to->capacity * 2 : 4096;
        uint32_t *more = realloc(to->items, capacity * sizeof *more);
        if (!more) {
            return false;
        }
        to->items = more;
        to->capacity = capacity;
    }
    to->items[to->count++] = item;
    return true;
}

static bool emit(walk *w, uint32_t key, uint32_t level, double nearest_m) {
    if (w->found_count == w->found_capacity) {
        uint32_t capacity = w->found_capacity ? w->found_capacity * 2 : 4096;
        wanted *more = realloc(w->found, capacity * sizeof *more);
        if (!more) {
            return false;
        }
        w->found = more;
        w->found_capacity = capacity;
    }
    w->found[w->found_count++] = (wanted){key, core_tile_ancestor(key, level), nearest_m};
    return true;
}

/* `first`: where the parent's cells begin in the stacks. False: out of memory. */
static bool visit(walk *w, uint32_t key, const uint32_t first[MAX_STATES]) {
    core_tile_cap cap = core_tile_cap_of(key);
    double least_m;
    double most_m;
    uint32_t begin[MAX_STATES] = {0};
    uint32_t detail = 0;
    bool ok = true;
    distances(w, &cap, &least_m, &most_m);
    if (least_m > w->distance_m || least_m >= level_to_m(w, cap.level)) {
        return true;
    }
    bool wants = cap.level >= 1 && most_m >= level_from_m(w, cap.level);
    bool deeper = cap.level < VELUM_TILE_LEVEL_MAX && least_m < level_to_m(w, cap.level + 1);
    for (uint32_t s = 0; s < w->state_count; s++) {
        uint32_t end = w->cells[s].count;
        begin[s] = end;
        for (uint32_t i = first[s]; i < end; i++) {
            uint32_t cell = w->cells[s].items[i];
            if (core_cell_matters(w->states[s]->cells[cell], &cap) && !push(&w->cells[s], cell)) {
                return false;
            }
        }
        if (wants) {
            const uint32_t count = w->cells[s].count - begin[s];
            const uint32_t *cells = count > 0 ? w->cells[s].items + begin[s] : NULL;
            uint32_t level = core_detail_level(w->states[s], cells, count, &cap);
            detail = detail > level ? detail : level;
        }
    }
    if (wants) {
        ok = emit(w, key, detail, least_m);
    }
    for (uint32_t child = 0; ok && deeper && child < 4; child++) {
        ok = visit(w,
                   velum_tile_key(cap.level + 1, velum_tile_key_face(key), velum_tile_key_x(key) * 2 + (child & 1u),
                                  velum_tile_key_y(key) * 2 + (child >> 1)),
                   begin);
    }
    for (uint32_t s = 0; s < w->state_count; s++) {
        w->cells[s].count = begin[s];
    }
    return ok;
}

static int by_key(const void *a, const void *b) {
    uint32_t x = ((const wanted *)a)->key;
    uint32_t y = ((const wanted *)b)->key;
    return (x > y) - (x < y);
}

static int by_nearest(const void *a, const void *b) {
    const wanted *x = a;
    const wanted *y = b;
    if (x->nearest_m != y->nearest_m) {
        return x->nearest_m < y->nearest_m ? -1 : 1;
    }
    return (x->key > y->key) - (x->key < y->key);
}

static int by_data(const void *a, const void *b) {
    const wanted *x = a;
    const wanted *y = b;
    if (x->data_key != y->data_key) {
        return x->data_key < y->data_key ? -1 : 1;
    }
    return by_nearest(a, b);
}

static velum_result check_eye(const core_tile_eye *eye, core_error *error) {
    for (int i = 0; i < 3; i++) {
        if (!(fabs(eye->position_ecef_m[i]) <= 1e9)) {
            return core_fail(error, VELUM_ERROR_ARGUMENT, "eye, position_ecef_m[%d]: found %g, expected -1e9..1e9", i,
                             eye->position_ecef_m[i]);
        }
    }
    if (!(eye->detail >= 1.0f / 16.0f && eye->detail <= 8.0f)) {
        return core_fail(error, VELUM_ERROR_ARGUMENT, "eye, detail: found %g, expected 1/16..8", (double)eye->detail);
    }
    if (!(eye->distance_m >= 0.0 && eye->distance_m <= 1e9)) {
        return core_fail(error, VELUM_ERROR_ARGUMENT, "eye, distance_m: found %g, expected 0..1e9", eye->distance_m);
    }
    return VELUM_OK;
}

/* To the tangent point and on to the highest cloud beyond it, on the sphere of radius a, which sees farthest. */
static double horizon_m(double eye_height_m, double cloud_height_m) {
    double eye = fmax(eye_height_m, 0.0);
    double cloud = fmax(cloud_height_m, 0.0);
    return sqrt(eye * (2.0 * CORE_WGS84_A_M + eye)) + sqrt(cloud * (2.0 * CORE_WGS84_A_M + cloud)) + 1000.0;
}

/* The stacks begin with all stations and regions. False: no cloud, or out of memory (then *result says so). */
static bool begin_walk(walk *w, const core_tile_eye *eye, const core_state *const *states, uint32_t state_count,
                       velum_result *result) {
    memcpy(w->eye_m, eye->position_ecef_m, sizeof w->eye_m);
    w->detail = (double)eye->detail;
    w->low_m = 1e9;
    w->high_m = -1e9;
    for (uint32_t s = 0; s < state_count && s < MAX_STATES; s++) {
        float base_m;
        float top_m;
        if (!states[s] || !core_state_height_range(states[s], &base_m, &top_m)) {
            continue;
        }
        uint32_t at = w->state_count++;
        w->states[at] = states[s];
        w->low_m = fmin(w->low_m, (double)base_m - HEIGHT_SPARE_M);
        w->high_m = fmax(w->high_m, (double)top_m + HEIGHT_SPARE_M);
        for (uint32_t c = states[s]->first_station; c < states[s]->cell_count; c++) {
            if (!push(&w->cells[at], c)) {
                *result = VELUM_ERROR_OUT_OF_MEMORY;
                return false;
            }
        }
    }
    w->distance_m = eye->distance_m;
    if (w->state_count > 0 && w->distance_m == 0.0) {
        w->distance_m = horizon_m(core_height_scaled(w->eye_m), w->high_m);
    }
    return w->state_count > 0;
}

static velum_result finish_set(core_tile_set *set, wanted *found, uint32_t count) {
    uint32_t data_count = 0;
    if (count == 0) {
        return VELUM_OK;
    }
    set->keys = malloc((count + 1u) * sizeof *set->keys);
    set->data = malloc((count + 1u) * sizeof *set->data);
    set->data_keys = malloc((count + 1u) * sizeof *set->data_keys);
    set->data_nearest_m = malloc((count + 1u) * sizeof *set->data_nearest_m);
    wanted *unique = malloc((count + 1u) * sizeof *unique);
    wanted *sorted = malloc((count + 1u) * sizeof *sorted);
    if (!set->keys || !set->data || !set->data_keys || !set->data_nearest_m || !unique || !sorted) {
        free(unique);
        free(sorted);
        return VELUM_ERROR_OUT_OF_MEMORY;
    }
    qsort(found, count, sizeof *found, by_data);
    for (uint32_t i = 0; i < count; i++) {
        if (i == 0 || found[i].data_key != found[i - 1].data_key) {
            unique[data_count++] = (wanted){found[i].data_key, found[i].data_key, found[i].nearest_m};
        }
    }
    qsort(unique, data_count, sizeof *unique, by_nearest);
    for (uint32_t i = 0; i < data_count; i++) {
        set->data_keys[i] = unique[i].key;
        set->data_nearest_m[i] = unique[i].nearest_m;
        unique[i].data_key = i;
    }
    memcpy(sorted, unique, data_count * sizeof *sorted);
    qsort(sorted, data_count, sizeof *sorted, by_key);
    qsort(found, count, sizeof *found, by_key);
    for (uint32_t i = 0; i < count; i++) {
        wanted probe = {found[i].data_key, 0, 0.0};
        const wanted *hit = bsearch(&probe, sorted, data_count, sizeof *sorted, by_key);
        set->keys[i] = found[i].key;
        set->data[i] = hit->data_key;
    }
    set->key_count = count;
    set->data_count = data_count;
    free(unique);
    free(sorted);
    return VELUM_OK;
}

velum_result core_tile_set_init(core_tile_set *set, const core_tile_eye *eye, const core_state *const *states,
                                uint32_t state_count, core_error *error) {
    core_tile_set made = {0};
    walk w = {0};
    static const uint32_t whole[MAX_STATES] = {0, 0};
    velum_result result = check_eye(eye, error);
    if (result != VELUM_OK) {
        return result;
    }
    if (begin_walk(&w, eye, states, state_count, &result)) {
        for (uint32_t face = 0; face < 6; face++) {
            if (!visit(&w, velum_tile_key(0, face, 0, 0), whole)) {
                result = VELUM_ERROR_OUT_OF_MEMORY;
            }
        }
    }
    if (result == VELUM_OK) {
        bool over = w.found_count > CORE_TILE_SET_MAX_KEYS;
        if (over) {
            qsort(w.found, w.found_count, sizeof *w.found, by_nearest);
            w.found_count = CORE_TILE_SET_MAX_KEYS;
        }
        made.distance_m = w.distance_m;
        result = finish_set(&made, w.found, w.found_count);
        if (result == VELUM_OK && over) {
            result = VELUM_DEGRADED;
        }
    }
    for (uint32_t s = 0; s < MAX_STATES; s++) {
        free(w.cells[s].items);
    }
    free(w.found);
    if (result < 0) {
        core_tile_set_finish(&made);
        return core_fail(error, result, "tile set: out of memory");
    }
    *set = made;
    return result;
}

void core_tile_set_finish(core_tile_set *set) {
    if (set) {
        free(set->keys);
        free(set->data);
        free(set->data_keys);
        free(set->data_nearest_m);
        *set = (core_tile_set){0};
    }
}

/* ---------------------------------------------------------------- the page table */

uint32_t core_tile_table_entries(uint32_t key_count) {
    uint32_t entries = 64;
    while (entries < key_count * 2u && entries < 1u << 30) {
        entries *= 2;
    }
    return entries;
}

/* Of both states in one word. */
static uint32_t pages_word(uint32_t state_count, core_tile_page_fn page, void *context, uint32_t data_key,
                           uint32_t slot) {
    uint32_t a = page(context, 0, data_key, slot) & VELUM_PAGE_NONE;
    uint32_t b = state_count > 1 ? page(context, 1, data_key, slot) & VELUM_PAGE_NONE : a;
    return a | b << 16;
}

#define NO_PAGES (VELUM_PAGE_NONE | VELUM_PAGE_NONE << 16)

static bool is_fringed(uint32_t state_count, core_tile_page_fn page, void *context, uint32_t data_key) {
    for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
        if (pages_word(state_count, page, context, data_key, VELUM_SLOT_COUNT + slot) != NO_PAGES) {
            return true;
        }
    }
    return false;
}

uint32_t core_tile_table_words(const core_tile_set *set, uint32_t state_count, core_tile_page_fn page, void *context,
                               uint32_t entries) {
    uint32_t words = entries * VELUM_TABLE_WORDS;
    for (uint32_t i = 0; i < set->key_count && i < entries - 1u; i++) {
        words += is_fringed(state_count, page, context, set->data_keys[set->data[i]]) ? VELUM_SLOT_COUNT : 0;
    }
    return words;
}

void core_tile_table_build(const core_tile_set *set, uint32_t state_count, core_tile_page_fn page, void *context,
                           uint32_t *words, uint32_t entries) {
    uint32_t mask = entries - 1u;
    uint32_t used = entries * VELUM_TABLE_WORDS;
    for (uint32_t i = 0; i < entries; i++) {
        uint32_t *entry = words + (size_t)i * VELUM_TABLE_WORDS;
        memset(entry, 0, VELUM_TABLE_PAGES * sizeof *entry);
        memset(entry + VELUM_TABLE_PAGES, 0xff, VELUM_SLOT_COUNT * sizeof *entry);
        entry[0] = VELUM_TILE_KEY_NONE;
    }
    for (uint32_t i = 0; i < set->key_count && i < mask; i++) {
        uint32_t at = velum_table_hash(set->keys[i], mask);
        uint32_t data_key = set->data_keys[set->data[i]];
        while (words[(size_t)at * VELUM_TABLE_WORDS] != VELUM_TILE_KEY_NONE) {
            at = (at + 1u) & mask;
        }
        uint32_t *entry = words + (size_t)at * VELUM_TABLE_WORDS;
        entry[0] = set->keys[i];
        entry[1] = velum_tile_key_level(data_key);
        for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
            uint32_t pages = pages_word(state_count, page, context, data_key, slot);
            entry[VELUM_TABLE_PAGES + slot] = pages;
            entry[2] |= pages != NO_PAGES ? 1u << slot : 0;
        }
        if (is_fringed(state_count, page, context, data_key)) {
            entry[3] = used;
            for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
                uint32_t pages = pages_word(state_count, page, context, data_key, VELUM_SLOT_COUNT + slot);
                words[used++] = pages;
                entry[2] |= pages != NO_PAGES ? 1u << (VELUM_SLOT_COUNT + slot) : 0;
            }
        }
    }
}

const uint32_t *core_tile_table_find(const uint32_t *words, uint32_t entries, uint32_t key) {
    uint32_t mask = entries - 1u;
    uint32_t at = velum_table_hash(key, mask);
    for (uint32_t probe = 0; probe < entries; probe++) {
        const uint32_t *entry = words + (size_t)at * VELUM_TABLE_WORDS;
        if (entry[0] == key) {
            return entry;
        }
        if (entry[0] == VELUM_TILE_KEY_NONE) {
            return NULL;
        }
        at = (at + 1u) & mask;
    }
    return NULL;
}
