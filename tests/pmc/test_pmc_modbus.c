/* SPDX-License-Identifier: MIT */
/* Modbus RTU (section 10). AX: an example of the specification; its frames were made by pymodbus 3.16. */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "face_rig.h"

#define SILENCE 3646u /* us at 9600 Bd */

static struct face_rig rig;
static const struct pmc_config two = {.face = &pmc_modbus_face, .axes = 2, .address = 1, .baud = 9600};
static const struct pmc_config one = {.face = &pmc_modbus_face, .axes = 1, .address = 1, .baud = 9600};

static struct pmc_axis_state state_of(unsigned axis)
{
    struct pmc_axis_state state;
    pmc_axis_state(&rig.unit, axis, &state);
    return state;
}

/* A whole frame, and the whole answer. */
static void expect_frame(const char *frame, const char *answer)
{
    ck_assert_str_eq(face_frame(&rig, frame, 5000), answer);
}

/* The same without check values. */
static void expect(const char *request, const char *answer)
{
    const char *found = face_ask(&rig, request);
    ck_assert_msg(strcmp(found, answer) == 0, "%s: expected %s, found %s", request, answer, found);
}

START_TEST(ax46_commands)
{
    face_begin(&rig, &two);
    expect_frame("01 06 00 00 04 30 8B 1E", "01 06 00 00 04 30 8B 1E");
    ck_assert_uint_eq(state_of(0).fifth, 1000);
    ck_assert_uint_eq(state_of(1).fifth, 10);
    expect_frame("01 06 00 00 01 20 89 82", "01 06 00 00 01 20 89 82");
    face_wait(&rig, 20);
    ck_assert(state_of(0).moving && state_of(0).forward && !state_of(1).moving);
    expect_frame("01 06 00 00 05 01 4B 5A", "01 06 00 00 05 01 4B 5A");
    face_wait(&rig, 1000);
    ck_assert(!state_of(0).moving);
    int32_t from = state_of(0).commanded;
    expect_frame("01 10 00 01 00 05 0A 72 01 FF FF FF F6 00 00 00 00 33 59", "01 10 00 01 00 05 51 CA");
    face_wait(&rig, 1000);
    ck_assert_int_eq(state_of(0).commanded, from - 10);
    expect_frame("01 10 00 01 00 03 06 61 03 07 D0 00 64 FA 52", "01 10 00 01 00 03 D1 C8");
    ck_assert_uint_eq(state_of(0).fifth, 2000);
    ck_assert_uint_eq(state_of(1).fifth, 100);
}
END_TEST

START_TEST(ax47_broadcast_and_absolute_moves)
{
    face_begin(&rig, &two);
    expect_frame("00 06 00 00 06 03 CB BA", "");
    ck_assert(state_of(0).state == PMC_SEARCHING && state_of(1).state == PMC_SEARCHING);
    expect("01 06 00 00 05 30", "01 06 00 00 05 30");
    face_wait(&rig, 10);
    expect("01 06 00 00 0A 33", "01 06 00 00 0A 33");
    expect("01 06 00 00 04 44", "01 06 00 00 04 44");
    expect_frame("01 10 00 01 00 05 0A 71 03 00 00 03 E8 FF FF FC 18 67 2D", "01 10 00 01 00 05 51 CA");
    face_wait(&rig, 2000);
    ck_assert_int_eq(state_of(0).commanded, 1000);
    ck_assert_int_eq(state_of(1).commanded, -1000);
    expect("80 06 00 00 09 03", ""); /* 128 is a broadcast, too */
    ck_assert_uint_eq(rig.unit.face.reply.counters.requests, 6);
}
END_TEST

START_TEST(ax48_parameters)
{
    face_begin(&rig, &two);
    expect_frame("01 03 04 4E 00 08 25 2B", "01 03 10 00 0A 01 90 01 90 00 32 00 0A 00 64 03 E8 1F 40 B0 16");
    expect_frame("01 06 04 4E 01 F5 29 3A", "01 86 03 02 61");
    ck_assert_int_eq(rig.unit.axis[0].parameters.value[PMC_MULTIPLIER], 10);
}
END_TEST

