#include "case.h"
#include "shared/planet.h"

#define CASE_PLANET_IN 15
#define CASE_PLANET_OUT 6
CASE(case_planet) {
    velum_eye_geometry eye;
    eye.scaled_x = IN_FLOAT(0);
    eye.scaled_y = IN_FLOAT(1);
    eye.scaled_z = IN_FLOAT(2);
    eye.scaled_m = IN_FLOAT(3);
    eye.power_m2 = IN_FLOAT(4);
    eye.x_m = IN_FLOAT(5);
    eye.y_m = IN_FLOAT(6);
    eye.z_m = IN_FLOAT(7);
    velum_place place = velum_place_at(eye, IN_FLOAT(8), IN_FLOAT(9), IN_FLOAT(10));
    velum_span span = velum_sphere_span(eye, 0.0f, 0.0f, 0.0f, IN_FLOAT(11), IN_FLOAT(12), IN_FLOAT(13), IN_FLOAT(14));
    OUT_FLOAT(0, place.height_m);
    OUT_FLOAT(1, place.nx);
    OUT_FLOAT(2, place.ny);
    OUT_FLOAT(3, place.nz);
    OUT_FLOAT(4, span.enter_m);
    OUT_FLOAT(5, span.leave_m);
}
