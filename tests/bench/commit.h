/* A scenario's weather into a world, for the programs of tests/ that play scenarios. */
#ifndef BENCH_COMMIT_H
#define BENCH_COMMIT_H

#include <velum/world.h>
#include <velum_weather/weather.h>

/* All keys, and the timeline. wind_east_m_s: added to the wind of all layers of cells (not of a grid's). On error the
 * world holds the states before, and some of these. */
velum_result commit_scenario(const velum_world_api *api, velum_world *world, const velum_scenario *scenario,
                             float wind_east_m_s);

#endif
