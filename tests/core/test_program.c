/* SPDX-License-Identifier: MIT */
/* test_program.c: the program memory, C2, C8, C9 and C10 of the specification. One case alone: CK_RUN_CASE=ring ./test_program */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>

#include "program.h"

#define TAPE_MAX (6 * RKM04_PROGRAM_MAX)

static struct rkm04_program program;

/* The model: the whole tape since the reset, nothing of it ever lost, and what follows from that by looking through it. */
static struct rkm04_command tape[TAPE_MAX];
static uint64_t length;

static void append(uint8_t op, uint32_t argument)
{
    ck_assert_uint_lt(length, TAPE_MAX);
    tape[length++] = (struct rkm04_command){op, argument};
    program_append(&program, (struct rkm04_command){op, argument});
}

static void append_many(unsigned count)
{
    for (unsigned i = 0; i < count; i++)
        append('W', 1 + i);
}

static uint64_t model_oldest(void)
{
    return length > RKM04_PROGRAM_MAX ? length - RKM04_PROGRAM_MAX : 0;
}

/* Number of the last command like this that is still in memory, or `length`. */
static uint64_t model_last(uint8_t op, uint32_t argument)
{
    for (uint64_t n = length; n-- > model_oldest();)
        if (tape[n].op == op && tape[n].argument == argument)
            return n;
    return length;
}

static void assert_label(unsigned label)
{
    uint64_t number = RKM04_NEVER, expected = model_last('@', label);
    bool found = program_label(&program, label, &number);
    ck_assert_msg(found == (expected < length), "label %u after %llu commands: %s", label, (unsigned long long)length,
                  found ? "found" : "not found");
    if (found)
        ck_assert_uint_eq(number, expected);
}

static void assert_commands(void)
{
    ck_assert_uint_eq(program.written, length);
    ck_assert_uint_eq(program_oldest(&program), model_oldest());
    ck_assert_uint_eq(program_count(&program), length - model_oldest());
    for (uint64_t n = model_oldest(); n < length; n++) {
        struct rkm04_command command = program_at(&program, n);
        ck_assert_uint_eq(command.op, tape[n].op);
        ck_assert_uint_eq(command.argument, tape[n].argument);
    }
}

static void set_up(void)
{
    program_clear(&program);
    length = 0;
}

START_TEST(C2_an_empty_memory_has_no_commands_and_no_labels)
{
    ck_assert_uint_eq(program_count(&program), 0);
    ck_assert_uint_eq(program_oldest(&program), program.written);
    for (unsigned label = 1; label <= RKM04_LABELS; label++)
        assert_label(label);
    ck_assert(!program_closed_after(&program, 0));
}
END_TEST

START_TEST(C2_commands_are_in_the_order_in_which_they_arrived)
{
    append('F', 16000000);
    append('=', (uint32_t)-2000000000);
    append('G', RKM04_G_BACK);
    append('R', 0);
    assert_commands();
}
END_TEST

START_TEST(P9_places_count_from_1_to_700_and_begin_anew)
{
    ck_assert_uint_eq(program_place(0), 1);
    ck_assert_uint_eq(program_place(699), 700);
    ck_assert_uint_eq(program_place(700), 1);
    ck_assert_uint_eq(program_place(UINT64_C(700) * 10000000000u + 5), 6);
}
END_TEST

START_TEST(C10_700_commands_fit_and_the_701st_overwrites_the_oldest)
{
    append_many(RKM04_PROGRAM_MAX);
    ck_assert_uint_eq(program_oldest(&program), 0);
    ck_assert_uint_eq(program_count(&program), RKM04_PROGRAM_MAX);
    append('R', 0);
    ck_assert_uint_eq(program_oldest(&program), 1);
    ck_assert_uint_eq(program_count(&program), RKM04_PROGRAM_MAX);
    assert_commands();
}
END_TEST

START_TEST(C8_of_a_label_that_occurs_more_than_once_the_one_written_last_counts)
{
    uint64_t number = 0;
    append('@', 80);
    append('@', 1);
    append('R', 0);
    append('@', 80);
    ck_assert(program_label(&program, 80, &number));
    ck_assert_uint_eq(number, 3);
    ck_assert(program_label(&program, 1, &number));
    ck_assert_uint_eq(number, 1);
}
END_TEST

START_TEST(C10_a_label_overwritten_is_not_in_memory)
{
    uint64_t number = 0;
    append('@', 5);
    append_many(RKM04_PROGRAM_MAX - 1);
    ck_assert(program_label(&program, 5, &number));
    append('R', 0);
    ck_assert(!program_label(&program, 5, &number));
}
END_TEST

START_TEST(C10_overwriting_an_earlier_label_of_the_same_number_leaves_the_later_one)
{
    uint64_t number = 0;
    append('@', 5);
    append_many(10);
    append('@', 5);
    append_many(RKM04_PROGRAM_MAX - 1);
    ck_assert(program_label(&program, 5, &number));
    ck_assert_uint_eq(number, 11);
    append('R', 0);
    ck_assert(!program_label(&program, 5, &number));
}
END_TEST

START_TEST(C10_a_label_that_overwrites_itself_is_in_memory)
{
    uint64_t number = 0;
    append('@', 5);
    append_many(RKM04_PROGRAM_MAX - 1);
    append('@', 5);
    ck_assert(program_label(&program, 5, &number));
    ck_assert_uint_eq(number, 700);
    append_many(1);
    assert_label(5);
}
END_TEST

