#include "geodesy.h"

#include <GeographicLib/Geocentric.hpp>
#include <GeographicLib/Geodesic.hpp>
#include <cmath>

namespace {

bool finite3(const double v[3]) {
    return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

} // namespace

extern "C" {

bool core_ecef_from_geodetic(const core_geodetic *place, double ecef_m[3]) {
    ecef_m[0] = ecef_m[1] = ecef_m[2] = 0.0;
    try {
        double x, y, z;
        GeographicLib::Geocentric::WGS84().Forward(place->lat_deg, place->lon_deg, place->height_m, x, y, z);
        const double found[3] = {x, y, z};
        if (!finite3(found)) {
            return false;
        }
        ecef_m[0] = x;
        ecef_m[1] = y;
        ecef_m[2] = z;
        return true;
    } catch (...) {
        return false;
    }
}

bool core_geodetic_from_ecef(const double ecef_m[3], core_geodetic *place) {
    *place = core_geodetic{};
    if (!finite3(ecef_m)) {
        return false;
    }
    try {
        core_geodetic found;
        GeographicLib::Geocentric::WGS84().Reverse(ecef_m[0], ecef_m[1], ecef_m[2], found.lat_deg, found.lon_deg,
                                                   found.height_m);
        if (!std::isfinite(found.lat_deg) || !std::isfinite(found.lon_deg) || !std::isfinite(found.height_m)) {
            return false;
        }
        *place = found;
        return true;
    } catch (...) {
        return false;
    }
}

bool core_geodesic_inverse(double lat1_deg, double lon1_deg, double lat2_deg, double lon2_deg, double *distance_m,
                           double *azimuth_deg) {
    *distance_m = *azimuth_deg = 0.0;
    try {
        double distance, azimuth, azimuth2;
        GeographicLib::Geodesic::WGS84().Inverse(lat1_deg, lon1_deg, lat2_deg, lon2_deg, distance, azimuth, azimuth2);
        if (!std::isfinite(distance) || !std::isfinite(azimuth)) {
            return false;
        }
        *distance_m = distance;
        *azimuth_deg = azimuth;
        return true;
    } catch (...) {
        return false;
    }
}

bool core_geodesic_direct(double lat1_deg, double lon1_deg, double azimuth_deg, double distance_m, double *lat2_deg,
                          double *lon2_deg) {
    *lat2_deg = *lon2_deg = 0.0;
    try {
        double lat, lon;
        GeographicLib::Geodesic::WGS84().Direct(lat1_deg, lon1_deg, azimuth_deg, distance_m, lat, lon);
        if (!std::isfinite(lat) || !std::isfinite(lon)) {
            return false;
        }
        *lat2_deg = lat;
        *lon2_deg = lon;
        return true;
    } catch (...) {
        return false;
    }
}

bool core_eye_geometry(const double ecef_m[3], velum_eye_geometry *out) {
    *out = velum_eye_geometry{};
    if (!finite3(ecef_m)) {
        return false;
    }
    const double sz = ecef_m[2] * (CORE_WGS84_A_M / CORE_WGS84_B_M);
    const double square = ecef_m[0] * ecef_m[0] + ecef_m[1] * ecef_m[1] + sz * sz;
    const double norm = std::sqrt(square);
    if (!(norm > 1.0) || !(norm < 1e9)) {
        return false;
    }
    out->scaled_x = static_cast<float>(ecef_m[0] / norm);
    out->scaled_y = static_cast<float>(ecef_m[1] / norm);
    out->scaled_z = static_cast<float>(sz / norm);
    out->scaled_m = static_cast<float>(norm);
    out->power_m2 = static_cast<float>((norm - CORE_WGS84_A_M) * (norm + CORE_WGS84_A_M));
    out->x_m = static_cast<float>(ecef_m[0]);
    out->y_m = static_cast<float>(ecef_m[1]);
    out->z_m = static_cast<float>(ecef_m[2]);
    return true;
}

double core_height_scaled(const double ecef_m[3]) {
    const double k = CORE_WGS84_A_M / CORE_WGS84_B_M;
    const double sz = ecef_m[2] * k;
    const double norm = std::sqrt(ecef_m[0] * ecef_m[0] + ecef_m[1] * ecef_m[1] + sz * sz);
    const double sin_beta = norm > 0.0 ? sz / norm : 0.0;
    return (norm - CORE_WGS84_A_M) / std::sqrt(1.0 - sin_beta * sin_beta + k * k * sin_beta * sin_beta);
}

} // extern "C"
