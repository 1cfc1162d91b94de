/* SPDX-License-Identifier: MIT */
/* test_prt.c: the messages and their answers, P1-P6 and P8 of the specification, without framing. */
#include <check.h>
#include <stdio.h>
#include <string.h>

#include "rig.h"

#define PROGRAM_MAX 700

static struct rig rig;

static void setup(void)
{
    rig_power_up(&rig, NULL);
}

static void teardown(void)
{
    ck_assert_uint_eq(rig.flash.misuse, 0);
    rig_free(&rig);
}

static void exchange(const char *request, size_t request_length, const char *answer, size_t answer_length)
{
    uint8_t got[512];
    size_t length = rkm04_exchange(&rig.unit, (const uint8_t *)request, request_length, got, sizeof got);
    ck_assert_msg(length == answer_length, "an answer of %zu bytes, not %zu", length, answer_length);
    for (size_t i = 0; i < length; i++)
        ck_assert_msg(got[i] == (uint8_t)answer[i], "byte %zu of the answer is %02X, not %02X", i, got[i], (uint8_t)answer[i]);
}

/* Both are string literals without their final zero. */
#define ASK(request, answer) exchange(request, sizeof(request) - 1, answer, sizeof(answer) - 1)

/* Store the command n times, in one message. */
static int fill(char motor, const char *command, unsigned n)
{
    char text[9000];
    size_t length = 0;
    for (unsigned i = 0; i < n; i++)
        length += (size_t)snprintf(text + length, sizeof text - length, "%s ", command);
    return rkm04_set_command(&rig.unit, motor, text, length, NULL);
}


START_TEST(P1_all_right_is_flag_0_and_character_0)
{
    ASK("\x02" "1F100 R", "\x02" "1\0\0");
}
END_TEST

START_TEST(P1_a_bad_value_is_flag_1_with_the_character_of_the_command)
{
    ASK("\x02" "1A0", "\x02" "1\1A");
    ASK("\x02" "1F1 V16001 R", "\x02" "1\1V");
    ASK("\x02" "2W", "\x02" "2\1W");
    ASK("\x02" "3I01X5", "\x02" "3\1I");
    ASK("\x02" "4=+5", "\x02" "4\1=");
    ASK("\x02" "0F99999999999999999999", "\x02" "0\1F");
}
END_TEST

START_TEST(P1_an_unknown_command_is_flag_2_with_that_character)
{
    ASK("\x02" "1Q", "\x02" "1\2Q");
    ASK("\x02" "1F100 r", "\x02" "1\2r");
    ASK("\x02" "2F100 5", "\x02" "2\2" "5");
    ASK("\x02" "3-", "\x02" "3\2-");
    ASK("\x02" "4F100 {R", "\x02" "4\2{");
    ASK("\x02" "0\xFF", "\x02" "0\2\xFF");
}
END_TEST

START_TEST(P1_an_overflow_is_flag_3_and_character_0)
{
    ck_assert_int_eq(fill('2', "U", PROGRAM_MAX), 0);
    ASK("\x02" "2U", "\x02" "2\3\0");
}
END_TEST

START_TEST(P2_an_error_anywhere_keeps_the_whole_message_from_being_stored_and_executed)
{
    ASK("\x02" "1T01 F100 R Q", "\x02" "1\2Q");
    ASK("\x02" "1T01 F100 R A0", "\x02" "1\1A");
    ck_assert_str_eq(rig_program(&rig, 1), "");
    rig_to(&rig, 1 * SECOND);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
    ck_assert_uint_eq(recorder_steps(&rig.record, 1), 0);
}
END_TEST

START_TEST(P2_a_reset_in_a_message_with_an_error_is_not_done)
{
    rig_accept(&rig, '1', "T01 F1000 R");
    rig_to(&rig, 500 * MS);
    ASK("\x02" "1\\ Q", "\x02" "1\2Q");
    ASK("\x02" "1Q \\ F1", "\x02" "1\2Q");
    ck_assert_str_eq(rig_program(&rig, 1), "T01 F1000 R");
    rig_to(&rig, 3 * SECOND);
    ck_assert_int_eq(rig_motor(&rig, 1).position, 1000);
}
END_TEST

