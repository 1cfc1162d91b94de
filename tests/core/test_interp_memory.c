/* SPDX-License-Identifier: MIT */
/* test_interp_memory.c: the program memory as a ring, T40, flash and power-up: C10, U5, U8 of the specification. */
#include <check.h>
#include <stdio.h>
#include <string.h>

#include "rig.h"

#define PLACES 700

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

/* A text: `first`, then n times "U", then `last`. Returns the flag. */
static int set_around(const char *first, unsigned n, const char *last)
{
    char text[4096];
    size_t length = (size_t)snprintf(text, sizeof text, "%s ", first);
    for (unsigned i = 0; i < n; i++)
        length += (size_t)snprintf(text + length, sizeof text - length, "U ");
    length += (size_t)snprintf(text + length, sizeof text - length, "%s", last);
    ck_assert_uint_lt(length, sizeof text);
    return rkm04_set_command(&rig.unit, '1', text, length, NULL);
}

static void store(char motor)
{
    uint8_t answer[3], request[2] = {3, (uint8_t)motor};
    ck_assert_uint_eq(rkm04_exchange(&rig.unit, request, 2, answer, 3), 3);
    ck_assert_uint_eq(answer[2], 0);
}

static void expect_program(const char *first, unsigned n, const char *last)
{
    char text[4096];
    size_t length = (size_t)snprintf(text, sizeof text, "%s", first);
    for (unsigned i = 0; i < n; i++)
        length += (size_t)snprintf(text + length, sizeof text - length, "%sU", length ? " " : "");
    snprintf(text + length, sizeof text - length, "%s%s", length && *last ? " " : "", last);
    ck_assert_str_eq(rig_program(&rig, 1), text);
}

static void expect_fault(enum rkm04_fault fault)
{
    ck_assert_str_eq(rkm04_fault_name(rig_motor(&rig, 1).fault), rkm04_fault_name(fault));
}


START_TEST(C10_700_commands_fit)
{
    ck_assert_int_eq(set_around("T01", PLACES - 2, "T02"), 0);
    ck_assert_uint_eq(rig_motor(&rig, 1).commands, PLACES);
    expect_program("T01", PLACES - 2, "T02");
    rig_to(&rig, 1 * SECOND);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 1 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 3, 1), 700 * MS);
}
END_TEST

START_TEST(C10_the_701st_is_flag_3_and_overwrites_the_oldest)
{
    ck_assert_int_eq(set_around("W1000 T01", PLACES - 2, ""), 0);
    ck_assert_int_eq(rig_set(&rig, '1', "T02"), 3);
    expect_program("T01", PLACES - 2, "T02");
    ck_assert_uint_eq(rig_motor(&rig, 1).commands, PLACES);
}
END_TEST

START_TEST(C10_flag_3_is_for_messages_that_overwrite)
{
    ck_assert_int_eq(set_around("W1000", PLACES - 1, ""), 0);
    ck_assert_int_eq(rig_set(&rig, '1', ""), 0);
    ck_assert_int_eq(rig_set(&rig, '1', "{ nothing }"), 0);
    ck_assert_int_eq(rig_set(&rig, '1', "K"), 0);
    ck_assert_int_eq(rig_set(&rig, '1', "K C75"), 0);
    ck_assert_int_eq(rig_set(&rig, '1', "U"), 3);
    ck_assert_int_eq(rig_set(&rig, '1', "U"), 3);
    ck_assert_int_eq(rig_set(&rig, '1', "\\ U"), 0);
}
END_TEST

START_TEST(C10_a_message_longer_than_the_memory_leaves_its_last_700)
{
    ck_assert_int_eq(set_around("T01 T02 T03", PLACES - 1, "T04"), 3);
    expect_program("", PLACES - 1, "T04");
    rig_to(&rig, 2 * SECOND);
    ck_assert_uint_eq(rig_outputs_became(&rig, 8, 1), 700 * MS); /* begins with the oldest left */
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 8);
    ck_assert_int_eq(rig_motor(&rig, 1).state, RKM04_IDLE);
}
END_TEST

