/* SPDX-License-Identifier: MIT */
/* test_config_tree.c: configuration files: what is read, and how errors are reported.
 * One test case alone: CK_RUN_CASE=reading ./test_config_tree */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "text/config_tree.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

static char *said; /* what went to `errors` */
static size_t said_length;
static FILE *errors;

static void setup(void)
{
    errors = open_memstream(&said, &said_length);
    ck_assert_ptr_nonnull(errors);
}

static void teardown(void)
{
    fclose(errors);
    free(said);
}

static struct config_tree *read_text(const char *text)
{
    return config_read("file", text, strlen(text), errors);
}

static struct config_tree *read_well(const char *text)
{
    struct config_tree *tree = read_text(text);
    fflush(errors);
    ck_assert_msg(tree != NULL, "refused: %s", said);
    return tree;
}

static void assert_said(const char *expected)
{
    fflush(errors);
    ck_assert_str_eq(said, expected);
}

static void assert_refused(const char *text, const char *expected)
{
    ck_assert_ptr_null(read_text(text));
    assert_said(expected);
}

/* ---- What is read --------------------------------------------------------------------------------------------------- */

START_TEST(maps_and_lists_keep_their_order_and_their_places)
{
    struct config_tree *tree = read_well("# a comment\nmotors:\n  - steps: 200\n    names: [a, \"b\"]\nlast: x\n");
    const struct config_node *root = config_root(tree);
    ck_assert_int_eq(config_type(root), CONFIG_MAP);
    ck_assert_uint_eq(config_count(root), 2);
    ck_assert_str_eq(config_key(root, 0), "motors");
    ck_assert_str_eq(config_key(root, 1), "last");
    const struct config_node *motor = config_at(config_get(root, "motors"), 0);
    ck_assert_str_eq(config_text(config_get(motor, "steps")), "200");
    const struct config_node *names = config_get(motor, "names");
    ck_assert_int_eq(config_type(names), CONFIG_LIST);
    ck_assert_str_eq(config_text(config_at(names, 1)), "b");
    ck_assert_uint_eq(config_line(config_at(names, 1)), 4);
    ck_assert_uint_eq(config_column(config_at(names, 1)), 16);
    config_free(tree);
}
END_TEST

START_TEST(what_is_not_there_is_NULL)
{
    struct config_tree *tree = read_well("a: [1]\n");
    const struct config_node *root = config_root(tree);
    ck_assert_ptr_null(config_get(root, "b"));
    ck_assert_ptr_null(config_at(root, 1));
    ck_assert_ptr_null(config_key(root, 1));
    ck_assert_ptr_null(config_get(config_get(root, "a"), "b"));
    ck_assert_ptr_null(config_text(root));
    config_free(tree);
}
END_TEST

START_TEST(JSON_is_read_too)
{
    struct config_tree *tree = read_well("{\"a\": {\"b\": [1, 2]}}");
    ck_assert_str_eq(config_text(config_at(config_get(config_get(config_root(tree), "a"), "b"), 1)), "2");
    config_free(tree);
}
END_TEST

START_TEST(block_texts_keep_their_lines)
{
    struct config_tree *tree = read_well("program: |\n  \\ S100\n  F200 R { : # }\n");
    ck_assert_str_eq(config_text(config_get(config_root(tree), "program")), "\\ S100\nF200 R { : # }\n");
    config_free(tree);
}
END_TEST

START_TEST(whole_numbers_are_read_within_their_limits)
{
    struct config_tree *tree = read_well("[-5, 007, 9223372036854775807]");
    const struct config_node *root = config_root(tree);
    int64_t value;
    ck_assert(config_integer(config_at(root, 0), "an offset", -5, 5, &value));
    ck_assert_int_eq(value, -5);
    ck_assert(config_integer(config_at(root, 1), "an offset", 0, 7, &value));
    ck_assert_int_eq(value, 7);
    ck_assert(config_integer(config_at(root, 2), "an offset", 0, INT64_MAX, &value));
    ck_assert_int_eq(value, INT64_MAX);
    config_free(tree);
}
END_TEST

