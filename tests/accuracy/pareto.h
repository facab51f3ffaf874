/* The front of best trades: what nothing else beats in both cost and error. */
#ifndef ACCURACY_PARETO_H
#define ACCURACY_PARETO_H

#include <stdbool.h>
#include <stdint.h>

typedef struct pareto_point {
    double cost, error;
    bool on_front;
} pareto_point;

/* Sets on_front of each point that no other beats: none is at most as dear and at most as wrong, and less in one.
 * Equal points share the front. Points with a NaN are never on it. */
void pareto_mark(pareto_point *points, uint32_t count);

#endif
