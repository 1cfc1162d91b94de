/* SPDX-License-Identifier: MIT */
/* Worked examples of the CIB module: commands, inputs, outputs, configuration, X28-X30, X33-X37, and what the registers of Y1-Y10
 * hold. As in test_cib_motion.c. */
#include <check.h>

#include "cib_rig.h"

static void setup(void)
{
    cib_power_up(&cib_example);
}

/* ---- X28, X29: the slot of a command ---- */

START_TEST(X28_only_the_last_command_before_a_slot_acts)
{
    at(-800);
    ck_assert_uint_eq(in(0x11), 0x20);
    command(A, 102, 100, 100);
    ck_assert_uint_eq(in(0x11), 0x21);
    at(-300);
    command(A, 102, -5, 100);
    at(1000000);
    ck_assert_uint_eq(pulses(), 5);
    for (int i = 1; i <= 5; i++) {
        expect_pulse((unsigned)i, 10000 * i, 0);
        expect_reached(-i, 10000 * i, 0);
    }
    expect_status(-801, 0x20);
    expect_status(-800, 0x21);
    expect_status(0, 0x23);
    expect_status(50000, 0x2A);
}
END_TEST

START_TEST(X28_a_stop_before_the_slot)
{
    at(-800);
    command(A, 102, 100, 100);
    at(-300);
    command(A, 108, 0, 0);
    at(1000000);
    ck_assert_uint_eq(pulses(), 0);
    expect_status(-301, 0x21);
    expect_status(-300, 0x20);
    expect_status(1000000, 0x20);
}
END_TEST

START_TEST(X29_what_the_motion_before_reaches_does_not_show)
{
    at(0);
    command(A, 102, 10, 100);
    at(99700);
    command(A, 102, 5, 100);
    at(200000);
    expect_pulse(10, 100000, 0);
    expect_pulse(11, 110000, 0);
    expect_pulse(15, 150000, 0);
    ck_assert_uint_eq(pulses(), 15);
    expect_status(99999, 0x21);
    expect_status(100000, 0x21);
    expect_status(149999, 0x21);
    expect_status(150000, 0x28);
}
END_TEST

static void power_up_at_70(void)
{
    struct cib_config config = cib_example;
    config.setup.drive[A].start_speed = 70;
    cib_power_up(&config);
}

START_TEST(X29_a_stop_after_the_last_pulse)
{
    power_up_at_70();
    at(0);
    command(A, 102, 3, 70);
    at(42500);
    command(A, 108, 0, 0);
    at(100000);
    expect_pulse(3, 42858, 0);
    expect_status(42857, 0x21);
    expect_status(42858, 0x21);
    expect_status(42999, 0x21);
    expect_status(43000, 0x20);
}
END_TEST

START_TEST(X29_a_turn_before_the_slot)
{
    power_up_at_70();
    at(0);
    command(A, 105, 70, 0);
    at(15000);
    command(A, 105, -70, 0);
    at(28300);
    command(A, 109, 0, 0);
    at(100000);
    expect_status(15000, 0x21);
    expect_pulse(2, 28572, 0);
    expect_status(28571, 0x21);
    expect_status(28572, 0x23);
    expect_status(29000, 0x23);
    expect_pulse(3, 42858, 0);
    expect_reached(1, 42858, 0);
    ck_assert_uint_eq(pulses(), 3);
    expect_status(42858, 0x22);
}
END_TEST

/* ---- Commands ---- */

START_TEST(BC2_a_command_is_taken_when_seq_changes)
{
    const uint16_t first[] = {7, 102, 0, 3, 100};
    ck_assert_int_eq(cib_write(&cib, 0x10, first, 5), CIB_DONE);
    ck_assert_uint_eq(in(0x10), 7);
    ck_assert_uint_eq(events(CIB_EVENT_TAKEN), 1);
    ck_assert_int_eq(cib_write(&cib, 0x10, first, 5), CIB_DONE); /* the same zone again */
    ck_assert_uint_eq(events(CIB_EVENT_TAKEN), 1);
    set(0x10, 65535); /* SEQ alone: the same command again */
    ck_assert_uint_eq(events(CIB_EVENT_TAKEN), 2);
    ck_assert_uint_eq(in(0x10), 65535);
    set(0x10, 0);
    ck_assert_uint_eq(events(CIB_EVENT_TAKEN), 3);
    ck_assert_uint_eq(in(0x10), 0);
    ck_assert_uint_eq(out(0x11), 102);
    ck_assert_uint_eq(out(0x13), 3);
    ck_assert_uint_eq(out(0x14), 100);
}
END_TEST

