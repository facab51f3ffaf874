#include "arguments.h"
#include "world.h"

velum_result world_query_point(world *w, const velum_point_query *query, velum_point_answer *out) {
    (void)query, (void)out;
    return log_fail(&w->sink, VELUM_ERROR_UNSUPPORTED, "world", "query_point: not there yet");
}

velum_result world_query_line(world *w, const velum_line_query *query, velum_line_answer *out) {
    (void)query, (void)out;
    return log_fail(&w->sink, VELUM_ERROR_UNSUPPORTED, "world", "query_line: not there yet");
}
