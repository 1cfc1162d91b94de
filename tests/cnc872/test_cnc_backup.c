/* SPDX-License-Identifier: MIT */
/* test_cnc_backup.c: the backup memory in flash: the old content or the new one, wherever the power goes off (NO3). */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "cnc872/cnc872.h"

static uint8_t memory[CNC_BACKUP_BLOCKS][CNC_BACKUP_BLOCK];
static int bad_block = -1; /* that cannot be read */
static int operations_left; /* until the power goes off, in the middle of an operation; -1: it stays on */

/* Does this operation come to its end? One that does not is half done. */
static int operate(unsigned *length)
{
    if (operations_left < 0)
        return 0;
    if (operations_left == 0) {
        *length /= 2;
        return -1;
    }
    operations_left--;
    return 0;
}

static int on_read(void *context, unsigned block, unsigned offset, void *data, unsigned length)
{
    (void)context;
    ck_assert(block < CNC_BACKUP_BLOCKS && offset + length <= CNC_BACKUP_BLOCK);
    memcpy(data, memory[block] + offset, length);
    return (int)block == bad_block ? -1 : 0;
}

static int on_program(void *context, unsigned block, unsigned offset, const void *data, unsigned length)
{
    (void)context;
    ck_assert(block < CNC_BACKUP_BLOCKS && offset + length <= CNC_BACKUP_BLOCK);
    const int failed = operate(&length);
    for (unsigned i = 0; i < length; i++)
        memory[block][offset + i] &= ((const uint8_t *)data)[i];
    return failed;
}

static int on_erase(void *context, unsigned block)
{
    unsigned length = CNC_BACKUP_BLOCK;
    (void)context;
    const int failed = operate(&length);
    memset(memory[block], 0xFF, length);
    return failed;
}

static const struct cnc_flash flash = {.read = on_read, .program = on_program, .erase = on_erase};

static void fill(uint8_t *bytes, unsigned seed)
{
    for (unsigned i = 0; i < CNC_BACKUP_SIZE; i++)
        bytes[i] = (uint8_t)(i * 7u + seed);
}

static void begin(void)
{
    memset(memory, 0xFF, sizeof memory);
    operations_left = bad_block = -1;
}

START_TEST(NO3_erased_or_strange_flash_is_empty_memory)
{
    uint8_t bytes[CNC_BACKUP_SIZE], none[CNC_BACKUP_SIZE] = {0};
    uint32_t number = 9;
    ck_assert(!cnc_backup_load(&flash, bytes, &number));
    ck_assert_mem_eq(bytes, none, sizeof bytes);
    ck_assert_uint_eq(number, 0);
    memset(memory, 0x43, sizeof memory);
    ck_assert(!cnc_backup_load(&flash, bytes, &number));
    ck_assert_mem_eq(bytes, none, sizeof bytes);
}
END_TEST

START_TEST(NO3_what_was_stored_last_comes_back)
{
    uint8_t bytes[CNC_BACKUP_SIZE], wanted[CNC_BACKUP_SIZE];
    uint32_t number = 0, loaded;
    for (unsigned seed = 1; seed < 6; seed++) {
        fill(wanted, seed);
        ck_assert(cnc_backup_store(&flash, wanted, &number));
        ck_assert(cnc_backup_load(&flash, bytes, &loaded));
        ck_assert_mem_eq(bytes, wanted, sizeof bytes);
        ck_assert_uint_eq(loaded, number);
    }
    memory[number % 2 * 3 + 1][100] ^= 1; /* of the last one: that before it counts */
    ck_assert(cnc_backup_load(&flash, bytes, &loaded));
    fill(wanted, 4);
    ck_assert_mem_eq(bytes, wanted, sizeof bytes);
}
END_TEST

