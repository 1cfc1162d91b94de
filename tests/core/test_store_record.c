/* SPDX-License-Identifier: MIT */
/* test_store_record.c: the bytes of a record in flash (docs/SPEC.md, "Flash") and which of them are trusted, U5. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "crc32.h"
#include "store_rig.h"

/* Record of motor 2, generation 1: S100 V1000 F5 R =-7 I05H20. */
static const uint8_t record[] = {
    0x52, 0x4b, 0x34, 0x50, 0x01, 0x02, 0x06, 0x00, 0x01, 0x00, 0x00, 0x00, 0x52, 0x85, 0x1f, 0x7c, /* header */
    0x53, 0x64, 0x00, 0x00, 0x00, 0x56, 0xe8, 0x03, 0x00, 0x00, 0x46, 0x05, 0x00, 0x00, 0x00,       /* S V F */
    0x52, 0x00, 0x00, 0x00, 0x00, 0x3d, 0xf9, 0xff, 0xff, 0xff, 0x49, 0x05, 0x01, 0x14, 0x00,       /* R = I */
    0xff, 0xff,
};
#define COMMANDS_AT 16
#define COMMANDS_LENGTH 30

static void fill_example(struct rkm04_program *program)
{
    program_clear(program);
    program_append(program, (struct rkm04_command){'S', 100});
    program_append(program, (struct rkm04_command){'V', 1000});
    program_append(program, (struct rkm04_command){'F', 5});
    program_append(program, (struct rkm04_command){'R', 0});
    program_append(program, (struct rkm04_command){'=', (uint32_t)-7});
    program_append(program, (struct rkm04_command){'I', 5 | 1 << 8 | 20 << 16});
}

START_TEST(U5_the_check_value_of_123456789_is_CBF43926)
{
    ck_assert_uint_eq(crc32_update(0, (const uint8_t *)"123456789", 9), 0xcbf43926u);
    ck_assert_uint_eq(crc32_update(crc32_update(0, (const uint8_t *)"1234", 4), (const uint8_t *)"56789", 5), 0xcbf43926u);
}
END_TEST

START_TEST(U5_a_record_has_the_documented_bytes)
{
    struct rkm04_program program;
    fill_example(&program);
    ck_assert_int_eq(save(2, &program), 0);
    ck_assert_mem_eq(flash.data[2], record, sizeof record);
    for (unsigned block = 0; block < RKM04_FLASH_BLOCKS; block++)
        for (unsigned i = block == 2 ? sizeof record : 0; i < RKM04_FLASH_BLOCK_SIZE; i++)
            ck_assert_uint_eq(flash.data[block][i], 0xff);
}
END_TEST

/* Put a record into a block as another writer might have, its check value made right again. */
static void plant(unsigned block, const uint8_t *bytes)
{
    uint8_t copy[sizeof record];
    memcpy(copy, bytes, sizeof copy);
    uint32_t check = crc32_update(crc32_update(0, copy, 12), copy + COMMANDS_AT, COMMANDS_LENGTH);
    for (int i = 0; i < 4; i++)
        copy[12 + i] = (uint8_t)(check >> 8 * i);
    memset(flash.data[block], 0xff, RKM04_FLASH_BLOCK_SIZE);
    memcpy(flash.data[block], copy, sizeof copy);
}

START_TEST(U5_the_documented_bytes_are_loaded)
{
    struct rkm04_program program;
    fill_example(&program);
    memcpy(flash.data[2], record, sizeof record);
    assert_slot(2, &program);
    memset(flash.data[2], 0xff, RKM04_FLASH_BLOCK_SIZE);
    memcpy(flash.data[3], record, sizeof record);
    assert_slot(2, &program);
}
END_TEST

static const struct {
    const char *what;
    unsigned at;
    uint8_t byte;
} spoiled[] = {
    {"another magic", 0, 'r'},
    {"another magic", 3, 'Q'},
    {"a later version", 4, 2},
    {"version 0", 4, 0},
    {"the record of another motor", 5, 3},
    {"a character that is no command", COMMANDS_AT, 'a'},
    {"an erased byte as a command", COMMANDS_AT, 0xff},
    {"a reset", COMMANDS_AT + 15, '\\'},
    {"K", COMMANDS_AT + 15, 'K'},
    {"S2148", COMMANDS_AT + 2, 8},
    {"V66536", COMMANDS_AT + 8, 1},
    {"R with a number", COMMANDS_AT + 16, 1},
    {"=-2130706439", COMMANDS_AT + 24, 0x80},
    {"I09H20", COMMANDS_AT + 26, 9},
    {"a level that is neither H nor L", COMMANDS_AT + 27, 2},
    {"I05H81", COMMANDS_AT + 28, 81},
    {"I05H00", COMMANDS_AT + 28, 0},
    {"an argument of I that says too much", COMMANDS_AT + 29, 1},
};