START_TEST(C10_commands_before_a_reset_take_no_room)
{
    char text[4096] = "";
    for (int i = 0; i < 600; i++)
        strcat(text, "U ");
    strcat(text, "\\ ");
    for (int i = 0; i < 650; i++)
        strcat(text, "D ");
    rig_accept(&rig, '1', text);
    ck_assert_uint_eq(rig_motor(&rig, 1).commands, 650);
}
END_TEST

START_TEST(C10_the_command_under_way_ends_with_its_own_values)
{
    rig_accept(&rig, '1', "W100 T01");
    rig_to(&rig, 50 * MS);
    ck_assert_int_eq(set_around("", PLACES - 1, ""), 3); /* over the W */
    rig_to(&rig, 2 * SECOND);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 101 * MS);
}
END_TEST

START_TEST(C10_a_motion_under_way_ends_with_its_own_values)
{
    rig_accept(&rig, '1', "F1000 R T01");
    rig_to(&rig, 50 * MS);
    ck_assert_int_eq(set_around("V77 S77 A77", PLACES - 6, ""), 0);
    ck_assert_int_eq(rig_set(&rig, '1', "U U"), 3); /* over F1000 and R */
    rig_to(&rig, 5 * SECOND);
    uint64_t end = 2 * MS + move_ticks(100, 1000, 2000, 1000);
    rig_expect_motion(&rig, 1, 1, 2 * MS, end, 1000, true);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), slot_behind(end));
}
END_TEST

START_TEST(C10_when_the_next_command_is_overwritten_execution_goes_on_at_the_oldest_left)
{
    rig_accept(&rig, '1', "W100 T01 T02 T03");
    rig_to(&rig, 50 * MS);
    ck_assert_int_eq(set_around("", PLACES - 2, ""), 3); /* over W100 and T01 */
    rig_to(&rig, 2 * SECOND);
    ck_assert_uint_eq(rig_outputs_became(&rig, 2, 1), 101 * MS);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 6);
}
END_TEST

START_TEST(C10_having_reached_the_newest_the_motor_is_idle)
{
    ck_assert_int_eq(set_around("", PLACES, ""), 0);
    rig_to(&rig, 1 * SECOND);
    ck_assert_int_eq(rig_set(&rig, '1', "T01 U"), 3);
    rig_to(&rig, 2 * SECOND);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 1 * SECOND);
    ck_assert_int_eq(rig_motor(&rig, 1).state, RKM04_IDLE);
}
END_TEST

START_TEST(C10_the_index_is_the_place_in_memory)
{
    ck_assert_int_eq(set_around("", PLACES - 1, "O01"), 0);
    rig_to(&rig, 1 * SECOND);
    ck_assert_str_eq(rig_ask(&rig, 7, 1), " 0; 700");
    ck_assert_int_eq(rig_set(&rig, '1', "O02"), 3);
    rig_input_at(&rig, 2 * SECOND, 1, true);
    rig_to(&rig, 3 * SECOND);
    ck_assert_str_eq(rig_ask(&rig, 7, 1), " 0; 1");
}
END_TEST


START_TEST(C10_an_overwritten_label_is_not_in_memory)
{
    ck_assert_int_eq(set_around("@1", PLACES - 1, ""), 0);
    rig_to(&rig, 1 * SECOND);
    ck_assert_int_eq(rig_set(&rig, '1', "J1"), 3); /* stored over the label */
    rig_to(&rig, 2 * SECOND);
    rig_expect_state(&rig, 1, RKM04_WAIT);
}
END_TEST