START_TEST(P2_an_error_before_the_last_reset_counts_too)
{
    ASK("\x02" "1A0 \\ F1", "\x02" "1\1A");
    ck_assert_str_eq(rig_program(&rig, 1), "");
}
END_TEST

START_TEST(P2_the_first_error_in_the_text_is_reported)
{
    ASK("\x02" "1F1 A0 Q", "\x02" "1\1A");
    ASK("\x02" "1F1 Q A0", "\x02" "1\2Q");
}
END_TEST

START_TEST(P2_no_text_at_all_is_all_right)
{
    ASK("\x02" "1", "\x02" "1\0\0");
    ASK("\x02" "1 \t\r\n{ nothing }", "\x02" "1\0\0");
    ck_assert_uint_eq(rig_motor(&rig, 1).commands, 0);
}
END_TEST

START_TEST(P3_motor_0_stores_the_text_for_all_four)
{
    ASK("\x02" "0F100 R", "\x02" "0\0\0");
    rig_to(&rig, 1 * SECOND);
    for (unsigned motor = 1; motor <= 4; motor++) {
        ck_assert_str_eq(rig_program(&rig, motor), "F100 R");
        ck_assert_int_eq(rig_motor(&rig, motor).position, 100);
    }
}
END_TEST

START_TEST(P3_the_flag_for_motor_0_is_the_worst_of_the_four)
{
    ck_assert_int_eq(fill('3', "U", PROGRAM_MAX), 0);
    ASK("\x02" "0T01", "\x02" "0\3\0");
    ck_assert_str_eq(rig_program(&rig, 4), "T01");
}
END_TEST

START_TEST(P3_each_motor_decides_for_itself_whether_memory_is_overwritten)
{
    rig_accept(&rig, '3', "T40");
    rig_to(&rig, 2 * MS);
    ck_assert_int_eq(fill('3', "U", PROGRAM_MAX - 1), 0);
    ck_assert_int_eq(fill('2', "U", PROGRAM_MAX), 0);
    ASK("\x02" "0D", "\x02" "0\3\0");
    const char *second = rig_program(&rig, 2);
    ck_assert_str_eq(second + strlen(second) - 3, "U D");
    const char *third = rig_program(&rig, 3);
    ck_assert_str_eq(third + strlen(third) - 3, "U U");
}
END_TEST

START_TEST(P3_each_motor_decides_for_itself_whether_a_speed_is_a_change_of_speed)
{
    rig_accept(&rig, '1', "F5000 R");
    rig_to(&rig, 1 * SECOND);
    ASK("\x02" "0V500", "\x02" "0\0\0");
    ck_assert_str_eq(rig_program(&rig, 1), "F5000 R");
    ck_assert_str_eq(rig_program(&rig, 2), "V500");
}
END_TEST

START_TEST(P4_set_command_for_a_wrong_motor_is_flag_1_with_that_character)
{
    ASK("\x02" "5F100 R", "\x02" "5\1" "5");
    ASK("\x02" "\\ F100 R", "\x02" "\\\1\\");
    ASK("\x02" "\x01" "F100 R", "\x02\x01\x01\x01");
    for (unsigned motor = 1; motor <= 4; motor++)
        ck_assert_uint_eq(rig_motor(&rig, motor).commands, 0);
}
END_TEST

START_TEST(P4_set_command_without_a_motor_is_flag_1_for_motor_0_with_character_0)
{
    ASK("\x02", "\x02" "0\1\0");
}
END_TEST


START_TEST(P4_store_flash_for_a_wrong_or_missing_motor_is_error_1)
{
    ASK("\x03" "5", "\x03" "5\1");
    ASK("\x03", "\x03" "0\1");
    ck_assert_uint_eq(rig.flash.operations, 0);
}
END_TEST

