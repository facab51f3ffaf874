#include "tiles.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Tile sets allow an eye to move by 5 % of the distance to any place; levels end at 19.5 km. */
#define SET_HOLDS_M 900.0

bool table_space_init(table_space *space, gpu *g) {
    memset(space->taken, 0, sizeof space->taken);
    return gpu_buffer_init(g, &space->buffer, (VkDeviceSize)TABLE_CHUNKS * TABLE_CHUNK_BYTES,
                           VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, GPU_MEMORY_DEVICE);
}

void table_space_finish(table_space *space, gpu *g) {
    gpu_buffer_finish(g, &space->buffer);
}

static void give_chunks(table_space *space, tiles *t) {
    memset(space->taken + t->first_chunk, 0, t->chunk_count);
    t->first_chunk = t->chunk_count = 0;
}

static bool take_chunks(table_space *space, tiles *t, uint32_t count) {
    give_chunks(space, t);
    uint32_t run = 0;
    for (uint32_t i = 0; i < TABLE_CHUNKS; i++) {
        run = space->taken[i] ? 0 : run + 1;
        if (run == count) {
            t->first_chunk = i + 1 - count;
            t->chunk_count = count;
            memset(space->taken + t->first_chunk, 1, count);
            return true;
        }
    }
    return false;
}

void tiles_finish(tiles *t, table_space *space) {
    give_chunks(space, t);
    core_tile_set_finish(&t->set);
    free(t->resolved);
    free(t->page);
    free(t->contents);
    free(t->words);
    *t = (tiles){0};
}

static uint64_t id_of(const core_state *state) {
    return state ? core_state_id(state) : 0;
}

static bool set_holds(const tiles *t, const tiles_context *c, const double position[3], double distance_m) {
    double moved2 = 0.0;
    for (int i = 0; i < 3; i++) {
        double d = position[i] - t->wanted.position_ecef_m[i];
        moved2 += d * d;
    }
    return t->has_set && t->states[0] == id_of(c->weather->state[0]) && t->states[1] == id_of(c->weather->state[1]) &&
           moved2 <= SET_HOLDS_M * SET_HOLDS_M && t->wanted.distance_m == distance_m;
}

static velum_result make_set(tiles *t, const tiles_context *c, const double position[3], double distance_m) {
    core_tile_eye wanted = {.detail = WORLD_TILE_DETAIL, .distance_m = distance_m};
    memcpy(wanted.position_ecef_m, position, sizeof wanted.position_ecef_m);
    const core_state *states[2] = {c->weather->state[0], c->weather->state[1]};
    core_tile_set set = {0};
    core_error error = {0};
    velum_result result = VELUM_OK;
    if (states[0] || states[1]) {
        result = core_tile_set_init(&set, &wanted, states, states[0] == states[1] ? 1 : 2, &error);
    }
    if (result < 0) {
        return log_fail(c->sink, result, "eye", "record_shared: %s", error.text);
    }
    size_t count = set.data_count ? set.data_count : 1;
    uint32_t *resolved = calloc(count, sizeof *resolved);
    uint32_t *page = calloc(count * 2 * TILE_PAGES, sizeof *page);
    uint64_t *contents = calloc(count * 2 * TILE_PAGES, sizeof *contents);
    if (!resolved || !page || !contents) {
        free(resolved);
        free(page);
        free(contents);
        core_tile_set_finish(&set);
        return log_fail(c->sink, VELUM_ERROR_OUT_OF_MEMORY, "eye", "record_shared: no memory for a set of tiles");
    }
    core_tile_set_finish(&t->set);
    free(t->resolved);
    free(t->page);
    free(t->contents);
    t->set = set;
    t->resolved = resolved;
    t->page = page;
    t->contents = contents;
    t->wanted = wanted;
    t->states[0] = id_of(states[0]);
    t->states[1] = id_of(states[1]);
    t->has_set = true;
    return result;
}

