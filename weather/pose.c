#include "pose.h"

#include <math.h>
#include <string.h>

static const double DEG = 0.017453292519943295;
static const double PI = 3.14159265358979324;
static const double WGS84_A_M = 6378137.0;
static const double WGS84_F = 1 / 298.257223563;

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3]) {
    double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
    out[0] = x, out[1] = y, out[2] = z;
}

static void mix(const double a[3], double wa, const double b[3], double wb, double out[3]) {
    for (int i = 0; i < 3; i++) {
        out[i] = a[i] * wa + b[i] * wb;
    }
}

/* Turns x towards y: x' = x cos + y sin, y' = y cos - x sin. */
static void turn(double x[3], double y[3], double angle_deg) {
    double s, c, turned[3];
    pose_sincos_deg(angle_deg, &s, &c);
    mix(x, c, y, s, turned);
    mix(y, c, x, -s, y);
    memcpy(x, turned, sizeof turned);
}

void pose_sincos_deg(double angle_deg, double *sine, double *cosine) {
    int quadrant = 0;
    double rest = remquo(angle_deg, 90, &quadrant) * DEG;
    double s = sin(rest), c = cos(rest);
    switch ((unsigned)quadrant & 3u) {
    case 0: *sine = s, *cosine = c; break;
    case 1: *sine = c, *cosine = -s; break;
    case 2: *sine = -s, *cosine = -c; break;
    default: *sine = -c, *cosine = s; break;
    }
}

void pose_local_axes(double lat_deg, double lon_deg, double east[3], double north[3], double up[3]) {
    double sin_lat, cos_lat, sin_lon, cos_lon;
    pose_sincos_deg(lat_deg, &sin_lat, &cos_lat);
    pose_sincos_deg(lon_deg, &sin_lon, &cos_lon);
    east[0] = -sin_lon, east[1] = cos_lon, east[2] = 0;
    north[0] = -sin_lat * cos_lon, north[1] = -sin_lat * sin_lon, north[2] = cos_lat;
    up[0] = cos_lat * cos_lon, up[1] = cos_lat * sin_lon, up[2] = sin_lat;
}

void velum_scenario_pose_ecef(const velum_scenario_camera *pose, double position_m[3], double right[3], double up[3],
                              double forward[3]) {
    double east[3], north[3], normal[3], s, c;
    pose_local_axes(pose->lat_deg, pose->lon_deg, east, north, normal);
    const double e2 = WGS84_F * (2 - WGS84_F);
    double prime_vertical_m = WGS84_A_M / sqrt(1 - e2 * normal[2] * normal[2]);
    position_m[0] = (prime_vertical_m + pose->height_m) * normal[0];
    position_m[1] = (prime_vertical_m + pose->height_m) * normal[1];
    position_m[2] = (prime_vertical_m * (1 - e2) + pose->height_m) * normal[2];

    pose_sincos_deg(pose->heading_deg, &s, &c);
    mix(north, c, east, s, forward);
    mix(east, c, north, -s, right);
    memcpy(up, normal, sizeof normal);
    turn(forward, up, pose->pitch_deg);
    turn(up, right, pose->roll_deg);
}

void velum_scenario_channel_axes(const velum_scenario_channel *channel, const double eye_right[3],
                                 const double eye_up[3], const double eye_forward[3], double right[3], double up[3],
                                 double forward[3]) {
    double r[3], u[3], f[3];
    memcpy(r, eye_right, sizeof r);
    memcpy(u, eye_up, sizeof u);
    memcpy(f, eye_forward, sizeof f);
    turn(f, r, channel->yaw_deg);
    turn(f, u, channel->pitch_deg);
    turn(u, r, channel->roll_deg);
    memcpy(right, r, sizeof r);
    memcpy(up, u, sizeof u);
    memcpy(forward, f, sizeof f);
}