static const struct {
    uint16_t number;
    int32_t p1;
    uint16_t p2, error;
} commands[] = {
    {0, 99, 99, 0},       {1, 0, 0, 1},          {8, 0, 0, 1},           {10, 0, 0, 1},         {15, 0, 0, 1},
    {99, 0, 0, 1},        {103, 0, 0, 1},        {104, 0, 0, 1},         {106, 0, 0, 1},        {107, 0, 0, 1},
    {110, 0, 0, 1},       {65535, 0, 0, 1},      {9, 0, 0, 0},           {9, 1, 0, 0},          {9, 2, 0, 3},
    {9, -1, 0, 3},        {11, 4, 0, 3},         {11, 5, 0, 0},          {11, 10000, 0, 0},     {11, 10001, 0, 3},
    {11, 65541, 0, 3},    {11, -5, 0, 3},        {12, 4, 0, 3},          {12, 5, 0, 0},         {12, 200, 0, 0},
    {12, 201, 0, 4},      {12, 240, 0, 4},       {12, 241, 0, 3},        {13, 4, 0, 3},         {13, 5, 0, 0},
    {13, 100, 0, 0},      {13, 101, 0, 4},       {13, 241, 0, 3},        {14, 4, 0, 3},         {14, 5, 0, 0},
    {14, 240, 0, 0},      {14, 241, 0, 3},       {100, INT32_MIN, 0, 0}, {101, 9, 4, 3},        {101, 9, 5, 0},
    {101, 9, 1000, 0},    {101, 9, 1001, 4},     {102, -9, 0, 3},        {102, -9, 5, 0},       {102, -9, 1000, 0},
    {102, -9, 65535, 4},  {105, 0, 0, 0},        {105, 4, 0, 3},         {105, -4, 0, 3},       {105, 5, 0, 0},
    {105, -5, 0, 0},      {105, 1000, 0, 0},     {105, -1000, 0, 0},     {105, 1001, 0, 4},     {105, -1001, 0, 4},
    {105, 10001, 0, 4},   {105, INT32_MIN, 0, 4}, {108, -1, 4, 0},       {109, -1, 4, 0},
};

START_TEST(BC3_what_is_refused)
{
    command(A, 1, 0, 0);
    ck_assert_uint_eq(in(0x12), 1);
    ck_assert_uint_eq(in(0x11), 0x30);
    command(A, commands[_i].number, commands[_i].p1, commands[_i].p2);
    ck_assert_uint_eq(in(0x12), commands[_i].error);
    ck_assert_uint_eq(in(0x11) & CIB_ERR, commands[_i].error != 0 ? CIB_ERR : 0);
    ck_assert_uint_eq(events(CIB_EVENT_REFUSED), commands[_i].error != 0 ? 2 : 1);
    ck_assert_uint_eq(events(CIB_EVENT_TAKEN), commands[_i].error == 0);
}
END_TEST

START_TEST(BC3_the_position_is_set_at_rest_only)
{
    command(A, 102, 3, 100);
    command(A, 100, 50, 0);
    ck_assert_uint_eq(in(0x12), 5);
    at(500000);
    ck_assert_int_eq(position(), 3);
    command(A, 100, 50, 0);
    ck_assert_uint_eq(in(0x12), 0);
    ck_assert_uint_eq(in(0x11), 0x28); /* TRG stays */
    ck_assert_int_eq(position(), 50);
    ck_assert_uint_eq(last_event(CIB_EVENT_POSITION), 50);
    ck_assert_uint_eq(in(0x16), 3);
}
END_TEST

START_TEST(BC3_values_are_taken)
{
    command(A, 11, 300, 0);
    command(A, 12, 6, 0);
    command(A, 13, 7, 0);
    command(A, 14, 8, 0);
    const uint16_t expected[] = {300, 6, 7, 8};
    for (uint16_t i = 0; i < 4; i++)
        ck_assert_uint_eq(in((uint16_t)(0x17 + i)), expected[i]);
    command(A, 9, 0, 0);
    ck_assert_uint_eq(in(0x11), 0);
    command(A, 9, 1, 0);
    ck_assert_uint_eq(in(0x11), 0x20);
    ck_assert_uint_eq(in(0x27), 100); /* the other drive's */
    ck_assert_uint_eq(in(0x21), 0x20);
}
END_TEST