START_TEST(P4_extra_bytes_after_a_complete_request_are_ignored)
{
    ASK("\x01garbage", "\x01\x10" "01.02,06.03.2009");
    ASK("\x03" "1garbage", "\x03" "1\0");
    ASK("\x04" "1garbage", "\x04" "1\x0A" "         0");
    ASK("\x05" "1garbage", "\x05" "1");
    ASK("\x06" "1garbage", "\x06" "1 0;[]");
    ASK("\x07" "1garbage", "\x07" "1 0; 0");
    ASK("\x09garbage", "\xFF\x09\0\0");
}
END_TEST

START_TEST(P4_an_empty_message_gets_no_answer)
{
    ASK("", "");
}
END_TEST

START_TEST(P6_a_stored_program_starts_by_itself_after_power_up)
{
    rig_accept(&rig, '2', "F100 R");
    ASK("\x03" "2", "\x03" "2\0");
    rig_power_cycle(&rig);
    ck_assert_int_eq(rig_motor(&rig, 2).slot, RKM04_SLOT_LOADED);
    rig_to(&rig, 1 * SECOND);
    rig_expect_motion(&rig, 2, 1, 2000, 2000 + move_ticks(100, 1000, 2000, 100), 100, true);
}
END_TEST

START_TEST(P6_motor_0_stores_all_four)
{
    const char *text[] = {"W1", "W2", "W3", "W4"};
    for (unsigned motor = 1; motor <= 4; motor++)
        rig_accept(&rig, (char)('0' + motor), text[motor - 1]);
    ASK("\x03" "0", "\x03" "0\0");
    rig_power_cycle(&rig);
    for (unsigned motor = 1; motor <= 4; motor++)
        ck_assert_str_eq(rig_program(&rig, motor), text[motor - 1]);
}
END_TEST

START_TEST(P6_all_four_are_tried_when_one_fails)
{
    rig_accept(&rig, '0', "W5");
    flash_fake_arm(&rig.flash, 1, FLASH_FAIL_NOTHING, 1);
    uint8_t answer[8];
    ck_assert_uint_eq(rkm04_exchange(&rig.unit, (const uint8_t *)"\x03" "0", 2, answer, sizeof answer), 3);
    ck_assert_uint_ne(answer[2], 0);
    rig_power_cycle(&rig);
    ck_assert_str_eq(rig_program(&rig, 1), "");
    for (unsigned motor = 2; motor <= 4; motor++)
        ck_assert_str_eq(rig_program(&rig, motor), "W5");
}
END_TEST

START_TEST(P6_a_failed_write_is_an_error_and_keeps_the_program_stored_before)
{
    rig_accept(&rig, '1', "W1");
    ASK("\x03" "1", "\x03" "1\0");
    rig_accept(&rig, '1', "W2");
    flash_fake_arm(&rig.flash, 1, FLASH_FAIL_NOTHING, 1);
    uint8_t answer[8];
    ck_assert_uint_eq(rkm04_exchange(&rig.unit, (const uint8_t *)"\x03" "1", 2, answer, sizeof answer), 3);
    ck_assert_uint_ne(answer[2], 0);
    rig_power_cycle(&rig);
    ck_assert_str_eq(rig_program(&rig, 1), "W1");
}
END_TEST

START_TEST(P6_what_is_stored_is_every_command_since_the_last_reset)
{
    rig_accept(&rig, '1', "F1 R");
    rig_accept(&rig, '1', "F2 R \\ V500");
    rig_accept(&rig, '1', "F3 R");
    ASK("\x03" "1", "\x03" "1\0");
    rig_accept(&rig, '1', "F4 R");
    rig_power_cycle(&rig);
    ck_assert_str_eq(rig_program(&rig, 1), "V500 F3 R");
}
END_TEST