static const char *const wrong_integers[][2] = {
    {"[6]", "file:1:2: error: expected an offset, a whole number -5..5, found 6\n"},
    {"[5x]", "file:1:2: error: expected an offset, a whole number -5..5, found 5x\n"},
    {"[ 1.5]", "file:1:3: error: expected an offset, a whole number -5..5, found 1.5\n"},
    {"[-]", "file:1:2: error: expected an offset, a whole number -5..5, found -\n"},
    {"['']", "file:1:2: error: expected an offset, a whole number -5..5, found nothing\n"},
    {"[[]]", "file:1:2: error: expected an offset, a whole number -5..5, found a list\n"},
    {"[{}]", "file:1:2: error: expected an offset, a whole number -5..5, found a map\n"},
    {"[99999999999999999999]", "file:1:2: error: expected an offset, a whole number -5..5, found 99999999999999999999\n"},
    {"[\"a\\nb\"]", "file:1:2: error: expected an offset, a whole number -5..5, found a b\n"},
};

START_TEST(what_is_no_whole_number_is_named)
{
    struct config_tree *tree = read_well(wrong_integers[_i][0]);
    int64_t value = 77;
    ck_assert(!config_integer(config_at(config_root(tree), 0), "an offset", -5, 5, &value));
    assert_said(wrong_integers[_i][1]);
    ck_assert_int_eq(value, 77);
    config_free(tree);
}
END_TEST

START_TEST(a_long_text_is_cut_in_messages)
{
    struct config_tree *tree = read_well("[aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa]");
    bool value;
    ck_assert(!config_flag(config_at(config_root(tree), 0), "a flag", &value));
    assert_said("file:1:2: error: expected a flag, true or false, found aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa...\n");
    config_free(tree);
}
END_TEST

START_TEST(times_have_a_unit)
{
    struct config_tree *tree = read_well("[1.5ms, 5]");
    uint64_t ticks = 0;
    ck_assert(config_time(config_at(config_root(tree), 0), "the end", &ticks));
    ck_assert_uint_eq(ticks, 1500);
    ck_assert(!config_time(config_at(config_root(tree), 1), "the end", &ticks));
    assert_said("file:1:9: error: expected the end, a time with its unit, such as 250us, 1500ms or 2.5s, found 5\n");
    config_free(tree);
}
END_TEST

START_TEST(flags_have_many_names)
{
    struct config_tree *tree = read_well("[true, yes, on, 1, false, no, off, 0]");
    for (size_t i = 0; i < 8; i++) {
        bool value = i >= 4;
        ck_assert(config_flag(config_at(config_root(tree), i), "it", &value));
        ck_assert_int_eq(value, i < 4);
    }
    config_free(tree);
}
END_TEST

START_TEST(every_unknown_key_is_reported_with_its_place)
{
    static const char *const names[] = {"from", "to", "at", NULL};
    struct config_tree *tree = read_well("form: 1\nto:\n  2\nta: 3\n");
    ck_assert(!config_keys(config_root(tree), names));
    assert_said("file:1:1: error: expected from, to or at, found \"form\"; did you mean `from'?\n"
                "file:4:1: error: expected from, to or at, found \"ta\"; did you mean `to'?\n");
    config_free(tree);
}
END_TEST

START_TEST(as_JSON_whole_numbers_and_truth_are_themselves_and_the_rest_is_text)
{
    struct config_tree *tree = read_well("{a: 5, b: -7, c: 01, d: 'true', e: true, f: ~, g: 1.5s, h: [\"5\", 0, no, -0, +1], i: ,"
                                         " j: 99999999999999999999}");
    json_t *json = config_json(config_root(tree));
    char *text = json_dumps(json, JSON_COMPACT);
    ck_assert_str_eq(text, "{\"a\":5,\"b\":-7,\"c\":\"01\",\"d\":\"true\",\"e\":true,\"f\":null,\"g\":\"1.5s\","
                           "\"h\":[\"5\",0,\"no\",\"-0\",\"+1\"],\"i\":null,\"j\":\"99999999999999999999\"}");
    free(text);
    json_decref(json);
    config_free(tree);
}
END_TEST