START_TEST(C10_a_label_that_is_not_overwritten_is_still_there)
{
    ck_assert_int_eq(set_around("U @1 O01 T02", PLACES - 4, ""), 0);
    rig_input_at(&rig, 0, 1, true);
    rig_to(&rig, 1 * SECOND);
    ck_assert_int_eq(rig_set(&rig, '1', "J1"), 3);
    rig_input_at(&rig, 1 * SECOND, 1, false);
    rig_to(&rig, 2 * SECOND);
    expect_fault(RKM04_FAULT_NONE);
    ck_assert_uint_eq(rig_motor(&rig, 1).index, 3);
}
END_TEST

START_TEST(C10_of_two_equal_labels_the_newer_one_survives)
{
    ck_assert_int_eq(set_around("@1 @1 O01", PLACES - 3, ""), 0);
    rig_input_at(&rig, 0, 1, true);
    rig_to(&rig, 1 * SECOND);
    ck_assert_int_eq(rig_set(&rig, '1', "J1"), 3); /* over the older one */
    rig_input_at(&rig, 1 * SECOND, 1, false);
    rig_to(&rig, 2 * SECOND);
    expect_fault(RKM04_FAULT_NONE);
    ck_assert_uint_eq(rig_motor(&rig, 1).index, 3);
}
END_TEST

START_TEST(C10_a_loop_whose_beginning_is_overwritten_is_a_fault)
{
    ck_assert_int_eq(set_around("L2", PLACES - 1, ""), 0);
    rig_to(&rig, 1 * SECOND);
    ck_assert_int_eq(rig_set(&rig, '1', "E"), 3);
    rig_to(&rig, 2 * SECOND);
    expect_fault(RKM04_FAULT_OVERWRITTEN);
}
END_TEST

START_TEST(C10_a_loop_whose_beginning_is_still_there_goes_on)
{
    ck_assert_int_eq(set_around("U L2", PLACES - 2, ""), 0);
    rig_to(&rig, 1 * SECOND);
    ck_assert_int_eq(rig_set(&rig, '1', "E"), 3); /* over the U before the L */
    rig_to(&rig, 3 * SECOND);
    expect_fault(RKM04_FAULT_NONE);
    ck_assert_int_eq(rig_motor(&rig, 1).state, RKM04_IDLE);
    ck_assert_uint_ne(rig_ran(&rig, 1, 3), RKM04_NEVER); /* U once, E twice: on its place */
}
END_TEST

START_TEST(C10_a_return_whose_place_is_overwritten_is_a_fault)
{
    rig_accept(&rig, '1', "'1 T01 @1 W900");
    rig_to(&rig, 100 * MS);
    ck_assert_int_eq(set_around("", PLACES - 3, "."), 3); /* over the call and T01, where the . would return to */
    rig_to(&rig, 5 * SECOND);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
    expect_fault(RKM04_FAULT_OVERWRITTEN);
}
END_TEST

START_TEST(C10_a_return_whose_place_is_still_there_returns)
{
    rig_accept(&rig, '1', "'1 T01 O02 @1 W900");
    rig_to(&rig, 100 * MS);
    ck_assert_int_eq(set_around("", PLACES - 5, "."), 3); /* over the call alone */
    rig_to(&rig, 5 * SECOND);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 1);
    expect_fault(RKM04_FAULT_NONE);
}
END_TEST


static void lock_and_fill(void)
{
    rig_accept(&rig, '1', "T40");
    rig_to(&rig, 10 * MS);
    ck_assert_int_eq(set_around("", PLACES - 1, ""), 0);
    rig_to(&rig, 1 * SECOND);
}

START_TEST(C10_with_T40_the_rest_of_the_text_is_ignored)
{
    lock_and_fill();
    ck_assert_int_eq(rig_set(&rig, '1', "T01"), 3);
    expect_program("T40", PLACES - 1, "");
    rig_to(&rig, 2 * SECOND);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
}
END_TEST