START_TEST(ax49_exceptions)
{
    face_begin(&rig, &two);
    expect("01 05 00 00 FF 00", "01 85 01");
    expect("01 03 05 00 00 01", "01 83 02");
    expect("01 06 00 00 01 20", "01 06 00 00 01 20");
    expect("01 06 00 00 01 20", "01 86 06");
    expect_frame("01 06 00 00 01 20 89 82", "01 86 06 C2 62");
}
END_TEST

START_TEST(ax50_program_registers)
{
    char text[PMC_COMMAND_TEXT_MAX + 1] = "";
    face_begin(&rig, &two);
    expect_frame("01 10 10 28 00 08 10 00 08 00 00 00 00 00 00 00 00 00 03 00 00 00 00 21 74", "01 10 10 28 00 08 45 07");
    expect_frame("01 10 10 38 00 08 10 00 01 FF FF FF 33 00 04 00 32 00 00 00 00 00 00 43 B2", "01 10 10 38 00 08 44 C2");
    text[pmc_command_write(&rig.unit.axis[0].program[5], text)] = '\0';
    ck_assert_str_eq(text, "REP 3");
    text[pmc_command_write(&rig.unit.axis[0].program[7], text)] = '\0';
    ck_assert_str_eq(text, "ABS -20.5 V4 50");
    expect("01 03 10 38 00 08", "01 03 10 00 01 FF FF FF 33 00 04 00 32 00 00 00 00 00 00");
    expect("01 10 12 00 00 08 10 00 06 00 00 00 00 00 00 03 E8 00 00 00 01 00 01", "01 10 12 00 00 08");
    ck_assert(rig.unit.axis[1].program[0].op == PMC_OTP && rig.unit.axis[1].program[0].wait);
    expect("01 03 12 07 00 01", "01 03 02 00 01");
}
END_TEST

START_TEST(ax51_input_registers)
{
    face_begin(&rig, &two);
    expect("01 10 00 01 00 05 0A 72 01 FF FF FF F6 00 00 00 00", "01 10 00 01 00 05");
    face_wait(&rig, 1000);
    expect_frame("01 04 00 00 00 0C F0 0F",
                 "01 04 18 FF FF FF F6 FF FF FF F6 00 00 00 00 00 00 FF FF 00 00 00 00 00 00 00 00 C9 44");
}
END_TEST

/* ---- The line (AB1) --------------------------------------------------------------------------------------------------- */

START_TEST(answer_begins_after_the_silence)
{
    static const uint32_t bauds[] = {9600, 19200, 38400, 115200};
    static const unsigned silence[] = {3646, 1823, 1750, 1750};
    for (size_t i = 0; i < 4; i++) {
        struct pmc_config config = two;
        config.baud = bauds[i];
        face_begin(&rig, &config);
        ck_assert_str_eq(face_frame(&rig, "01 03 04 4E 00 01 E5 2D", silence[i] - 1), "");
        ck_assert_str_eq(face_frame(&rig, "", 1), "01 03 02 00 0A 38 43");
        ck_assert(pmc_modbus_face.due(&rig.unit) == PMC_NEVER);
    }
}
END_TEST

/* Two halves of a frame, the second one so many us later. */
static const char *send_halves(uint32_t baud, unsigned us)
{
    struct pmc_config config = two;
    config.baud = baud;
    face_begin(&rig, &config);
    (void)face_frame(&rig, "01 03 04 4E", us);
    return face_frame(&rig, "00 01 E5 2D", 5000);
}

