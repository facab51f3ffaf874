#include "case.h"
#include "shared/sample.h"

/* Slot; coverage, base, top, extinction, kind; height; rank, lump, fine; wind across and along. */
#define CASE_DENSITY_IN 12
#define CASE_DENSITY_OUT 7
CASE(case_density) {
    int slot = IN_INT(0);
    velum_slot_fields f;
    f.coverage = IN_FLOAT(1);
    f.base_m = IN_FLOAT(2);
    f.top_m = IN_FLOAT(3);
    f.extinction_1_m = IN_FLOAT(4);
    f.wind_x_m_s = IN_FLOAT(10);
    f.wind_y_m_s = IN_FLOAT(11);
    f.wind_z_m_s = 0.0f;
    f.kind = IN_FLOAT(5);
    velum_profile profile = velum_profile_of(slot, f);
    float z = (IN_FLOAT(6) - f.base_m) / (f.top_m - f.base_m);
    OUT_FLOAT(0, velum_slot_extinction(slot, f, IN_FLOAT(6), IN_FLOAT(7), IN_FLOAT(8), IN_FLOAT(9)));
    OUT_FLOAT(1, velum_excess(profile, f.coverage, IN_FLOAT(7)));
    OUT_FLOAT(2, velum_threshold(profile, z));
    velum_slot_noise noise = velum_noise_of(slot);
    OUT_FLOAT(3, noise.shape_period_m + noise.lump_period_m + noise.fine_period_m + noise.stretch + noise.fine_stretch);
    velum_noise_point lean = velum_lean(slot, f, IN_FLOAT(6), 0.6f, 0.0f, 0.8f);
    OUT_FLOAT(4, lean.x);
    OUT_FLOAT(5, lean.y);
    OUT_FLOAT(6, lean.z);
}
