#include "cloud_sample.h"

#include <math.h>

core_cloud_noise core_cloud_noise_at(const core_noise *noise, uint32_t slot, const double origin_ecef_m[3],
                                     const core_drift *drift) {
    core_cloud_noise cloud = {.noise = noise,
                              .tau_s = {drift->tau_s[0], drift->tau_s[1]},
                              .weight_1 = drift->weight[1],
                              .drifting = drift->weight[0] > 0.0f && drift->weight[1] > 0.0f,
                              .stretch = velum_noise_of((int)slot).stretch,
                              .fine_stretch = velum_noise_of((int)slot).fine_stretch,
                              .origin_m = {(float)origin_ecef_m[0], (float)origin_ecef_m[1], (float)origin_ecef_m[2]},
                              .slot = (int)slot};
    core_slot_phases_at(slot, origin_ecef_m, drift, &cloud.phases);
    return cloud;
}

static velum_noise_point place_in(const core_cloud_noise *cloud, const velum_slot_fields *f, const float *phase,
                                  float stretch, int life, const float point_m[3], velum_noise_point lean) {
    const float tau_s = cloud->tau_s[life];
    const float x = point_m[0] - f->wind_x_m_s * tau_s;
    const float y = point_m[1] - f->wind_y_m_s * tau_s;
    const float z = point_m[2] - f->wind_z_m_s * tau_s;
    float across_m = 0.0f;
    if (cloud->slot == VELUM_SLOT_HIGH) {
        across_m = velum_north_m(cloud->origin_m[0], cloud->origin_m[1], cloud->origin_m[2], x, y, z) +
                   velum_waves_m(cloud->origin_m[0] + x, cloud->origin_m[1] + y, cloud->origin_m[2] + z);
    }
    return velum_noise_place(phase[0], phase[1], phase[2], phase[3], stretch, across_m, x + lean.x, y + lean.y,
                             z + lean.z);
}

/* With one phase alone it is that phase, whichever it is. */
static int only_life(const core_cloud_noise *cloud) {
    return !cloud->drifting && cloud->weight_1 > 0.5f ? 1 : 0;
}

static float rank_of(const core_cloud_noise *cloud, const velum_slot_fields *fields, const float foot_m[3],
                     velum_noise_point lean) {
    int life = only_life(cloud);
    velum_noise_point p = place_in(cloud, fields, cloud->phases.shape[life], cloud->stretch, life, foot_m, lean);
    float rank = core_noise_shape(cloud->noise, p.x, p.y, p.z);
    if (cloud->drifting) {
        p = place_in(cloud, fields, cloud->phases.shape[1], cloud->stretch, 1, foot_m, lean);
        rank = velum_rank_mix(rank, core_noise_shape(cloud->noise, p.x, p.y, p.z), cloud->weight_1);
    }
    return rank;
}

static float detail_of(const core_cloud_noise *cloud, const velum_slot_fields *fields, const float phases[2][4],
                       float stretch, const float point_m[3]) {
    int life = only_life(cloud);
    velum_noise_point p = place_in(cloud, fields, phases[life], stretch, life, point_m, (velum_noise_point){0});
    float detail = core_noise_detail(cloud->noise, p.x, p.y, p.z);
    if (cloud->drifting) {
        p = place_in(cloud, fields, phases[1], stretch, 1, point_m, (velum_noise_point){0});
        detail = velum_detail_mix(detail, core_noise_detail(cloud->noise, p.x, p.y, p.z), cloud->weight_1);
    }
    return detail;
}

float core_cloud_lump(const core_cloud_noise *cloud, const velum_slot_fields *fields, const float point_m[3]) {
    return 2.0f * detail_of(cloud, fields, (const float(*)[4])cloud->phases.lump, 1.0f, point_m) - 1.0f;
}

float core_cloud_fine(const core_cloud_noise *cloud, const velum_slot_fields *fields, const float point_m[3]) {
    return detail_of(cloud, fields, (const float(*)[4])cloud->phases.fine, cloud->fine_stretch, point_m);
}

/* The foot of a point's column, moved. */
static void foot_of(const float point_m[3], const float normal[3], float height_m, const float moved_m[3],
                    float foot_m[3]) {
    for (int axis = 0; axis < 3; axis++) {
        foot_m[axis] = point_m[axis] + moved_m[axis] - normal[axis] * height_m;
    }
}

/* Rank of the column over a foot, at a height, where columns lean. */
static float rank_at(const core_cloud_noise *cloud, const velum_slot_fields *f, const float foot_m[3],
                     const float normal[3], float height_m) {
    const velum_noise_point p = velum_lean(cloud->slot, *f, height_m, normal[0], normal[1], normal[2]);
    return rank_of(cloud, f, foot_m, p);
}