START_TEST(BC4_a_drive_that_is_not_configured)
{
    struct cib_config config = cib_example;
    config.setup.use[2] = CIB_USE_DO;
    cib_power_up(&config);
    command(B, 102, 5, 100);
    ck_assert_uint_eq(in(0x22), 2);
    command(B, 0, 0, 0);
    ck_assert_uint_eq(in(0x22), 2);
    command(B, 7, 0, 0);
    at(500000);
    const uint16_t expected[] = {3, 0x10, 1, 0, 0, 0, 0, 0, 0, 0, 0};
    for (uint16_t i = 0; i < 11; i++)
        ck_assert_uint_eq(in((uint16_t)(0x20 + i)), expected[i]);
    ck_assert_uint_eq(cib_driven(&cib), 0);
}
END_TEST

START_TEST(BC8_a_distance_counts_from_the_slot)
{
    command(A, 105, 100, 0);
    at(99500);
    command(A, 102, 5, 100); /* position 9 now, 10 in the slot */
    at(200000);
    ck_assert_int_eq(position(), 15);
}
END_TEST

/* ---- X33: inputs ---- */

START_TEST(X33_a_level_shows_after_5_ms)
{
    const bool kept = _i == 1;
    cib_advance_to(10000);
    cib_set_inputs(&cib, 1);
    ck_assert_uint_eq(cib_inputs(&cib), 1);
    cib_advance_to(14999);
    ck_assert_uint_eq(in(0), 0);
    if (!kept)
        cib_set_inputs(&cib, 0);
    cib_advance_to(15000);
    ck_assert_uint_eq(in(0), kept ? 1 : 0);
    cib_set_inputs(&cib, 0);
    ck_assert_uint_eq(in(0), kept ? 1 : 0);
    cib_advance_to(19999);
    ck_assert_uint_eq(in(0), kept ? 1 : 0);
    cib_advance_to(20000);
    ck_assert_uint_eq(in(0), 0);
    cib_advance_to(30000);
    ck_assert_uint_eq(events(CIB_EVENT_INPUTS), kept ? 2 : 0);
    ck_assert_uint_eq(in(0), 0);
}
END_TEST

START_TEST(BU2_levels_at_power_up_count_at_once)
{
    cib_set_inputs(&cib, 0xa5);
    ck_assert_uint_eq(in(0), 0xa5);
    cib_advance(&cib, 1);
    cib_set_inputs(&cib, 0xff);
    ck_assert_uint_eq(in(0), 0xa5);
    cib_advance_to(3000);
    cib_set_inputs(&cib, 0xfd); /* bit 1 back, the others stay on their way */
    cib_advance_to(5001);
    ck_assert_uint_eq(in(0), 0xfd);
    ck_assert_uint_eq(cib_read_bits(&cib, CIB_INPUT_ZONE), 0xfd);
    ck_assert_uint_eq(last_event(CIB_EVENT_INPUTS), 0xa5);
    cib_advance(&cib, 1);
    ck_assert_uint_eq(last_event(CIB_EVENT_INPUTS), 0xfd);
    ck_assert_uint_eq(cib_next_event(&cib), CIB_NEVER);
}
END_TEST

/* ---- X35: buttons ---- */

static void power_up_with_uses(uint16_t first, uint16_t second, uint16_t third)
{
    struct cib_config config = cib_example;
    config.setup.use[0] = first;
    config.setup.use[1] = second;
    config.setup.use[2] = third;
    cib_power_up(&config);
}

START_TEST(X35_a_button_inverts_its_output)
{
    power_up_with_uses(2, 2, 0);
    set(0, 0x20);
    ck_assert_uint_eq(in(1), 0x20);
    cib_set_buttons(&cib, 0x20);
    ck_assert_uint_eq(in(1), 0);
    ck_assert_uint_eq(in(2), 0x20);
    ck_assert_uint_eq(out(0), 0x20);
    cib_set_buttons(&cib, 0);
    ck_assert_uint_eq(in(1), 0x20);
    expect_driven(-BASE, 0x20);
}
END_TEST

