/* SPDX-License-Identifier: MIT */
/* The registers of the CIB module (BL7, BL8), and what Y1-Y10 of its worked examples read and write. */
#include <check.h>
#include <string.h>

#include "cib_rig.h"

static void setup(void)
{
    cib_power_up(&cib_default_config);
}

/* ---- The table ---- */

static bool lies_in(unsigned address, unsigned first, unsigned last)
{
    return address >= first && address <= last;
}

START_TEST(BL7_the_registers_that_there_are)
{
    for (unsigned address = 0; address <= UINT16_MAX; address++) {
        const bool setup_word =
            lies_in(address, 0x100, 0x10b) || lies_in(address, 0x110, 0x115) || lies_in(address, 0x120, 0x125);
        const bool output = lies_in(address, 0, 8) || lies_in(address, 0x10, 0x14) || lies_in(address, 0x20, 0x24);
        const bool input = lies_in(address, 0, 2) || lies_in(address, 0x10, 0x1a) || lies_in(address, 0x20, 0x2a) ||
                           lies_in(address, 0x30, 0x31);
        ck_assert_int_eq(cib_has_register(CIB_OUTPUT_ZONE, (uint16_t)address), output || setup_word);
        ck_assert_int_eq(cib_has_register(CIB_INPUT_ZONE, (uint16_t)address), input || setup_word);
    }
    ck_assert_uint_eq(cib_read(&cib, CIB_OUTPUT_ZONE, 9), 0);
    ck_assert_uint_eq(cib_read(&cib, CIB_INPUT_ZONE, 0x32), 0);
}
END_TEST

START_TEST(BL7_every_output_register_keeps_its_value)
{
    static uint16_t expected[0x126];
    for (uint16_t address = 0; address < 0x126; address++)
        if (address != 0x100 && address != 0x10 && address != 0x20 && cib_has_register(CIB_OUTPUT_ZONE, address)) {
            expected[address] = (uint16_t)(address < 9 ? address + 1 : 0x8001 + 3 * address);
            set(address, expected[address]);
        }
    for (uint16_t address = 0; address < 0x126; address++)
        ck_assert_uint_eq(cib_read(&cib, CIB_OUTPUT_ZONE, address), expected[address]);
}
END_TEST

START_TEST(BU9_the_default_configuration)
{
    static const uint16_t common[] = {2, 2, 2, 0, 1000, 0, 1000, 0, 1000, 0, 0xff}, drive[] = {20, 100, 1000, 240, 240, 1};
    for (uint16_t i = 0; i < 11; i++) {
        ck_assert_uint_eq(in((uint16_t)(0x101 + i)), common[i]);
        ck_assert_uint_eq(out((uint16_t)(0x101 + i)), common[i]);
    }
    for (uint16_t i = 0; i < 6; i++) {
        ck_assert_uint_eq(in((uint16_t)(0x110 + i)), drive[i]);
        ck_assert_uint_eq(out((uint16_t)(0x120 + i)), drive[i]);
    }
    ck_assert_uint_eq(cib_check_setup(&cib_default_setup, CIB_FIRMWARE_1_1), 0);
    ck_assert_int_eq(memcmp(&cib_default_setup, &cib_default_config.setup, sizeof cib_default_setup), 0);
    ck_assert_uint_eq(in(0x30), 0x0808);
    ck_assert_uint_eq(in(0x31), 0x0102);
    ck_assert_uint_eq(in(0x100), 0);
    ck_assert_uint_eq(in(0), 0);
}
END_TEST

/* ---- All or nothing ---- */

