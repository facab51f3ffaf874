/* The growing set of cells behind velum_weather_set, for the readers. */
#ifndef VELUM_WEATHER_SET_H
#define VELUM_WEATHER_SET_H

#include <stddef.h>
#include <velum_weather/weather.h>

/* A zeroed cell with struct_size, layer_stride and a fresh id; null: out of memory. The pointer holds until the next
 * cell is added. */
velum_cell *weather_set_add_cell(velum_weather_set *set);

uint32_t weather_set_cell_count(const velum_weather_set *set);
velum_cell *weather_set_cell(velum_weather_set *set, uint32_t index);

/* An id that no cell of the set has: for the cells of a grid. */
uint64_t weather_set_next_id(velum_weather_set *set);

/* Zeroed memory that lives as long as the set; null: out of memory or count * size overflows. */
void *weather_set_alloc(velum_weather_set *set, size_t count, size_t size);

/* Gives the cell `count` zeroed layers (struct_size set) and returns them; null: out of memory (or count 0). */
velum_layer *weather_set_layers(velum_weather_set *set, velum_cell *cell, uint32_t count);

/* Makes *grid the set's grid (a copy of the struct; its cells come from weather_set_alloc) in place of any earlier one.
 */
velum_result weather_set_take_grid(velum_weather_set *set, const velum_grid *grid);

/* A state to return to after an error: cells and memory made since are gone, the grid is as it was. Cells that existed
 * before must not be changed in between. */
typedef struct weather_set_mark_point {
    uint32_t cell_count;
    int has_grid;
    uint64_t next_id;
    velum_grid grid;
    void *block;
    size_t block_used;
} weather_set_mark_point;

weather_set_mark_point weather_set_mark(const velum_weather_set *set);
void weather_set_rollback(velum_weather_set *set, const weather_set_mark_point *mark);

#endif
