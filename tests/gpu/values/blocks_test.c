/* Blocks that C fills are what shaders read: on a device, and by the offsets in the passes' SPIR-V. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "block_members.h"
#include "blocks_eye.spv.h"
#include "blocks_shadow_level.spv.h"
#include "blocks_view.spv.h"
#include "compute.h"
#include "march.spv.h"
#include "resolve.spv.h"
#include "shadow.spv.h"
#include "shared/arguments.h"
#include "value_inputs.h"

typedef struct member {
    const char *name;
    size_t offset;
} member;

#define EYE(name) {#name, offsetof(velum_eye_block, name)},
#define VIEW(name) {#name, offsetof(velum_view_block, name)},
#define SHADOW(name) {#name, offsetof(velum_shadow_level_block, name)},
#define SLOT(name) {#name, offsetof(velum_slot_block, name)},
static const member eye_members[] = {MEMBERS_EYE(EYE, EYE) EYE(shades) EYE(slots) EYE(fringes)};
static const member view_members[] = {MEMBERS_VIEW(VIEW, VIEW) VIEW(drifts)};
static const member shadow_members[] = {MEMBERS_SHADOW_LEVEL(SHADOW, SHADOW)};
static const member slot_members[] = {MEMBERS_SLOT(SLOT)};

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))
_Static_assert((COUNT(eye_members) - 3 + VELUM_SHADE_LEVELS + VELUM_FRINGE_PARTS) * 16 +
                       VELUM_SLOT_COUNT * sizeof(velum_slot_block) ==
                   sizeof(velum_eye_block),
               "block_members.h lacks members of velum_eye_block");
_Static_assert((COUNT(view_members) - 1 + VELUM_SHADE_LEVELS) * 16 == sizeof(velum_view_block),
               "block_members.h lacks some of velum_view_block");
_Static_assert(COUNT(shadow_members) * 16 == sizeof(velum_shadow_level_block),
               "block_members.h lacks members of velum_shadow_level_block");
_Static_assert(COUNT(slot_members) * 16 == sizeof(velum_slot_block), "block_members.h lacks some of velum_slot_block");

/* Every word is its index, plus 1, as a float. The shader copies member by member, in the order of block_members.h. */
static uint32_t pattern(size_t word) {
    return float_word((float)(word + 1));
}

static void read_back(const uint32_t *spirv, size_t spirv_bytes, size_t block_bytes, const member *members,
                      size_t count) {
    compute_device device;
    char reason[256];
    if (!compute_open(&device, reason)) {
        print_message("no device: %s\n", reason);
        skip();
    }
    const size_t words = block_bytes / 4;
    uint32_t *block = calloc(words, sizeof *block);
    uint32_t *got = calloc(words, sizeof *got);
    assert_true(block && got);
    for (size_t i = 0; i < words; i++) {
        block[i] = pattern(i);
    }
    compute_job job = {.spirv = spirv,
                       .spirv_bytes = spirv_bytes,
                       .input = block,
                       .input_bytes = block_bytes,
                       .output = got,
                       .output_bytes = block_bytes,
                       .invocations = 1};
    assert_true(compute_run(&device, &job));
    size_t at = 0;
    for (size_t n = 0; n < count; n++) {
        size_t vectors = 1;
        if (strcmp(members[n].name, "slots") == 0) {
            vectors = VELUM_SLOT_COUNT * COUNT(slot_members);
        } else if (strcmp(members[n].name, "shades") == 0 || strcmp(members[n].name, "drifts") == 0) {
            vectors = VELUM_SHADE_LEVELS;
        } else if (strcmp(members[n].name, "fringes") == 0) {
            vectors = VELUM_FRINGE_PARTS;
        }
        for (size_t i = 0; i < 4 * vectors; i++, at++) {
            if (got[at] != pattern(members[n].offset / 4 + i)) {
                fail_msg("%s, word %zu: the device reads word %g of the block", members[n].name, i,
                         (double)word_float(got[at]) - 1.0);
            }
        }
    }
    assert_int_equal(at, words);
    free(got);
    free(block);
    compute_close(&device);
}

static void device_reads_the_eye_block(void **state) {
    (void)state;
    read_back(blocks_eye_spirv, sizeof blocks_eye_spirv, sizeof(velum_eye_block), eye_members, COUNT(eye_members));
}
static void device_reads_the_view_block(void **state) {
    (void)state;
    read_back(blocks_view_spirv, sizeof blocks_view_spirv, sizeof(velum_view_block), view_members, COUNT(view_members));
}
static void device_reads_the_shadow_level_block(void **state) {
    (void)state;
    read_back(blocks_shadow_level_spirv, sizeof blocks_shadow_level_spirv, sizeof(velum_shadow_level_block),
              shadow_members, COUNT(shadow_members));
}

/* SPIR-V 1.6, section 3: opcodes and decorations. */
enum { OP_NAME = 5, OP_MEMBER_NAME = 6, OP_MEMBER_DECORATE = 72, DECORATION_OFFSET = 35 };

/* Offsets of a struct in a module against C's. Returns how many members were found. */
static size_t compare_offsets(const uint32_t *spirv, size_t bytes, const char *name, const member *members,
                              size_t count) {
    const size_t words = bytes / 4;
    size_t found = 0;
    assert_int_equal(spirv[0], 0x07230203u);
    for (size_t named = 5; named < words; named += spirv[named] >> 16u) {
        if ((spirv[named] & 0xffffu) != OP_NAME || strcmp((const char *)&spirv[named + 2], name) != 0) {
            continue;
        }
        const uint32_t id = spirv[named + 1];
        for (size_t i = 5; i < words; i += spirv[i] >> 16u) {
            uint32_t op = spirv[i] & 0xffffu;
            if (op == OP_MEMBER_NAME && spirv[i + 1] == id) {
                assert_true(spirv[i + 2] < count);
                assert_string_equal((const char *)&spirv[i + 3], members[spirv[i + 2]].name);
            } else if (op == OP_MEMBER_DECORATE && spirv[i + 1] == id && spirv[i + 3] == DECORATION_OFFSET) {
                assert_true(spirv[i + 2] < count);
                assert_int_equal(spirv[i + 4], members[spirv[i + 2]].offset);
                found++;
            }
        }
    }
    return found;
}

static void the_passes_have_the_offsets_of_c(void **state) {
    (void)state;
#define MODULE(name) velum_##name##_spv, sizeof velum_##name##_spv
    assert_int_equal(compare_offsets(MODULE(march), "velum_eye_block", eye_members, COUNT(eye_members)),
                     COUNT(eye_members));
    assert_int_equal(compare_offsets(MODULE(march), "velum_slot_block", slot_members, COUNT(slot_members)),
                     COUNT(slot_members));
    assert_int_equal(compare_offsets(MODULE(march), "velum_view_block", view_members, COUNT(view_members)),
                     COUNT(view_members));
    assert_int_equal(compare_offsets(MODULE(resolve), "velum_view_block", view_members, COUNT(view_members)),
                     COUNT(view_members));
    assert_int_equal(compare_offsets(MODULE(shadow), "velum_eye_block", eye_members, COUNT(eye_members)),
                     COUNT(eye_members));
    assert_int_equal(compare_offsets(MODULE(shadow), "velum_shadow_level_block", shadow_members, COUNT(shadow_members)),
                     COUNT(shadow_members));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(device_reads_the_eye_block),
        cmocka_unit_test(device_reads_the_view_block),
        cmocka_unit_test(device_reads_the_shadow_level_block),
        cmocka_unit_test(the_passes_have_the_offsets_of_c),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
