/* SPDX-License-Identifier: MIT */
/* test_fakes.c: what the other tests lean on: the flash that breaks on demand and the recording port. */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "flash_fake.h"
#include "recorder.h"

static struct flash_fake flash;
static const uint8_t eight[8] = {1, 2, 3, 4, 5, 6, 7, 8};

static void set_up(void)
{
    flash_fake_init(&flash);
}

static int program_eight(unsigned block, unsigned offset)
{
    return flash_fake_program(&flash, block, offset, eight, sizeof eight);
}

START_TEST(an_erased_flash_reads_FF_and_keeps_what_is_programmed)
{
    uint8_t data[16];
    ck_assert_int_eq(program_eight(7, RKM04_FLASH_BLOCK_SIZE - 8), 0);
    ck_assert_int_eq(flash_fake_read(&flash, 7, RKM04_FLASH_BLOCK_SIZE - 16, data, 16), 0);
    for (int i = 0; i < 8; i++)
        ck_assert_uint_eq(data[i], 0xff);
    ck_assert_mem_eq(data + 8, eight, 8);
    ck_assert_int_eq(flash_fake_erase(&flash, 7), 0);
    ck_assert_int_eq(flash_fake_read(&flash, 7, RKM04_FLASH_BLOCK_SIZE - 8, data, 8), 0);
    ck_assert_uint_eq(data[7], 0xff);
    ck_assert_uint_eq(flash.misuse, 0);
}
END_TEST

START_TEST(programming_twice_without_an_erase_is_refused)
{
    ck_assert_int_eq(program_eight(0, 8), 0);
    ck_assert_int_eq(program_eight(0, 8), 1);
    ck_assert_uint_eq(flash.misuse, 1);
    ck_assert_int_eq(program_eight(0, 16), 0);
    ck_assert_int_eq(flash_fake_erase(&flash, 0), 0);
    ck_assert_int_eq(program_eight(0, 8), 0);
    ck_assert_uint_eq(flash.misuse, 1);
}
END_TEST

START_TEST(odd_offsets_and_lengths_and_whatever_is_out_of_bounds_are_refused)
{
    uint8_t data[16] = {0};
    ck_assert_int_eq(flash_fake_program(&flash, 0, 4, data, 8), 1);
    ck_assert_int_eq(flash_fake_program(&flash, 0, 8, data, 12), 1);
    ck_assert_int_eq(flash_fake_program(&flash, 0, 8, data, 0), 1);
    ck_assert_int_eq(flash_fake_program(&flash, 8, 0, data, 8), 1);
    ck_assert_int_eq(flash_fake_program(&flash, 0, RKM04_FLASH_BLOCK_SIZE - 8, data, 16), 1);
    ck_assert_int_eq(flash_fake_read(&flash, 0, RKM04_FLASH_BLOCK_SIZE, data, 1), 1);
    ck_assert_int_eq(flash_fake_read(&flash, 0, 1, data, UINT32_MAX), 1);
    ck_assert_int_eq(flash_fake_read(&flash, 8, 0, data, 1), 1);
    ck_assert_int_eq(flash_fake_erase(&flash, 8), 1);
    ck_assert_uint_eq(flash.misuse, 9);
    ck_assert_uint_eq(flash.operations, 0);
}
END_TEST

START_TEST(after_a_power_cut_nothing_works_until_the_power_is_back)
{
    uint8_t data[8];
    flash_fake_arm(&flash, 2, FLASH_CUT_BEFORE, 1);
    ck_assert_int_eq(program_eight(0, 0), 0);
    ck_assert_int_eq(program_eight(0, 8), 1);
    ck_assert_int_eq(program_eight(0, 16), 1);
    ck_assert_int_eq(flash_fake_erase(&flash, 1), 1);
    ck_assert_int_eq(flash_fake_read(&flash, 0, 0, data, 8), 1);
    flash_fake_power_on(&flash);
    ck_assert_int_eq(flash_fake_read(&flash, 0, 0, data, 8), 0);
    ck_assert_mem_eq(data, eight, 8);
    ck_assert_int_eq(flash_fake_read(&flash, 0, 8, data, 8), 0);
    ck_assert_uint_eq(data[0], 0xff);
    ck_assert_int_eq(program_eight(0, 16), 0);
}
END_TEST

