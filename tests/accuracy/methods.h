/* What is compared: each row is a curve, its values the points on it. A new curve is a new row. */
#ifndef ACCURACY_METHODS_H
#define ACCURACY_METHODS_H

#include <velum/engine.h>

enum { METHOD_VALUES = 12 };

/* How the camera or the weather moves while a row is measured; the last frame stands where the scene's camera does. */
typedef enum method_motion {
    MOTION_STILL = 0,
    MOTION_FORWARD, /* 250 m/s */
    MOTION_ROLL,    /* 60 degrees a second */
    MOTION_WIND     /* 50 m/s more from the west */
} method_motion;

typedef struct method_row {
    const char *group; /* of curves in one chart; a file's name */
    const char *name;
    const char *unit; /* of the values */
    int32_t quality;  /* the plan that is changed */
    uint32_t frames;  /* after a cut; the last is compared */
    method_motion motion;
    void (*set)(velum_plan *plan, double value);
    uint32_t count;
    double values[METHOD_VALUES];
} method_row;

extern const method_row method_rows[]; /* ends with a null group */

/* What a group's curves tend to: the error against its picture is that of what the rows change, alone. Null: nothing.
 */
const method_row *method_limit(const char *group);

/* By group, or by name. */
int method_matches(const method_row *row, const char *text);

#endif
