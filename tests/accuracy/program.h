/* velum-accuracy: what its commands share. */
#ifndef ACCURACY_PROGRAM_H
#define ACCURACY_PROGRAM_H

#include "measure.h"

enum { PROGRAM_NAMES = 48 };

typedef struct program program;
/* Told of every picture that was compared. */
typedef bool (*program_picture_fn)(program *p, const measurement *m, const picture *found, const reference *r);

struct program {
    stage s;
    reference_options reference;
    const char *scenes[PROGRAM_NAMES]; /* none: all */
    uint32_t scene_count;
    int32_t presets[8]; /* none: all */
    uint32_t preset_count;
    const char *method; /* null: presets alone; "all", a group, a curve's name */
    double value;       /* of a method's values this alone; 0: all */
    bool json;
    const char *folder; /* of chart and tables */
    bool at_hand;       /* scenes without a reference are skipped */
    bool by_pixel;      /* charts and published figures by the error of pixels instead of means over 8 x 8 */
    program_picture_fn on_picture;
    FILE *log; /* null, or gets every measurement as it is made */
    measurement *results;
    uint32_t result_count, result_capacity;
    uint32_t skipped, failed;
    double minutes; /* for `reference`; 0: until all are good enough */
};

/* The error that is charted. */
double program_error(const program *p, const measurement *m);
bool program_wants(const program *p, const scene_row *scene);
/* Presets (if `presets`) and methods that match p->method on one scene; into p->results. */
void program_run_scene(program *p, const scene_row *scene, bool presets);

/* Goes round the scenes, and adds paths to each reference that is not good enough yet. */
int program_make_references(program *p);

/* chart.c: measures all presets on all scenes and all methods on those marked for it; SVG, PNG, tables, a page. */
int chart_run(program *p);
/* bounds.c: presets against their bounds over all scenes; 0, or 1 if one is missed. */
int bounds_run(program *p);
/* genera.c: ten genera by three suns from three places beside their references; a sheet each and a page. */
int genera_run(program *p);
/* flight.c: a strip of pictures from a flight through broken cloud, preset medium. */
int flight_run(program *p);
/* tables.c: published figures beside p->results, as ratios to each one's own base. */
void tables_write(const program *p, FILE *file);
/* stability.c: 0, or 1 if a bound is broken. */
int stability_run(program *p);

#endif