START_TEST(BU7_other_outputs_ignore_their_buttons)
{
    power_up_with_uses(0, 1, 2);
    cib_set_buttons(&cib, 0xff);
    ck_assert_uint_eq(in(1), 0x03);
    set(0x100, 1);
    ck_assert_uint_eq(in(1), 0x03);
    set(0, 0xff);
    ck_assert_uint_eq(in(1), 0);
    cib_set_buttons(&cib, 0);
    ck_assert_uint_eq(in(1), 0x03);
    ck_assert_uint_eq(cib_read_bits(&cib, CIB_INPUT_ZONE), 0x0300);
}
END_TEST

/* ---- X36: configuration ---- */

static const struct {
    uint16_t firmware, first, second, third, bipolar, address, value, result;
} proposals[] = {
    {0x102, 2, 0, 2, 0, 0, 0, 0x102},
    {0x102, 0, 2, 2, 0, 0, 0, 0x102},
    {0x102, 1, 0, 0, 1, 0, 0, 0x10a},
    {0x102, 0, 1, 0, 2, 0, 0, 0x10a},
    {0x102, 0, 1, 0, 1, 0, 0, 0},
    {0x102, 1, 1, 0, 1, 0, 0, 0x10a},
    {0x102, 1, 1, 0, 2, 0, 0, 0x10a},
    {0x102, 1, 1, 0, 3, 0, 0, 0},
    {0x102, 1, 1, 0, 4, 0, 0, 0},
    {0x102, 1, 1, 1, 7, 0, 0, 0},
    {0x102, 1, 0, 1, 4, 0, 0, 0},
    {0x102, 2, 2, 2, 7, 0, 0, 0},
    {0x102, 2, 2, 2, 0, 0x105, 9, 0x104},
    {0x102, 2, 2, 2, 0, 0x105, 10, 0},
    {0x102, 2, 2, 2, 0, 0x106, 15, 0},
    {0x102, 2, 2, 2, 0, 0x106, 16, 0x106},
    {0x102, 2, 2, 2, 0, 0x109, 0, 0x108},
    {0x102, 2, 2, 2, 0, 0x10b, 0xff, 0},
    {0x102, 2, 2, 2, 0, 0x10b, 0x100, 0x10b},
    {0x102, 2, 2, 2, 0, 0x110, 18, 0x110},
    {0x102, 2, 2, 2, 0, 0x110, 34, 0x110},
    {0x102, 2, 2, 2, 0, 0x110, 15, 0x110},
    {0x102, 2, 2, 2, 0, 0x110, 33, 0},
    {0x102, 2, 2, 2, 0, 0x111, 4, 0x111},
    {0x102, 2, 2, 2, 0, 0x111, 10000, 0},
    {0x102, 2, 2, 2, 0, 0x111, 10001, 0x111},
    {0x102, 2, 2, 2, 0, 0x112, 4, 0x112},
    {0x102, 2, 2, 2, 0, 0x112, 10001, 0x112},
    {0x102, 2, 2, 2, 0, 0x113, 4, 0x113},
    {0x102, 2, 2, 2, 0, 0x113, 241, 0x113},
    {0x102, 2, 2, 2, 0, 0x114, 4, 0x114},
    {0x102, 2, 2, 2, 0, 0x114, 240, 0},
    {0x102, 2, 2, 2, 0, 0x114, 241, 0x114},
    {0x102, 2, 2, 2, 0, 0x115, 2, 0x115},
    {0x102, 2, 2, 0, 0, 0x120, 0, 0x120}, /* without use, too */
    {0x102, 2, 2, 2, 0, 0x125, 2, 0x125},
    {0x101, 1, 0, 0, 0, 0, 0, 0},
    {0x101, 0, 1, 0, 0, 0, 0, 0x102},
    {0x101, 0, 0, 1, 0, 0, 0, 0x103},
    {0x101, 2, 2, 1, 0, 0, 0, 0x103},
    {0x101, 2, 0, 7, 0, 0, 0, 0x102},
    {0x102, 2, 0, 7, 0, 0, 0, 0x102},
    {0x102, 2, 2, 7, 0, 0, 0, 0x103},
    {0x102, 3, 2, 7, 0, 0, 0, 0x101},
    {0x102, 2, 2, 2, 8, 0, 0, 0x10a},
};