/* How many of the bytes that an operation had to change it did change. */
static unsigned changed(unsigned n, enum flash_fault fault, int expected)
{
    uint8_t zero[64] = {0};
    flash_fake_init(&flash);
    flash_fake_arm(&flash, n, fault, 3);
    int programmed = flash_fake_program(&flash, 2, 0, zero, sizeof zero);
    int erased = n == 2 ? flash_fake_erase(&flash, 2) : 0;
    ck_assert_int_eq(n == 1 ? programmed : erased, expected);
    unsigned count = 0;
    for (unsigned i = 0; i < sizeof zero; i++)
        count += flash.data[2][i] != (n == 1 ? 0xff : 0);
    return count;
}

START_TEST(every_fault_does_as_much_as_its_name_says)
{
    for (unsigned n = 1; n <= 2; n++) {
        ck_assert_uint_eq(changed(n, FLASH_WELL, 0), 64);
        ck_assert_uint_eq(changed(n, FLASH_FAIL_NOTHING, 1), 0);
        ck_assert_uint_eq(changed(n, FLASH_FAIL_DONE, 1), 64);
        ck_assert_uint_eq(changed(n, FLASH_CUT_BEFORE, 1), 0);
        ck_assert_uint_eq(changed(n, FLASH_CUT_AFTER, 1), 64);
        unsigned torn = changed(n, FLASH_LIE, 0);
        ck_assert_uint_gt(torn, 0);
        ck_assert_uint_eq(changed(n, FLASH_FAIL_TORN, 1), torn);
        ck_assert_uint_eq(changed(n, FLASH_CUT_BITS, 1), torn);
    }
    unsigned prefix = changed(1, FLASH_CUT_PREFIX, 1);
    ck_assert(prefix > 0 && prefix < 64 && flash.data[2][0] == 0 && flash.data[2][63] == 0xff);
    ck_assert_uint_eq(changed(1, FLASH_CUT_SUFFIX, 1), 64 - prefix);
    ck_assert(flash.data[2][0] == 0xff && flash.data[2][63] == 0);
}
END_TEST

START_TEST(a_block_left_half_erased_has_to_be_erased_again)
{
    ck_assert_int_eq(program_eight(3, 0), 0);
    ck_assert_int_eq(program_eight(3, RKM04_FLASH_BLOCK_SIZE - 8), 0);
    flash_fake_arm(&flash, 1, FLASH_CUT_SUFFIX, 9);
    ck_assert_int_eq(flash_fake_erase(&flash, 3), 1);
    flash_fake_power_on(&flash);
    ck_assert_mem_eq(flash.data[3], eight, 8);
    ck_assert_uint_eq(flash.data[3][RKM04_FLASH_BLOCK_SIZE - 1], 0xff);
    ck_assert_int_eq(program_eight(3, RKM04_FLASH_BLOCK_SIZE - 8), 1);
    ck_assert_int_eq(flash_fake_erase(&flash, 3), 0);
    ck_assert_int_eq(program_eight(3, RKM04_FLASH_BLOCK_SIZE - 8), 0);
}
END_TEST

START_TEST(a_cut_may_leave_zeros_or_wrong_bits_anywhere_in_the_block)
{
    ck_assert_uint_ge(changed(1, FLASH_CUT_FLIPS, 1), 56);
    unsigned wrong = 0;
    for (unsigned i = 0; i < RKM04_FLASH_BLOCK_SIZE; i++)
        wrong += flash.data[2][i] != (i < 64 ? 0 : 0xff);
    ck_assert(wrong >= 1 && wrong <= 8);
    flash_fake_power_on(&flash);
    ck_assert_int_eq(program_eight(3, 0), 0);
    flash_fake_arm(&flash, 1, FLASH_CUT_ZEROS, 1);
    flash.border = 5;
    ck_assert_int_eq(flash_fake_erase(&flash, 3), 1);
    ck_assert_uint_eq(flash.length, RKM04_FLASH_BLOCK_SIZE);
    ck_assert_mem_eq(flash.data[3], "\0\0\0\0\0\6\7\10\377", 9);
}
END_TEST

