#include "case.h"
#include "shared/air.h"

#define CASE_AIR_IN 5
#define CASE_AIR_OUT 10
CASE(case_air) {
    float height_m = IN_FLOAT(0);
    velum_air_uv uv = velum_air_uv_of(height_m, IN_FLOAT(1));
    velum_air_ray ray = velum_air_ray_of(IN_FLOAT(3), IN_FLOAT(4));
    OUT_FLOAT(0, velum_rayleigh_density(height_m));
    OUT_FLOAT(1, velum_aerosol_density(height_m));
    OUT_FLOAT(2, velum_ozone_density(height_m));
    OUT_FLOAT(3, velum_fog_density(height_m, IN_FLOAT(2)));
    OUT_FLOAT(4, velum_fog_column_m(height_m, IN_FLOAT(2)));
    OUT_FLOAT(5, uv.u);
    OUT_FLOAT(6, uv.v);
    OUT_FLOAT(7, ray.height_m);
    OUT_FLOAT(8, ray.mu);
    OUT_FLOAT(9, velum_horizon_mu(height_m));
}