START_TEST(X36_a_proposal_is_checked_whole)
{
    struct cib_config config = cib_example;
    config.firmware = proposals[_i].firmware;
    cib_power_up(&config);
    const uint16_t uses[] = {proposals[_i].first, proposals[_i].second, proposals[_i].third};
    ck_assert_int_eq(cib_write(&cib, 0x101, uses, 3), CIB_DONE);
    set(0x10a, proposals[_i].bipolar);
    if (proposals[_i].address != 0)
        set(proposals[_i].address, proposals[_i].value);
    ck_assert_uint_eq(in(0x101), 2); /* only a proposal yet */
    set(0x100, 0);
    ck_assert_uint_eq(events(CIB_EVENT_APPLY), 0);
    set(0x100, 1);
    ck_assert_uint_eq(out(0x100), 0);
    ck_assert_uint_eq(in(0x100), proposals[_i].result);
    ck_assert_uint_eq(last_event(CIB_EVENT_APPLY), proposals[_i].result);
    ck_assert_uint_eq(events(CIB_EVENT_APPLY), 1);
    const bool good = proposals[_i].result == 0;
    ck_assert_uint_eq(in(0x101), good ? uses[0] : 2);
    ck_assert_uint_eq(in(0x103), good ? uses[2] : 2);
    ck_assert_uint_eq(in(0x10a), good ? proposals[_i].bipolar : 0);
    if (good && proposals[_i].address != 0)
        ck_assert_uint_eq(in(proposals[_i].address), proposals[_i].value);
    for (uint16_t address = 0x101; address <= 0x125; address++)
        if (good && cib_has_register(CIB_INPUT_ZONE, address))
            ck_assert_uint_eq(in(address), out(address));
    ck_assert_uint_eq(out(0x103), uses[2]);
    ck_assert_uint_eq(in(0x31), proposals[_i].firmware);
}
END_TEST

START_TEST(BU8_apply_acts_after_the_rest_of_its_request)
{
    const uint16_t words[] = {1, 2, 2, 0};
    ck_assert_int_eq(cib_write(&cib, 0x100, words, 4), CIB_DONE);
    ck_assert_uint_eq(in(0x103), 0);
    ck_assert_uint_eq(in(0x100), 0);
}
END_TEST

START_TEST(BU8_apply_is_as_after_power_up)
{
    set(0x103, 1);
    set(0x100, 1);
    command(A, 105, -500, 0);
    command(A, 11, 150, 0);
    command(A, 12, 7, 0);
    set(8, 5000);
    at(3000000);
    command(A, 2, 0, 0);
    command(A, 9, 0, 0);
    command(A, 102, 7, 500); /* waits for its slot */
    set(0, 0x55);
    cib_set_buttons(&cib, 0x0f);
    const unsigned before = pulses();
    const uint16_t sequence = out(0x10);
    set(0x111, 200);
    set(0x100, 1);
    const uint16_t expected[] = {sequence, 0x20, 0, 0, 0, 0, 0, 200, 200, 100, 100};
    for (uint16_t i = 0; i < 11; i++)
        ck_assert_uint_eq(in((uint16_t)(0x10 + i)), expected[i]);
    ck_assert_uint_eq(out(0x10), sequence);
    ck_assert_uint_eq(out(0x11), 102);
    ck_assert_uint_eq(out(0x13), 7);
    ck_assert_uint_eq(out(0x14), 500);
    ck_assert_uint_eq(out(0), 0);
    ck_assert_uint_eq(out(8), 0);
    ck_assert_uint_eq(in(1), 0);
    ck_assert_uint_eq(in(2), 0x0f);
    at(9000000);
    ck_assert_uint_eq(pulses(), before);
    expect_status(3000000, 0x20);
    command(A, 102, 1, 500);
    at(9100000);
    ck_assert_uint_eq(in(1), 3); /* row 1 again */
}
END_TEST

START_TEST(BU8_a_pulse_of_the_tick_of_apply_does_not_come)
{
    at(0);
    command(A, 102, 10, 100);
    at(20000);
    set(0x100, 1);
    at(50000);
    ck_assert_uint_eq(pulses(), 1);
}
END_TEST

START_TEST(BU8_a_wrong_proposal_changes_nothing)
{
    at(0);
    command(A, 102, 10, 100);
    at(15000);
    set(0x110, 18);
    set(0x100, 1);
    ck_assert_uint_eq(in(0x100), 0x110);
    at(200000);
    ck_assert_uint_eq(pulses(), 10);
    expect_status(100000, 0x28);
    set(0x110, 20);
    set(0x100, 1);
    ck_assert_uint_eq(in(0x100), 0);
}
END_TEST

/* ---- X37: options ---- */