START_TEST(U5_a_record_with_a_right_check_value_and_a_wrong_content_is_not_trusted)
{
    uint8_t bytes[sizeof record];
    memcpy(bytes, record, sizeof bytes);
    bytes[spoiled[_i].at] = spoiled[_i].byte;
    plant(2, bytes);
    struct rkm04_program found;
    ck_assert_msg(load(2, &found) == RKM04_SLOT_UNTRUSTED && program_count(&found) == 0, "%s was trusted", spoiled[_i].what);
}
END_TEST

START_TEST(U5_a_label_out_of_range_or_C75_is_not_trusted)
{
    static const struct rkm04_command bad[] = {{'@', 0}, {'@', 81}, {'C', 75}, {'@', UINT32_MAX}, {'I', UINT32_MAX}, {0, 0}};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        uint8_t bytes[sizeof record];
        memcpy(bytes, record, sizeof bytes);
        bytes[COMMANDS_AT] = bad[i].op;
        for (int j = 0; j < 4; j++)
            bytes[COMMANDS_AT + 1 + j] = (uint8_t)(bad[i].argument >> 8 * j);
        plant(2, bytes);
        assert_untrusted(2);
    }
}
END_TEST

START_TEST(U5_a_record_of_701_commands_is_not_trusted)
{
    static const uint8_t r[5] = {'R'};
    for (unsigned count = RKM04_PROGRAM_MAX; count <= RKM04_PROGRAM_MAX + 1; count++) {
        uint8_t *block = flash.data[2];
        memset(block, 0xff, RKM04_FLASH_BLOCK_SIZE);
        memcpy(block, record, COMMANDS_AT);
        block[6] = (uint8_t)count;
        block[7] = (uint8_t)(count >> 8);
        for (unsigned i = 0; i < count; i++)
            memcpy(block + COMMANDS_AT + 5 * i, r, sizeof r);
        uint32_t check = crc32_update(crc32_update(0, block, 12), block + COMMANDS_AT, 5 * count);
        for (int i = 0; i < 4; i++)
            block[12 + i] = (uint8_t)(check >> 8 * i);
        struct rkm04_program found;
        ck_assert_int_eq(load(2, &found), count <= RKM04_PROGRAM_MAX ? RKM04_SLOT_LOADED : RKM04_SLOT_UNTRUSTED);
    }
}
END_TEST

START_TEST(U5_a_record_with_any_bit_changed_is_not_trusted)
{
    struct rkm04_program program;
    fill_example(&program);
    ck_assert_int_eq(save(2, &program), 0);
    for (unsigned bit = 0; bit < 8 * (COMMANDS_AT + COMMANDS_LENGTH); bit++) {
        flash.data[2][bit / 8] ^= (uint8_t)(1u << bit % 8);
        assert_untrusted(2);
        flash.data[2][bit / 8] ^= (uint8_t)(1u << bit % 8);
    }
    assert_slot(2, &program);
}
END_TEST

START_TEST(U5_a_full_record_with_any_byte_changed_is_not_trusted)
{
    ck_assert_int_eq(save(4, &programs[WRAPPED]), 0);
    for (unsigned at = 0; at < COMMANDS_AT + 5 * RKM04_PROGRAM_MAX; at++) {
        flash.data[6][at] ^= 0xff;
        assert_untrusted(4);
        flash.data[6][at] ^= 0xff;
    }
    assert_slot(4, &programs[WRAPPED]);
}
END_TEST

START_TEST(U5_if_the_newest_record_is_spoiled_the_one_before_is_loaded)
{
    ck_assert_int_eq(save(1, &programs[SHORT]), 0);
    ck_assert_int_eq(save(1, &programs[FULL]), 0);
    flash.data[1][1234] ^= 0x10;
    assert_slot(1, &programs[SHORT]);
    ck_assert_int_eq(save(1, &programs[ONE]), 0);
    assert_slot(1, &programs[ONE]);
}
END_TEST

START_TEST(U5_generations_count_on_through_zero)
{
    uint8_t bytes[sizeof record];
    memcpy(bytes, record, sizeof bytes);
    memset(bytes + 8, 0xff, 4);
    bytes[8] = 0xfd;
    plant(3, bytes);
    for (unsigned i = 0; i < 6; i++) {
        fill(&programs[ONE], 50 + i, 1);
        ck_assert_int_eq(save(2, &programs[ONE]), 0);
        assert_slot(2, &programs[ONE]);
    }
    ck_assert_uint_eq(flash.data[3][8], 0x03);
    ck_assert_uint_eq(flash.data[3][11], 0x00);
    ck_assert_uint_eq(flash.data[2][8], 0x02);
}
END_TEST

START_TEST(U5_garbage_in_the_flash_is_not_trusted_and_can_be_stored_over)
{
    uint32_t random = 1;
    for (int round = 0; round < 200; round++) {
        for (unsigned i = 0; i < RKM04_FLASH_BLOCK_SIZE; i++) {
            random = random * 1664525u + 1013904223u;
            flash.data[4][i] = (uint8_t)(random >> 24);
            flash.data[5][i] = (uint8_t)(random >> 16);
        }
        assert_untrusted(3);
    }
    ck_assert_int_eq(save(3, &programs[SHORT]), 0);
    assert_slot(3, &programs[SHORT]);
}
END_TEST