START_TEST(silence_inside_a_frame_spoils_it)
{
    ck_assert_str_eq(send_halves(9600, 2605), "01 03 02 00 0A 38 43"); /* 1.5 characters and the next one */
    ck_assert_str_eq(send_halves(9600, 2606), "");
    ck_assert_uint_eq(rig.unit.face.reply.counters.dropped, 1);
    ck_assert_str_eq(send_halves(115200, 837), "01 03 02 00 0A 38 43");
    ck_assert_str_eq(send_halves(115200, 838), "");
    ck_assert_str_eq(send_halves(9600, 3700), "");
    ck_assert_uint_eq(rig.unit.face.reply.counters.dropped, 2);
    expect("01 03 04 4E 00 01", "01 03 02 00 0A");
}
END_TEST

START_TEST(what_is_no_frame_is_dropped)
{
    char longest[3 * 300] = "";
    face_begin(&rig, &two);
    expect_frame("01 03 04 4E 00 01 E5 2C", "");
    expect_frame("01 03 04", "");
    ck_assert_uint_eq(rig.unit.face.reply.counters.dropped, 2);
    for (unsigned i = 0; i < 254; i++)
        strcat(longest, "05 ");
    expect(longest, ""); /* 256 bytes, for another unit */
    ck_assert_uint_eq(rig.unit.face.reply.counters.others, 1);
    strcat(longest, "05 ");
    expect(longest, "");
    ck_assert_uint_eq(rig.unit.face.reply.counters.dropped, 3);
    expect("02 03 04 4E 00 01", "");
    ck_assert_uint_eq(rig.unit.face.reply.counters.others, 2);
    ck_assert_uint_eq(rig.unit.face.reply.counters.requests, 0);
}
END_TEST

START_TEST(lost_byte_spoils_a_frame)
{
    face_begin(&rig, &two);
    (void)face_frame(&rig, "01 03 04 4E", 100);
    pmc_lose_byte(&rig.unit);
    expect_frame("00 01 E5 2D", "");
    ck_assert_uint_eq(rig.unit.face.reply.counters.dropped, 1);
    pmc_lose_byte(&rig.unit);
    face_wait(&rig, 5);
    expect("01 03 04 4E 00 01", "01 03 02 00 0A");
}
END_TEST

START_TEST(nothing_is_heard_while_an_answer_goes_out)
{
    uint8_t byte;
    face_begin(&rig, &two);
    ck_assert_str_eq(face_frame(&rig, "01 03 04 4E 00 01 E5 2D", 0), "");
    face_wait(&rig, 5);
    ck_assert(pmc_modbus_face.has_answer(&rig.unit));
    ck_assert_uint_eq(pmc_modbus_face.receive(&rig.unit, (const uint8_t *)"\1", 1), 0);
    for (unsigned i = 0; i < 7; i++)
        ck_assert_uint_eq(pmc_modbus_face.send(&rig.unit, &byte, 1), 1);
    ck_assert_uint_eq(pmc_modbus_face.send(&rig.unit, &byte, 1), 0);
    ck_assert_uint_eq(rig.unit.face.reply.counters.answers, 1);
    expect("01 03 04 4E 00 01", "01 03 02 00 0A");
}
END_TEST

START_TEST(first_answer_is_late)
{
    struct pmc_config late = two;
    late.first_answer_late = 2500;
    face_begin(&rig, &late);
    ck_assert_str_eq(face_frame(&rig, "01 03 04 4E 00 01 E5 2D", 2500000 + SILENCE - 1), "");
    ck_assert_str_eq(face_frame(&rig, "", 1), "01 03 02 00 0A 38 43");
    expect("01 03 04 4E 00 01", "01 03 02 00 0A");
}
END_TEST

/* ---- The order of checks (AB2) ------------------------------------------------------------------------------------------ */

START_TEST(length_and_quantity_come_before_the_address)
{
    face_begin(&rig, &two);
    expect("01 2B", "01 AB 01");
    expect("01 01 04 4E 00 01", "01 81 01");
    expect("01 03", "01 83 03");
    expect("01 03 05 00 00 00", "01 83 03");
    expect("01 03 05 00 00 7E", "01 83 03");
    expect("01 03 04 4E 00 01 00", "01 83 03");
    expect("01 04 04 4E 00 01", "01 84 02");
    expect("01 03 10 00 00 7D 00", "01 83 03");
    expect("01 06 05 00 00", "01 86 03");
    expect("01 10 05 00 00 00 00", "01 90 03");
    expect("01 10 05 00 00 02 02 00 01", "01 90 03");
    expect("01 10 05 00 00 02 04 00 01", "01 90 03");
    expect("01 10 05", "01 90 03");
    expect("01 10 05 00 00 01 02 00 01", "01 90 02");
}
END_TEST