static const struct {
    uint16_t address;
    uint8_t count;
    uint16_t value[4];
    enum cib_answer answer;
} writes[] = {
    {0, 3, {1, 10000, 1}, CIB_DONE},
    {0, 3, {256, 1, 1}, CIB_BAD_VALUE},
    {0, 3, {1, 1, 10001}, CIB_BAD_VALUE},
    {7, 3, {1, 1, 1}, CIB_NO_REGISTER},
    {7, 3, {10001, 1, 1}, CIB_NO_REGISTER}, /* before the value */
    {9, 1, {0}, CIB_NO_REGISTER},
    {0x13, 3, {1, 1, 1}, CIB_NO_REGISTER},
    {0x100, 2, {2, 1}, CIB_BAD_VALUE},
    {0x10b, 2, {1, 1}, CIB_NO_REGISTER},
    {65535, 2, {1, 1}, CIB_NO_REGISTER},
};

START_TEST(BL5_nothing_of_a_wrong_message_is_stored)
{
    ck_assert_int_eq(cib_write(&cib, writes[_i].address, writes[_i].value, writes[_i].count), writes[_i].answer);
    const bool stored = writes[_i].answer == CIB_DONE;
    for (unsigned i = 0; i < writes[_i].count; i++) {
        const uint16_t address = (uint16_t)(writes[_i].address + i);
        const uint16_t before = address == 0x101 ? 2 : address == 0x10b ? 0xff : 0;
        ck_assert_uint_eq(cib_read(&cib, CIB_OUTPUT_ZONE, address), stored ? writes[_i].value[i] : before);
    }
    ck_assert_uint_eq(events(CIB_EVENT_APPLY), 0);
    ck_assert_uint_eq(events(CIB_EVENT_DUTY), stored ? 2 : 0);
}
END_TEST

START_TEST(BL7_coils)
{
    set(0x103, 0);
    set(0x100, 1);
    set(0, 0x0f);
    cib_write_coils(&cib, 0x3c, 0xf0);
    ck_assert_uint_eq(out(0), 0x33);
    ck_assert_uint_eq(cib_read_bits(&cib, CIB_OUTPUT_ZONE), 0x33);
    ck_assert_uint_eq(cib_read_bits(&cib, CIB_INPUT_ZONE), 0x3000);
    cib_set_buttons(&cib, 0x10);
    ck_assert_uint_eq(cib_read_bits(&cib, CIB_INPUT_ZONE), 0x2000);
    ck_assert_uint_eq(cib_read_bits(&cib, CIB_OUTPUT_ZONE), 0x33);
}
END_TEST

/* ---- Y1-Y10, without their frames ---- */

static void expect_input(const uint16_t *expected, unsigned count)
{
    for (unsigned i = 0; i < count; i++)
        ck_assert_uint_eq(in((uint16_t)(0x10 + i)), expected[i]);
}

static void write_zone(uint16_t address, const uint16_t words[5])
{
    ck_assert_int_eq(cib_write(&cib, address, words, 5), CIB_DONE);
}

START_TEST(Y1_to_Y6_a_motion)
{
    cib_advance_to(500);
    expect_input((const uint16_t[]){0, 0x20, 0, 0, 0, 0, 0}, 7);
    cib_advance_to(1000);
    write_zone(0x10, (const uint16_t[]){1, 0x66, 0, 0x0bb8, 0x01f4});
    cib_advance_to(1001500);
    expect_input((const uint16_t[]){1, 0x21, 0, 0, 0x00dc, 0x0154, 4}, 7);
    cib_advance_to(7335000);
    expect_reached(3000, 7334334 - BASE, 0);
    expect_input((const uint16_t[]){1, 0x28, 0, 0, 0x0bb8, 0, 4}, 7);
    cib_advance_to(7335100);
    write_zone(0x10, (const uint16_t[]){2, 0x65, 0xfffe, 0xee90, 0x03e8});
    cib_advance_to(7335500);
    write_zone(0x10, (const uint16_t[]){3, 0x65, 0, 0, 0x03e9});
    cib_advance_to(7336500);
    expect_input((const uint16_t[]){3, 0x33, 4}, 3);
}
END_TEST

