/* SPDX-License-Identifier: MIT */
/* Frames of Modbus RTU. The frames with check values were made by pymodbus 3.16. */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "modbus/modbus.h"

static const uint8_t single[] = {0x01, 0x06, 0x00, 0x00, 0x01, 0x20, 0x89, 0x82};
static const uint8_t block[] = {0x01, 0x10, 0x00, 0x01, 0x00, 0x03, 0x06, 0x61, 0x03, 0x07, 0xD0, 0x00, 0x64, 0xFA, 0x52};
static const uint8_t refusal[] = {0x01, 0x86, 0x03, 0x02, 0x61};
static const uint8_t reading[] = {0x01, 0x03, 0x10, 0x00, 0x0A, 0x01, 0x90, 0x01, 0x90, 0x00, 0x32,
                                  0x00, 0x0A, 0x00, 0x64, 0x03, 0xE8, 0x1F, 0x40, 0xB0, 0x16};

START_TEST(check_value)
{
    ck_assert_uint_eq(modbus_crc((const uint8_t *)"123456789", 9), 0x4B37);
    ck_assert(modbus_is_frame(single, sizeof single));
    ck_assert(modbus_is_frame(block, sizeof block));
    uint8_t frame[sizeof block];
    memcpy(frame, block, sizeof block - 2);
    ck_assert_uint_eq(modbus_append_crc(frame, sizeof block - 2), sizeof block);
    ck_assert_mem_eq(frame, block, sizeof block);
    for (unsigned bit = 0; bit < 8u * sizeof block; bit++) {
        memcpy(frame, block, sizeof block);
        frame[bit / 8] ^= (uint8_t)(1u << bit % 8);
        ck_assert_msg(!modbus_is_frame(frame, sizeof block), "bit %u", bit);
    }
}
END_TEST

START_TEST(shortest_and_longest_frame)
{
    uint8_t frame[MODBUS_FRAME_MAX + 1] = {1, 7};
    ck_assert(!modbus_is_frame(frame, modbus_append_crc(frame, 1)));
    ck_assert(modbus_is_frame(frame, modbus_append_crc(frame, 2)));
    ck_assert(modbus_is_frame(frame, modbus_append_crc(frame, MODBUS_FRAME_MAX - 2)));
    ck_assert(!modbus_is_frame(frame, modbus_append_crc(frame, MODBUS_FRAME_MAX - 1)));
    ck_assert(!modbus_is_frame(frame, 0));
}
END_TEST

static void expect_length(size_t (*find)(const uint8_t *bytes, size_t length), const uint8_t *frame, size_t known, size_t length)
{
    for (size_t i = 0; i <= length; i++) {
        size_t found = find(frame, i);
        ck_assert_msg(found == (i < known ? 0 : length), "%zu of %zu bytes: %zu", i, length, found);
    }
}

START_TEST(length_of_requests)
{
    expect_length(modbus_request_length, single, 2, sizeof single);
    expect_length(modbus_request_length, block, 7, sizeof block);
    for (uint8_t function = 1; function <= 6; function++)
        ck_assert_uint_eq(modbus_request_length((const uint8_t[]){1, function}, 2), 8);
    ck_assert_uint_eq(modbus_request_length((const uint8_t[]){1, 15, 0, 0, 0, 1, 1}, 7), 10);
    ck_assert_uint_eq(modbus_request_length((const uint8_t[]){1, 16, 0, 0, 0, 1, 247}, 7), 256);
    ck_assert_uint_eq(modbus_request_length((const uint8_t[]){1, 16, 0, 0, 0, 1, 248}, 7), MODBUS_NO_LENGTH);
    const uint8_t others[] = {0, 7, 14, 17, 0x86, 255};
    for (size_t i = 0; i < sizeof others; i++)
        ck_assert_uint_eq(modbus_request_length((const uint8_t[]){1, others[i]}, 2), MODBUS_NO_LENGTH);
}
END_TEST

START_TEST(length_of_answers)
{
    expect_length(modbus_answer_length, refusal, 2, sizeof refusal);
    expect_length(modbus_answer_length, reading, 3, sizeof reading);
    const uint8_t written[] = {5, 6, 15, 16};
    for (size_t i = 0; i < sizeof written; i++)
        ck_assert_uint_eq(modbus_answer_length((const uint8_t[]){1, written[i]}, 2), 8);
    ck_assert_uint_eq(modbus_answer_length((const uint8_t[]){1, 3, 251}, 3), 256);
    ck_assert_uint_eq(modbus_answer_length((const uint8_t[]){1, 3, 252}, 3), MODBUS_NO_LENGTH);
    const uint8_t others[] = {0, 7, 14, 17, 127};
    for (size_t i = 0; i < sizeof others; i++)
        ck_assert_uint_eq(modbus_answer_length((const uint8_t[]){1, others[i]}, 2), MODBUS_NO_LENGTH);
}
END_TEST

START_TEST(words_and_refusals)
{
    uint8_t frame[8] = {1};
    ck_assert_uint_eq(modbus_append_crc(frame, 1 + modbus_put_exception(frame + 1, 6, MODBUS_ILLEGAL_VALUE)), sizeof refusal);
    ck_assert_mem_eq(frame, refusal, sizeof refusal);
    modbus_put_word(frame, 0x1234);
    ck_assert_mem_eq(frame, ((const uint8_t[]){0x12, 0x34}), 2);
    ck_assert_uint_eq(modbus_word((const uint8_t[]){0xFE, 0xDC}), 0xFEDC);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("modbus");
    TCase *one = tcase_create("modbus");
    tcase_add_test(one, check_value);
    tcase_add_test(one, shortest_and_longest_frame);
    tcase_add_test(one, length_of_requests);
    tcase_add_test(one, length_of_answers);
    tcase_add_test(one, words_and_refusals);
    suite_add_tcase(suite, one);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