START_TEST(range_comes_before_the_values)
{
    face_begin(&rig, &two);
    expect("01 03 04 4D 00 02", "01 83 02");
    expect("01 03 FF FF 00 02", "01 83 02");
    expect("01 03 00 01 00 01", "01 83 02"); /* write only */
    expect("01 03 00 00 00 01", "01 03 02 00 00");
    expect("01 06 00 01 61 01", "01 86 02");
    expect("01 10 00 02 00 01 02 61 01", "01 90 02");
    expect("01 10 00 00 00 02 04 05 01 61 01", "01 90 02");
    expect("01 06 04 59 00 00", "01 86 02"); /* a half of a value */
    expect("01 10 04 59 00 01 02 00 00", "01 90 02");
    expect("01 10 04 5A 00 02 04 00 00 00 00", "01 90 02");
    expect("01 06 10 00 00 0A", "01 86 02");
    expect("01 10 10 01 00 08 10 00 0A 00 00 00 00 00 00 00 00 00 00 00 00 00 00", "01 90 02");
    expect("01 10 04 5F 00 02 04 00 00 FF FF", "01 90 03"); /* X's last, then Y's first */
    expect("01 04 00 00 00 0E", "01 84 02");
    expect("01 04 00 0C 00 01", "01 04 02 00 00");
    expect("01 04 00 1D 00 01", "01 84 02");
    expect("01 03 14 00 00 01", "01 83 02");
}
END_TEST

START_TEST(values_come_before_a_busy_axis)
{
    face_begin(&rig, &two);
    expect("01 06 00 00 01 20", "01 06 00 00 01 20");
    expect("01 06 04 4E 00 00", "01 86 03");
    expect("01 06 04 4E 00 0B", "01 86 06");
    expect("01 06 04 60 00 0B", "01 06 04 60 00 0B"); /* Y is free */
    expect("01 10 04 5F 00 02 04 00 01 00 01", "01 90 06");
    expect("01 06 00 00 0A 01", "01 86 06");
    expect("01 06 00 00 0B 03", "01 86 06");
    expect("01 06 00 00 0B 02", "01 06 00 00 0B 02");
    expect("01 06 00 00 06 01", "01 86 06");
    expect("01 06 00 00 06 03", "01 86 06");
    ck_assert(!pmc_is_busy(&rig.unit, 1));
    expect("01 10 00 01 00 05 0A 72 03 00 00 00 01 00 00 00 01", "01 90 06");
    expect("01 10 00 01 00 05 0A 72 01 00 80 00 00 00 00 00 01", "01 90 03");
    expect("01 10 10 00 00 08 10 00 0A 00 00 00 00 00 00 00 00 00 00 00 00 00 00", "01 90 06");
    expect("01 06 04 84 00 05", "01 06 04 84 00 05"); /* the fifth speed may change */
    ck_assert_uint_eq(state_of(0).fifth, 5);
}
END_TEST

START_TEST(starts_are_refused_during_an_emergency_stop)
{
    face_begin(&rig, &two);
    pmc_set_inputs(&rig.unit, PMC_EMG);
    face_wait(&rig, 2);
    expect("01 06 00 00 01 30", "01 86 03");
    expect("01 06 00 00 01 20", "01 86 06");
    expect("01 06 00 00 06 01", "01 86 06");
    expect("01 06 00 00 07 01", "01 86 06");
    expect("01 10 00 01 00 05 0A 71 01 00 00 00 01 00 00 00 00", "01 90 06");
    expect("01 06 00 00 09 01", "01 06 00 00 09 01");
    ck_assert_uint_eq(rig.pulses[0], 0);
}
END_TEST

