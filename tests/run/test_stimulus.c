/* SPDX-License-Identifier: MIT */
/* test_stimulus.c: times and stimulus files of `rkm04 exec`. One test alone: CK_RUN_CASE=times ./test_stimulus */
#include <check.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include <rkm04/limits.h>

#include "run/stimulus.h"
#include "text/time_value.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

/* ---- Times -------------------------------------------------------------------------------------------------------- */

START_TEST(a_time_is_exact_to_the_microsecond)
{
    static const struct {
        const char *text;
        uint64_t ticks;
    } times[] = {
        {"0us", 0},           {"250us", 250},       {"1500ms", 1500000},    {"2.5s", 2500000},
        {"0.001ms", 1},       {"0.000001s", 1},     {"1.234567s", 1234567}, {"12.345ms", 12345},
        {"007s", 7000000},    {"0.1s", 100000},     {"16777217us", 16777217}, {"1000000000s", TIME_VALUE_MAX},
        {"999999999.999999s", TIME_VALUE_MAX - 1},
    };
    for (size_t i = 0; i < COUNT(times); i++) {
        uint64_t ticks = 0;
        size_t wrong;
        const char *form = time_value_read(times[i].text, strlen(times[i].text), &ticks, &wrong);
        ck_assert_msg(form == NULL, "%s: expected %s", times[i].text, form);
        ck_assert_msg(ticks == times[i].ticks, "%s is %" PRIu64, times[i].text, ticks);
    }
}
END_TEST

START_TEST(a_time_that_is_none_is_refused_with_what_was_expected)
{
    static const struct {
        const char *text;
        size_t wrong;
        const char *expected;
    } times[] = {
        {"", 0, "unit"},          {"5", 1, "unit"},         {"5 s", 1, "unit"},       {"s", 0, "unit"},
        {"-5s", 0, "unit"},       {"+5s", 0, "unit"},       {".5s", 0, "unit"},       {"5.s", 2, "unit"},
        {"5min", 1, "unit"},      {"5S", 1, "unit"},        {"5ss", 1, "unit"},       {"1e3s", 1, "unit"},
        {"1.5.5s", 3, "unit"},    {"0x5s", 1, "unit"},      {"1,5s", 1, "unit"},
        {"0.5us", 1, "whole"},    {"1.0us", 1, "whole"},    {"1.2345ms", 5, "3 digits"}, {"1.2345678s", 8, "6 digits"},
        {"1000000001s", 0, "at most"}, {"1000000000.000001s", 0, "at most"}, {"99999999999999999999999s", 0, "at most"},
        {"1000000000000000000ms", 0, "at most"}, {"0.99999999999999999999s", 2, "fewer"},
    };
    for (size_t i = 0; i < COUNT(times); i++) {
        uint64_t ticks = 77;
        size_t wrong = 99;
        const char *form = time_value_read(times[i].text, strlen(times[i].text), &ticks, &wrong);
        ck_assert_msg(form != NULL, "'%s' was taken for %" PRIu64, times[i].text, ticks);
        ck_assert_msg(strstr(form, times[i].expected) != NULL, "'%s': expected %s", times[i].text, form);
        ck_assert_msg(wrong == times[i].wrong, "'%s': wrong at %zu", times[i].text, wrong);
        ck_assert_uint_eq(ticks, 77);
    }
}
END_TEST

START_TEST(a_time_ends_where_its_length_says)
{
    uint64_t ticks;
    size_t wrong;
    ck_assert_ptr_null(time_value_read("5msX", 3, &ticks, &wrong));
    ck_assert_uint_eq(ticks, 5000);
    ck_assert_ptr_nonnull(time_value_read("5ms", 1, &ticks, &wrong));
}
END_TEST

/* ---- Stimulus files ----------------------------------------------------------------------------------------------- */

static struct stimuli stimuli;
static char *complaints;

/* Read the text from a copy that ends where it ends, for the sanitizer to watch. */
static int read_bytes(const char *text, size_t length)
{
    size_t size;
    char *copy = malloc(length > 0 ? length : 1);
    FILE *errors = open_memstream(&complaints, &size);
    ck_assert(copy != NULL && errors != NULL);
    memcpy(copy, text, length);
    int count = stimuli_read(&stimuli, &rkm04_device, "in.txt", copy, length, errors);
    fclose(errors);
    free(copy);
    return count;
}

static int read_text(const char *text)
{
    return read_bytes(text, strlen(text));
}

static void forget(void)
{
    stimuli_free(&stimuli);
    free(complaints);
    complaints = NULL;
}

static void ck_data(const struct stimulus *s, const void *data, size_t length)
{
    ck_assert_uint_eq(s->length, length);
    ck_assert_mem_eq(s->data, data, length);
}

