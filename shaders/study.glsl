/* Methods of others in the march, by velum_plan: in pipelines of their own (VELUM_STUDY), so that the ordinary ones pay
 * nothing for them. STUDIED(theirs, ours) stands wherever they differ. */
#ifndef VELUM_STUDY_GLSL
#define VELUM_STUDY_GLSL

#include "shared/slab.h"

/* Mean cosines of velum_phase_cloud (shared/phase.h). */
const float study_g_water = 0.8793;
const float study_g_ice = 0.75;

#ifdef VELUM_STUDY
#define STUDIED(theirs, ours) (theirs)

#define VELUM_SHADOW_SET 0
#define VELUM_SHADOW_BLOCK_BINDING VELUM_BIND_SHADOW_BLOCK
#define VELUM_SHADOW_MAP_BINDING VELUM_BIND_SHADOW
#include "velum/velum_shadow.glsl"

bool study_flag(uint flag) {
    return (view.study.x & flag) != 0u;
}

/* Steps that look for cloud are as long as those in it: there is no looking. */
bool study_all_alike() {
    return view.study_limits.x == 0.0;
}

/* Whether a step takes the base shape for the cloud. */
bool study_base(bool is_short) {
    return study_flag(VELUM_STUDY_BASE_SEARCH) && !is_short;
}

/* Whether a step is done with though it found nothing: what looked like cloud is not looked at again. */
bool study_crossed(bool is_short) {
    return study_flag(VELUM_STUDY_BASE_SEARCH) && is_short;
}

float study_thinned(float extinction_1_m, float mean_1_m) {
    return extinction_1_m < view.study_limits.y * mean_1_m ? 0.0 : extinction_1_m;
}

/* Share of a step's source that reaches the eye. */
float study_share(float through, float depth) {
    float after = exp(-depth);
    float before_share = through * depth;
    float after_share = through * after * depth;
    uint integrator = view.study.y;
    return integrator == VELUM_STUDY_BEFORE      ? before_share
           : integrator == VELUM_STUDY_AFTER     ? after_share
           : integrator == VELUM_STUDY_TRAPEZOID ? 0.5 * (before_share + after_share)
                                                 : through * velum_opacity(depth, after);
}

/* These take the light of a step from one place of it in uniform layers, too. */
bool study_at_point() {
    return view.study.y != 0u;
}

bool study_sun_lumps() {
    return view.study.w != VELUM_STUDY_SUN_COARSE;
}

float study_sun_fine(int slot, velum_slot_fields f, vec3 r) {
    float fine = 0.5;
    if (view.study.w == VELUM_STUDY_SUN_FINE) {
        fine = fine_noise(slot, f, r);
    }
    return fine;
}

int study_sun_steps(int steps) {
    return view.study.w == VELUM_STUDY_SUN_MAP ? 0 : steps;
}

/* Instead of `depth`, of no samples then. */
float study_sun_depth(vec3 r, float depth) {
    if (view.study.w == VELUM_STUDY_SUN_MAP) {
        depth = -log(clamp(velum_shadow(r), 1.0e-7, 1.0));
    }
    return depth;
}

/* What octaves work on: the first order's phase function, the asymmetry of the next ones; depths towards the sun, and
 * up and down to the light of sky and ground. */
struct study_light {
    vec3 sun;
    vec3 above, below; /* mean luminance of the half spheres */
    float first, g, cos_sun;
    float depth, depth_above, depth_below;
};

bool study_volume() {
    return view.study.z == VELUM_STUDY_VOLUME;
}

bool study_octaves() {
    return view.study.z == VELUM_STUDY_OCTAVES;
}

/* Wrenninge, Kulla & Lundqvist 2013, with a = b = c = 0.5. */
vec3 study_octave_source(study_light light) {
    vec3 sum = vec3(0.0);
    float share = 1.0;
    for (uint i = 0u; i < view.steps.z; ++i) {
        float phase = i == 0u ? light.first : velum_phase_hg(light.cos_sun, light.g * share);
        vec3 ambient = light.above * exp(-share * light.depth_above) + light.below * exp(-share * light.depth_below);
        sum += share * (light.sun * phase * exp(-share * light.depth) + 0.5 * ambient);
        share *= 0.5;
    }
    return sum;
}

#else
#define STUDIED(theirs, ours) (ours)
#endif
#endif
