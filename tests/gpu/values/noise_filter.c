/* On demand: error and speed of the device's filter over the noise volumes, by texture format. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "compute.h"
#include "core/noise.h"
#include "filter.spv.h"
#include "filter_speed.spv.h"
#include "noise_textures.h"
#include "shared/hash.h"

enum { PLACES = 1 << 18, RAYS = 1 << 16, STEPS = 64 };

static void print_error(const char *format, const char *volume, const float *at, const uint32_t *words, uint32_t which,
                        float (*expected)(const core_noise *, float, float, float), const core_noise *noise) {
    double worst = 0.0;
    double sum = 0.0;
    double squares = 0.0;
    for (uint32_t i = 0; i < PLACES; i++) {
        float got;
        memcpy(&got, &words[2 * i + which], sizeof got);
        double error = (double)got - (double)expected(noise, at[3 * i], at[3 * i + 1], at[3 * i + 2]);
        worst = fmax(worst, fabs(error));
        sum += error;
        squares += error * error;
    }
    printf("%-11s %-6s error: greatest %.6f, rms %.6f, mean %+.6f\n", format, volume, worst, sqrt(squares / PLACES),
           sum / PLACES);
}

int main(void) {
    compute_device device;
    char reason[256];
    if (!compute_open(&device, reason)) {
        fprintf(stderr, "%s\n", reason);
        return 77;
    }
    printf("%s\n", device.name);
    int status = 1;
    const core_noise *noise = core_noise_built();
    float *places = malloc(sizeof *places * 3 * PLACES);
    uint32_t *words = malloc(sizeof *words * 2 * PLACES);
    if (!places || !words) {
        goto error;
    }
    for (uint32_t i = 0; i < 3 * PLACES; i++) {
        places[i] = velum_hash_unit(velum_hash(i));
    }
    static const struct {
        VkFormat format;
        const char *name;
    } formats[] = {
        {VK_FORMAT_R8_UNORM, "R8_UNORM"}, {VK_FORMAT_R16_UNORM, "R16_UNORM"}, {VK_FORMAT_R32_SFLOAT, "R32_SFLOAT"}};
    for (size_t f = 0; f < sizeof formats / sizeof formats[0]; f++) {
        if (!compute_filters(&device, formats[f].format)) {
            printf("%-11s no linear filter\n", formats[f].name);
            continue;
        }
        compute_texture shape;
        compute_texture detail;
        bool made = noise_texture_create(&device, formats[f].format, CORE_NOISE_SHAPE_SIDE, noise->shape, &shape) &&
                    noise_texture_create(&device, formats[f].format, CORE_NOISE_DETAIL_SIDE, noise->detail, &detail);
        if (!made) {
            goto error;
        }
        compute_job filter = {.spirv = filter_spirv,
                              .spirv_bytes = sizeof filter_spirv,
                              .input = places,
                              .input_bytes = sizeof *places * 3 * PLACES,
                              .output = words,
                              .output_bytes = sizeof *words * 2 * PLACES,
                              .invocations = PLACES,
                              .textures = {&shape, &detail}};
        if (!compute_run(&device, &filter)) {
            goto error;
        }
        print_error(formats[f].name, "shape", places, words, 0, core_noise_shape, noise);
        print_error(formats[f].name, "detail", places, words, 1, core_noise_detail, noise);
        static const uint32_t steps[] = {2, 8, 60};
        for (uint32_t s = 0; s < 3; s++) {
            for (uint32_t volume = 0; volume < 2; volume++) {
                compute_job speed = {.spirv = filter_speed_spirv,
                                     .spirv_bytes = sizeof filter_speed_spirv,
                                     .input = &steps[s],
                                     .input_bytes = sizeof steps[s],
                                     .output = words,
                                     .output_bytes = sizeof *words * RAYS,
                                     .invocations = RAYS,
                                     .textures = {volume ? &detail : &shape},
                                     .repeats = 7};
                if (!compute_run(&device, &speed)) {
                    goto error;
                }
                printf("%-11s %-6s step %.3f of the period: %.1f million samples/s\n", formats[f].name,
                       volume ? "detail" : "shape", 0.001 * steps[s], 1e-6 * RAYS * STEPS / speed.seconds);
            }
        }
        compute_texture_destroy(&device, &shape);
        compute_texture_destroy(&device, &detail);
    }
    status = 0;
error:
    free(words);
    free(places);
    compute_close(&device);
    return status;
}
