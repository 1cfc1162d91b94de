/* SPDX-License-Identifier: MIT */
/* test_cib_rtu.c: requests byte by byte at one CIB module, and functions with a length that no frame would have (BL2-BL5). */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "cib_faces/rtu.h"
#include "core/rig.h"

static const struct cib_port nobody;
static const uint8_t read_type[] = {1, 4, 0, 0x30, 0, 1, 0x31, 0xC5};
static struct cib_unit unit;
static struct cib_rtu rtu;

static void begin(void)
{
    rtu = (struct cib_rtu){.address = 1, .silence = CIB_SILENCE};
    cib_begin(&unit, &cib_default_config, &nobody, NULL);
}

static void take(const uint8_t *bytes, size_t length)
{
    for (size_t i = 0; i < length; i++)
        ck_assert(cib_rtu_receive(&rtu, &unit, bytes[i]));
}

/* A frame with this content and its check value. */
static void take_frame(const uint8_t *content, size_t length)
{
    uint8_t frame[MODBUS_FRAME_MAX];
    memcpy(frame, content, length);
    take(frame, modbus_append_crc(frame, length));
}

static void be_silent(void)
{
    cib_advance(&unit, CIB_SILENCE);
    cib_rtu_check_silence(&rtu, &unit);
    ck_assert(cib_rtu_due(&rtu) == CIB_NEVER);
}

static size_t sent(uint8_t answer[MODBUS_FRAME_MAX])
{
    size_t length = 0;
    while (cib_rtu_send(&rtu, &unit, &answer[length]))
        length++;
    return length;
}

/* ---- Frames ------------------------------------------------------------------------------------------------------------- */

START_TEST(bl4_a_byte_after_a_request_that_waits_is_lost)
{
    uint8_t answer[MODBUS_FRAME_MAX];
    ck_assert(!cib_rtu_send(&rtu, &unit, answer));
    take(read_type, sizeof read_type);
    take(read_type, sizeof read_type);
    ck_assert(!cib_rtu_receive(&rtu, &unit, 1));
    ck_assert(cib_rtu_due(&rtu) == CIB_NEVER); /* no silence ends the one that waits */
    ck_assert_uint_eq(sent(answer), 14);       /* 01 04 02 08 08, check value, twice */
    ck_assert_uint_eq(answer[7 + 3], 0x08);
    ck_assert_uint_eq(rtu.counters.requests, 2);
    ck_assert_uint_eq(rtu.counters.answers, 2);
    take(read_type, sizeof read_type);
    ck_assert_uint_eq(sent(answer), 7);
}
END_TEST

/* What is no request is dropped by silence, and the next one is received. */
START_TEST(bl3_silence_drops_what_is_no_request)
{
    static const struct {
        uint8_t bytes[6];
        size_t length;
        bool is_frame; /* the check value is added */
    } rows[] = {
        {{1}, 1, false},                 /* a byte */
        {{1, 4, 0}, 3, false},           /* the begin of one */
        {{1, 0x41, 0, 0, 0, 0}, 6, false}, /* a function without a length, the check value is wrong */
        {{9, 0x41, 0, 0, 0, 0}, 6, false}, /* the same for another module */
        {{1, 3}, 2, true},               /* too short for its function, the check value is right */
        {{9}, 1, false},
    };
    uint8_t answer[MODBUS_FRAME_MAX];
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        if (rows[i].is_frame)
            take_frame(rows[i].bytes, rows[i].length);
        else
            take(rows[i].bytes, rows[i].length);
        be_silent();
        ck_assert_uint_eq(rtu.counters.dropped, i + 1);
        ck_assert_uint_eq(sent(answer), 0);
    }
    take(read_type, sizeof read_type);
    ck_assert_uint_eq(sent(answer), 7);
}
END_TEST

START_TEST(bl2_a_frame_for_another_module_is_counted)
{
    static const uint8_t unknown[] = {9, 0x41, 0, 0};
    uint8_t answer[MODBUS_FRAME_MAX];
    take_frame(unknown, sizeof unknown);
    be_silent();
    ck_assert_uint_eq(rtu.counters.others, 1);
    ck_assert_uint_eq(rtu.counters.dropped, 0);
    ck_assert_uint_eq(sent(answer), 0);
}
END_TEST

/* ---- Functions ---------------------------------------------------------------------------------------------------------- */

/* As they may come over TCP, where the length is a field of its own (BL5). Nothing is stored. */
START_TEST(bl5_functions_with_a_wrong_length_or_address_are_refused)
{
    static const struct {
        uint8_t request[12];
        size_t length;
        uint8_t exception;
    } rows[] = {
        {{1, 0, 0, 0}, 4, 3},       {{1, 0, 0, 0, 1, 0}, 6, 3},    {{3, 0, 0, 0}, 4, 3},
        {{4, 0, 0x30, 0, 1, 0}, 6, 3}, {{5, 0, 0, 0xFF}, 4, 3},    {{5, 0, 0, 0xFF, 0, 0}, 6, 3},
        {{6, 0, 0, 0}, 4, 3},       {{6, 0, 0, 0, 7, 0}, 6, 3},    {{15, 0, 0, 0, 8, 1}, 6, 3},
        {{15, 0, 0, 0, 8, 2, 7, 7}, 8, 3}, {{15, 0, 0, 0, 8, 1, 7, 7}, 8, 3}, {{16, 0, 0, 0, 1, 2, 0}, 7, 3},
        {{16, 0, 0, 0, 1, 4, 0, 7, 0, 7}, 10, 3}, {{16, 0, 0, 0, 1, 2, 0, 7, 0, 7}, 10, 3},
        {{16, 0xFF, 0xFF, 0, 2, 4, 0, 7, 0, 7}, 10, 2}, {{3, 0xFF, 0xFF, 0, 2}, 5, 2}, {{6, 0xFF, 0xFF, 0, 0}, 5, 2},
        {{15, 0, 1, 0, 8, 1, 7}, 7, 2}, {{15, 0, 0, 0, 0, 0, 7}, 7, 3}, {{0x41}, 1, 1}, {{16}, 1, 3},
        {{15, 0, 0, 0x07, 0xB1, 0xF7, 7}, 7, 3}, {{16, 0, 0, 0, 124, 248, 0}, 7, 3},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        uint8_t answer[MODBUS_PDU_MAX];
        ck_assert_msg(cib_modbus(&unit, rows[i].request, rows[i].length, answer) == 2, "row %zu", i);
        ck_assert_msg(answer[0] == (rows[i].request[0] | MODBUS_IS_EXCEPTION) && answer[1] == rows[i].exception,
                      "row %zu: exception %u", i, answer[1]);
        ck_assert_uint_eq(cib_read(&unit, CIB_OUTPUT_ZONE, 0), 0);
    }
}
END_TEST

static Suite *cib_rtu_suite(void)
{
    Suite *suite = suite_create("cib_rtu");
    TCase *all = tcase_create("all");
    tcase_add_checked_fixture(all, begin, NULL);
    tcase_add_test(all, bl4_a_byte_after_a_request_that_waits_is_lost);
    tcase_add_test(all, bl3_silence_drops_what_is_no_request);
    tcase_add_test(all, bl2_a_frame_for_another_module_is_counted);
    tcase_add_test(all, bl5_functions_with_a_wrong_length_or_address_are_refused);
    suite_add_tcase(suite, all);
    return suite;
}

int main(void)
{
    return rig_run(cib_rtu_suite(), "./test_cib_rtu");
}
