/* Work of one lane in segments, each an invocation's own, side by side: where few lanes are due they do not fill a GPU,
 * and a pass takes as long as the longest of them. A few fill software devices, which have one segment a lane. */
#ifndef VELUM_SEGMENTS_GLSL
#define VELUM_SEGMENTS_GLSL

#include "shared/arguments.h"

layout(constant_id = 9) const bool velum_segmented = false;

/* As many as the dispatch has layers: a power of two, up to all lanes of a group. */
uint segment_count() {
    return velum_segmented ? gl_NumWorkGroups.z : 1u;
}
uint segment_here() {
    return velum_segmented ? gl_LocalInvocationIndex % segment_count() : 0u;
}

/* An invocation's lane, of the 64 that a group and its like in other layers have. */
uint segment_lane() {
    uint lanes = uint(VELUM_GROUP * VELUM_GROUP) / segment_count();
    return velum_segmented ? gl_WorkGroupID.z * lanes + gl_LocalInvocationIndex / segment_count()
                           : gl_LocalInvocationIndex;
}

#endif
