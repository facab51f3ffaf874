#include <string.h>

#include "budget.h"
#include "shared/reference.h"

typedef struct timestamp {
    uint64_t ticks, available;
} timestamp;

/* Milliseconds between two timestamps; 0 if there are none. */
static float span_ms(const engine *e, const timestamp *results, uint32_t first) {
    if (first + 1 >= FRAME_QUERIES || !results[first].available || !results[first + 1].available ||
        results[first + 1].ticks < results[first].ticks) {
        return 0.0f;
    }
    return (float)(results[first + 1].ticks - results[first].ticks) * e->g.properties.limits.timestampPeriod * 1e-6f;
}

void stats_read(engine *e, frame_slot *slot) {
    if (slot->serial == 0 || slot->serial > e->completed_serial) {
        return;
    }
    timestamp results[FRAME_QUERIES];
    memset(results, 0, sizeof results);
    if (slot->query_count > 0) {
        /* VK_NOT_READY, where a command buffer was never submitted, leaves its availability 0. */
        VkResult result =
            e->g.GetQueryPoolResults(e->g.device, slot->queries, 0, slot->query_count, sizeof results, results,
                                     sizeof results[0], VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WITH_AVAILABILITY_BIT);
        if (result < 0) {
            memset(results, 0, sizeof results);
        }
    }
    float shared_ms = span_ms(e, results, slot->shared_query);
    float shadow_ms = 0.0f;
    for (uint32_t i = 0; i < slot->shadow_queries; i++) {
        shadow_ms += span_ms(e, results, slot->shadow_query[i]);
    }
    for (uint32_t i = 0; i < slot->record_count; i++) {
        frame_record *record = &slot->record[i];
        if (!record->v) {
            continue;
        }
        uint32_t counters[VELUM_COUNTER_WORDS];
        memcpy(counters, (const char *)slot->counters.mapped + (size_t)i * COUNTER_STRIDE, sizeof counters);
        velum_view_stats *stats = &record->v->stats;
        *stats = record->stats;
        stats->rays = counters[0];
        stats->samples = counters[1];
        stats->light_samples = counters[2];
        stats->incomplete = stats->incomplete || counters[3] > 0;
        stats->march_ms = span_ms(e, results, record->query);
        stats->resolve_ms = span_ms(e, results, record->query + 1);
        stats->shared_ms = shared_ms;
        stats->shadow_ms = shadow_ms;
        if (record->v->eye->quality == VELUM_QUALITY_REFERENCE) {
            uint32_t words[VELUM_SLICE_WORDS];
            memcpy(words,
                   (const char *)slot->counters.mapped + (size_t)i * COUNTER_STRIDE +
                       sizeof(uint32_t) * VELUM_COUNTER_WORDS,
                   sizeof words);
            if (counters[VELUM_COUNTER_ABOVE] > 0 || counters[VELUM_COUNTER_BAD] > 0) {
                log_write(&e->sink, VELUM_LOG_ERROR, record->v->name,
                          "reference: %u samples are denser than their bound, %u paths are no number: the picture is "
                          "not unbiased",
                          counters[VELUM_COUNTER_ABOVE], counters[VELUM_COUNTER_BAD]);
            }
            reference_learn(record->v, record, words, stats->march_ms);
        }
        record->v->has_stats = true;
    }
    budget_learn(e, slot);
    slot->serial = 0;
}

void stats_forget(engine *e, const view *v) {
    for (uint32_t s = 0; s < e->frames_in_flight; s++) {
        for (uint32_t i = 0; i < e->slots[s].record_count; i++) {
            if (e->slots[s].record[i].v == v) {
                e->slots[s].record[i].v = NULL;
            }
        }
    }
}