static const float unmoved_m[3] = {0.0f, 0.0f, 0.0f};

float core_cloud_rank(const core_cloud_noise *cloud, const velum_slot_fields *fields, const float point_m[3],
                      const float normal[3], float height_m) {
    float foot[3];
    foot_of(point_m, normal, height_m, unmoved_m, foot);
    return rank_at(cloud, fields, foot, normal, height_m);
}

float core_cloud_extinction_of(const core_cloud_noise *cloud, const velum_slot_fields *fields,
                               const velum_profile *profile, float rank, const float point_m[3], float height_m,
                               bool fine) {
    const float over_m = height_m - fields->base_m;
    const float z = over_m / fmaxf(fields->top_m - fields->base_m, 1.0f);
    const float e = velum_excess(*profile, fields->coverage, rank);
    if (!(z > 0.0f && z < 1.0f && e > 0.0f)) {
        return 0.0f;
    }
    return fields->extinction_1_m * velum_body(*profile, e, z, over_m, core_cloud_lump(cloud, fields, point_m),
                                               fine ? core_cloud_fine(cloud, fields, point_m) : 0.5f);
}

float core_cloud_extinction(const core_cloud_noise *cloud, const velum_slot_fields *fields, const float point_m[3],
                            const float normal[3], float height_m, bool fine) {
    if (fields->coverage <= 0.0f || height_m < fields->base_m || height_m > fields->top_m) {
        return 0.0f;
    }
    if (cloud->slot >= VELUM_SLOT_UNIFORM) {
        return velum_slot_extinction(cloud->slot, *fields, height_m, 1.0f, 0.0f, 0.5f);
    }
    const velum_profile profile = velum_profile_of(cloud->slot, *fields);
    const float rank = core_cloud_rank(cloud, fields, point_m, normal, height_m);
    return core_cloud_extinction_of(cloud, fields, &profile, rank, point_m, height_m, fine);
}

static float hem_1_m(const core_cloud_noise *cloud, const velum_slot_fields *f, const velum_fringe *g,
                     const float point_m[3], const float normal[3], float height_m, bool fine) {
    velum_span_m span = velum_hem_span(*f, *g);
    if (!(g->scud > 0.0f || g->transition_m > 0.0f) || height_m < span.low || height_m > span.high) {
        return 0.0f;
    }
    velum_profile profile = velum_profile_of(cloud->slot, *f);
    float e = velum_excess(profile, f->coverage, core_cloud_rank(cloud, f, point_m, normal, height_m));
    float lumps[2][4];
    for (int i = 0; i < 8; i++) {
        lumps[i / 4][i % 4] = cloud->phases.lump[i / 4][i % 4] * VELUM_SCUD_LUMPS;
    }
    float noise = velum_scud_noise(detail_of(cloud, f, (const float(*)[4])lumps, 1.0f, point_m),
                                   fine ? core_cloud_fine(cloud, f, point_m) : 0.5f);
    return velum_scud_1_m(profile, *f, *g, e, height_m, noise) + velum_band_1_m(profile, *f, *g, e, height_m);
}

static float fall_1_m(const core_cloud_noise *cloud, const velum_slot_fields *f, const velum_fringe *g,
                      const float point_m[3], const float normal[3], float height_m, bool fine) {
    velum_span_m span = velum_fall_span(*f, *g);
    if (!(g->fall > 0.0f) || height_m < span.low || height_m > span.high) {
        return 0.0f;
    }
    float lag_s = velum_fall_lag_s(*g, f->base_m - height_m);
    const float moved[3] = {f->wind_x_m_s * lag_s, f->wind_y_m_s * lag_s, f->wind_z_m_s * lag_s};
    float foot[3];
    foot_of(point_m, normal, height_m, moved, foot);
    velum_profile profile = velum_profile_of(cloud->slot, *f);
    float e = velum_excess(profile, f->coverage, rank_at(cloud, f, foot, normal, 0.0f));
    float streak = velum_fall_streak(core_cloud_lump(cloud, f, foot), fine ? core_cloud_fine(cloud, f, foot) : 0.5f);
    return velum_fall_1_m(profile, *f, *g, e, height_m, streak);
}

float core_cloud_fringe(const core_cloud_noise *cloud, const velum_slot_fields *fields, const velum_fringe *fringe,
                        const float point_m[3], const float normal[3], float height_m, bool fine) {
    if (fields->coverage <= 0.0f || cloud->slot >= VELUM_SLOT_UNIFORM) {
        return 0.0f;
    }
    return hem_1_m(cloud, fields, fringe, point_m, normal, height_m, fine) +
           fall_1_m(cloud, fields, fringe, point_m, normal, height_m, fine);
}
