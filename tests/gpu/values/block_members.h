/* Members of the blocks of shared/arguments.h, in order: F of floats, U of words. */
#define MEMBERS_SLOT(F)                                                                                                \
    F(shape_0)                                                                                                         \
    F(shape_1) F(lump_0) F(lump_1) F(fine_0) F(fine_1) F(bounds) F(optics) F(profile_0) F(profile_1) F(profile_2)      \
        F(profile_3)
#define MEMBERS_EYE(F, U) F(scaled) F(position) F(up) U(table) F(weather) F(drift) F(sun) F(sun_lx) F(ground) F(span)
#define MEMBERS_VIEW(F, U)                                                                                             \
    F(right)                                                                                                           \
    F(up)                                                                                                              \
    F(forward)                                                                                                         \
    F(offset)                                                                                                          \
    F(before_right)                                                                                                    \
    F(before_up) F(before_forward) F(before_offset) F(scale) F(depth) U(size) U(march_size) U(frame) F(march) U(steps) \
        U(turn) F(room) U(study) F(before_jitter) F(study_limits)
#define MEMBERS_SHADOW_LEVEL(F, U) F(axis_u) F(axis_v) F(origin) U(window)
