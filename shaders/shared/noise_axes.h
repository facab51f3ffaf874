/* Noise coordinates: a fixed rotation, so that the texture's axes lie along no meridian or parallel anywhere, then the
 * slot's period. Phases at the eye (rotation of the eye's ECEF position over the period, modulo 1, plus the seed's and
 * the drift cycle's offset) come from the CPU in double. Rows of the rotation: */
#ifndef VELUM_NOISE_AXES_H
#define VELUM_NOISE_AXES_H

#define VELUM_NOISE_AX 0.612478317f
#define VELUM_NOISE_AY 0.659745974f
#define VELUM_NOISE_AZ 0.435437207f
#define VELUM_NOISE_BX (-0.778383623f)
#define VELUM_NOISE_BY 0.407325232f
#define VELUM_NOISE_BZ 0.477708165f
#define VELUM_NOISE_CX 0.137801477f
#define VELUM_NOISE_CY (-0.631523084f)
#define VELUM_NOISE_CZ 0.763013334f

#endif