START_TEST(failed_store_is_a_device_failure)
{
    face_begin(&rig, &two);
    rig.stores = false;
    expect("01 06 00 00 0B 01", "01 86 04");
    rig.stores = true;
    expect("01 06 04 52 00 63", "01 06 04 52 00 63");
    expect("01 06 00 00 0B 01", "01 06 00 00 0B 01");
    expect("01 06 00 00 0C 00", "01 06 00 00 0C 00");
    face_wait(&rig, 2);
    expect("01 03 04 52 00 01", "01 03 02 00 63");
}
END_TEST

/* ---- Commands (AB4, AB5) ------------------------------------------------------------------------------------------------ */

START_TEST(wrong_commands_are_exceptions)
{
    static const char *const wrong[] = {"00 00", "01 00", "01 30", "01 03", "01 40", "01 80", "01 08", "02 01", "03 01", "04 00",
                                        "04 50", "04 05", "05 00", "05 11", "05 04", "05 40", "06 00", "06 04", "07 04", "08 00",
                                        "09 10", "0A 00", "0A 04", "0A 40", "0B 00", "0B 04", "0C 01", "0D 01", "FF 01"};
    static const char *const blocks[] = {
        "00 01 02 61 01", "00 02 04 61 01 00 01", "00 03 06 61 00 00 01 00 01", "00 03 06 61 04 00 01 00 01",
        "00 03 06 61 01 00 00 00 01", "00 03 06 61 02 00 01 1F 41", "00 03 06 71 01 00 00 00 01",
        "00 05 0A 73 01 00 00 00 01 00 00 00 01", "00 05 0A 61 01 00 00 00 01 00 00 00 01",
        "00 06 0C 71 01 00 00 00 01 00 00 00 01 00 00", "00 05 0A 71 02 00 00 00 00 FF 7F FF FF"};
    char request[64], refusal[] = "01 86 03";
    face_begin(&rig, &two);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        snprintf(request, sizeof request, "01 06 00 00 %s", wrong[i]);
        expect(request, refusal);
    }
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++) {
        snprintf(request, sizeof request, "01 10 00 01 %s", blocks[i]);
        expect(request, "01 90 03");
    }
    ck_assert(!pmc_is_busy(&rig.unit, 0) && !pmc_is_busy(&rig.unit, 1));
}
END_TEST

START_TEST(one_axis_has_no_y)
{
    face_begin(&rig, &one);
    expect("01 06 00 00 01 02", "01 86 03");
    expect("01 06 00 00 06 03", "01 86 03");
    expect("01 06 00 00 04 11", "01 86 03");
    expect("01 06 00 00 05 20", "01 86 03");
    expect("01 06 00 00 0A 21", "01 86 03");
    expect("01 10 00 01 00 03 06 61 02 00 01 00 01", "01 90 03");
    expect("01 03 04 60 00 01", "01 83 02");
    expect("01 03 04 8C 00 01", "01 83 02");
    expect("01 03 04 8D 00 01", "01 83 02");
    expect("01 03 12 00 00 01", "01 83 02");
    expect("01 04 00 10 00 01", "01 84 02");
    expect("01 03 04 73 00 01", "01 83 02");
    expect("01 03 04 72 00 01", "01 03 02 00 01");
}
END_TEST

START_TEST(directions_and_ways_to_stop)
{
    face_begin(&rig, &two);
    expect("01 06 00 00 01 12", "01 06 00 00 01 12");
    face_wait(&rig, 500);
    ck_assert(state_of(0).moving && !state_of(0).forward && state_of(1).moving && state_of(1).forward);
    expect("01 06 00 00 05 12", "01 06 00 00 05 12"); /* X at once, Y with its ramp */
    face_wait(&rig, 500);
    ck_assert(!state_of(0).moving && !state_of(1).moving);
    expect("01 06 00 00 01 21", "01 06 00 00 01 21");
    face_wait(&rig, 10);
    ck_assert(state_of(0).forward && !state_of(1).forward);
}
END_TEST

