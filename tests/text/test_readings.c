/* SPDX-License-Identifier: MIT */
/* test_readings.c: names, values and texts of the readings (specification section 9). One case alone:
 * CK_RUN_CASE=CASE ./test_readings */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "text/readings.h"

/* The canonical text of what was read, or the error. */
static const char *read_text(const char *text)
{
    static char out[READINGS_TEXT_SIZE], error[READINGS_ERROR_SIZE];
    struct rkm04_readings readings = {0};
    readings_set named = 0;
    if (!readings_read(&readings, &named, text, error))
        return error;
    return readings_text(&readings, out);
}

static const char *read_json(const char *text)
{
    static char out[READINGS_TEXT_SIZE], error[READINGS_ERROR_SIZE];
    struct rkm04_readings readings = {0};
    json_t *json = json_loads(text, JSON_DECODE_ANY, NULL);
    ck_assert_ptr_nonnull(json);
    bool ok = readings_read_json(&readings, json, error);
    json_decref(json);
    return ok ? readings_text(&readings, out) : error;
}

/* The canonical text of a map of YAML, or what was reported. */
static const char *read_map(const char *text)
{
    static char out[READINGS_TEXT_SIZE], *said;
    size_t length;
    struct rkm04_readings readings = {0};
    readings_set named = 0;
    free(said);
    FILE *errors = open_memstream(&said, &length);
    struct config_tree *tree = config_read("x", text, strlen(text), errors);
    bool ok = tree && readings_read_map(&readings, &named, config_root(tree));
    config_free(tree);
    fclose(errors);
    return ok ? readings_text(&readings, out) : said;
}

#define ALL \
    "label=fault,fault-exit=new,hold-exit=latch,x-after=once,guard-start=step,v-alone=first,y-eleventh=y,reset-t41=clear," \
    "negative-position=no,speed-change=2000ms,planning=2000ms,input-filter=100ms,store-time=1000ms"

START_TEST(each_reading_has_its_member)
{
    struct rkm04_readings wanted = {.label = RKM04_LABEL_FAULT, .fault_exit = RKM04_FAULT_EXIT_NEW,
                                    .hold_exit = RKM04_HOLD_EXIT_LATCH, .x_after = RKM04_X_AFTER_ONCE,
                                    .guard_start = RKM04_GUARD_START_STEP, .v_alone = RKM04_V_ALONE_FIRST,
                                    .y_eleventh = RKM04_Y_ELEVENTH_Y, .reset_t41 = RKM04_RESET_T41_CLEAR,
                                    .negative_position = RKM04_NEGATIVE_POSITION_NO, .input_filter = 100,
                                    .speed_change = 2000, .planning = 2000, .store_time = 1000};
    struct rkm04_readings read = {0};
    readings_set named = 0;
    char error[READINGS_ERROR_SIZE];
    ck_assert(readings_read(&read, &named, ALL, error));
    ck_assert_mem_eq(&read, &wanted, sizeof wanted);
    ck_assert_uint_eq(named, (1u << READINGS) - 1u);
    ck_assert_str_eq(read_text(ALL), ALL);
}
END_TEST

START_TEST(the_text_names_what_is_not_at_its_default_in_the_order_of_the_table)
{
    ck_assert_str_eq(read_text("speed-change=0,hold-exit=new"), "");
    ck_assert_str_eq(read_text("planning=1.5s,hold-exit=latch"), "hold-exit=latch,planning=1500ms");
    ck_assert_str_eq(read_text("input-filter=5"), "input-filter=5ms");
    ck_assert_str_eq(read_text("input-filter=005ms"), "input-filter=5ms");
    ck_assert_str_eq(read_text("store-time=1000000us"), "store-time=1000ms");
}
END_TEST

