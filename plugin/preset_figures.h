/* What the presets came to when they were last measured: tests/report/accuracy/README.md, "Presets", over all scenes.
 * A new chart belongs here (test `plugin-preset-figures` compares). */
#ifndef PLUGIN_PRESET_FIGURES_H
#define PLUGIN_PRESET_FIGURES_H

#include <stdint.h>

enum { PRESETS = 4 };

typedef struct preset_figures {
    float error;   /* relative, of means over 8 x 8, settled */
    float samples; /* a pixel, one ray for 16 */
} preset_figures;

/* Low, medium, high, ultra. */
static const preset_figures preset_figures_of[PRESETS] = {
    {0.092f, 2.6f}, {0.093f, 3.4f}, {0.092f, 5.4f}, {0.093f, 6.6f}};

/* The cheapest whose error is not above this; where there is none, the cheapest of those with the least. */
static inline uint32_t preset_for_error(float error) {
    uint32_t best = 0;
    for (uint32_t i = 0; i < PRESETS; i++) {
        if (preset_figures_of[i].error <= error) {
            return i;
        }
        best = preset_figures_of[i].error < preset_figures_of[best].error ? i : best;
    }
    return best;
}

#endif
