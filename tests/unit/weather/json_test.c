#include "json.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "near.h"

static velum_result parse(json_document *document, const char *text, velum_weather_error *error) {
    memset(error, 0, sizeof *error);
    return json_document_init(document, "f.json", text, strlen(text), error);
}

static void assert_place(const json_document *document, const json_node *node, uint32_t line, uint32_t column,
                         const char *path) {
    uint32_t l = 0, c = 0;
    char text[160];
    assert_non_null(node);
    json_place(document, node, &l, &c);
    json_path(document, node, text, sizeof text);
    assert_int_equal(l, line);
    assert_int_equal(c, column);
    assert_string_equal(text, path);
}

static void every_value_has_its_place(void **state) {
    (void)state;
    velum_weather_error error;
    json_document d;
    assert_int_equal(parse(&d,
                           "{ \"a\" : [ 1,\n  {\"b\\u0041\": true , \"\xc3\xa9\":  \"x\\\"]}\", \"t\":true}, [ ], "
                           "{}],\r\n\t\"z\":-1.5e3}",
                           &error),
                     VELUM_OK);
    const json_node *root = json_document_root(&d), *a = json_member(&d, root, "a");
    assert_place(&d, root, 1, 1, "");
    assert_place(&d, a, 1, 9, "a");
    assert_int_equal(a->count, 4);
    const json_node *one = json_first(&d, a), *two = json_next(&d, one), *three = json_next(&d, two);
    assert_place(&d, one, 1, 11, "a[0]");
    assert_place(&d, two, 2, 3, "a[1]");
    assert_place(&d, json_member(&d, two, "bA"), 2, 15, "a[1].bA");
    assert_place(&d, json_member(&d, two, "\xc3\xa9"), 2, 28, "a[1].\xc3\xa9"); /* columns count characters */
    assert_place(&d, json_member(&d, two, "t"), 2, 41, "a[1].t");
    assert_place(&d, three, 2, 48, "a[2]");
    assert_place(&d, json_next(&d, three), 2, 53, "a[3]");
    assert_null(json_next(&d, json_next(&d, three)));
    assert_place(&d, json_member(&d, root, "z"), 3, 6, "z");
    assert_null(json_member(&d, root, "y"));
    assert_null(json_first(&d, three));
    double z = 0;
    assert_int_equal(json_read_double(&d, root, "z", JSON_REQUIRED, -2000, 0, &z), VELUM_OK);
    assert_near(z, -1500, 0);
    json_document_finish(&d);
    json_document_finish(&d);
    json_document_finish(NULL);
}

static void a_byte_order_mark_is_skipped(void **state) {
    (void)state;
    velum_weather_error error;
    json_document d;
    assert_int_equal(parse(&d, "\xef\xbb\xbf{\"a\":1}", &error), VELUM_OK);
    assert_place(&d, json_member(&d, json_document_root(&d), "a"), 1, 6, "a");
    json_document_finish(&d);
}