START_TEST(an_input_has_its_number_and_level)
{
    ck_assert_int_eq(read_text("250us di 05 1\n1s di 5 0 # off again\n2s\tdi\t8\t1"), 0);
    ck_assert_uint_eq(stimuli.count, 3);
    ck_assert_uint_eq(stimuli.list[0].tick, 250);
    ck_assert_int_eq(stimuli.list[0].kind, STIMULUS_INPUT);
    ck_assert_uint_eq(stimuli.list[0].input, 5);
    ck_assert(stimuli.list[0].level);
    ck_assert_uint_eq(stimuli.list[1].input, 5);
    ck_assert(!stimuli.list[1].level);
    ck_assert_uint_eq(stimuli.list[2].tick, 2000000);
    ck_assert_uint_eq(stimuli.list[2].input, 8);
    forget();
}
END_TEST

START_TEST(a_text_goes_to_the_end_of_its_line)
{
    ck_assert_int_eq(read_text("1s set 0   F1000 R { # no comment of the file }  \r\n  2s set 4 K\n"), 0);
    ck_assert_uint_eq(stimuli.count, 2);
    ck_assert_int_eq(stimuli.list[0].kind, STIMULUS_SET);
    ck_assert_int_eq(stimuli.list[0].motor, 0);
    ck_data(&stimuli.list[0], "F1000 R { # no comment of the file }", 36);
    ck_assert_uint_eq(stimuli.list[0].line, 1);
    ck_assert_uint_eq(stimuli.list[0].column, 12);
    ck_assert_int_eq(stimuli.list[1].motor, 4);
    ck_data(&stimuli.list[1], "K", 1);
    ck_assert_uint_eq(stimuli.list[1].line, 2);
    ck_assert_uint_eq(stimuli.list[1].column, 12);
    forget();
}
END_TEST

START_TEST(a_message_is_bytes_in_hexadecimal)
{
    ck_assert_int_eq(read_text("0us message 0431\n0us message 02 31 4B # K\n0us message fFaA0031"), 0);
    ck_assert_uint_eq(stimuli.count, 3);
    ck_assert_int_eq(stimuli.list[0].kind, STIMULUS_MESSAGE);
    ck_data(&stimuli.list[0], "\x04\x31", 2);
    ck_data(&stimuli.list[1], "\x02\x31\x4B", 3);
    ck_data(&stimuli.list[2], "\xFF\xAA\x00\x31", 4);
    forget();
}
END_TEST

START_TEST(L4_the_longest_message_is_taken_and_one_byte_more_is_not)
{
    size_t digits = 2 * RKM04_MESSAGE_MAX, head = strlen("1s message ");
    char *text = malloc(head + digits + 3);
    memcpy(text, "1s message ", head);
    memset(text + head, '3', digits + 2);
    text[head + digits] = '\0';
    ck_assert_int_eq(read_text(text), 0);
    ck_assert_uint_eq(stimuli.list[0].length, RKM04_MESSAGE_MAX);
    forget();
    text[head + digits] = '3';
    text[head + digits + 2] = '\0';
    ck_assert_int_eq(read_text(text), 1);
    ck_assert_uint_eq(stimuli.count, 0);
    forget();
    free(text);
}
END_TEST

START_TEST(lines_act_by_time_and_those_of_one_time_in_the_order_of_the_file)
{
    char text[4096];
    size_t at = 0;
    for (int i = 0; i < 100; i++)
        at += (size_t)sprintf(text + at, "%dms set 1 W%d\n", i % 3 == 0 ? 2 : i % 3 == 1 ? 1 : 3, i + 1);
    ck_assert_int_eq(read_bytes(text, at), 0);
    ck_assert_uint_eq(stimuli.count, 100);
    for (size_t i = 1; i < stimuli.count; i++) {
        const struct stimulus *a = &stimuli.list[i - 1], *b = &stimuli.list[i];
        ck_assert(a->tick < b->tick || (a->tick == b->tick && a->line < b->line));
    }
    ck_data(&stimuli.list[0], "W2", 2);
    forget();
}
END_TEST

START_TEST(comments_and_empty_lines_are_nothing)
{
    ck_assert_int_eq(read_text("# 1s di 01 1\n\n  \t\r\n   # x\n#"), 0);
    ck_assert_uint_eq(stimuli.count, 0);
    forget();
    ck_assert_int_eq(read_text(""), 0);
    ck_assert_uint_eq(stimuli.count, 0);
    forget();
}
END_TEST