/* Heading, pitch and roll of axes at lat_deg, lon_deg. */
static void attitude_of(const double right[3], const double up[3], const double forward[3],
                        velum_scenario_camera *out) {
    double east[3], north[3], normal[3], s, c;
    pose_local_axes(out->lat_deg, out->lon_deg, east, north, normal);
    double ahead_east = dot(forward, east), ahead_north = dot(forward, north), ahead_up = dot(forward, normal);
    double level = hypot(ahead_east, ahead_north);
    out->pitch_deg = atan2(ahead_up, level) / DEG;
    double heading = level > 1e-9 ? atan2(ahead_east, ahead_north) : atan2(-dot(right, north), dot(right, east));
    heading /= DEG;
    out->roll_deg = 0;
    if (level > 1e-9) {
        double level_right[3], level_up[3];
        pose_sincos_deg(heading, &s, &c);
        mix(east, c, north, -s, level_right);
        cross(level_right, forward, level_up);
        out->roll_deg = atan2(dot(up, level_right), dot(up, level_up)) / DEG;
    }
    heading = heading < 0 ? heading + 360 : heading;
    out->heading_deg = heading < 360 ? heading : 0;
}

/* Newton's method on tan(reduced latitude) from Bowring's start (1976, 1985): below 1e-9 m for heights above -1000 km
 * after a few turns. */
static void geodetic_of(const double p[3], velum_scenario_camera *out) {
    const double b_m = WGS84_A_M * (1 - WGS84_F), e2 = WGS84_F * (2 - WGS84_F), ep2 = e2 / (1 - e2);
    double axis_m = hypot(p[0], p[1]);
    double sin_beta = p[2] * WGS84_A_M, cos_beta = axis_m * b_m;
    double sin_lat = 0, cos_lat = 1;
    for (int i = 0; i < 6; i++) {
        double length = hypot(sin_beta, cos_beta);
        sin_beta = length > 0 ? sin_beta / length : 0;
        cos_beta = length > 0 ? cos_beta / length : 1;
        sin_lat = p[2] + ep2 * b_m * sin_beta * sin_beta * sin_beta;
        cos_lat = axis_m - e2 * WGS84_A_M * cos_beta * cos_beta * cos_beta;
        length = hypot(sin_lat, cos_lat);
        sin_lat = length > 0 ? sin_lat / length : 0;
        cos_lat = length > 0 ? cos_lat / length : 1;
        sin_beta = sin_lat * (1 - WGS84_F);
        cos_beta = cos_lat;
    }
    double normal_m = WGS84_A_M / sqrt(1 - e2 * sin_lat * sin_lat);
    out->lat_deg = atan2(sin_lat, cos_lat) / DEG;
    out->lon_deg = axis_m > 0 ? atan2(p[1], p[0]) / DEG : 0;
    out->height_m = axis_m * cos_lat + p[2] * sin_lat - normal_m * (1 - e2 * sin_lat * sin_lat);
}

void pose_from_ecef(const double position_m[3], const double right[3], const double up[3], const double forward[3],
                    velum_scenario_camera *out) {
    geodetic_of(position_m, out);
    attitude_of(right, up, forward, out);
}

/* ------------------------------------------------------------------ keyframes */

/* w, x, y, z of the rotation with the columns right, up, -forward (Shepperd 1978). */
static void quaternion_of(const double right[3], const double up[3], const double forward[3], double q[4]) {
    const double m[3][3] = {
        {right[0], up[0], -forward[0]}, {right[1], up[1], -forward[1]}, {right[2], up[2], -forward[2]}};
    double trace = m[0][0] + m[1][1] + m[2][2];
    int largest = 0;
    double most = trace;
    for (int i = 0; i < 3; i++) {
        if (m[i][i] > most) {
            most = m[i][i];
            largest = i + 1;
        }
    }
    if (largest == 0) {
        q[0] = 1 + trace;
        q[1] = m[2][1] - m[1][2];
        q[2] = m[0][2] - m[2][0];
        q[3] = m[1][0] - m[0][1];
    } else {
        int i = largest - 1, j = (i + 1) % 3, k = (i + 2) % 3;
        q[0] = m[k][j] - m[j][k];
        q[1 + i] = 1 + m[i][i] - m[j][j] - m[k][k];
        q[1 + j] = m[i][j] + m[j][i];
        q[1 + k] = m[i][k] + m[k][i];
    }
    double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (int i = 0; i < 4; i++) {
        q[i] /= length;
    }
}