static void what_is_not_json_is_refused_where_it_stands(void **state) {
    (void)state;
    static const struct {
        const char *text, *place, *says;
    } bad[] = {
        {"", "f.json:1:1: ", "end of file"},
        {"{\"a\":\n NaN}", "f.json:2:2: ", "invalid token"},
        {"{\"a\": Infinity}", "f.json:1:7: ", "invalid token"},
        {"{\"a\": -Infinity}", "f.json:1:", "invalid token"},
        {"{\"a\": 1e999}", "f.json:1:7: ", "overflow"},
        {"{\"a\": 99999999999999999999}", "f.json:1:7: ", "too big integer"},
        {"{\"a\":1,\n\"a\":2}", "f.json:2:1: ", "duplicate object key"},
        {"{\"a\":1,}", "f.json:1:8: ", "expected near '}'"},
        {"{\"a\":1} x", "f.json:1:9: ", "end of file expected"},
        {"[1, 2", "f.json:1:6: ", "']' expected"},
        {"12", "f.json:1:1: ", "'[' or '{' expected"},
        {"{\"a\":\"\x80\"}", "f.json:1:6: ", "unable to decode byte 0x80"},
        {"{\"a\":\"\\u0000\"}", "f.json:1:", "\\u0000 is not allowed"},
        {"{'a':1}", "f.json:1:2: ", "string or '}' expected"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        velum_weather_error error;
        json_document d;
        assert_int_equal(parse(&d, bad[i].text, &error), VELUM_ERROR_ARGUMENT);
        if (strncmp(error.text, bad[i].place, strlen(bad[i].place)) != 0 || !strstr(error.text, bad[i].says)) {
            fail_msg("%s: found \"%s\", expected \"%s...%s\"", bad[i].text, error.text, bad[i].place, bad[i].says);
        }
        assert_null(d.root);
    }
}

static void depth_has_an_end(void **state) {
    (void)state;
    static char text[20000];
    velum_weather_error error;
    json_document d;
    memset(text, '[', sizeof text - 1);
    assert_int_equal(parse(&d, text, &error), VELUM_ERROR_ARGUMENT);
    memset(text, '[', 2000);
    memset(text + 2000, ']', 2000);
    text[4000] = '\0';
    assert_int_equal(parse(&d, text, &error), VELUM_OK);
    assert_int_equal(d.count, 2000);
    char path[64];
    json_path(&d, d.nodes + 1999, path, sizeof path);
    assert_int_equal(strlen(path), 63);
    json_document_finish(&d);
}

static void readers_name_field_found_and_expected(void **state) {
    (void)state;
    velum_weather_error error;
    json_document d;
    double number = 5;
    int64_t integer = 5;
    uint32_t flag = 5;
    int32_t word = 5;
    float floats[2] = {5, 5};
    const char *string = "5";
    static const json_word words[] = {{"one", 1}, {"two", 2}};
    static const char *const keys[] = {"a", "bcd", NULL};
    assert_int_equal(
        parse(&d, "{\"a\": {\"n\": 91, \"s\": \"x\\ny\", \"b\": 1, \"l\": [1, \"2\"], \"i\": 1.5}}", &error), VELUM_OK);
    const json_node *a = json_member(&d, json_document_root(&d), "a");
    assert_int_equal(json_read_double(&d, a, "n", 0, -90, 90, &number), VELUM_ERROR_ARGUMENT);
    assert_string_equal(error.text, "f.json:1:13: a.n: found 91, expected a number from -90 to 90");
    assert_int_equal(error.line, 1);
    assert_int_equal(error.column, 13);
    assert_string_equal(error.file, "f.json");
    assert_int_equal(json_read_double(&d, a, "s", 0, -90, 90, &number), VELUM_ERROR_ARGUMENT);
    assert_string_equal(error.text, "f.json:1:22: a.s: found \"x?y\", expected a number from -90 to 90");
    assert_int_equal(json_read_double(&d, a, "m", JSON_REQUIRED, 0, 1, &number), VELUM_ERROR_ARGUMENT);
    assert_string_equal(error.text, "f.json:1:7: a.m: found nothing, expected a number from 0 to 1");
    assert_int_equal(json_read_double(&d, a, "m", JSON_OPTIONAL, 0, 1, &number), VELUM_OK);
    assert_near(number, 5, 0);
    assert_int_equal(json_read_integer(&d, a, "i", 0, 0, 9, &integer), VELUM_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "a.i: found 1.5, expected an integer from 0 to 9"));
    assert_int_equal(json_read_bool(&d, a, "b", 0, &flag), VELUM_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "a.b: found 1, expected true or false"));
    assert_int_equal(json_read_word(&d, a, "s", 0, words, 2, &word), VELUM_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "expected one of one, two"));
    assert_int_equal(json_read_floats(&d, a, "l", 0, 2, 0, 9, floats), VELUM_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "a.l[1]: found \"2\", expected a number from 0 to 9"));
    assert_int_equal(json_read_floats(&d, a, "l", 0, 3, 0, 9, floats), VELUM_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "a.l: found an array of 2, expected an array of 3"));
    assert_int_equal(json_read_string(&d, a, "s", 0, 4, 9, &string), VELUM_ERROR_ARGUMENT);
    assert_int_equal(json_expect_keys(&d, a, keys), VELUM_ERROR_ARGUMENT);
    assert_string_equal(error.text, "f.json:1:8: a.n: found an unknown field, expected one of a, bcd");
    json_document_finish(&d);

    static const char *const known[] = {"layers", "visibility_m", "merge", NULL};
    assert_int_equal(parse(&d, "{\"name\": 1, \"stroke\": 2, \"layer\": 3}", &error), VELUM_OK);
    assert_int_equal(json_expect_spelling(&d, json_document_root(&d), known), VELUM_ERROR_ARGUMENT);
    assert_string_equal(error.text, "f.json:1:26: layer: found an unknown field, expected layers");
    json_document_finish(&d);
    assert_int_equal(parse(&d, "{\"name\": 1, \"stroke\": 2, \"merge\": 3, \"Visibility_M\": 1}", &error), VELUM_OK);
    assert_int_equal(json_expect_spelling(&d, json_document_root(&d), known), VELUM_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "Visibility_M: found an unknown field, expected visibility_m"));
    json_document_finish(&d);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_value_has_its_place),
        cmocka_unit_test(a_byte_order_mark_is_skipped),
        cmocka_unit_test(what_is_not_json_is_refused_where_it_stands),
        cmocka_unit_test(depth_has_an_end),
        cmocka_unit_test(readers_name_field_found_and_expected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