START_TEST(a_wrong_line_is_reported_with_its_place_and_what_was_expected)
{
    static const struct {
        const char *line, *complaint;
    } wrong[] = {
        {"x", "in.txt:1:1: error: expected a time with its unit, such as 250us, 1500ms or 2.5s, found 'x'\n"},
        {"10 di 1 1", "in.txt:1:3: error: expected a time with its unit, such as 250us, 1500ms or 2.5s, found '10'\n"},
        {"1s", "in.txt:1:3: error: expected di, set or message, found the end of the line\n"},
        {"1s DI 01 1", "in.txt:1:4: error: expected di, set or message, found 'DI'\n"},
        {"1s di 09 1", "in.txt:1:7: error: expected an input 01 to 08, found '09'\n"},
        {"1s di 0 1", "in.txt:1:7: error: expected an input 01 to 08, found '0'\n"},
        {"1s di 001 1", "in.txt:1:7: error: expected an input 01 to 08, found '001'\n"},
        {"1s di 1", "in.txt:1:8: error: expected 0 or 1, found the end of the line\n"},
        {"1s di 1 2", "in.txt:1:9: error: expected 0 or 1, found '2'\n"},
        {"1s di 1 1 1", "in.txt:1:11: error: expected the end of the line, found '1'\n"},
        {"1s set 5 R", "in.txt:1:8: error: expected a motor 1 to 4, or 0 for all, found '5'\n"},
        {"1s set R", "in.txt:1:8: error: expected a motor 1 to 4, or 0 for all, found 'R'\n"},
        {"1s set 1  ", "in.txt:1:11: error: expected a program text, found the end of the line\n"},
        {"1s message", "in.txt:1:11: error: expected the bytes of a message in hexadecimal, such as 0431, found the end of the "
                       "line\n"},
        {"1s message # 31", "in.txt:1:12: error: expected the bytes of a message in hexadecimal, such as 0431, found '#'\n"},
        {"1s message 043", "in.txt:1:15: error: expected two hexadecimal digits a byte, found '043'\n"},
        {"1s message 04x1", "in.txt:1:14: error: expected two hexadecimal digits a byte, found '04x1'\n"},
        {"1s\xC2\xA0" "di 1 1", "in.txt:1:2: error: expected a time with its unit, such as 250us, 1500ms or 2.5s, found "
                                "'1s\xC2\xA0" "di'; there is a no-break space (U+00A0) in it\n"},
        {"1s di \xE2\x80\x8B" "1 1", "in.txt:1:7: error: expected an input 01 to 08, found '\xE2\x80\x8B" "1'; there is a "
                                     "zero-width space (U+200B) in it\n"},
        {"1s d\x01i 1 1", "in.txt:1:4: error: expected di, set or message, found 'd?i'\n"},
    };
    for (size_t i = 0; i < COUNT(wrong); i++) {
        int count = read_text(wrong[i].line);
        ck_assert_str_eq(complaints, wrong[i].complaint);
        ck_assert_int_eq(count, 1);
        ck_assert_uint_eq(stimuli.count, 0);
        forget();
    }
}
END_TEST

START_TEST(every_wrong_line_is_reported_and_the_others_are_kept)
{
    ck_assert_int_eq(read_text("1s di 1 3\n1s di 1 1\n\n2x set 1 R\n"), 2);
    ck_assert_str_eq(complaints, "in.txt:1:9: error: expected 0 or 1, found '3'\n"
                                 "in.txt:4:2: error: expected a time with its unit, such as 250us, 1500ms or 2.5s, found "
                                 "'2x'\n");
    ck_assert_uint_eq(stimuli.count, 1);
    forget();
}
END_TEST

START_TEST(any_bytes_are_read_without_harm)
{
    static const char pieces[][8] = {"1s ", "di ", "set ", "message", " 1", "0", "\n", "#", "\xC2", "R", ".", "us", "F", "{"};
    uint32_t random = 1;
    for (int round = 0; round < 2000; round++) {
        char text[64];
        size_t length = 0;
        while (length < 48) {
            random = random * 1664525u + 1013904223u;
            if (random >> 28 == 0) {
                text[length++] = (char)(random >> 16);
            } else {
                const char *piece = pieces[(random >> 16) % COUNT(pieces)];
                memcpy(text + length, piece, strlen(piece));
                length += strlen(piece);
            }
        }
        int count = read_bytes(text, length);
        ck_assert_int_ge(count, 0);
        ck_assert_int_eq(count > 0, complaints[0] != '\0');
        forget();
    }
}
END_TEST

static Suite *stimulus_suite(void)
{
    Suite *suite = suite_create("stimulus");
    TCase *times = tcase_create("times");
    tcase_add_test(times, a_time_is_exact_to_the_microsecond);
    tcase_add_test(times, a_time_that_is_none_is_refused_with_what_was_expected);
    tcase_add_test(times, a_time_ends_where_its_length_says);
    suite_add_tcase(suite, times);
    TCase *lines = tcase_create("lines");
    tcase_add_test(lines, an_input_has_its_number_and_level);
    tcase_add_test(lines, a_text_goes_to_the_end_of_its_line);
    tcase_add_test(lines, a_message_is_bytes_in_hexadecimal);
    tcase_add_test(lines, L4_the_longest_message_is_taken_and_one_byte_more_is_not);
    tcase_add_test(lines, lines_act_by_time_and_those_of_one_time_in_the_order_of_the_file);
    tcase_add_test(lines, comments_and_empty_lines_are_nothing);
    tcase_add_test(lines, a_wrong_line_is_reported_with_its_place_and_what_was_expected);
    tcase_add_test(lines, every_wrong_line_is_reported_and_the_others_are_kept);
    tcase_add_test(lines, any_bytes_are_read_without_harm);
    suite_add_tcase(suite, lines);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(stimulus_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed > 0)
        puts("one test case alone: CK_RUN_CASE=times|lines ./test_stimulus");
    return failed > 0;
}