START_TEST(a_wrong_name_or_value_is_answered_with_what_is_legal)
{
    static const char *const cases[][2] = {
        {"", "expected NAME=VALUE, found nothing"},
        {"label=fault,", "expected NAME=VALUE, found nothing"},
        {",label=fault", "expected NAME=VALUE, found nothing"},
        {"hold-exit", "expected NAME=VALUE, found `hold-exit'"},
        {"hold_exit=latch", "unknown reading `hold_exit'; did you mean `hold-exit'?"},
        {"Label=fault", "unknown reading `Label'; did you mean `label'?"},
        {"hold-exti=latch", "unknown reading `hold-exti'; did you mean `hold-exit'?"},
        {"=latch", "unknown reading `'; readings are: label, fault-exit, hold-exit, x-after, guard-start, v-alone, y-eleventh, "
                   "reset-t41, negative-position, speed-change, planning, input-filter, store-time"},
        {"hold-exit=Latch", "hold-exit: expected new or latch, found `Latch'"},
        {"hold-exit=", "hold-exit: expected new or latch, found `'"},
        {"hold-exit=latch ", "hold-exit: expected new or latch, found `latch '"},
        {"label=fault,label=wait", "label is given twice"},
        {"speed-change=2001", "speed-change: expected whole ms from 0 to 2000, as in 5 or 5ms, found `2001'"},
        {"input-filter=101ms", "input-filter: expected whole ms from 0 to 100, as in 5 or 5ms, found `101ms'"},
        {"planning=1500us", "planning: expected whole ms from 0 to 2000, as in 5 or 5ms, found `1500us'"},
        {"planning=-1", "planning: expected whole ms from 0 to 2000, as in 5 or 5ms, found `-1'"},
        {"planning=", "planning: expected whole ms from 0 to 2000, as in 5 or 5ms, found `'"},
        {"planning=4294967297", "planning: expected whole ms from 0 to 2000, as in 5 or 5ms, found `4294967297'"},
        {"planning=18446744073709551617",
         "planning: expected whole ms from 0 to 2000, as in 5 or 5ms, found `18446744073709551617'"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        ck_assert_str_eq(read_text(cases[i][0]), cases[i][1]);
}
END_TEST

START_TEST(a_long_name_does_not_overflow_the_message)
{
    char text[1000];
    memset(text, 'x', sizeof text);
    text[sizeof text - 1] = '\0';
    text[900] = '=';
    ck_assert_ptr_nonnull(strstr(read_text(text), "readings are: label"));
    memcpy(text, "label=", 6);
    ck_assert_ptr_nonnull(strstr(read_text(text), "label: expected wait or fault, found `xxx"));
}
END_TEST

START_TEST(what_is_wrong_changes_nothing)
{
    struct rkm04_readings readings = {.planning = 7};
    readings_set named = 0;
    char error[READINGS_ERROR_SIZE], text[READINGS_TEXT_SIZE];
    ck_assert(!readings_read(&readings, &named, "label=fault,planning=8,x", error));
    ck_assert_str_eq(readings_text(&readings, text), "planning=7ms");
    ck_assert_uint_eq(named, 0);
    ck_assert(readings_read(&readings, &named, "label=fault", error));
    ck_assert(!readings_read(&readings, &named, "label=wait", error));
    ck_assert_str_eq(readings_text(&readings, text), "label=fault,planning=7ms");
}
END_TEST

START_TEST(json_and_back)
{
    struct rkm04_readings readings = {0};
    readings_set named = 0;
    char error[READINGS_ERROR_SIZE];
    ck_assert(readings_read(&readings, &named, ALL, error));
    json_t *json = readings_json(&readings);
    char *text = json_dumps(json, JSON_COMPACT);
    json_decref(json);
    ck_assert_str_eq(read_json(text), ALL);
    free(text);
    ck_assert_str_eq(read_json("{}"), "");
    ck_assert_str_eq(read_json("{\"planning\":\"20ms\"}"), "planning=20ms");
    ck_assert_str_eq(read_json("[]"), "expected an object, as in {\"hold-exit\":\"latch\"}");
    ck_assert_str_eq(read_json("{\"plannning\":1}"), "unknown reading `plannning'; did you mean `planning'?");
    ck_assert_str_eq(read_json("{\"planning\":-1}"), "planning: expected whole ms from 0 to 2000, as in 5 or 5ms, found `-1'");
    ck_assert_str_eq(read_json("{\"label\":true}"), "label: expected wait or fault, found `'");
}
END_TEST

START_TEST(a_map_in_a_file_is_read_with_places)
{
    ck_assert_str_eq(read_map("{hold-exit: latch, planning: 20, speed-change: 1.5s, negative-position: no}"),
                     "hold-exit=latch,negative-position=no,speed-change=1500ms,planning=20ms");
    ck_assert_str_eq(read_map("{}"), "");
    ck_assert_str_eq(read_map("hold-exit: latch\nhold-edit: new\nlabel: x\n"),
                     "x:2:1: error: unknown reading `hold-edit'; did you mean `hold-exit'?\n"
                     "x:3:8: error: label: expected wait or fault, found `x'\n");
    ck_assert_str_eq(read_map("planning: [1]\n"),
                     "x:1:11: error: planning: expected whole ms from 0 to 2000, as in 5 or 5ms, found `'\n");
    ck_assert_str_eq(read_map("latch"), "x:1:1: error: expected readings, a map as in {hold-exit: latch}\n");
}
END_TEST

START_TEST(what_is_tried_is_legal_and_other_than_the_default)
{
    unsigned all = 0;
    for (unsigned at = 0; at < READINGS; at++) {
        unsigned values[READINGS_TRIED_MAX], count = readings_tried(at, values);
        ck_assert_uint_ge(count, 1);
        for (unsigned i = 0; i < count; i++) {
            struct rkm04_readings readings = {0};
            char text[READINGS_TEXT_SIZE];
            readings_put(&readings, at, values[i]);
            ck_assert_uint_eq(readings_get(&readings, at), values[i]);
            ck_assert_uint_gt(values[i], i > 0 ? values[i - 1] : 0);
            readings_text(&readings, text);
            ck_assert_str_eq(read_text(text), text);
            ck_assert_int_eq(strncmp(text, readings_name(at), strlen(readings_name(at))), 0);
        }
        all += count;
    }
    ck_assert_uint_eq(all, 22);
}
END_TEST

START_TEST(sets_are_compared_by_value)
{
    for (unsigned at = 0; at < READINGS; at++) {
        struct rkm04_readings left = {0}, right = {0};
        ck_assert(readings_same(&left, &right));
        readings_put(&right, at, 1);
        ck_assert(!readings_same(&left, &right));
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("readings");
    TCase *names = tcase_create("readings");
    tcase_add_test(names, each_reading_has_its_member);
    tcase_add_test(names, the_text_names_what_is_not_at_its_default_in_the_order_of_the_table);
    tcase_add_test(names, a_wrong_name_or_value_is_answered_with_what_is_legal);
    tcase_add_test(names, a_long_name_does_not_overflow_the_message);
    tcase_add_test(names, what_is_wrong_changes_nothing);
    tcase_add_test(names, json_and_back);
    tcase_add_test(names, a_map_in_a_file_is_read_with_places);
    tcase_add_test(names, what_is_tried_is_legal_and_other_than_the_default);
    tcase_add_test(names, sets_are_compared_by_value);
    suite_add_tcase(suite, names);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed > 0 ? 1 : 0;
}
