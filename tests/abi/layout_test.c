/* Today's headers begin as the frozen ones: nothing moved, shrank, changed its type or its value. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "layout.h"

static const layout_struct *find_struct(const char *name) {
    for (uint32_t i = 0; i < now_struct_count; i++) {
        if (strcmp(now_structs[i].name, name) == 0) {
            return &now_structs[i];
        }
    }
    return NULL;
}

/* A reserved field may be given a name. */
static const layout_field *find_field(const layout_field *old) {
    for (uint32_t i = 0; i < now_field_count; i++) {
        const layout_field *field = &now_fields[i];
        if (strcmp(field->owner, old->owner) == 0 &&
            (strcmp(field->name, old->name) == 0 ||
             (strncmp(old->name, "reserved", 8) == 0 && field->offset == old->offset))) {
            return field;
        }
    }
    return NULL;
}

static void structs_do_not_shrink(void **state) {
    (void)state;
    assert_true(v1_struct_count >= 30);
    uint32_t wrong = 0;
    for (uint32_t i = 0; i < v1_struct_count; i++) {
        const layout_struct *now = find_struct(v1_structs[i].name);
        if (!now || now->size < v1_structs[i].size) {
            print_error("%s: %llu bytes in v1, %llu now\n", v1_structs[i].name, (unsigned long long)v1_structs[i].size,
                        now ? (unsigned long long)now->size : 0);
            wrong++;
        }
    }
    assert_int_equal(wrong, 0);
}

static void fields_do_not_move(void **state) {
    (void)state;
    assert_true(v1_field_count >= 200);
    uint32_t wrong = 0;
    for (uint32_t i = 0; i < v1_field_count; i++) {
        const layout_field *old = &v1_fields[i];
        const layout_field *now = find_field(old);
        if (!now) {
            print_error("%s.%s: gone\n", old->owner, old->name);
            wrong++;
        } else if (now->offset != old->offset || now->size != old->size ||
                   (strcmp(now->name, old->name) == 0 && strcmp(now->declaration, old->declaration) != 0)) {
            print_error("%s.%s: v1 '%s' at %llu, %llu bytes; now '%s' at %llu, %llu bytes\n", old->owner, old->name,
                        old->declaration, (unsigned long long)old->offset, (unsigned long long)old->size,
                        now->declaration, (unsigned long long)now->offset, (unsigned long long)now->size);
            wrong++;
        }
    }
    assert_int_equal(wrong, 0);
}

/* struct_size first; in a table it is the first of its fields too. */
static void structs_begin_with_their_size(void **state) {
    (void)state;
    static const char *const plain[] = {"velum_lat_lon", "velum_shadow_block"};
    uint32_t wrong = 0;
    for (uint32_t i = 0; i < now_struct_count; i++) {
        const char *name = now_structs[i].name;
        bool begins = strcmp(name, plain[0]) == 0 || strcmp(name, plain[1]) == 0;
        for (uint32_t j = 0; j < now_field_count && !begins; j++) {
            begins = strcmp(now_fields[j].owner, name) == 0 && now_fields[j].offset == 0 &&
                     strcmp(now_fields[j].declaration, "uint32_t struct_size") == 0;
        }
        if (!begins) {
            print_error("%s does not begin with struct_size\n", name);
            wrong++;
        }
    }
    assert_int_equal(wrong, 0);
}

static void constants_keep_their_values(void **state) {
    (void)state;
    assert_true(v1_constant_count >= 60);
    uint32_t wrong = 0;
    for (uint32_t i = 0; i < v1_constant_count; i++) {
        const layout_constant *now = NULL;
        for (uint32_t j = 0; j < now_constant_count && !now; j++) {
            now = strcmp(now_constants[j].name, v1_constants[i].name) == 0 ? &now_constants[j] : NULL;
        }
        if (!now || now->value != v1_constants[i].value) {
            print_error("%s: %lld in v1, %s\n", v1_constants[i].name, (long long)v1_constants[i].value,
                        now ? "another value now" : "gone now");
            wrong++;
        }
    }
    assert_int_equal(wrong, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(structs_do_not_shrink),
        cmocka_unit_test(fields_do_not_move),
        cmocka_unit_test(structs_begin_with_their_size),
        cmocka_unit_test(constants_keep_their_values),
    };
    return cmocka_run_group_tests_name("abi layout", tests, NULL, NULL);
}
