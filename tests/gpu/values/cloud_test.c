/* The noise volumes through a device's filter, and cloud made of them, against core's noise. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cloud.spv.h"
#include "compute.h"
#include "core/noise.h"
#include "noise_textures.h"
#include "value_inputs.h"

enum { CASES = 1 << 17 };

static const core_noise *noise;

static float velum_shape_at(float x, float y, float z) {
    return core_noise_shape(noise, x, y, z);
}
static float velum_detail_at(float x, float y, float z) {
    return core_noise_detail(noise, x, y, z);
}

#include "case_cloud.h"

/* The greatest difference of neighbours along an axis: what an error of a filter's weight is multiplied by. */
static double steepest(const uint8_t *texels, uint32_t side) {
    int worst = 0;
    for (uint32_t z = 0; z < side; z++) {
        for (uint32_t y = 0; y < side; y++) {
            for (uint32_t x = 0; x < side; x++) {
                int here = texels[(z * side + y) * side + x];
                int next[3] = {texels[(z * side + y) * side + (x + 1) % side],
                               texels[(z * side + (y + 1) % side) * side + x],
                               texels[((z + 1) % side * side + y) * side + x]};
                for (int n = 0; n < 3; n++) {
                    worst = abs(next[n] - here) > worst ? abs(next[n] - here) : worst;
                }
            }
        }
    }
    return worst / 255.0;
}

/* Extinction of a case whose noise is that of `sampled`. */
static float extinction_of(const uint32_t *in, const uint32_t *sampled) {
    velum_slot_fields f = {.coverage = word_float(in[1]),
                           .base_m = 1000.0f,
                           .top_m = 3000.0f,
                           .extinction_1_m = 0.06f,
                           .kind = word_float(in[2])};
    return velum_slot_extinction((int)in[0], f, 1000.0f + word_float(in[3]) * 2000.0f, word_float(sampled[0]),
                                 word_float(sampled[1]), word_float(sampled[2]));
}

typedef struct errors {
    double shape, detail; /* greatest, of the filter */
    double function;      /* extinction of the same noise, over the layer's */
    double whole, rms;    /* extinction with the filter's error */
    uint32_t cloudy;
} errors;

static errors measure(const uint32_t *in, const uint32_t *got) {
    errors e = {0};
    double squares = 0.0;
    for (uint32_t i = 0; i < CASES; i++) {
        const uint32_t *words = got + i * CASE_CLOUD_OUT;
        uint32_t want[CASE_CLOUD_OUT];
        case_cloud(in + i * CASE_CLOUD_IN, want);
        double error[CASE_CLOUD_OUT];
        for (uint32_t n = 0; n < CASE_CLOUD_OUT; n++) {
            error[n] = fabs((double)word_float(words[n]) - (double)word_float(want[n]));
        }
        e.shape = fmax(e.shape, error[0]);
        e.detail = fmax(e.detail, fmax(0.5 * error[1], error[2]));
        e.whole = fmax(e.whole, error[3] / 0.06);
        squares += error[3] * error[3] / (0.06 * 0.06);
        double same = extinction_of(in + i * CASE_CLOUD_IN, words);
        e.function = fmax(e.function, fabs((double)word_float(words[3]) - same) / 0.06);
        e.cloudy += word_float(want[3]) > 0.0f;
    }
    e.rms = sqrt(squares / CASES);
    return e;
}

static void check(VkFormat format, const char *name) {
    compute_device device;
    char reason[256];
    if (!compute_open(&device, reason)) {
        print_message("no device: %s\n", reason);
        skip();
    }
    if (!compute_filters(&device, format)) {
        print_message("%s does not filter %s in 3D\n", device.name, name);
        compute_close(&device);
        skip();
    }
    uint32_t *in = calloc(CASES, sizeof *in * CASE_CLOUD_IN);
    uint32_t *got = calloc(CASES, sizeof *got * CASE_CLOUD_OUT);
    assert_true(in && got);
    noise = core_noise_built();
    for (uint32_t i = 0; i < CASES; i++) {
        fill_cloud(i, in + i * CASE_CLOUD_IN);
    }
    compute_texture shape;
    compute_texture detail;
    assert_true(noise_texture_create(&device, format, CORE_NOISE_SHAPE_SIDE, noise->shape, &shape));
    assert_true(noise_texture_create(&device, format, CORE_NOISE_DETAIL_SIDE, noise->detail, &detail));
    compute_job job = {.spirv = cloud_spirv,
                       .spirv_bytes = sizeof cloud_spirv,
                       .input = in,
                       .input_bytes = CASES * sizeof *in * CASE_CLOUD_IN,
                       .output = got,
                       .output_bytes = CASES * sizeof *got * CASE_CLOUD_OUT,
                       .invocations = CASES,
                       .textures = {&shape, &detail}};
    assert_true(compute_run(&device, &job));
    errors e = measure(in, got);
    print_message(
        "%s, %s: filter errs by %.2g (shape), %.2g (detail); extinction over the layer's by %.2g rms %.2g, of "
        "the same noise %.2g; %u of %d in cloud\n",
        device.name, name, e.shape, e.detail, e.whole, e.rms, e.function, e.cloudy, CASES);

    /* Weights have subTexelPrecisionBits bits at least (half a step wrong on each of three axes, and the place itself
     * rounded to them); a device may keep 8 bits of the result where the texture has no more. */
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(device.physical, &properties);
    double weight = 3.0 * ldexp(1.0, -(int)properties.limits.subTexelPrecisionBits);
    double result = format == VK_FORMAT_R8_UNORM ? 1.5 / 255.0 : 1e-5;
    assert_true(e.shape <= weight * steepest(noise->shape, CORE_NOISE_SHAPE_SIDE) + result);
    assert_true(e.detail <= weight * steepest(noise->detail, CORE_NOISE_DETAIL_SIDE) + result);
    assert_true(e.function <= 3e-4);
    assert_true(e.cloudy > CASES / 20);
    if (format == VK_FORMAT_R16_UNORM && device.processor) { /* queries agree with the picture within 1e-3 */
        assert_true(e.shape <= 3e-6 && e.detail <= 3e-6);
        assert_true(e.whole <= 1e-3);
    }
    compute_texture_destroy(&device, &detail);
    compute_texture_destroy(&device, &shape);
    compute_close(&device);
    free(got);
    free(in);
    noise = NULL;
}

static void cloud_of_8_bit_textures(void **state) {
    (void)state;
    check(VK_FORMAT_R8_UNORM, "R8_UNORM");
}
static void cloud_of_16_bit_textures(void **state) {
    (void)state;
    check(VK_FORMAT_R16_UNORM, "R16_UNORM");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cloud_of_8_bit_textures),
        cmocka_unit_test(cloud_of_16_bit_textures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