START_TEST(C10_a_label_that_overwrites_another_leaves_only_itself)
{
    append('@', 5);
    append_many(RKM04_PROGRAM_MAX - 1);
    append('@', 6);
    assert_label(5);
    assert_label(6);
}
END_TEST

START_TEST(C9_a_block_is_closed_by_a_bracket_after_it_only)
{
    append(']', 0);
    append('[', 0);
    ck_assert(!program_closed_after(&program, 1));
    append('R', 0);
    ck_assert(!program_closed_after(&program, 1));
    append(']', 0);
    ck_assert(program_closed_after(&program, 1));
    ck_assert(program_closed_after(&program, 2));
    ck_assert(!program_closed_after(&program, 3));
}
END_TEST

START_TEST(C9_one_bracket_closes_all_open_blocks)
{
    append('[', 0);
    append('[', 0);
    append(']', 0);
    ck_assert(program_closed_after(&program, 0));
    ck_assert(program_closed_after(&program, 1));
}
END_TEST

START_TEST(C9_a_block_is_closed_across_the_end_of_the_memory)
{
    append_many(RKM04_PROGRAM_MAX - 1);
    append('[', 0);
    ck_assert(!program_closed_after(&program, RKM04_PROGRAM_MAX - 1));
    append(']', 0);
    ck_assert(program_closed_after(&program, RKM04_PROGRAM_MAX - 1));
}
END_TEST

START_TEST(C1_after_a_reset_nothing_of_the_old_program_is_left)
{
    for (unsigned label = 1; label <= RKM04_LABELS; label++)
        append('@', label);
    append(']', 0);
    append_many(RKM04_PROGRAM_MAX);
    set_up();
    program_clear(&program);
    append('[', 0);
    assert_commands();
    for (unsigned label = 1; label <= RKM04_LABELS; label++)
        assert_label(label);
    ck_assert(!program_closed_after(&program, 0));
}
END_TEST

/* Random tapes of six memories' length. The rarer labels are, the more of them fall out of memory unrepeated. */
START_TEST(C10_the_memory_is_the_newest_700_of_the_tape_whatever_is_written)
{
    uint32_t random = (uint32_t)_i * 77777u + 1;
    unsigned label_rate = 2u << _i, closed = 0;
    while (length < TAPE_MAX) {
        random = random * 1664525u + 1013904223u;
        unsigned label = 1 + (random >> 8) % RKM04_LABELS;
        if ((random >> 16) % label_rate == 0) {
            append('@', label);
        } else if ((random >> 16) % 97 == 1) {
            append(']', 0);
            closed = (unsigned)length;
        } else {
            append('F', 1 + (random >> 16));
        }
        assert_label(label);
        assert_label(1 + (unsigned)length % RKM04_LABELS);
        uint64_t number = model_oldest() + (random >> 12) % program_count(&program);
        ck_assert_int_eq(program_closed_after(&program, number), closed > number + 1);
        if (length % 89 == 0) {
            assert_commands();
            for (unsigned each = 1; each <= RKM04_LABELS; each++)
                assert_label(each);
        }
    }
}
END_TEST

static Suite *program_suite(void)
{
    Suite *suite = suite_create("program");
    TCase *ring = tcase_create("ring");
    tcase_add_checked_fixture(ring, set_up, NULL);
    tcase_set_timeout(ring, 60);
    tcase_add_test(ring, C2_an_empty_memory_has_no_commands_and_no_labels);
    tcase_add_test(ring, C2_commands_are_in_the_order_in_which_they_arrived);
    tcase_add_test(ring, P9_places_count_from_1_to_700_and_begin_anew);
    tcase_add_test(ring, C10_700_commands_fit_and_the_701st_overwrites_the_oldest);
    tcase_add_test(ring, C1_after_a_reset_nothing_of_the_old_program_is_left);
    tcase_add_loop_test(ring, C10_the_memory_is_the_newest_700_of_the_tape_whatever_is_written, 0, 9);
    suite_add_tcase(suite, ring);

    TCase *labels = tcase_create("labels");
    tcase_add_checked_fixture(labels, set_up, NULL);
    tcase_add_test(labels, C8_of_a_label_that_occurs_more_than_once_the_one_written_last_counts);
    tcase_add_test(labels, C10_a_label_overwritten_is_not_in_memory);
    tcase_add_test(labels, C10_overwriting_an_earlier_label_of_the_same_number_leaves_the_later_one);
    tcase_add_test(labels, C10_a_label_that_overwrites_itself_is_in_memory);
    tcase_add_test(labels, C10_a_label_that_overwrites_another_leaves_only_itself);
    suite_add_tcase(suite, labels);

    TCase *blocks = tcase_create("blocks");
    tcase_add_checked_fixture(blocks, set_up, NULL);
    tcase_add_test(blocks, C9_a_block_is_closed_by_a_bracket_after_it_only);
    tcase_add_test(blocks, C9_one_bracket_closes_all_open_blocks);
    tcase_add_test(blocks, C9_a_block_is_closed_across_the_end_of_the_memory);
    suite_add_tcase(suite, blocks);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(program_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed > 0)
        printf("One case alone: CK_RUN_CASE=ring|labels|blocks ./test_program\n");
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