START_TEST(Y7_to_Y10_outputs)
{
    cib_advance_to(9000000);
    set(0x103, 0);
    set(0x100, 1);
    ck_assert_uint_eq(in(0x100), 0);
    ck_assert_uint_eq(in(0x101), 2);
    ck_assert_uint_eq(in(0x102), 2);
    ck_assert_uint_eq(in(0x103), 0);
    cib_write_coils(&cib, 0x20, 0x20);
    ck_assert_uint_eq(cib_read_bits(&cib, CIB_OUTPUT_ZONE), 0x20);
    ck_assert_uint_eq(in(1), 0x20);
    cib_write_coils(&cib, 0xf0, 0xa0);
    ck_assert_uint_eq(in(1), 0xa0);
    set(1, 0x09c4);
    ck_assert_uint_eq(out(1), 2500);
    set(0x120, 0x12);
    set(0x100, 1);
    ck_assert_uint_eq(in(0x100), 0x120);
}
END_TEST

START_TEST(BL7_the_speed_has_a_sign)
{
    command(A, 105, -500, 0);
    at(1000500);
    ck_assert_uint_eq(in(0x15), (uint16_t)-340);
    struct cib_drive_state state;
    cib_drive_state(&cib, A, &state);
    ck_assert(state.moving && !state.stopping && !state.turning && !state.waiting && !state.forward && state.configured);
    ck_assert_uint_eq(state.steps, (uint32_t)-position());
    command(A, 105, 500, 0);
    cib_drive_state(&cib, A, &state);
    ck_assert(state.waiting && !state.turning);
    at(1001500);
    cib_drive_state(&cib, A, &state);
    ck_assert(state.turning && state.stopping && !state.waiting && !state.forward);
    command(A, 109, 0, 0);
    at(1002500);
    cib_drive_state(&cib, A, &state);
    ck_assert(!state.turning && state.stopping);
    at(9000000);
    cib_drive_state(&cib, A, &state);
    ck_assert(!state.moving && !state.stopping && !state.forward && state.speed == 0);
    cib_drive_state(&cib, B, &state);
    ck_assert(!state.moving && state.forward && state.row == 0);
}
END_TEST

START_TEST(names_and_uses)
{
    ck_assert_str_eq(cib_error_name(0), "none");
    ck_assert_str_eq(cib_error_name(5), "moving");
    ck_assert_str_eq(cib_error_name(6), "unknown");
    set(0x101, 0);
    set(0x102, 1);
    set(0x100, 1);
    const enum cib_use uses[] = {CIB_USE_DO, CIB_USE_DO, CIB_USE_PWM, CIB_USE_PWM, CIB_USE_DRIVE, CIB_USE_DRIVE};
    for (unsigned i = 0; i < 6; i++)
        ck_assert_int_eq(cib_use_of(&cib, i), uses[i]);
    ck_assert_int_eq(cib_use_of(&cib, 7), CIB_USE_DRIVE);
    ck_assert(!cib_has_drive(&cib, A) && cib_has_drive(&cib, B));
}
END_TEST

static Suite *cib_registers_suite(void)
{
    Suite *suite = suite_create("cib_registers");
    TCase *tests = tcase_create("registers");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_set_timeout(tests, 60);
    tcase_add_test(tests, BL7_the_registers_that_there_are);
    tcase_add_test(tests, BL7_every_output_register_keeps_its_value);
    tcase_add_test(tests, BU9_the_default_configuration);
    tcase_add_loop_test(tests, BL5_nothing_of_a_wrong_message_is_stored, 0, sizeof writes / sizeof *writes);
    tcase_add_test(tests, BL7_coils);
    tcase_add_test(tests, Y1_to_Y6_a_motion);
    tcase_add_test(tests, Y7_to_Y10_outputs);
    tcase_add_test(tests, BL7_the_speed_has_a_sign);
    tcase_add_test(tests, names_and_uses);
    suite_add_tcase(suite, tests);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(cib_registers_suite());
    srunner_run_all(runner, CK_ENV);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? 0 : 1;
}
