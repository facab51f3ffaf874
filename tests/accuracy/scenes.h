/* The scenes that everything is measured on: scenarios in scenes/NAME.json, which velum-host plays too. */
#ifndef ACCURACY_SCENES_H
#define ACCURACY_SCENES_H

#include <stdbool.h>
#include <stdint.h>

typedef struct scene_row {
    const char *name;
    const char *about;
    bool real;  /* needs the forecast and the reports of VELUM_SHARED */
    bool sweep; /* methods are compared on it */
} scene_row;

extern const scene_row scene_rows[]; /* ends with a null name */

const scene_row *scene_find(const char *name);

#endif