/* ---- What is refused ------------------------------------------------------------------------------------------------ */

static const char *const refusals[][2] = {
    {"", "file:1:1: error: expected a document, found nothing\n"},
    {"# nothing\n", "file:2:1: error: expected a document, found nothing\n"},
    {"a: 1\nb: 2\na: 3\n", "file:3:1: error: expected each key once, found \"a\" again (first in line 1)\n"},
    {"a: &x 1\n", "file:1:4: error: expected no anchors and no tags (quote a text that begins with & or !)\n"},
    {"a: !!int 1\n", "file:1:4: error: expected no anchors and no tags (quote a text that begins with & or !)\n"},
    {"a: &x [1]\n", "file:1:4: error: expected no anchors and no tags\n"},
    {"a: !t {b: 1}\n", "file:1:4: error: expected no anchors and no tags\n"},
    {"a: *x\n", "file:1:4: error: expected no aliases (quote a text that begins with *)\n"},
    {"? [1]\n: 2\n", "file:1:3: error: expected a word as key\n"},
    {"a: 1\n---\nb: 2\n", "file:2:1: error: expected one document\n"},
    {"a: \"x\\0y\"\n", "file:1:4: error: expected text without the character 0\n"},
    {"\"x\\0y\": 1\n", "file:1:1: error: expected text without the character 0\n"},
    {"a: [1, 2\nb: 3\n",
     "file:2:2: error: expected YAML: did not find expected ',' or ']' while parsing a flow sequence (line 1)\n"},
    {"a: b: c\n", "file:1:5: error: expected YAML: mapping values are not allowed in this context while reading (line 1)\n"},
};

START_TEST(what_cannot_be_read_is_refused_with_its_place)
{
    assert_refused(refusals[_i][0], refusals[_i][1]);
}
END_TEST

START_TEST(text_that_is_not_UTF_8_is_refused)
{
    ck_assert_ptr_null(read_text("a: \xff\n"));
    fflush(errors);
    ck_assert_msg(strstr(said, "expected text in UTF-8, found something else at byte 3") != NULL, "%s", said);
}
END_TEST

START_TEST(lists_within_lists_end_somewhere)
{
    static char text[100000];
    memset(text, '[', sizeof text - 1);
    assert_refused(text, "file:1:33: error: expected at most 32 levels of lists and maps\n");
}
END_TEST

START_TEST(maps_have_a_limit)
{
    char text[8000];
    size_t at = 0;
    for (unsigned i = 0; i <= 256; i++)
        at += (size_t)snprintf(text + at, sizeof text - at, "k%u: 1\n", i);
    assert_refused(text, "file:257:1: error: expected at most 256 keys\n");
}
END_TEST

/* Whatever it is, it is read or refused with a message, and nothing is lost (the sanitizers look). */
START_TEST(texts_with_one_character_changed_are_read_or_refused_with_a_message)
{
    static const char good[] = "a:\n  - {b: [1, 'x'], \"c\": |-\n    }\n  - d: >\n      text\n    e: ~\n";
    static const char other[] = "\n\t :-?[]{}'\"&*!|>%@#,\\0a\x7f\xc3";
    for (size_t at = 0; at < sizeof good - 1; at++) {
        for (size_t i = 0; i < sizeof other; i++) {
            char text[sizeof good];
            memcpy(text, good, sizeof good);
            text[at] = other[i];
            fflush(errors);
            size_t before = said_length;
            struct config_tree *tree = config_read("file", text, sizeof good - 1, errors);
            fflush(errors);
            ck_assert(tree ? said_length == before : said_length > before);
            config_free(tree);
        }
    }
}
END_TEST