START_TEST(P6_a_wrapped_memory_is_stored_oldest_command_first)
{
    ck_assert_int_eq(fill('1', "U", PROGRAM_MAX), 0);
    ck_assert_int_eq(rig_set(&rig, '1', "D H"), 3);
    ASK("\x03" "1", "\x03" "1\0");
    rig_power_cycle(&rig);
    const char *program = rig_program(&rig, 1);
    ck_assert_uint_eq(strlen(program), 2 * PROGRAM_MAX - 1);
    ck_assert_int_eq(strncmp(program, "U U", 3), 0);
    ck_assert_str_eq(program + strlen(program) - 5, "U D H");
}
END_TEST

START_TEST(P6_storing_does_not_disturb_a_running_program)
{
    rig_accept(&rig, '1', "F1000 R W10 T01");
    rig_to(&rig, 700 * MS);
    ASK("\x03" "1", "\x03" "1\0");
    rig_to(&rig, 3 * SECOND);
    uint64_t end = 2000 + move_ticks(100, 1000, 2000, 1000);
    rig_expect_motion(&rig, 1, 1, 2000, end, 1000, true);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), slot_behind(end) + 10 * MS);
}
END_TEST

START_TEST(P6_an_empty_program_empties_the_slot)
{
    rig_accept(&rig, '1', "W1");
    ASK("\x03" "1", "\x03" "1\0");
    ck_assert_int_eq(rig_motor(&rig, 1).slot, RKM04_SLOT_STORED);
    rig_accept(&rig, '1', "\\");
    ASK("\x03" "1", "\x03" "1\0");
    ck_assert_int_eq(rig_motor(&rig, 1).slot, RKM04_SLOT_EMPTY);
    rig_power_cycle(&rig);
    ck_assert_str_eq(rig_program(&rig, 1), "");
    ck_assert_int_eq(rig_motor(&rig, 1).slot, RKM04_SLOT_EMPTY);
}
END_TEST


START_TEST(M5_3_4_the_counter_is_right_aligned_in_ten_characters)
{
    rig_accept(&rig, '1', "=5000");
    rig_accept(&rig, '2', "=-7");
    rig_accept(&rig, '3', "=2000000000");
    rig_accept(&rig, '4', "=-999999999");
    rig_to(&rig, 2 * MS);
    ASK("\x04" "1", "\x04" "1\x0A" "      5000");
    ASK("\x04" "0", "\x04" "0\x0A" "      5000" "\x0A" "        -7" "\x0A" "2000000000" "\x0A" "-999999999");
}
END_TEST

START_TEST(M5_3_4_a_counter_of_minus_1_000_000_000_and_below_takes_eleven_characters)
{
    rig_accept(&rig, '2', "=-1000000000");
    rig_accept(&rig, '3', "=-2000000000");
    rig_to(&rig, 2 * MS);
    ASK("\x04" "2", "\x04" "2\x0B" "-1000000000");
    ASK("\x04" "0", "\x04" "0\x0A" "         0" "\x0B" "-1000000000" "\x0B" "-2000000000" "\x0A" "         0");
}
END_TEST

START_TEST(P4_asking_a_wrong_motor_is_answered_like_motor_0_of_P5)
{
    ASK("\x04" "5", "\x04" "5ERROR COMMAND! ");
    ASK("\x05" "5", "\x05" "5ERROR COMMAND! ");
    ASK("\x06" "/", "\x06" "/ERROR COMMAND! ");
    ASK("\x07" "\1", "\x07" "\1ERROR COMMAND! ");
}
END_TEST

START_TEST(P4_a_missing_motor_is_answered_as_motor_0)
{
    ASK("\x05", "\x05" "0ERROR COMMAND! ");
    ASK("\x06", "\x06" "0ERROR COMMAND! ");
    ASK("\x07", "\x07" "0ERROR COMMAND! ");
}
END_TEST


START_TEST(P8_the_text_is_canonical)
{
    rig_accept(&rig, '1', "@007A00500 M5 I 1 H 020{c}T1C80 T\n55 \"3 '4 G+G -G0005=-05 =0 )8(08.W1[ ]O3Z95 C100C7");
    ck_assert_str_eq(rig_program(&rig, 1),
                     "@7 A500 M05 I01H20 T01 C80 T55 '3 '4 G+ G- G5 =-5 =0 )08 (08 . W1 [ ] O03 Z95 C100 C07");
}
END_TEST

