/* From a cell's layers to the slots of shared/slots.h. */
#ifndef VELUM_CORE_SLOTS_H
#define VELUM_CORE_SLOTS_H

#include <stdbool.h>
#include <stdint.h>
#include <velum/weather.h>

#include "shared/slots.h"

#define CORE_WATER_DENSITY_KG_M3 1000.0f
#define CORE_ICE_DENSITY_KG_M3 917.0f

/* What a cell holds in one slot. Heights MSL; wind in the frame that the cell's wind is given in. */
typedef struct core_slot_layer {
    float coverage;
    float base_m, top_m;
    float extinction_1_m;
    float wind_east_m_s, wind_north_m_s;
    float kind;
    float transition_m, scud;
    float precipitation_mm_h;
    int32_t precipitation;
    float water_per_extinction; /* g/m3 for each 1/m: water content = extinction times this */
    float albedo, hg_asymmetry; /* of UNIFORM slots */
    uint32_t flags;             /* VELUM_LAYER_* of the layers that went in */
} core_slot_layer;

typedef struct core_slot_layers {
    uint32_t mask;   /* bit per slot in use */
    uint32_t merged; /* layers that had to share a slot with another one */
    core_slot_layer slot[VELUM_SLOT_COUNT];
} core_slot_layers;

/* The slot family of a genus (LOW, CUMULUS, STORM, MIDDLE, HIGH) and the kind within it. False: not a genus. */
bool core_slot_of_genus(int32_t genus, uint32_t *slot, float *kind);
/* VELUM_GENUS_* nearest to a kind in a slot; 0 for UNIFORM slots. */
int32_t core_genus_of_slot(uint32_t slot, float kind);

/* Extinction 3 WC / (2 rho r_eff) (geometric optics, efficiency 2; Hess et al. 1998), 1/m. */
float core_extinction_1_m(float water_g_m3, float radius_um, int32_t water);
/* Of a layer: the given one, or from its water. */
float core_layer_extinction_1_m(const velum_layer *layer);

/* Assigns valid layers (at most 16). Layers without coverage or without extinction take no slot. */
void core_slots_assign(const velum_layer *layers, uint32_t count, core_slot_layers *out);

#endif