START_TEST(C10_with_T40_what_fits_is_stored)
{
    rig_accept(&rig, '1', "T40");
    rig_to(&rig, 10 * MS);
    ck_assert_int_eq(set_around("", PLACES - 3, ""), 0);
    ck_assert_int_eq(rig_set(&rig, '1', "T01 T02 T03 T04"), 3);
    expect_program("T40", PLACES - 3, "T01 T02");
    rig_to(&rig, 2 * SECOND);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 3);
}
END_TEST

START_TEST(C10_T40_is_checked_when_text_is_stored)
{
    ck_assert_int_eq(set_around("T40", PLACES, "T01"), 3); /* not executed yet: overwritten, the T40 too */
    expect_program("", PLACES - 1, "T01");
}
END_TEST

START_TEST(C10_C40_unlocks_the_memory)
{
    rig_accept(&rig, '1', "T40 O01 C40");
    rig_to(&rig, 10 * MS);
    ck_assert_int_eq(set_around("", PLACES - 3, ""), 0);
    ck_assert_int_eq(rig_set(&rig, '1', "D"), 3);
    rig_input_at(&rig, 20 * MS, 1, true);
    rig_to(&rig, 1 * SECOND);
    ck_assert_int_eq(rig_set(&rig, '1', "D"), 3);
    expect_program("O01 C40", PLACES - 3, "D");
}
END_TEST

START_TEST(C10_a_full_locked_memory_still_obeys_reset)
{
    lock_and_fill();
    ck_assert_int_eq(rig_set(&rig, '1', "\\ T01"), 0);
    ck_assert_str_eq(rig_program(&rig, 1), "T01");
}
END_TEST

START_TEST(C10_a_full_locked_memory_still_obeys_K_C75_and_a_change_of_speed)
{
    rig_accept(&rig, '1', "T40 F5000 R");
    rig_to(&rig, 10 * MS);
    ck_assert_int_eq(set_around("", PLACES - 3, ""), 0);
    rig_to(&rig, 1 * SECOND);
    ck_assert_int_eq(rig_set(&rig, '1', "V500"), 0);
    rig_to(&rig, 2 * SECOND);
    ck_assert_uint_eq(rig_motor(&rig, 1).speed, 500);
    ck_assert_int_eq(rig_set(&rig, '1', "K"), 0);
    rig_to(&rig, 3 * SECOND);
    ck_assert_int_eq(rig_motor(&rig, 1).state, RKM04_HELD);
    ck_assert_int_eq(rig_set(&rig, '1', "U"), 3); /* nothing is stored, so the hold stays */
    rig_to(&rig, 4 * SECOND);
    ck_assert_int_eq(rig_motor(&rig, 1).state, RKM04_HELD);
    ck_assert_int_eq(rig_set(&rig, '1', "C75"), 0);
    rig_to(&rig, 20 * SECOND);
    ck_assert_int_eq(rig_motor(&rig, 1).position, 5000);
}
END_TEST


START_TEST(U8_at_power_up_everything_is_0)
{
    ck_assert_uint_eq(rkm04_now(&rig.unit), 0);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
    ck_assert_uint_eq(rkm04_variables(&rig.unit), 0);
    for (unsigned motor = 1; motor <= 4; motor++) {
        struct rkm04_motor_state state = rig_motor(&rig, motor);
        ck_assert_int_eq(state.position, 0);
        ck_assert_uint_eq(state.commands, 0);
        ck_assert_uint_eq(state.index, 0);
        ck_assert_int_eq(state.state, RKM04_IDLE);
        ck_assert_int_eq(state.fault, RKM04_FAULT_NONE);
        ck_assert_int_eq(state.led, RKM04_LED_OFF);
        ck_assert(!state.lit);
        ck_assert_int_eq(state.slot, RKM04_SLOT_EMPTY);
    }
    struct rkm04_motor_state state;
    ck_assert(!rkm04_motor_state(&rig.unit, 0, &state));
    ck_assert(!rkm04_motor_state(&rig.unit, 5, &state));
}
END_TEST