START_TEST(X37_switched_off_at_rest)
{
    struct cib_config config = cib_example;
    config.idle_off = 500;
    cib_power_up(&config);
    at(0);
    command(A, 102, 1, 500);
    at(5000000);
    expect_driven(9966, 0);
    expect_driven(9967, 3);
    expect_driven(509966, 3);
    expect_driven(509967, 0);
    expect_pulse(1, 9967, 0);
    ck_assert_uint_eq(in(0x16), 1);
    command(A, 102, 1, 500);
    at(5005000);
    ck_assert_uint_eq(in(1), 0);
    at(5400000);
    ck_assert_uint_eq(in(1), 6);
}
END_TEST

START_TEST(BT3_a_command_before_it_is_switched_off_begins_anew)
{
    struct cib_config config = cib_example;
    config.idle_off = 500;
    cib_power_up(&config);
    at(0);
    command(A, 102, 1, 100);
    at(509999);
    command(A, 102, 0, 100); /* nothing to do: MOVE stays 0 */
    at(510001);
    ck_assert_uint_eq(in(1), 0);
    command(A, 102, 1, 100);
    at(1000000);
    ck_assert_uint_eq(in(1), 6);
    expect_reached(2, 521000, 0);
    at(1020000);
    command(A, 102, 1, 100); /* with a pulse to do: MOVE 1 */
    at(1025000);
    ck_assert_uint_eq(in(1), 6);
    at(1529999);
    ck_assert_uint_eq(in(1), 12);
}
END_TEST

START_TEST(X37_no_request)
{
    struct cib_config config = cib_example;
    config.comm_timeout = 1000;
    cib_power_up(&config);
    at(0);
    cib_note_request(&cib);
    command(A, 105, 500, 0);
    at(1000000);
    expect_speed(300);
    at(4000000);
    expect_position(1000000, 200);
    expect_reached(600, 3000000, 0);
    ck_assert_uint_eq(pulses(), 600);
    expect_status(999999, 0x21);
    expect_status(1000000, 0x21);
    expect_status(3000000, 0x20);
    ck_assert_uint_eq(events(CIB_EVENT_TIMEOUT), 1);
}
END_TEST

static Suite *cib_unit_suite(void)
{
    Suite *suite = suite_create("cib_unit");
    TCase *tests = tcase_create("unit");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_set_timeout(tests, 60);
    tcase_add_test(tests, X28_only_the_last_command_before_a_slot_acts);
    tcase_add_test(tests, X28_a_stop_before_the_slot);
    tcase_add_test(tests, X29_what_the_motion_before_reaches_does_not_show);
    tcase_add_test(tests, X29_a_stop_after_the_last_pulse);
    tcase_add_test(tests, X29_a_turn_before_the_slot);
    tcase_add_test(tests, BC2_a_command_is_taken_when_seq_changes);
    tcase_add_loop_test(tests, BC3_what_is_refused, 0, sizeof commands / sizeof *commands);
    tcase_add_test(tests, BC3_the_position_is_set_at_rest_only);
    tcase_add_test(tests, BC3_values_are_taken);
    tcase_add_test(tests, BC4_a_drive_that_is_not_configured);
    tcase_add_test(tests, BC8_a_distance_counts_from_the_slot);
    tcase_add_loop_test(tests, X33_a_level_shows_after_5_ms, 0, 2);
    tcase_add_test(tests, BU2_levels_at_power_up_count_at_once);
    tcase_add_test(tests, X35_a_button_inverts_its_output);
    tcase_add_test(tests, BU7_other_outputs_ignore_their_buttons);
    tcase_add_loop_test(tests, X36_a_proposal_is_checked_whole, 0, sizeof proposals / sizeof *proposals);
    tcase_add_test(tests, BU8_apply_acts_after_the_rest_of_its_request);
    tcase_add_test(tests, BU8_apply_is_as_after_power_up);
    tcase_add_test(tests, BU8_a_pulse_of_the_tick_of_apply_does_not_come);
    tcase_add_test(tests, BU8_a_wrong_proposal_changes_nothing);
    tcase_add_test(tests, X37_switched_off_at_rest);
    tcase_add_test(tests, BT3_a_command_before_it_is_switched_off_begins_anew);
    tcase_add_test(tests, X37_no_request);
    suite_add_tcase(suite, tests);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(cib_unit_suite());
    srunner_run_all(runner, CK_ENV);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? 0 : 1;
}