START_TEST(P8_the_call_has_one_canonical_character)
{
    rig_accept(&rig, '1', "'1 \"2 \xB4" "3 \x84" "4");
    ck_assert_str_eq(rig_program(&rig, 1), "'1 '2 '3 '4");
}
END_TEST

START_TEST(P8_feeding_the_text_back_gives_the_same_program)
{
    static const char text[] = "A60000 B16000000 C08 C40 C58 C95 C100 D E F1 G2000000000 G+ G- H I95L80 J80 L255 M01 N08 O80 R "
                               "S2000 T58 U V16000 W16000000 X04 Y Z01 )01 (08 =-2000000000 =2000000000 '80 . [ ] @80";
    rig_accept(&rig, '1', text);
    ck_assert_str_eq(rig_program(&rig, 1), text);
    char again[512];
    strcpy(again, rig_program(&rig, 1));
    rig_accept(&rig, '2', again);
    ck_assert_str_eq(rig_program(&rig, 2), text);
}
END_TEST

START_TEST(P8_the_oldest_command_comes_first_after_a_wrap)
{
    ck_assert_int_eq(fill('1', "U", PROGRAM_MAX - 1), 0);
    ck_assert_int_eq(rig_set(&rig, '1', "H D R"), 3);
    const char *program = rig_program(&rig, 1);
    ck_assert_uint_eq(strlen(program), 2 * PROGRAM_MAX - 1);
    ck_assert_str_eq(program + strlen(program) - 7, "U H D R");
}
END_TEST


START_TEST(M5_3_8_every_number_but_1_to_7_is_unknown)
{
    for (unsigned number = 0; number < 256; number++) {
        uint8_t request = (uint8_t)number, answer[64] = {0};
        size_t length = rkm04_exchange(&rig.unit, &request, 1, answer, sizeof answer);
        if (number >= 1 && number <= 7) {
            ck_assert_uint_eq(answer[0], number);
        } else {
            ck_assert_uint_eq(length, 4);
            ck_assert_int_eq(memcmp(answer, (uint8_t[]){255, request, 0, 0}, 4), 0);
        }
    }
}
END_TEST

START_TEST(M5_3_1_the_version_text_is_configurable_up_to_255_characters)
{
    static char text[256];
    memset(text, 'v', 255);
    rig_power_up(&rig, &(struct rkm04_config){.node = 1, .version_text = text});
    uint8_t answer[300];
    ck_assert_uint_eq(rkm04_exchange(&rig.unit, (const uint8_t *)"\x01", 1, answer, sizeof answer), 257);
    ck_assert_uint_eq(answer[1], 255);
    ck_assert_int_eq(memcmp(answer + 2, text, 255), 0);
}
END_TEST

START_TEST(exchange_gives_a_small_room_the_answers_beginning_and_the_whole_length)
{
    uint8_t answer[4] = {0, 0, 0, 0xEE};
    ck_assert_uint_eq(rkm04_exchange(&rig.unit, (const uint8_t *)"\x04" "1", 2, answer, 3), 13);
    ck_assert_int_eq(memcmp(answer, "\x04" "1\x0A\xEE", 4), 0);
}
END_TEST