/* What an erase and a program return on a worn block, and what is left there: the flash had a block of zeros. */
static void assert_wear(enum flash_wear wear, int erased, int programmed, bool whole)
{
    static const uint8_t zero[RKM04_FLASH_BLOCK_SIZE];
    const char *name = flash_wear_name(wear);
    flash_fake_init(&flash);
    ck_assert_int_eq(flash_fake_program(&flash, 5, 0, zero, sizeof zero), 0);
    flash.wear[5] = wear;
    ck_assert_msg(flash_fake_erase(&flash, 5) == erased, "%s: erase", name);
    unsigned left = 0;
    for (unsigned i = 0; i < RKM04_FLASH_BLOCK_SIZE; i++)
        left += flash.data[5][i] != 0xff;
    ck_assert_msg((left == 0) == whole, "%s: %u bytes are not erased", name, left);
    if (erased == 0)
        ck_assert_msg(program_eight(5, 0) == programmed, "%s: program", name);
    ck_assert_msg((memcmp(flash.data[5], eight, 8) == 0) == (erased == 0 && programmed == 0), "%s: programmed", name);
}

START_TEST(a_worn_block_fails_as_its_wear_says)
{
    assert_wear(FLASH_SOUND, 0, 0, true);
    assert_wear(FLASH_NO_ERASE, 1, 0, false);
    assert_wear(FLASH_HALF_ERASE, 1, 0, false);
    assert_wear(FLASH_NO_PROGRAM, 0, 1, true);
    assert_wear(FLASH_HALF_PROGRAM, 0, 1, true);
    assert_wear(FLASH_STUCK_CELLS, 0, 0, false);
    ck_assert_uint_eq(flash.data[5][13], 0xdf);
}
END_TEST

START_TEST(two_faults_may_be_armed)
{
    flash_fake_arm(&flash, 3, FLASH_CUT_BEFORE, 1);
    flash_fake_arm_also(&flash, 1, FLASH_FAIL_NOTHING);
    ck_assert_int_eq(program_eight(0, 0), 1);
    ck_assert_int_eq(program_eight(0, 8), 0);
    ck_assert_int_eq(program_eight(0, 16), 1);
    ck_assert(flash.off);
}
END_TEST

START_TEST(the_power_may_go_at_a_read)
{
    uint8_t data[1];
    flash_fake_cut_at_read(&flash, 2);
    ck_assert_int_eq(flash_fake_read(&flash, 0, 0, data, 1), 0);
    ck_assert_int_eq(flash_fake_read(&flash, 0, 0, data, 1), 1);
    ck_assert_int_eq(flash_fake_read(&flash, 0, 0, data, 1), 1);
    ck_assert_int_eq(flash_fake_erase(&flash, 0), 1);
    flash_fake_power_on(&flash);
    ck_assert_int_eq(flash_fake_read(&flash, 0, 0, data, 1), 0);
}
END_TEST

START_TEST(one_read_fails_if_it_is_told_to)
{
    uint8_t data[1];
    flash_fake_arm_read(&flash, 2);
    ck_assert_int_eq(flash_fake_read(&flash, 0, 0, data, 1), 0);
    ck_assert_int_eq(flash_fake_read(&flash, 0, 0, data, 1), 1);
    ck_assert_int_eq(flash_fake_read(&flash, 0, 0, data, 1), 0);
}
END_TEST