/* A flash whose cells lose their contents one by one: the reads from the n-th on get one bit wrong. */
static unsigned reads_before_decay;

static int decaying_read(void *context, unsigned block, unsigned offset, void *data, unsigned length)
{
    int error = flash_fake_read(context, block, offset, data, length);
    if (reads_before_decay > 0)
        reads_before_decay--;
    if (reads_before_decay == 0 && length > 1)
        ((uint8_t *)data)[length - 1] ^= 1;
    return error;
}

START_TEST(U5_a_record_that_reads_otherwise_the_second_time_is_not_trusted)
{
    const struct rkm04_port port = {.flash_read = decaying_read};
    struct rkm04_program found;
    memcpy(flash.data[2], record, sizeof record);
    reads_before_decay = 100;
    ck_assert_int_eq(store_load(&port, &flash, 2, &found), RKM04_SLOT_LOADED);
    /* Loading looks at both blocks (three reads: two headers, the commands), then reads the chosen one into memory. */
    for (unsigned good = 3; good <= 4; good++) {
        reads_before_decay = good + 1;
        ck_assert_int_eq(store_load(&port, &flash, 2, &found), RKM04_SLOT_UNTRUSTED);
        ck_assert_uint_eq(program_count(&found), 0);
    }
}
END_TEST

START_TEST(U5_of_two_records_of_the_same_generation_one_is_loaded)
{
    struct rkm04_program program;
    fill_example(&program);
    plant(2, record);
    plant(3, record);
    assert_slot(2, &program);
}
END_TEST

START_TEST(U5_garbage_in_either_block_beside_a_blank_one_is_not_trusted)
{
    for (unsigned block = 2; block <= 3; block++) {
        flash_fake_init(&flash);
        memset(flash.data[block], 0x5a, 100);
        assert_untrusted(2);
    }
}
END_TEST

static int ignore_erase(void *context, unsigned block)
{
    (void)context, (void)block;
    return 0;
}

static int ignore_program(void *context, unsigned block, unsigned offset, const void *data, unsigned length)
{
    (void)context, (void)block, (void)offset, (void)data, (void)length;
    return 0;
}

START_TEST(P6_a_flash_that_does_nothing_and_says_all_is_well_is_an_error)
{
    const struct rkm04_port port = {.flash_read = flash_fake_read, .flash_erase = ignore_erase, .flash_program = ignore_program};
    struct rkm04_program program;
    fill_example(&program);
    ck_assert_int_eq(store_save(&port, &flash, 2, &program), 1);
    plant(2, record); /* whole records, but not the one that was to be written */
    plant(3, record);
    program_append(&program, (struct rkm04_command){'U', 0});
    ck_assert_int_eq(store_save(&port, &flash, 2, &program), 1);
}
END_TEST

static Suite *record_suite(void)
{
    Suite *suite = suite_create("store_record");
    TCase *bytes = add_store_case(suite, "bytes", 30);
    tcase_add_test(bytes, U5_the_check_value_of_123456789_is_CBF43926);
    tcase_add_test(bytes, U5_a_record_has_the_documented_bytes);
    tcase_add_test(bytes, U5_the_documented_bytes_are_loaded);
    tcase_add_loop_test(bytes, U5_a_record_with_a_right_check_value_and_a_wrong_content_is_not_trusted, 0,
                        sizeof spoiled / sizeof spoiled[0]);
    tcase_add_test(bytes, U5_a_label_out_of_range_or_C75_is_not_trusted);
    tcase_add_test(bytes, U5_a_record_of_701_commands_is_not_trusted);
    tcase_add_test(bytes, U5_a_record_with_any_bit_changed_is_not_trusted);
    tcase_add_test(bytes, U5_a_full_record_with_any_byte_changed_is_not_trusted);
    tcase_add_test(bytes, U5_if_the_newest_record_is_spoiled_the_one_before_is_loaded);
    tcase_add_test(bytes, U5_generations_count_on_through_zero);
    tcase_add_test(bytes, U5_garbage_in_the_flash_is_not_trusted_and_can_be_stored_over);
    tcase_add_test(bytes, U5_a_record_that_reads_otherwise_the_second_time_is_not_trusted);
    tcase_add_test(bytes, U5_of_two_records_of_the_same_generation_one_is_loaded);
    tcase_add_test(bytes, U5_garbage_in_either_block_beside_a_blank_one_is_not_trusted);
    tcase_add_test(bytes, P6_a_flash_that_does_nothing_and_says_all_is_well_is_an_error);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(record_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed > 0)
        printf("One case alone: CK_RUN_CASE=bytes ./test_store_record\n");
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
