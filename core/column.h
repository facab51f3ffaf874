/* The smooth fields of a state over one place. */
#ifndef VELUM_CORE_COLUMN_H
#define VELUM_CORE_COLUMN_H

#include "shared/slots.h"
#include "state.h"

#define CORE_VISIBILITY_DEFAULT_M 100000.0f /* where no cell gives one */

typedef struct core_surface {
    float visibility_m;                       /* meteorological optical range */
    float fog_top_m;                          /* HAE; the visibility reaches up to here */
    float elevation_m;                        /* HAE */
    float wind_x_m_s, wind_y_m_s, wind_z_m_s; /* ECEF, tangent at the place */
    float gust_m_s;
    float temperature_k, dew_point_k; /* 0: not known */
    float precipitation_mm_h;
    int32_t precipitation; /* VELUM_PRECIPITATION_* */
    float thunderstorm;    /* 0..1 */
} core_surface;

typedef struct core_column {
    uint32_t mask;                            /* slots with coverage > 0; the others are zeroed */
    velum_slot_fields slot[VELUM_SLOT_COUNT]; /* heights HAE */
    core_surface surface;
} core_column;

/* `normal`: geodetic, unit. `texel_m`: size of what is asked for; a sharp edge becomes a ramp of 2 texels, centred on
 * the edge. A pure function of its arguments. core_column_layers leaves `surface` zeroed and is faster. */
void core_column_at(const core_state *state, const double normal[3], double texel_m, core_column *out);
void core_column_layers(const core_state *state, const double normal[3], double texel_m, core_column *out);

#endif