START_TEST(the_recorder_finds_steps_and_events_by_motor_and_number)
{
    struct recorder recorder = {0};
    for (unsigned i = 0; i < 3000; i++)
        recorder_port.step(&recorder, 100 + i, 1 + i % 2, (int32_t)i);
    recorder_port.event(&recorder, 50, 2, RKM04_EVENT_MOTION, 1);
    recorder_port.event(&recorder, 60, 2, RKM04_EVENT_MOTION, 0);
    recorder_port.event(&recorder, 70, 2, RKM04_EVENT_MOTION, 1);
    ck_assert_uint_eq(recorder_steps(&recorder, 1), 1500);
    ck_assert_uint_eq(recorder_steps(&recorder, 3), 0);
    ck_assert_uint_eq(recorder_step(&recorder, 2, 1), 101);
    ck_assert_uint_eq(recorder_step(&recorder, 2, 1500), 3099);
    ck_assert(recorder_step(&recorder, 2, 1501) == RKM04_NEVER);
    ck_assert_uint_eq(recorder_event(&recorder, 2, RKM04_EVENT_MOTION, 1, 2)->tick, 70);
    ck_assert_ptr_null(recorder_event(&recorder, 2, RKM04_EVENT_MOTION, 1, 3));
    ck_assert_ptr_null(recorder_event(&recorder, 1, RKM04_EVENT_MOTION, 1, 1));
    recorder_clear(&recorder);
    ck_assert_uint_eq(recorder_steps(&recorder, 1), 0);
    recorder_free(&recorder);
}
END_TEST

START_TEST(the_recorder_sorts_by_tick_and_motor_and_keeps_the_order_of_the_rest)
{
    struct recorder recorder = {0};
    recorder_sort(&recorder);
    for (unsigned i = 0; i < 1000; i++)
        recorder_port.step(&recorder, 7919 * i % 101, 1 + i % 4, (int32_t)i);
    recorder_sort(&recorder);
    ck_assert_uint_eq(recorder.count, 1000);
    for (size_t i = 1; i < recorder.count; i++) {
        const struct record *a = &recorder.list[i - 1], *b = &recorder.list[i];
        ck_assert(a->tick < b->tick || (a->tick == b->tick && a->motor <= b->motor));
        if (a->tick == b->tick && a->motor == b->motor)
            ck_assert_int_lt(a->value, b->value);
    }
    recorder_free(&recorder);
}
END_TEST

static Suite *fakes_suite(void)
{
    Suite *suite = suite_create("fakes");
    TCase *fake = tcase_create("flash");
    tcase_add_checked_fixture(fake, set_up, NULL);
    tcase_add_test(fake, an_erased_flash_reads_FF_and_keeps_what_is_programmed);
    tcase_add_test(fake, programming_twice_without_an_erase_is_refused);
    tcase_add_test(fake, odd_offsets_and_lengths_and_whatever_is_out_of_bounds_are_refused);
    tcase_add_test(fake, after_a_power_cut_nothing_works_until_the_power_is_back);
    tcase_add_test(fake, every_fault_does_as_much_as_its_name_says);
    tcase_add_test(fake, a_block_left_half_erased_has_to_be_erased_again);
    tcase_add_test(fake, one_read_fails_if_it_is_told_to);
    tcase_add_test(fake, a_cut_may_leave_zeros_or_wrong_bits_anywhere_in_the_block);
    tcase_add_test(fake, a_worn_block_fails_as_its_wear_says);
    tcase_add_test(fake, two_faults_may_be_armed);
    tcase_add_test(fake, the_power_may_go_at_a_read);
    suite_add_tcase(suite, fake);
    TCase *recorder = tcase_create("recorder");
    tcase_add_test(recorder, the_recorder_finds_steps_and_events_by_motor_and_number);
    tcase_add_test(recorder, the_recorder_sorts_by_tick_and_motor_and_keeps_the_order_of_the_rest);
    suite_add_tcase(suite, recorder);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(fakes_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed > 0)
        printf("One case alone: CK_RUN_CASE=flash|recorder ./test_fakes\n");
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