static void release(core_tile *tile[2]) {
    core_tile_unref(tile[0]);
    core_tile_unref(tile[1]);
    tile[0] = tile[1] = NULL;
}

/* The tiles of a key in both states; false: one of them is not there. */
static bool find_tiles(const tiles_context *c, uint32_t key, bool rasterise, core_tile *tile[2]) {
    bool same = c->weather->state[0] == c->weather->state[1];
    tile[0] = tile[1] = NULL;
    for (uint32_t s = 0; s < (same ? 1u : 2u); s++) {
        const core_state *state = c->weather->state[s];
        bool made = false;
        if (state) {
            tile[s] = world_tile(c->w, state, key, rasterise && *c->budget > 0, &made);
            if (!tile[s]) {
                release(tile);
                return false;
            }
        }
        *c->budget -= made ? 1 : 0;
    }
    if (same && tile[0]) {
        tile[1] = core_tile_ref(tile[0]);
    }
    return true;
}

static void note_fringe(tiles *t, uint32_t slot, const core_tile_slot *fields) {
    if (core_span_has_some(fields->hem_m)) {
        t->fringes |= 1u << (VELUM_PART_HEM + slot);
        core_span_widen(&t->hem_m[slot], fields->hem_m);
        t->most_scud_1_m[slot] = fmaxf(t->most_scud_1_m[slot], fields->max_scud_1_m);
        t->most_band_1_m[slot] = fmaxf(t->most_band_1_m[slot], fields->max_band_1_m);
    }
    if (core_span_has_some(fields->fall_m)) {
        t->fringes |= 1u << (VELUM_PART_FALL + slot);
        core_span_widen(&t->fall_m[slot], fields->fall_m);
        t->most_fall_1_m[slot] = fmaxf(t->most_fall_1_m[slot], fields->max_fall_1_m);
    }
}

/* Pages of data key i from two tiles. False: no room. */
static bool take_pages(tiles *t, const tiles_context *c, uint32_t i, core_tile *tile[2]) {
    bool all = true;
    for (uint32_t s = 0; s < 2; s++) {
        for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
            uint32_t at = (i * 2 + s) * TILE_PAGES + slot;
            uint32_t fringe = at + VELUM_SLOT_COUNT;
            t->page[at] = t->page[fringe] = VELUM_PAGE_NONE;
            t->contents[at] = t->contents[fringe] = 0;
            if (!tile[s] || !(tile[s]->mask & (1u << slot))) {
                continue;
            }
            const core_tile_slot *fields = &tile[s]->slot[slot];
            t->page[at] = pages_get(c->p, c->s, tile[s], slot, &t->contents[at]);
            all = all && t->page[at] != VELUM_PAGE_NONE;
            bool first = !(t->mask & (1u << slot));
            bool closes =
                slot >= VELUM_SLOT_UNIFORM || velum_overcast(fields->looks.most.value[CORE_LOOK_COVERAGE]) > 0.0f;
            t->mask |= 1u << slot;
            t->closing |= closes ? 1u << slot : 0;
            t->base_m[slot] = first ? fields->min_base_m : fminf(t->base_m[slot], fields->min_base_m);
            t->top_m[slot] = first ? fields->max_top_m : fmaxf(t->top_m[slot], fields->max_top_m);
            if (fields->fringe) {
                t->page[fringe] = pages_get(c->p, c->s, tile[s], VELUM_SLOT_COUNT + slot, &t->contents[fringe]);
                all = all && t->page[fringe] != VELUM_PAGE_NONE;
                note_fringe(t, slot, fields);
            }
        }
    }
    return all;
}

/* Coarser tiles for what is far when the pages run out: levels to go up. */
static uint32_t coarsening(const pages *p) {
    return pages_full(p, 0.97f) ? 4 : pages_full(p, 0.88f) ? 2 : pages_full(p, 0.75f) ? 1 : 0;
}

static uint32_t parent_of(uint32_t key) {
    uint32_t level = velum_tile_key_level(key);
    return velum_tile_key(level - 1, velum_tile_key_face(key), velum_tile_key_x(key) >> 1, velum_tile_key_y(key) >> 1);
}

