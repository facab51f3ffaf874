/* What the host's own passes are given, compiled as C and as GLSL (std140). */
#ifndef HOST_ARGUMENTS_H
#define HOST_ARGUMENTS_H

#ifdef __STDC__
#define HOST_VEC4(name) float name[4]
#else
#define HOST_VEC4(name) vec4 name
#endif

/* Sizes of the ground's patterns, m: regions, woods, fields, tufts. */
#define HOST_PATTERN_REGION_M 6000.0f
#define HOST_PATTERN_WOOD_M 1700.0f
#define HOST_PATTERN_FIELD_M 330.0f
#define HOST_PATTERN_TUFT_M 45.0f

/* One view in one frame. With e the eye in ECEF, D = diag(1, 1, (a/b)^2) and a ray e + t d of the unit direction d, the
 * ellipsoid is A t^2 + 2 B t + C = 0 with A = d.D d / a, B = d.g, g = D e / a, C = (e.D e - a^2) / a: C is formed in
 * double, so that nothing cancels near the ground. */
#define HOST_VIEW_ARGUMENTS                                                                                            \
    HOST_VEC4(right);         /* w: tan_left */                                                                        \
    HOST_VEC4(up);            /* w: tan_right */                                                                       \
    HOST_VEC4(forward);       /* w: tan_bottom */                                                                      \
    HOST_VEC4(gradient);      /* g; w: tan_top */                                                                      \
    HOST_VEC4(surface);       /* (a/b)^2, 1/a, C, angular size of a pixel (rad) */                                     \
    HOST_VEC4(shadow_offset); /* eye - origin of the shadow map */                                                     \
    HOST_VEC4(sun);           /* towards the sun */                                                                    \
    HOST_VEC4(sun_lx);        /* through clear air, facing the sun */                                                  \
    HOST_VEC4(sky_lx);        /* on level ground */                                                                    \
    HOST_VEC4(albedo);        /* w: strength of the pattern */                                                         \
    HOST_VEC4(region_cell);   /* of the eye: cell in each pattern; w: exposure (1 / cd/m2) */                          \
    HOST_VEC4(wood_cell);     /* w: 1 / luminance_scale */                                                             \
    HOST_VEC4(field_cell);    /* w: width of the image */                                                              \
    HOST_VEC4(tuft_cell);     /* w: height */                                                                          \
    HOST_VEC4(region_part);   /* of the eye: part of the cell, 0..1; w: overlay columns, 0: none */                    \
    HOST_VEC4(wood_part);     /* w: overlay scale */                                                                   \
    HOST_VEC4(field_part);                                                                                             \
    HOST_VEC4(tuft_part);

/* Bindings of set 0. */
#define HOST_BINDING_VIEW 0
#define HOST_BINDING_SHADOW_BLOCK 1
#define HOST_BINDING_SHADOW_MAP 2
#define HOST_BINDING_COLOUR 3
#define HOST_BINDING_DEPTH 4
#define HOST_BINDING_LUMINANCE 5
#define HOST_BINDING_TRANSMITTANCE 6
#define HOST_BINDING_PICTURE 7
#define HOST_BINDING_OVERLAY 8

#define HOST_GROUP_SIZE 8

#ifdef __STDC__
struct host_view_arguments {
    HOST_VIEW_ARGUMENTS
};
#endif

#endif