START_TEST(a_text_with_too_many_values_is_refused_where_they_begin)
{
    const size_t values = 70000;
    char *text = malloc(2 * values + 2), *to = text;
    ck_assert_ptr_nonnull(text);
    *to++ = '[';
    for (size_t i = 0; i < values; i++) {
        *to++ = '1';
        *to++ = ',';
    }
    strcpy(to - 1, "]");
    assert_refused(text, "file:1:131072: error: expected at most 65536 values, lists and maps in all\n");
    free(text);
}
END_TEST

START_TEST(errors_have_a_limit)
{
    static const char *const names[] = {"name", NULL};
    struct config_tree *tree = read_well("a: 1\nb: 2\n");
    for (unsigned i = 0; i < 499; i++)
        ck_assert(!config_keys(config_root(tree), names));
    for (unsigned i = 0; i < 5; i++)
        ck_assert(!config_error(config_root(tree), "expected more, for the time %u", i));
    ck_assert(!config_keys(config_root(tree), names));
    config_free(tree);
    fflush(errors);
    ck_assert_ptr_nonnull(strstr(said, "for the time 1\nfile: 5 more errors are not shown\n"));
}
END_TEST

START_TEST(characters_that_cannot_be_seen_are_named)
{
    static const char *const names[] = {"name", "steps", NULL};
    struct config_tree *tree = read_well("name: x\n\xC2\xA0steps: 1\n");
    ck_assert(!config_keys(config_root(tree), names));
    config_free(tree);
    fflush(errors);
    ck_assert_ptr_nonnull(strstr(said, "found \"\xC2\xA0steps\"; there is a no-break space (U+00A0) in it\n"));
    ck_assert_ptr_null(read_text("a: 1\n\xE2\x80\x8B" "a: 2\n\xE2\x80\x8B" "a: 3\n"));
    fflush(errors);
    ck_assert_ptr_nonnull(strstr(said, "(first in line 2); there is a zero-width space (U+200B) in it\n"));
}
END_TEST

static Suite *config_tree_suite(void)
{
    Suite *suite = suite_create("config_tree");
    TCase *reading = tcase_create("reading");
    tcase_add_checked_fixture(reading, setup, teardown);
    tcase_add_test(reading, a_text_with_too_many_values_is_refused_where_they_begin);
    tcase_add_test(reading, maps_and_lists_keep_their_order_and_their_places);
    tcase_add_test(reading, what_is_not_there_is_NULL);
    tcase_add_test(reading, JSON_is_read_too);
    tcase_add_test(reading, block_texts_keep_their_lines);
    tcase_add_test(reading, whole_numbers_are_read_within_their_limits);
    tcase_add_loop_test(reading, what_is_no_whole_number_is_named, 0, COUNT(wrong_integers));
    tcase_add_test(reading, a_long_text_is_cut_in_messages);
    tcase_add_test(reading, times_have_a_unit);
    tcase_add_test(reading, flags_have_many_names);
    tcase_add_test(reading, every_unknown_key_is_reported_with_its_place);
    tcase_add_test(reading, as_JSON_whole_numbers_and_truth_are_themselves_and_the_rest_is_text);
    suite_add_tcase(suite, reading);

    TCase *refusing = tcase_create("refusing");
    tcase_add_checked_fixture(refusing, setup, teardown);
    tcase_add_loop_test(refusing, what_cannot_be_read_is_refused_with_its_place, 0, COUNT(refusals));
    tcase_add_test(refusing, text_that_is_not_UTF_8_is_refused);
    tcase_add_test(refusing, errors_have_a_limit);
    tcase_add_test(refusing, characters_that_cannot_be_seen_are_named);
    tcase_add_test(refusing, lists_within_lists_end_somewhere);
    tcase_add_test(refusing, maps_have_a_limit);
    tcase_add_test(refusing, texts_with_one_character_changed_are_read_or_refused_with_a_message);
    suite_add_tcase(suite, refusing);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(config_tree_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed > 0)
        puts("one test case alone: CK_RUN_CASE=reading|refusing ./test_config_tree");
    return failed > 0;
}