/* How alike the tiles of an eye are. */
typedef struct evenness {
    uint32_t everywhere; /* slots and VELUM_PART_* that all have */
    float high_base_m[VELUM_SLOT_COUNT], low_top_m[VELUM_SLOT_COUNT];
    core_look_range looks[2][VELUM_SLOT_COUNT]; /* of each state */
    uint32_t looked_at[2];                      /* slots of theirs */
    bool mixed;                                 /* states are not one */
    uint32_t finest;                            /* level */
} evenness;

/* Of a layer's thickness, so much may its heights differ from tile to tile: geoid and lapse rate lift them a little. */
#define EVEN_SHARE 0.25f

/* By so much, or by such a share of its own, may what makes a profile differ. */
static const core_look even_by = {{[CORE_LOOK_COVERAGE] = 0.002f, [CORE_LOOK_KIND] = 0.002f, [CORE_LOOK_WIND] = 0.1f}};
static const core_look even_share = {{[CORE_LOOK_THICKNESS] = 0.01f, [CORE_LOOK_EXTINCTION] = 0.01f}};

static bool looks_are_even(const core_look_range *looks) {
    bool even = looks->least.value[CORE_LOOK_COVERAGE] > 0.0f;
    for (int i = 0; i < CORE_LOOK_VALUES; i++) {
        const float most = looks->most.value[i];
        even = even && most - looks->least.value[i] <= even_by.value[i] + even_share.value[i] * most;
    }
    return even;
}

/* What a tile of one state has against all that the eye has. */
static void note_even(evenness *e, const core_tile *tile, uint32_t state) {
    uint32_t here = 0;
    for (uint32_t slot = 0; tile && slot < VELUM_SLOT_COUNT; slot++) {
        const core_tile_slot *own = &tile->slot[slot];
        if (tile->mask >> slot & 1u) {
            e->high_base_m[slot] = fmaxf(e->high_base_m[slot], own->min_base_m);
            e->low_top_m[slot] = fminf(e->low_top_m[slot], own->max_top_m);
            if (!(e->looked_at[state] >> slot & 1u)) {
                e->looks[state][slot] = own->looks;
            }
            core_look_widen(&e->looks[state][slot], &own->looks);
            e->looked_at[state] |= 1u << slot;
            here |= 1u << slot;
            here |= core_span_has_some(own->hem_m) ? 1u << (VELUM_PART_HEM + slot) : 0;
            here |= core_span_has_some(own->fall_m) ? 1u << (VELUM_PART_FALL + slot) : 0;
        }
    }
    e->everywhere &= here;
}

/* Whether a profile asks for a wind that is mixed of two. States are mixed by vectors, of which looks have but the
 * lengths; only anvils ask (velum_profile_of). */
static bool mixes_winds(const evenness *e, uint32_t slot) {
    const float most_m_s =
        fmaxf(e->looks[0][slot].most.value[CORE_LOOK_WIND], e->looks[1][slot].most.value[CORE_LOOK_WIND]);
    return slot == VELUM_SLOT_STORM && e->mixed && most_m_s > even_by.value[CORE_LOOK_WIND];
}

static bool is_uneven(const tiles *t, const evenness *e) {
    bool uneven = ((t->mask | t->fringes) & ~e->everywhere) != 0 || e->finest > VELUM_TILE_DATA_LEVEL_MIN;
    for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
        const float spare_m = EVEN_SHARE * (t->top_m[slot] - t->base_m[slot]);
        uneven = uneven || (t->mask >> slot & 1u && (e->high_base_m[slot] > t->base_m[slot] + spare_m ||
                                                     e->low_top_m[slot] < t->top_m[slot] - spare_m));
        uneven = uneven || mixes_winds(e, slot);
        for (uint32_t s = 0; s < 2; s++) {
            uneven = uneven || (e->looked_at[s] >> slot & 1u && !looks_are_even(&e->looks[s][slot]));
        }
    }
    return uneven;
}