START_TEST(U8_the_start_values_are_S100_V1000_A2000_forward_and_no_steps)
{
    rig_accept(&rig, '1', "R W10");
    rig_accept(&rig, '1', "D D F1000 R");
    rig_to(&rig, 3 * SECOND);
    rig_expect_motion(&rig, 1, 1, 15 * MS, 15 * MS + move_ticks(100, 1000, 2000, 1000), 1000, true);
}
END_TEST

START_TEST(U8_a_power_up_forgets_what_is_not_in_flash)
{
    rig_accept(&rig, '0', "=77 T01 T90 V300 S50 A100 B10 T41 T40 T51 M01 X02 W9");
    rig_to(&rig, 1 * SECOND);
    rig_power_cycle(&rig);
    ck_assert_int_eq(rig_motor(&rig, 1).position, 0);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
    ck_assert_uint_eq(rkm04_variables(&rig.unit), 0);
    ck_assert_uint_eq(rig_motor(&rig, 1).commands, 0);
    rkm04_set_inputs(&rig.unit, 3);
    rig_accept(&rig, '1', "F1000 Y R");
    rig_to(&rig, 3 * SECOND);
    rig_expect_motion_near(&rig, 1, 1, 3 * MS, 3 * MS + move_ticks(100, 1000, 2000, 1000), 1000, true);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
}
END_TEST

START_TEST(U5_stored_programs_start_together_in_the_first_slot)
{
    static const char *const text[] = {"T01", "T02", "T03", "T04"};
    for (unsigned motor = 1; motor <= 4; motor++) {
        rig_accept(&rig, (char)('0' + motor), text[motor - 1]);
        store((char)('0' + motor));
    }
    rig_to(&rig, 100 * MS);
    rig_power_cycle(&rig);
    for (unsigned motor = 1; motor <= 4; motor++)
        ck_assert_int_eq(rig_motor(&rig, motor).slot, RKM04_SLOT_LOADED);
    rig_to(&rig, 1 * MS);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
    rig_to(&rig, 1 * MS + 1);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0x0F);
}
END_TEST

START_TEST(U5_each_motor_has_its_own_slot)
{
    rig_accept(&rig, '2', "T02");
    store('2');
    rig_power_cycle(&rig);
    for (unsigned motor = 1; motor <= 4; motor++)
        ck_assert_int_eq(rig_motor(&rig, motor).slot, motor == 2 ? RKM04_SLOT_LOADED : RKM04_SLOT_EMPTY);
}
END_TEST

START_TEST(U5_a_full_program_survives)
{
    ck_assert_int_eq(set_around("T01", PLACES - 2, "=-2000000000"), 0);
    store('1');
    rig_power_cycle(&rig);
    expect_program("T01", PLACES - 2, "=-2000000000");
    rig_to(&rig, 1 * SECOND);
    ck_assert_int_eq(rig_motor(&rig, 1).position, -2000000000);
}
END_TEST

START_TEST(U5_commands_that_arrive_follow_the_program_from_flash)
{
    rig_accept(&rig, '1', "T01 U");
    store('1');
    rig_power_cycle(&rig);
    rig_accept(&rig, '1', "T02");
    rig_to(&rig, 1 * SECOND);
    ck_assert_str_eq(rig_program(&rig, 1), "T01 U T02");
    ck_assert_uint_eq(rig_outputs_became(&rig, 3, 1), 3 * MS);
}
END_TEST

START_TEST(U5_a_slot_that_cannot_be_trusted_is_empty_and_said_to_be_so)
{
    rig_accept(&rig, '0', "T01");
    store('0');
    for (unsigned block = 0; block < RKM04_FLASH_BLOCKS; block++)
        memset(rig.flash.data[block], 0x5A, 64);
    rig_power_cycle(&rig);
    for (unsigned motor = 1; motor <= 4; motor++) {
        ck_assert_int_eq(rig_motor(&rig, motor).slot, RKM04_SLOT_UNTRUSTED);
        ck_assert_uint_eq(rig_motor(&rig, motor).commands, 0);
    }
    rig_to(&rig, 1 * SECOND);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
}
END_TEST

