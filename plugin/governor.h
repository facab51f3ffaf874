/* How an eye keeps a time: what finished frames took, to the rays and steps of the next. Pure: no clock, no device. The
 * same times in the same order give the same settings. */
#ifndef PLUGIN_GOVERNOR_H
#define PLUGIN_GOVERNOR_H

#include <stdbool.h>
#include <stdint.h>

enum { GOVERNOR_FINER_MOST = 14 }; /* two in nine: velum_plan.finer_blocks */

typedef struct governor_setting {
    uint32_t ray_rate; /* pixels a ray: a power of two, 1..64 */
    float preset;      /* steps: 0 low, 1 medium, 2 high, 3 ultra, or between */
    uint32_t finer;    /* blocks of each 64 that may have four rays: 0..GOVERNOR_FINER_MOST */
    uint32_t epoch;    /* frames of an earlier one teach nothing */
} governor_setting;

typedef struct governor_frame {
    governor_setting setting;
    float march_ms; /* goes with rays and steps */
    float other_ms; /* does not */
} governor_frame;

typedef enum governor_doing {
    GOVERNOR_BEGINS, /* too few frames have finished */
    GOVERNOR_KEEPS,
    GOVERNOR_FALLS,
    GOVERNOR_RISES,
    GOVERNOR_WAITS, /* under, but twice the rays would be too dear, or have just proved so */
    GOVERNOR_LEAST, /* and still over */
    GOVERNOR_MOST   /* and still under */
} governor_doing;

/* Log2 of a time that changes and is noisy. */
typedef struct governor_track {
    float newest[3];
    uint32_t next, known; /* place of the next of newest; frames so far */
    float value;
    float error, spread; /* mean of what is newest less value, and of its size */
} governor_track;

typedef struct governor {
    float budget_ms;
    uint32_t first_preset;
    governor_setting most;
    governor_track cost, rest; /* march ms of one ray for 64 pixels at low; other ms */
    float power;               /* march time goes with this power of a preset's samples: learnt too */
    governor_frame newest;     /* learnt from; ray_rate 0: none */
    uint32_t density;          /* log2 of 64 / ray_rate */
    float steps;               /* log2 of samples over those of low */
    uint32_t finer;            /* as in a setting */
    bool rises;
    uint32_t since_denser, hold, hold_next; /* frames */
    uint32_t epoch;
    governor_doing doing;
} governor;

/* It begins with one ray for 16 pixels at the steps of a preset, and is never better than `most`. */
void governor_init(governor *g, float budget_ms, uint32_t first_preset, governor_setting most);
/* Another scene: what was learnt is forgotten, and it begins no better than at first. */
void governor_reset(governor *g);
void governor_learn(governor *g, const governor_frame *frame);
/* Once a frame in which rays and steps count. */
governor_setting governor_next(governor *g);
/* As governor_next left it. */
governor_setting governor_now(const governor *g);
/* What a frame so made should take; 0: nothing learnt yet. */
float governor_expected_ms(const governor *g);
/* Log2 of its march time over that of one ray for 64 pixels at low. */
float governor_octaves(const governor *g);

#endif
