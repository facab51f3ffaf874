#include "slots.h"

#include <math.h>
#include <string.h>

#define MAX_LAYERS 16

/* Radius that stands for the water of layers given by extinction alone. */
#define LIQUID_RADIUS_UM 10.0f
#define ICE_RADIUS_UM 40.0f

bool core_slot_of_genus(int32_t genus, uint32_t *slot, float *kind) {
    static const struct {
        uint32_t slot;
        float kind;
    } table[] = {
        [VELUM_GENUS_CI] = {VELUM_SLOT_HIGH, VELUM_KIND_CI},   [VELUM_GENUS_CC] = {VELUM_SLOT_HIGH, VELUM_KIND_CC},
        [VELUM_GENUS_CS] = {VELUM_SLOT_HIGH, VELUM_KIND_CS},   [VELUM_GENUS_AC] = {VELUM_SLOT_MIDDLE, VELUM_KIND_AC},
        [VELUM_GENUS_AS] = {VELUM_SLOT_MIDDLE, VELUM_KIND_AS}, [VELUM_GENUS_NS] = {VELUM_SLOT_MIDDLE, VELUM_KIND_NS},
        [VELUM_GENUS_SC] = {VELUM_SLOT_LOW, VELUM_KIND_SC},    [VELUM_GENUS_ST] = {VELUM_SLOT_LOW, VELUM_KIND_ST},
        [VELUM_GENUS_CU] = {VELUM_SLOT_CUMULUS, 0.0f},         [VELUM_GENUS_CB] = {VELUM_SLOT_STORM, VELUM_KIND_CB},
    };
    if (genus < VELUM_GENUS_CI || genus > VELUM_GENUS_CB) {
        return false;
    }
    *slot = table[genus].slot;
    *kind = table[genus].kind;
    return true;
}

int32_t core_genus_of_slot(uint32_t slot, float kind) {
    switch (slot) {
    case VELUM_SLOT_LOW:
    case VELUM_SLOT_LOW_2: return kind < 0.5f ? VELUM_GENUS_ST : VELUM_GENUS_SC;
    case VELUM_SLOT_CUMULUS: return VELUM_GENUS_CU;
    case VELUM_SLOT_STORM: return VELUM_GENUS_CB;
    case VELUM_SLOT_MIDDLE: return kind < 0.25f ? VELUM_GENUS_AS : kind < 0.75f ? VELUM_GENUS_NS : VELUM_GENUS_AC;
    case VELUM_SLOT_HIGH: return kind < 0.25f ? VELUM_GENUS_CS : kind < 0.75f ? VELUM_GENUS_CI : VELUM_GENUS_CC;
    default: return 0;
    }
}

static float water_per_extinction(float radius_um, int32_t water) {
    float density = water == VELUM_WATER_ICE ? CORE_ICE_DENSITY_KG_M3 : CORE_WATER_DENSITY_KG_M3;
    return 2.0f * density * radius_um * 1e-6f / 3.0f * 1e3f;
}

float core_extinction_1_m(float water_g_m3, float radius_um, int32_t water) {
    return water_g_m3 / water_per_extinction(radius_um, water);
}

float core_layer_extinction_1_m(const velum_layer *layer) {
    return layer->flags & VELUM_LAYER_EXTINCTION
               ? layer->extinction_1_m
               : core_extinction_1_m(layer->water_g_m3, layer->radius_um, layer->water);
}

static core_slot_layer slot_layer(const velum_layer *layer, float kind) {
    bool uniform = layer->flags & VELUM_LAYER_UNIFORM;
    float radius_um = layer->flags & VELUM_LAYER_EXTINCTION
                          ? (layer->water == VELUM_WATER_ICE ? ICE_RADIUS_UM : LIQUID_RADIUS_UM)
                          : layer->radius_um;
    return (core_slot_layer){
        .coverage = uniform ? 1.0f : layer->coverage,
        .base_m = layer->base_m,
        .top_m = layer->top_m,
        .extinction_1_m = core_layer_extinction_1_m(layer),
        .wind_east_m_s = layer->wind_east_m_s,
        .wind_north_m_s = layer->wind_north_m_s,
        .kind = uniform ? 0.0f : kind,
        .transition_m = layer->transition_m,
        .scud = layer->scud,
        .precipitation_mm_h = layer->precipitation_mm_h,
        .precipitation = layer->precipitation,
        .water_per_extinction = water_per_extinction(radius_um, layer->water),
        .albedo = layer->flags & VELUM_LAYER_ALBEDO ? layer->albedo : 1.0f,
        .hg_asymmetry = layer->flags & VELUM_LAYER_PHASE_HG ? layer->hg_asymmetry : 0.0f,
        .flags = layer->flags,
    };
}