static Suite *interp_memory_suite(void)
{
    Suite *suite = suite_create("interp_memory");

    TCase *ring = tcase_create("ring");
    tcase_add_checked_fixture(ring, setup, teardown);
    tcase_add_test(ring, C10_700_commands_fit);
    tcase_add_test(ring, C10_the_701st_is_flag_3_and_overwrites_the_oldest);
    tcase_add_test(ring, C10_flag_3_is_for_messages_that_overwrite);
    tcase_add_test(ring, C10_a_message_longer_than_the_memory_leaves_its_last_700);
    tcase_add_test(ring, C10_commands_before_a_reset_take_no_room);
    tcase_add_test(ring, C10_the_command_under_way_ends_with_its_own_values);
    tcase_add_test(ring, C10_a_motion_under_way_ends_with_its_own_values);
    tcase_add_test(ring, C10_when_the_next_command_is_overwritten_execution_goes_on_at_the_oldest_left);
    tcase_add_test(ring, C10_having_reached_the_newest_the_motor_is_idle);
    tcase_add_test(ring, C10_the_index_is_the_place_in_memory);
    suite_add_tcase(suite, ring);

    TCase *references = tcase_create("references");
    tcase_add_checked_fixture(references, setup, teardown);
    tcase_add_test(references, C10_an_overwritten_label_is_not_in_memory);
    tcase_add_test(references, C10_a_label_that_is_not_overwritten_is_still_there);
    tcase_add_test(references, C10_of_two_equal_labels_the_newer_one_survives);
    tcase_add_test(references, C10_a_loop_whose_beginning_is_overwritten_is_a_fault);
    tcase_add_test(references, C10_a_loop_whose_beginning_is_still_there_goes_on);
    tcase_add_test(references, C10_a_return_whose_place_is_overwritten_is_a_fault);
    tcase_add_test(references, C10_a_return_whose_place_is_still_there_returns);
    suite_add_tcase(suite, references);

    TCase *locked = tcase_create("locked");
    tcase_add_checked_fixture(locked, setup, teardown);
    tcase_add_test(locked, C10_with_T40_the_rest_of_the_text_is_ignored);
    tcase_add_test(locked, C10_with_T40_what_fits_is_stored);
    tcase_add_test(locked, C10_T40_is_checked_when_text_is_stored);
    tcase_add_test(locked, C10_C40_unlocks_the_memory);
    tcase_add_test(locked, C10_a_full_locked_memory_still_obeys_reset);
    tcase_add_test(locked, C10_a_full_locked_memory_still_obeys_K_C75_and_a_change_of_speed);
    suite_add_tcase(suite, locked);

    TCase *power_up = tcase_create("power_up");
    tcase_add_checked_fixture(power_up, setup, teardown);
    tcase_add_test(power_up, U8_at_power_up_everything_is_0);
    tcase_add_test(power_up, U8_the_start_values_are_S100_V1000_A2000_forward_and_no_steps);
    tcase_add_test(power_up, U8_a_power_up_forgets_what_is_not_in_flash);
    tcase_add_test(power_up, U5_stored_programs_start_together_in_the_first_slot);
    tcase_add_test(power_up, U5_each_motor_has_its_own_slot);
    tcase_add_test(power_up, U5_a_full_program_survives);
    tcase_add_test(power_up, U5_commands_that_arrive_follow_the_program_from_flash);
    tcase_add_test(power_up, U5_a_slot_that_cannot_be_trusted_is_empty_and_said_to_be_so);
    suite_add_tcase(suite, power_up);

    return suite;
}

int main(void)
{
    return rig_run(interp_memory_suite(), "./test_interp_memory");
}