START_TEST(program_begins_at_its_register)
{
    face_begin(&rig, &two);
    expect("01 06 04 85 00 40", "01 86 03");
    expect("01 06 04 85 00 05", "01 06 04 85 00 05");
    expect("01 10 10 28 00 08 10 00 0B 00 00 00 00 00 00 13 88 00 00 00 00 00 00", "01 10 10 28 00 08"); /* TIM 5000 */
    expect("01 06 00 00 07 01", "01 06 00 00 07 01");
    face_wait(&rig, 10);
    expect("01 04 00 06 00 02", "01 04 04 00 02 00 05");
    expect("01 06 00 00 08 01", "01 06 00 00 08 01");
    face_wait(&rig, 10);
    expect("01 04 00 06 00 02", "01 04 04 00 00 FF FF");
    expect("01 03 04 85 00 01", "01 03 02 00 05");
    expect("01 03 04 8D 00 01", "01 03 02 00 00");
}
END_TEST

START_TEST(counters_are_cleared_apart)
{
    face_begin(&rig, &two);
    expect("01 10 00 01 00 05 0A 72 03 00 00 00 05 00 00 00 06", "01 10 00 01 00 05");
    face_wait(&rig, 1000);
    expect("01 06 00 00 0A 12", "01 06 00 00 0A 12");
    face_wait(&rig, 2);
    expect("01 04 00 00 00 04", "01 04 08 00 00 00 05 00 00 00 00");
    expect("01 04 00 10 00 04", "01 04 08 00 00 00 00 00 00 00 06");
}
END_TEST

START_TEST(speed_is_shown_while_it_moves)
{
    face_begin(&rig, &two);
    expect("01 06 04 84 1F 40", "01 06 04 84 1F 40");
    expect("01 06 00 00 01 20", "01 06 00 00 01 20");
    face_wait(&rig, 1000);
    expect("01 04 00 04 00 03", "01 04 06 00 01 38 80 00 01"); /* 80 000 pulses/s, manual */
    expect("01 04 00 0B 00 01", "01 04 02 00 04");
}
END_TEST

START_TEST(program_registers_are_checked)
{
    static const char *const wrong[] = {
        "00 0C 00 00 00 00 00 00 00 00 00 00 00 00 00 00", "01 0A 00 00 00 00 00 00 00 00 00 00 00 00 00 00",
        "00 0A 00 00 00 01 00 00 00 00 00 00 00 00 00 00", "00 0A 00 00 00 00 01 00 00 00 00 00 00 00 00 00",
        "00 0A 00 00 00 00 00 00 00 01 00 00 00 00 00 00", "00 0A 00 00 00 00 00 00 00 00 01 00 00 00 00 00",
        "00 0A 00 00 00 00 00 00 00 00 00 00 01 00 00 00", "00 0A 00 00 00 00 00 00 00 00 00 00 00 00 00 01",
        "00 06 00 00 00 00 00 00 00 05 00 00 00 00 00 02", "00 01 00 00 00 0A 00 05 00 00 00 00 00 00 00 00",
        "00 01 00 00 00 0A 00 01 00 05 00 00 00 01 00 00", "00 01 00 00 00 0A 00 01 00 00 00 00 00 04 00 00",
        "00 0B 00 00 00 00 00 00 00 00 00 00 00 00 00 00", "00 07 00 00 00 00 00 00 00 00 00 40 00 00 00 00"};
    char request[128];
    face_begin(&rig, &two);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        snprintf(request, sizeof request, "01 10 10 00 00 08 10 %s", wrong[i]);
        expect(request, "01 90 03");
    }
    expect("01 10 10 00 00 08 10 00 01 00 00 00 0A 00 01 00 00 00 00 00 03 00 00", "01 10 10 00 00 08");
}
END_TEST