static Suite *prt_suite(void)
{
    Suite *suite = suite_create("prt");

    TCase *set_command = tcase_create("set_command");
    tcase_add_checked_fixture(set_command, setup, teardown);
    tcase_add_test(set_command, P1_all_right_is_flag_0_and_character_0);
    tcase_add_test(set_command, P1_a_bad_value_is_flag_1_with_the_character_of_the_command);
    tcase_add_test(set_command, P1_an_unknown_command_is_flag_2_with_that_character);
    tcase_add_test(set_command, P1_an_overflow_is_flag_3_and_character_0);
    tcase_add_test(set_command, P2_an_error_anywhere_keeps_the_whole_message_from_being_stored_and_executed);
    tcase_add_test(set_command, P2_a_reset_in_a_message_with_an_error_is_not_done);
    tcase_add_test(set_command, P2_an_error_before_the_last_reset_counts_too);
    tcase_add_test(set_command, P2_the_first_error_in_the_text_is_reported);
    tcase_add_test(set_command, P2_no_text_at_all_is_all_right);
    tcase_add_test(set_command, P3_motor_0_stores_the_text_for_all_four);
    tcase_add_test(set_command, P3_the_flag_for_motor_0_is_the_worst_of_the_four);
    tcase_add_test(set_command, P3_each_motor_decides_for_itself_whether_memory_is_overwritten);
    tcase_add_test(set_command, P3_each_motor_decides_for_itself_whether_a_speed_is_a_change_of_speed);
    tcase_add_test(set_command, P4_set_command_for_a_wrong_motor_is_flag_1_with_that_character);
    tcase_add_test(set_command, P4_set_command_without_a_motor_is_flag_1_for_motor_0_with_character_0);
    suite_add_tcase(suite, set_command);

    TCase *store_flash = tcase_create("store_flash");
    tcase_add_checked_fixture(store_flash, setup, teardown);
    tcase_add_test(store_flash, P4_store_flash_for_a_wrong_or_missing_motor_is_error_1);
    tcase_add_test(store_flash, P4_extra_bytes_after_a_complete_request_are_ignored);
    tcase_add_test(store_flash, P4_an_empty_message_gets_no_answer);
    tcase_add_test(store_flash, P6_a_stored_program_starts_by_itself_after_power_up);
    tcase_add_test(store_flash, P6_motor_0_stores_all_four);
    tcase_add_test(store_flash, P6_all_four_are_tried_when_one_fails);
    tcase_add_test(store_flash, P6_a_failed_write_is_an_error_and_keeps_the_program_stored_before);
    tcase_add_test(store_flash, P6_what_is_stored_is_every_command_since_the_last_reset);
    tcase_add_test(store_flash, P6_a_wrapped_memory_is_stored_oldest_command_first);
    tcase_add_test(store_flash, P6_storing_does_not_disturb_a_running_program);
    tcase_add_test(store_flash, P6_an_empty_program_empties_the_slot);
    suite_add_tcase(suite, store_flash);

    TCase *position = tcase_create("position");
    tcase_add_checked_fixture(position, setup, teardown);
    tcase_add_test(position, M5_3_4_the_counter_is_right_aligned_in_ten_characters);
    tcase_add_test(position, M5_3_4_a_counter_of_minus_1_000_000_000_and_below_takes_eleven_characters);
    tcase_add_test(position, P4_asking_a_wrong_motor_is_answered_like_motor_0_of_P5);
    tcase_add_test(position, P4_a_missing_motor_is_answered_as_motor_0);
    suite_add_tcase(suite, position);

    TCase *program_text = tcase_create("program_text");
    tcase_add_checked_fixture(program_text, setup, teardown);
    tcase_add_test(program_text, P8_the_text_is_canonical);
    tcase_add_test(program_text, P8_the_call_has_one_canonical_character);
    tcase_add_test(program_text, P8_feeding_the_text_back_gives_the_same_program);
    tcase_add_test(program_text, P8_the_oldest_command_comes_first_after_a_wrap);
    suite_add_tcase(suite, program_text);

    TCase *others = tcase_create("others");
    tcase_add_checked_fixture(others, setup, teardown);
    tcase_add_test(others, M5_3_8_every_number_but_1_to_7_is_unknown);
    tcase_add_test(others, M5_3_1_the_version_text_is_configurable_up_to_255_characters);
    tcase_add_test(others, exchange_gives_a_small_room_the_answers_beginning_and_the_whole_length);
    suite_add_tcase(suite, others);

    return suite;
}

int main(void)
{
    return rig_run(prt_suite(), "./test_prt");
}