/* Where one of two states that are mixed has a fringe alone, it hangs from a base between those of both. */
static void widen_mixed(tiles *t, core_tile *const tile[2]) {
    for (uint32_t slot = 0; tile[0] && tile[1] && tile[0] != tile[1] && slot < VELUM_SLOT_COUNT; slot++) {
        const core_tile_slot *a = &tile[0]->slot[slot];
        const core_tile_slot *b = &tile[1]->slot[slot];
        const velum_span_m reach_m = {t->base_m[slot] - VELUM_SCUD_SHALLOW_M, t->top_m[slot] + VELUM_FALL_JOIN_MOST_M};
        if (a->a && b->a && core_span_has_some(a->hem_m) != core_span_has_some(b->hem_m)) {
            core_span_widen(&t->hem_m[slot], reach_m);
        }
        if (a->a && b->a && core_span_has_some(a->fall_m) != core_span_has_some(b->fall_m)) {
            core_span_widen(&t->fall_m[slot], reach_m);
        }
    }
}

static void resolve(tiles *t, const tiles_context *c) {
    t->mask = t->closing = t->fringes = 0;
    memset(t->hem_m, 0, sizeof t->hem_m);
    memset(t->fall_m, 0, sizeof t->fall_m);
    memset(t->most_scud_1_m, 0, sizeof t->most_scud_1_m);
    memset(t->most_band_1_m, 0, sizeof t->most_band_1_m);
    memset(t->most_fall_1_m, 0, sizeof t->most_fall_1_m);
    t->standing = VELUM_OK;
    evenness even = {.everywhere = UINT32_MAX};
    for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
        even.high_base_m[slot] = -INFINITY;
        even.low_top_m[slot] = INFINITY;
    }
    for (uint32_t i = 0; i < t->set.data_count; i++) {
        uint32_t key = t->set.data_keys[i];
        uint32_t up = coarsening(c->p);
        for (; up > 0 && velum_tile_key_level(key) > VELUM_TILE_DATA_LEVEL_MIN; up--) {
            key = parent_of(key);
            t->standing = t->standing == VELUM_OK ? VELUM_DEGRADED : t->standing;
        }
        core_tile *tile[2];
        bool found = find_tiles(c, key, true, tile);
        while (!found) {
            t->standing = VELUM_INCOMPLETE;
            if (velum_tile_key_level(key) == 0) {
                break;
            }
            key = parent_of(key);
            found = find_tiles(c, key, false, tile);
        }
        t->resolved[i] = key;
        even.finest = velum_tile_key_level(key) > even.finest ? velum_tile_key_level(key) : even.finest;
        if (!take_pages(t, c, i, tile)) {
            t->standing = VELUM_INCOMPLETE;
        }
        widen_mixed(t, tile);
        even.mixed = even.mixed || tile[0] != tile[1];
        note_even(&even, tile[0], 0);
        note_even(&even, tile[1], 1);
        release(tile);
    }
    t->uneven = is_uneven(t, &even);
    for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
        t->look[0][slot] = even.looks[0][slot].most;
        t->look[1][slot] = even.looks[1][slot].most;
    }
}

/* For core_tile_table_build: which of the resolved keys is asked for. Keys come in no order, so a small hash. */
typedef struct lookup {
    const tiles *t;
    uint32_t *index; /* + 1 */
    uint32_t mask;
} lookup;

static uint32_t page_of(void *context, uint32_t state, uint32_t data_key, uint32_t slot) {
    const lookup *l = context;
    for (uint32_t h = velum_table_hash(data_key, l->mask);; h = (h + 1) & l->mask) {
        uint32_t i = l->index[h];
        if (i == 0) {
            return VELUM_PAGE_NONE;
        }
        if (l->t->resolved[i - 1] == data_key) {
            return l->t->page[((i - 1) * 2 + state) * TILE_PAGES + slot];
        }
    }
}

