/* WGS84 without anchors. ECEF with z scaled by a/b turns the ellipsoid into a sphere of radius a; the map is affine, so
 * rays stay straight. GPU positions are offsets r from the eye, metres, float, in ECEF axes. */
#ifndef VELUM_PLANET_H
#define VELUM_PLANET_H

#include "dialect.h"

#define VELUM_WGS84_A_M 6378137.0f          /* NIMA TR8350.2 */
#define VELUM_WGS84_F 0.0033528106647474805f
#define VELUM_WGS84_B_M 6356752.314245179f
#define VELUM_WGS84_E2 0.006694379990141317f /* first eccentricity squared */
#define VELUM_SCALE_Z 1.0033640898209764f    /* a / b */
#define VELUM_B_OVER_A 0.9966471893352525f

/* What the CPU prepares of the eye, in double, rounded once. */
VELUM_STRUCT(velum_eye_geometry) {
    float scaled_x, scaled_y, scaled_z; /* unit vector of the scaled position s */
    float scaled_m;                     /* |s| */
    float power_m2;                     /* |s|^2 - a^2, formed in double */
    float x_m, y_m, z_m;                /* ECEF */
};

VELUM_STRUCT(velum_place) {
    float height_m;      /* HAE */
    float nx, ny, nz;    /* geodetic normal */
};

/* Height above the ellipsoid and geodetic normal of the point at r from the eye.
 * |s| - a = ((|s_e|^2 - a^2) + 2 s_e.r' + |r'|^2) / (|s| + a): no cancellation. */
VELUM_FN velum_place velum_place_at(velum_eye_geometry eye, float rx, float ry, float rz) {
    velum_place place;
    float sz = rz * VELUM_SCALE_Z;
    float along = eye.scaled_x * rx + eye.scaled_y * ry + eye.scaled_z * sz;
    float square = rx * rx + ry * ry + sz * sz;
    float power = eye.power_m2 + 2.0f * eye.scaled_m * along + square;
    float radius = VELUM_SQRT(VELUM_MAX(VELUM_WGS84_A_M * VELUM_WGS84_A_M + power, 1.0f));
    float over = power / (radius + VELUM_WGS84_A_M);
    float sin_beta = (eye.scaled_z * eye.scaled_m + sz) / radius;
    float sin2 = sin_beta * sin_beta;
    place.height_m = over / VELUM_SQRT(1.0f - sin2 + VELUM_SCALE_Z * VELUM_SCALE_Z * sin2);
    /* tan(phi) = Z (N + h) / (p (N (1 - e2) + h)), N between a and a / (1 - f): N = a is within 1e-7 here. */
    float stretch =
        (VELUM_WGS84_A_M + place.height_m) / (VELUM_WGS84_A_M * (1.0f - VELUM_WGS84_E2) + place.height_m);
    float x = eye.x_m + rx;
    float y = eye.y_m + ry;
    float z = (eye.z_m + rz) * stretch;
    float norm = 1.0f / VELUM_SQRT(VELUM_MAX(x * x + y * y + z * z, 1.0f));
    place.nx = x * norm;
    place.ny = y * norm;
    place.nz = z * norm;
    return place;
}

VELUM_STRUCT(velum_span) {
    float enter_m, leave_m; /* along the unit ray; enter > leave: none */
};

/* Where a ray from offset o with unit direction d is inside the surface of constant height `height_m`, taken as the
 * scaled sphere of radius a + height_m k, with k between 1 and a/b: for inside tests choose k by what is to be bounded.
 * Both roots, by the stable quadratic. */
VELUM_FN velum_span velum_sphere_span(velum_eye_geometry eye, float ox, float oy, float oz, float dx, float dy,
                                      float dz, float over_m) {
    velum_span span;
    float sz = oz * VELUM_SCALE_Z;
    float ez = dz * VELUM_SCALE_Z;
    float a = dx * dx + dy * dy + ez * ez;
    float px = eye.scaled_x * eye.scaled_m + ox;
    float py = eye.scaled_y * eye.scaled_m + oy;
    float pz = eye.scaled_z * eye.scaled_m + sz;
    float b = px * dx + py * dy + pz * ez;
    float power = eye.power_m2 + 2.0f * eye.scaled_m * (eye.scaled_x * ox + eye.scaled_y * oy + eye.scaled_z * sz) +
                  ox * ox + oy * oy + sz * sz;
    float c = power - over_m * (2.0f * VELUM_WGS84_A_M + over_m);
    /* b^2 - a c, from the closest point, to keep digits when b^2 and a c are near: */
    float t0 = -b / a;
    float qx = px + dx * t0;
    float qy = py + dy * t0;
    float qz = pz + ez * t0;
    float closest = VELUM_SQRT(qx * qx + qy * qy + qz * qz);
    float radius = VELUM_WGS84_A_M + over_m;
    float discriminant = (radius - closest) * (radius + closest) * a;
    if (VELUM_ABS(c) < 1.0e10f) {
        discriminant = b * b - a * c;
    }
    span.enter_m = 1.0f;
    span.leave_m = -1.0f;
    if (discriminant > 0.0f) {
        float root = VELUM_SQRT(discriminant);
        float q = b >= 0.0f ? -(b + root) : root - b;
        float t1 = q / a;
        float t2 = q != 0.0f ? c / q : 0.0f;
        span.enter_m = VELUM_MIN(t1, t2);
        span.leave_m = VELUM_MAX(t1, t2);
    }
    return span;
}

#endif
