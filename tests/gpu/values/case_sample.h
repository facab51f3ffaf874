#include "case.h"
#include "shared/sample.h"

/* 0..3: texel value, height, extinction, wind; 4..8: ranks, weight, details; 9..16 and 17..24: fields; 25: blend;
 * 26..34: noise_place; 35..37: an eye for its points. */
#define CASE_SAMPLE_IN 38
#define CASE_SAMPLE_OUT 21
VELUM_FN velum_slot_fields case_fields(float coverage, float base_m, float top_m, float extinction_1_m, float x,
                                       float y, float z, float kind) {
    velum_slot_fields f;
    f.coverage = coverage;
    f.base_m = base_m;
    f.top_m = top_m;
    f.extinction_1_m = extinction_1_m;
    f.wind_x_m_s = x;
    f.wind_y_m_s = y;
    f.wind_z_m_s = z;
    f.kind = kind;
    return f;
}
CASE(case_sample) {
    OUT_FLOAT(0, velum_texel_height_m(IN_FLOAT(0)));
    OUT_FLOAT(1, velum_texel_extinction_1_m(IN_FLOAT(0)));
    OUT_FLOAT(2, velum_texel_wind_m_s(IN_FLOAT(0)));
    OUT_FLOAT(3, velum_texel_from_height(IN_FLOAT(1)));
    OUT_FLOAT(4, velum_texel_from_extinction(IN_FLOAT(2)));
    OUT_FLOAT(5, velum_texel_from_wind(IN_FLOAT(3)));
    OUT_FLOAT(6, velum_rank_mix(IN_FLOAT(4), IN_FLOAT(5), IN_FLOAT(6)));
    OUT_FLOAT(7, velum_detail_mix(IN_FLOAT(7), IN_FLOAT(8), IN_FLOAT(6)));
    velum_slot_fields a = case_fields(IN_FLOAT(9), IN_FLOAT(10), IN_FLOAT(11), IN_FLOAT(12), IN_FLOAT(13), IN_FLOAT(14),
                                      IN_FLOAT(15), IN_FLOAT(16));
    velum_slot_fields b = case_fields(IN_FLOAT(17), IN_FLOAT(18), IN_FLOAT(19), IN_FLOAT(20), IN_FLOAT(21),
                                      IN_FLOAT(22), IN_FLOAT(23), IN_FLOAT(24));
    velum_slot_fields f = velum_fields_mix(a, b, IN_FLOAT(25));
    OUT_FLOAT(8, f.coverage);
    OUT_FLOAT(9, f.base_m);
    OUT_FLOAT(10, f.top_m);
    OUT_FLOAT(11, f.extinction_1_m);
    OUT_FLOAT(12, f.wind_x_m_s);
    OUT_FLOAT(13, f.wind_y_m_s);
    OUT_FLOAT(14, f.wind_z_m_s);
    OUT_FLOAT(15, f.kind);
    velum_noise_point p = velum_noise_place(IN_FLOAT(26), IN_FLOAT(27), IN_FLOAT(28), IN_FLOAT(29), IN_FLOAT(30),
                                            IN_FLOAT(31), IN_FLOAT(32), IN_FLOAT(33), IN_FLOAT(34));
    OUT_FLOAT(16, p.x);
    OUT_FLOAT(17, p.y);
    OUT_FLOAT(18, p.z);
    OUT_FLOAT(19, velum_north_m(IN_FLOAT(35), IN_FLOAT(36), IN_FLOAT(37), IN_FLOAT(32), IN_FLOAT(33), IN_FLOAT(34)));
    OUT_FLOAT(20, velum_waves_m(IN_FLOAT(35), IN_FLOAT(36), IN_FLOAT(37)));
}