static velum_result build_table(tiles *t, tiles_context *c) {
    uint32_t entries = core_tile_table_entries(t->set.key_count);
    uint32_t slots = core_tile_table_entries(t->set.data_count);
    size_t bytes = 0;
    uint32_t *words = NULL;
    uint32_t *index = calloc(slots, sizeof *index);
    VkDeviceSize offset = 0;
    velum_result result = VELUM_OK;
    if (!index) {
        result = log_fail(c->sink, VELUM_ERROR_OUT_OF_MEMORY, "eye", "record_shared: no memory for a page table");
        goto error;
    }
    for (uint32_t i = 0; i < t->set.data_count; i++) {
        uint32_t h = velum_table_hash(t->resolved[i], slots - 1);
        while (index[h] && t->resolved[index[h] - 1] != t->resolved[i]) {
            h = (h + 1) & (slots - 1);
        }
        index[h] = index[h] ? index[h] : i + 1;
    }
    core_tile_set resolved = t->set;
    resolved.data_keys = t->resolved;
    lookup l = {t, index, slots - 1};
    bytes = core_tile_table_words(&resolved, 2, page_of, &l, entries) * sizeof *words;
    words = malloc(bytes);
    if (!words) {
        result = log_fail(c->sink, VELUM_ERROR_OUT_OF_MEMORY, "eye", "record_shared: no memory for a page table");
        goto error;
    }
    core_tile_table_build(&resolved, 2, page_of, &l, words, entries);
    if (t->words && t->words_bytes == bytes && memcmp(t->words, words, bytes) == 0) {
        free(words);
        free(index);
        return VELUM_OK;
    }
    uint32_t chunks = (uint32_t)((bytes + TABLE_CHUNK_BYTES - 1) / TABLE_CHUNK_BYTES);
    if (c->copy_count == c->copy_capacity || (chunks != t->chunk_count && !take_chunks(c->space, t, chunks))) {
        result = log_fail(c->sink, VELUM_ERROR_OUT_OF_MEMORY, "eye",
                          "record_shared: no room for a page table of %u entries", entries);
        goto error;
    }
    void *staged = stage_take(c->s, bytes, &offset);
    if (!staged) {
        result = log_fail(c->sink, VELUM_ERROR_OUT_OF_MEMORY, "eye",
                          "record_shared: no room on the stage for a page table of %u entries", entries);
        goto error;
    }
    memcpy(staged, words, bytes);
    c->copies[c->copy_count++] = (VkBufferCopy){offset, (VkDeviceSize)t->first_chunk * TABLE_CHUNK_BYTES, bytes};
    free(t->words);
    free(index);
    t->words = words;
    t->words_bytes = bytes;
    t->entries = entries;
    t->built++;
    return VELUM_OK;
error:
    free(words);
    free(index);
    t->has_set = false;
    return result;
}

static bool pages_hold(const tiles *t, pages *p) {
    bool all = true;
    for (uint32_t i = 0; i < t->set.data_count * 2 * TILE_PAGES; i++) {
        all = (t->page[i] == VELUM_PAGE_NONE || pages_keep(p, t->page[i], t->contents[i])) && all;
    }
    return all;
}

velum_result tiles_update(tiles *t, tiles_context *c, const double position_ecef_m[3], double distance_m) {
    velum_result set_result = VELUM_OK;
    bool fresh = !set_holds(t, c, position_ecef_m, distance_m);
    if (fresh) {
        set_result = make_set(t, c, position_ecef_m, distance_m);
        if (set_result < 0) {
            return set_result;
        }
    } else if (pages_hold(t, c->p) && t->standing != VELUM_INCOMPLETE && t->words) {
        return t->standing;
    }
    resolve(t, c);
    velum_result result = build_table(t, c);
    if (result < 0) {
        return result;
    }
    if (set_result == VELUM_DEGRADED && t->standing == VELUM_OK) {
        t->standing = VELUM_DEGRADED;
    }
    return t->standing;
}
