#include "case.h"
#include "shared/sample.h"

/* Includers define velum_shape_at and velum_detail_at. Slot; coverage, kind; height fraction; places in the shape
 * noise, of lumps and of fine detail. The layer is 1000 m to 3000 m, of 0.06 1/m. */
#define CASE_CLOUD_IN 13
#define CASE_CLOUD_OUT 4
CASE(case_cloud) {
    velum_slot_fields f;
    f.coverage = IN_FLOAT(1);
    f.base_m = 1000.0f;
    f.top_m = 3000.0f;
    f.extinction_1_m = 0.06f;
    f.wind_x_m_s = 0.0f;
    f.wind_y_m_s = 0.0f;
    f.wind_z_m_s = 0.0f;
    f.kind = IN_FLOAT(2);
    float rank = velum_shape_at(IN_FLOAT(4), IN_FLOAT(5), IN_FLOAT(6));
    float lump = 2.0f * velum_detail_at(IN_FLOAT(7), IN_FLOAT(8), IN_FLOAT(9)) - 1.0f;
    float fine = velum_detail_at(IN_FLOAT(10), IN_FLOAT(11), IN_FLOAT(12));
    OUT_FLOAT(0, rank);
    OUT_FLOAT(1, lump);
    OUT_FLOAT(2, fine);
    OUT_FLOAT(3, velum_slot_extinction(IN_INT(0), f, f.base_m + IN_FLOAT(3) * (f.top_m - f.base_m), rank, lump, fine));
}