START_TEST(NO3_a_power_cut_leaves_the_old_content_or_the_new_one)
{
    uint8_t bytes[CNC_BACKUP_SIZE], old[CNC_BACKUP_SIZE], fresh[CNC_BACKUP_SIZE];
    unsigned cuts = 0, olds = 0;
    fill(old, 1);
    fill(fresh, 2);
    for (bool is_stored = false; !is_stored; cuts++) {
        uint32_t number = 0;
        begin();
        ck_assert(cnc_backup_store(&flash, old, &number));
        operations_left = (int)cuts;
        is_stored = cnc_backup_store(&flash, fresh, &number);
        operations_left = -1;
        ck_assert(cnc_backup_load(&flash, bytes, &number));
        const bool is_old = memcmp(bytes, old, sizeof bytes) == 0;
        ck_assert(is_old != (memcmp(bytes, fresh, sizeof bytes) == 0));
        ck_assert(is_old || is_stored || cuts > 5);
        olds += is_old;
    }
    ck_assert_uint_ge(cuts, 7); /* three erased, three written, the head */
    ck_assert_uint_eq(olds, cuts - 1);
}
END_TEST

START_TEST(NO3_a_block_that_cannot_be_read_costs_its_image_alone)
{
    uint8_t bytes[CNC_BACKUP_SIZE], old[CNC_BACKUP_SIZE], fresh[CNC_BACKUP_SIZE];
    uint32_t number = 0, loaded;
    fill(old, 1);
    fill(fresh, 2);
    ck_assert(cnc_backup_store(&flash, old, &number) && cnc_backup_store(&flash, fresh, &number));
    for (bad_block = 0; bad_block < (int)CNC_BACKUP_BLOCKS; bad_block++) {
        const bool is_of_fresh = (unsigned)bad_block / 3 == number % 2;
        ck_assert(cnc_backup_load(&flash, bytes, &loaded));
        ck_assert_mem_eq(bytes, is_of_fresh ? old : fresh, sizeof bytes);
        ck_assert_uint_eq(loaded, is_of_fresh ? 1 : 2);
    }
}
END_TEST

/* The size of what an image holds is part of its head. */
START_TEST(NO3_an_image_of_another_size_does_not_count)
{
    uint8_t bytes[CNC_BACKUP_SIZE], none[CNC_BACKUP_SIZE] = {0};
    uint32_t number = 0;
    fill(bytes, 1);
    ck_assert(cnc_backup_store(&flash, bytes, &number));
    for (unsigned at = 8; at < 12; at++) {
        memory[3][at] ^= 1;
        ck_assert(!cnc_backup_load(&flash, bytes, &number));
        ck_assert_mem_eq(bytes, none, sizeof bytes);
        memory[3][at] ^= 1;
    }
}
END_TEST

/* 2^32 - 1 is followed by 0: by distance, not by size. */
START_TEST(NO3_the_number_of_an_image_goes_round)
{
    uint8_t bytes[CNC_BACKUP_SIZE], wanted[CNC_BACKUP_SIZE];
    uint32_t number = UINT32_MAX - 2, loaded;
    for (unsigned seed = 1; seed < 6; seed++) {
        fill(wanted, seed);
        ck_assert(cnc_backup_store(&flash, wanted, &number));
        ck_assert(cnc_backup_load(&flash, bytes, &loaded));
        ck_assert_mem_eq(bytes, wanted, sizeof bytes);
        ck_assert_uint_eq(loaded, number);
    }
    ck_assert_uint_eq(number, 2);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("cnc_backup");
    TCase *tests = tcase_create("flash");
    tcase_add_checked_fixture(tests, begin, NULL);
    tcase_add_test(tests, NO3_erased_or_strange_flash_is_empty_memory);
    tcase_add_test(tests, NO3_what_was_stored_last_comes_back);
    tcase_add_test(tests, NO3_a_power_cut_leaves_the_old_content_or_the_new_one);
    tcase_add_test(tests, NO3_a_block_that_cannot_be_read_costs_its_image_alone);
    tcase_add_test(tests, NO3_an_image_of_another_size_does_not_count);
    tcase_add_test(tests, NO3_the_number_of_an_image_goes_round);
    suite_add_tcase(suite, tests);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
