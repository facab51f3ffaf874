/* The line of figures. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "text.h"

#include <string.h>

static void every_character_is_told_from_every_other(void **state) {
    static const char all[] = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ.,:-+/%()=_? ";
    uint8_t bits[TEXT_BITS_SIZE(64)];
    (void)state;
    assert_int_equal(text_draw(all, 64, bits), strlen(all));
    for (size_t i = 0; i + 1 < strlen(all); i++) {
        for (size_t k = i + 1; k < strlen(all); k++) {
            assert_memory_not_equal(bits + 8 * i, bits + 8 * k, 8);
        }
    }
}

static void text_is_cut_not_overrun(void **state) {
    uint8_t bits[TEXT_BITS_SIZE(4) + 1] = {0};
    (void)state;
    bits[TEXT_BITS_SIZE(4)] = 0xa5;
    assert_int_equal(text_draw("ABCDEFGH", 4, bits), 4);
    assert_int_equal(bits[TEXT_BITS_SIZE(4)], 0xa5);
    assert_int_equal(text_draw("", 4, bits), 0);
}

static void small_letters_and_strangers(void **state) {
    uint8_t small[8], capital[8], strange[8], unknown[8];
    (void)state;
    text_draw("q", 1, small);
    text_draw("Q", 1, capital);
    text_draw("\xc3", 1, strange);
    text_draw("?", 1, unknown);
    assert_memory_equal(small, capital, 8);
    assert_memory_equal(strange, unknown, 8);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_character_is_told_from_every_other),
        cmocka_unit_test(text_is_cut_not_overrun),
        cmocka_unit_test(small_letters_and_strangers),
    };
    return cmocka_run_group_tests_name("text", tests, NULL, NULL);
}