/* Every register of AP1 reads its default, and no other address is there. */
START_TEST(map_has_the_registers_of_the_specification)
{
    unsigned count = 0;
    face_begin(&rig, &two);
    for (unsigned address = 0x100; address < 0x1000; address++) {
        char request[32];
        snprintf(request, sizeof request, "01 03 %02X %02X 00 01", address >> 8, address & 0xFF);
        count += strncmp(face_ask(&rig, request), "01 03 02", 8) == 0;
    }
    ck_assert_uint_eq(count, 2 * (22 + 3 + 2)); /* three values of two words; fifth speed and start */
    expect("01 03 04 1C 00 02", "01 03 04 01 23 1F 03");
    expect("01 03 04 21 00 02", "01 03 04 01 23 1F 03");
    expect("01 03 04 56 00 0A", "01 03 14 00 00 00 00 00 00 00 7F FF FF FF 80 00 01 00 01 03 E8 03 E8");
    expect("01 03 04 68 00 0C", "01 03 18 00 00 00 00 00 00 00 7F FF FF FF 80 00 01 00 01 03 E8 03 E8 00 01 00 01");
    expect("01 03 04 80 00 06", "01 03 0C 00 14 03 E8 00 00 00 00 00 0A 00 00");
    expect("01 03 04 88 00 06", "01 03 0C 00 14 03 E8 00 00 00 00 00 0A 00 00");
    expect("01 10 04 59 00 04 08 FF FF FF FF 00 00 00 01", "01 10 04 59 00 04");
    expect("01 03 04 59 00 04", "01 03 08 FF FF FF FF 00 00 00 01");
}
END_TEST

START_TEST(message_without_the_line)
{
    static const uint8_t request[] = {3, 0x04, 0x4E, 0, 1}, expected[] = {3, 2, 0, 10};
    uint8_t answer[8];
    face_begin(&rig, &two);
    ck_assert_uint_eq(pmc_exchange(&rig.unit, request, sizeof request, answer, sizeof answer), sizeof expected);
    ck_assert_mem_eq(answer, expected, sizeof expected);
    ck_assert_uint_eq(pmc_exchange(&rig.unit, request, 0, answer, sizeof answer), 0);
    ck_assert_uint_eq(rig.unit.face.reply.counters.requests, 0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("pmc_modbus");
    TCase *examples = tcase_create("examples"), *bus = tcase_create("line"), *map = tcase_create("map");
    tcase_add_test(examples, ax46_commands);
    tcase_add_test(examples, ax47_broadcast_and_absolute_moves);
    tcase_add_test(examples, ax48_parameters);
    tcase_add_test(examples, ax49_exceptions);
    tcase_add_test(examples, ax50_program_registers);
    tcase_add_test(examples, ax51_input_registers);
    tcase_add_test(bus, answer_begins_after_the_silence);
    tcase_add_test(bus, silence_inside_a_frame_spoils_it);
    tcase_add_test(bus, what_is_no_frame_is_dropped);
    tcase_add_test(bus, lost_byte_spoils_a_frame);
    tcase_add_test(bus, nothing_is_heard_while_an_answer_goes_out);
    tcase_add_test(bus, first_answer_is_late);
    tcase_add_test(map, length_and_quantity_come_before_the_address);
    tcase_add_test(map, range_comes_before_the_values);
    tcase_add_test(map, values_come_before_a_busy_axis);
    tcase_add_test(map, starts_are_refused_during_an_emergency_stop);
    tcase_add_test(map, failed_store_is_a_device_failure);
    tcase_add_test(map, wrong_commands_are_exceptions);
    tcase_add_test(map, one_axis_has_no_y);
    tcase_add_test(map, directions_and_ways_to_stop);
    tcase_add_test(map, program_begins_at_its_register);
    tcase_add_test(map, counters_are_cleared_apart);
    tcase_add_test(map, speed_is_shown_while_it_moves);
    tcase_add_test(map, program_registers_are_checked);
    tcase_add_test(map, map_has_the_registers_of_the_specification);
    tcase_add_test(map, message_without_the_line);
    suite_add_tcase(suite, examples);
    suite_add_tcase(suite, bus);
    suite_add_tcase(suite, map);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