/* Two layers as one: random overlap, common envelope, the mean water path kept, the rest by coverage. */
static void join(core_slot_layer *into, const core_slot_layer *other) {
    float c1 = into->coverage;
    float c2 = other->coverage;
    float sum = c1 + c2;
    float path = c1 * into->extinction_1_m * (into->top_m - into->base_m) +
                 c2 * other->extinction_1_m * (other->top_m - other->base_m);
    float t = c2 / sum;
    into->coverage = c1 + c2 - c1 * c2;
    into->base_m = fminf(into->base_m, other->base_m);
    into->top_m = fmaxf(into->top_m, other->top_m);
    into->extinction_1_m = path / (into->coverage * (into->top_m - into->base_m));
    into->wind_east_m_s = velum_mix(into->wind_east_m_s, other->wind_east_m_s, t);
    into->wind_north_m_s = velum_mix(into->wind_north_m_s, other->wind_north_m_s, t);
    into->kind = velum_mix(into->kind, other->kind, t);
    into->transition_m = velum_mix(into->transition_m, other->transition_m, t);
    into->scud = velum_mix(into->scud, other->scud, t);
    into->water_per_extinction = velum_mix(into->water_per_extinction, other->water_per_extinction, t);
    into->albedo = velum_mix(into->albedo, other->albedo, t);
    into->hg_asymmetry = velum_mix(into->hg_asymmetry, other->hg_asymmetry, t);
    if (other->precipitation_mm_h > into->precipitation_mm_h) {
        into->precipitation_mm_h = other->precipitation_mm_h;
        into->precipitation = other->precipitation;
    }
    into->flags |= other->flags;
}

static void put(core_slot_layers *out, uint32_t slot, const core_slot_layer *layer) {
    if (out->mask & (1u << slot)) {
        join(&out->slot[slot], layer);
        out->merged++;
    } else {
        out->slot[slot] = *layer;
        out->mask |= 1u << slot;
    }
}

void core_slots_assign(const velum_layer *layers, uint32_t count, core_slot_layers *out) {
    uint32_t order[MAX_LAYERS];
    uint32_t used = 0;
    memset(out, 0, sizeof *out);
    for (uint32_t i = 0; i < count && i < MAX_LAYERS; i++) {
        bool uniform = layers[i].flags & VELUM_LAYER_UNIFORM;
        if ((!uniform && !(layers[i].coverage > 0.0f)) || !(core_layer_extinction_1_m(&layers[i]) > 0.0f)) {
            continue;
        }
        uint32_t at = used++;
        while (at > 0 && layers[order[at - 1]].base_m > layers[i].base_m) {
            order[at] = order[at - 1];
            at--;
        }
        order[at] = i;
    }
    for (uint32_t i = 0; i < used; i++) {
        const velum_layer *layer = &layers[order[i]];
        uint32_t slot;
        float kind;
        if (!core_slot_of_genus(layer->genus, &slot, &kind)) {
            continue;
        }
        if (layer->flags & VELUM_LAYER_UNIFORM) {
            slot = VELUM_SLOT_UNIFORM;
        }
        /* From below: the lowest takes the first of a pair of slots, all others the second. */
        if ((slot == VELUM_SLOT_LOW || slot == VELUM_SLOT_UNIFORM) && out->mask & (1u << slot)) {
            slot++;
        }
        core_slot_layer one = slot_layer(layer, kind);
        put(out, slot, &one);
    }
}