static void axes_of(const double q[4], double right[3], double up[3], double forward[3]) {
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    right[0] = 1 - 2 * (y * y + z * z), right[1] = 2 * (x * y + w * z), right[2] = 2 * (x * z - w * y);
    up[0] = 2 * (x * y - w * z), up[1] = 1 - 2 * (x * x + z * z), up[2] = 2 * (y * z + w * x);
    forward[0] = -2 * (x * z + w * y), forward[1] = -2 * (y * z - w * x), forward[2] = -(1 - 2 * (x * x + y * y));
}

/* Shoemake (1985). */
static void slerp_quaternion(const double a[4], const double b[4], double share, double out[4]) {
    double cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
    double sign = cosine < 0 ? -1 : 1;
    double sum2 = 0, difference2 = 0;
    for (int i = 0; i < 4; i++) {
        double d = a[i] - sign * b[i], s = a[i] + sign * b[i];
        difference2 += d * d;
        sum2 += s * s;
    }
    double angle = 2 * atan2(sqrt(difference2), sqrt(sum2)), sine = sin(angle), length2 = 0;
    double wa = sine > 1e-12 ? sin((1 - share) * angle) / sine : 1 - share;
    double wb = sine > 1e-12 ? sin(share * angle) / sine : share;
    for (int i = 0; i < 4; i++) {
        out[i] = a[i] * wa + sign * b[i] * wb;
        length2 += out[i] * out[i];
    }
    for (int i = 0; i < 4; i++) {
        out[i] /= sqrt(length2);
    }
}

/* Along the great circle; between opposite points over the pole of the northern half. */
static void slerp_normal(const double a[3], const double b[3], double share, double out[3]) {
    double axis[3], ahead[3];
    cross(a, b, axis);
    double sine = sqrt(dot(axis, axis)), angle = atan2(sine, dot(a, b));
    if (sine > 1e-12) {
        cross(axis, a, ahead);
        mix(ahead, 1 / sine, ahead, 0, ahead);
    } else if (angle > PI / 2) {
        const double z[3] = {0, 0, 1}, x[3] = {1, 0, 0};
        const double *towards = fabs(a[2]) < 0.9 ? z : x;
        mix(towards, 1, a, -dot(a, towards), ahead);
        mix(ahead, 1 / sqrt(dot(ahead, ahead)), ahead, 0, ahead);
    } else {
        mix(a, 1 - share, b, share, out);
        return;
    }
    mix(a, cos(share * angle), ahead, sin(share * angle), out);
}

void pose_interpolate(const velum_scenario_camera *from, const velum_scenario_camera *to, double share,
                      velum_scenario_camera *out) {
    double right[3], up[3], forward[3], east[3], north[3], position[3];
    double normal_from[3], normal_to[3], normal[3], q_from[4], q_to[4], q[4];
    velum_scenario_pose_ecef(from, position, right, up, forward);
    quaternion_of(right, up, forward, q_from);
    pose_local_axes(from->lat_deg, from->lon_deg, east, north, normal_from);
    velum_scenario_pose_ecef(to, position, right, up, forward);
    quaternion_of(right, up, forward, q_to);
    pose_local_axes(to->lat_deg, to->lon_deg, east, north, normal_to);

    slerp_normal(normal_from, normal_to, share, normal);
    slerp_quaternion(q_from, q_to, share, q);
    axes_of(q, right, up, forward);
    double level = hypot(normal[0], normal[1]);
    out->lat_deg = atan2(normal[2], level) / DEG;
    out->lon_deg = level > 0 ? atan2(normal[1], normal[0]) / DEG : 0;
    out->height_m = from->height_m + (to->height_m - from->height_m) * share;
    attitude_of(right, up, forward, out);
}

void velum_scenario_pose(const velum_scenario *scenario, double time_s, velum_scenario_camera *out) {
    const velum_scenario_camera *cameras = scenario->cameras;
    uint32_t count = scenario->camera_count;
    if (count == 0) {
        *out = (velum_scenario_camera){.time_s = time_s};
        return;
    }
    uint32_t next = 0;
    while (next < count && cameras[next].time_s <= time_s) {
        next++;
    }
    if (next == 0 || next == count || cameras[next - 1].time_s == time_s) {
        *out = cameras[next ? next - 1 : 0];
    } else {
        const velum_scenario_camera *from = &cameras[next - 1], *to = &cameras[next];
        pose_interpolate(from, to, (time_s - from->time_s) / (to->time_s - from->time_s), out);
    }
    out->time_s = time_s;
}
