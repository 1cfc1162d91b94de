/* SPDX-License-Identifier: MIT */
/* test_cib_modbus.c: Modbus RTU at CIB modules on a bus, by the worked examples Y1-Y12 and X38, and what BL1-BL8 say. */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "cib_bus.h"
#include "core/rig.h"
#include "device/cib_device.h"

#define READ_A "01 04 00 10 00 07 B0 0D"

static struct cib_bus bus;

static void begin(void)
{
    cib_bus_begin(&bus, "1", false, NULL);
}

static void end(void)
{
    cib_bus_end(&bus);
}

/* ---- Worked examples ---------------------------------------------------------------------------------------------------- */

START_TEST(y1_to_y6_motions_over_the_zone_of_drive_a)
{
    cib_bus_to(&bus, 500);
    cib_bus_expect(&bus, READ_A, "01 04 0E 00 00 00 20 00 00 00 00 00 00 00 00 00 00 06 E7");
    cib_bus_to(&bus, 1000);
    cib_bus_expect(&bus, "01 10 00 10 00 05 0A 00 01 00 66 00 00 0B B8 01 F4 99 A8", "01 10 00 10 00 05 01 CF");
    cib_bus_to(&bus, 1001500);
    cib_bus_expect(&bus, READ_A, "01 04 0E 00 01 00 21 00 00 00 00 00 DC 01 54 00 04 90 A6");
    cib_bus_to(&bus, 7335000);
    cib_bus_expect(&bus, READ_A, "01 04 0E 00 01 00 28 00 00 00 00 0B B8 00 00 00 04 8E A5");
    cib_bus_to(&bus, 7335100);
    cib_bus_expect(&bus, "01 10 00 10 00 05 0A 00 02 00 65 FF FE EE 90 03 E8 34 2E", "01 10 00 10 00 05 01 CF");
    cib_bus_to(&bus, 7335500);
    cib_bus_expect(&bus, "01 10 00 10 00 05 0A 00 03 00 65 00 00 00 00 03 E9 F0 A0", "01 10 00 10 00 05 01 CF");
    cib_bus_to(&bus, 7336500);
    cib_bus_expect(&bus, "01 04 00 10 00 03 B1 CE", "01 04 06 00 03 00 33 00 04 D5 5F");
}
END_TEST

static void use_outputs_5_to_8_as_do(void)
{
    cib_bus_expect(&bus, "01 06 01 03 00 00 78 36", "01 06 01 03 00 00 78 36");
    cib_bus_expect(&bus, "01 06 01 00 00 01 49 F6", "01 06 01 00 00 01 49 F6");
}

START_TEST(y7_to_y10_outputs_and_configuration)
{
    cib_bus_to(&bus, 7777);
    use_outputs_5_to_8_as_do();
    cib_bus_expect(&bus, "01 04 01 00 00 04 F0 35", "01 04 08 00 00 00 02 00 02 00 00 FC 0D");
    cib_bus_expect(&bus, "01 05 00 05 FF 00 9C 3B", "01 05 00 05 FF 00 9C 3B");
    cib_bus_expect(&bus, "01 01 00 00 00 08 3D CC", "01 01 01 20 50 50");
    cib_bus_expect(&bus, "01 04 00 01 00 01 60 0A", "01 04 02 00 20 B8 E8");
    cib_bus_expect(&bus, "01 0F 00 04 00 04 01 0A 4F 51", "01 0F 00 04 00 04 15 C9");
    cib_bus_expect(&bus, "01 06 00 01 09 C4 DF C9", "01 06 00 01 09 C4 DF C9");
    cib_bus_expect(&bus, "01 06 01 20 00 12 09 F1", "01 06 01 20 00 12 09 F1");
    cib_bus_expect(&bus, "01 06 01 00 00 01 49 F6", "01 06 01 00 00 01 49 F6");
    cib_bus_expect(&bus, "01 04 01 00 00 01 30 36", "01 04 02 01 20 B9 78");
}
END_TEST

START_TEST(y11_exceptions)
{
    cib_bus_send(&bus, "01 41 00 10 50");
    cib_bus_to(&bus, 2343);
    ck_assert_str_eq(bus.heard, "");
    cib_bus_to(&bus, 3000);
    ck_assert_str_eq(bus.heard, "01 C1 01 B0 50");
    ck_assert_uint_eq(bus.first_tick, 2344);
    cib_bus_expect(&bus, "01 03 00 09 00 01 54 08", "01 83 02 C0 F1");
    cib_bus_expect(&bus, "01 03 00 08 00 02 45 C9", "01 83 02 C0 F1");
    cib_bus_expect(&bus, "01 03 00 00 00 7E C5 EA", "01 83 03 01 31");
    cib_bus_expect(&bus, "01 06 00 01 27 11 03 F6", "01 86 03 02 61");
    cib_bus_expect(&bus, "01 05 00 00 12 34 C0 BD", "01 85 03 02 91");
}
END_TEST

START_TEST(y12_no_answer)
{
    use_outputs_5_to_8_as_do();
    cib_bus_expect(&bus, "00 05 00 00 FF 00 8D EB", "");
    cib_bus_expect_checked(&bus, "01 01 00 00 00 08", "01 01 01 01");
    cib_bus_expect(&bus, "01 03 00 00 00 01 00 00", "");
    cib_bus_to(&bus, 10000);
    ck_assert_str_eq(bus.heard, "");
    cib_bus_expect(&bus, "02 03 00 00 00 01 84 39", "");
    cib_bus_to(&bus, 20000);
    ck_assert_str_eq(bus.heard, "");
}
END_TEST

/* What begins at `gap` us behind the fourth byte, whose stop bit ends at 2084. */
static void send_in_two(uint64_t gap)
{
    cib_bus_begin(&bus, "1", true, NULL);
    cib_bus_send(&bus, "01 04 00 10");
    cib_bus_to(&bus, 2084 + gap - 521);
    cib_bus_send(&bus, "00 07 B0 0D");
    cib_bus_to(&bus, 40000);
}

START_TEST(x38_silence_and_the_begin_of_answers)
{
    cib_bus_begin(&bus, "1", true, NULL);
    cib_bus_send(&bus, READ_A);
    cib_bus_to(&bus, 40000);
    ck_assert_uint_eq(bus.first_tick, 5990 + 521);
    end();
    cib_bus_begin(&bus, "1", true, NULL);
    cib_bus_send(&bus, "01 41 00 10 50");
    cib_bus_to(&bus, 40000);
    ck_assert_str_eq(bus.heard, "01 C1 01 B0 50");
    ck_assert_uint_eq(bus.first_tick, 4949 + 521);
    end();
    send_in_two(2343);
    ck_assert_str_ne(bus.heard, "");
    end();
    send_in_two(2344);
    ck_assert_str_eq(bus.heard, "");
    end();
}
END_TEST

/* ---- Frames ------------------------------------------------------------------------------------------------------------- */

START_TEST(bl1_a_module_obeys_its_address_from_1_to_247)
{
    cib_bus_begin(&bus, "247,3", false, NULL);
    cib_bus_expect_checked(&bus, "F7 04 00 30 00 02", "F7 04 04 08 08 01 02");
    cib_bus_expect_checked(&bus, "03 04 00 30 00 01", "03 04 02 08 08");
    cib_bus_expect_checked(&bus, "04 04 00 30 00 01", "");
    end();
}
END_TEST

START_TEST(bl2_all_modules_obey_writes_to_0_and_do_not_answer_reads)
{
    cib_bus_begin(&bus, "1,2", false, NULL);
    cib_bus_expect_checked(&bus, "00 06 01 03 00 00", "");
    cib_bus_expect_checked(&bus, "00 10 01 00 00 01 02 00 01", "");
    cib_bus_expect_checked(&bus, "00 0F 00 00 00 08 01 A5", "");
    cib_bus_expect_checked(&bus, "00 03 00 00 00 01", "");
    cib_bus_expect_checked(&bus, "01 01 00 00 00 08", "01 01 01 A5");
    cib_bus_expect_checked(&bus, "02 01 00 00 00 08", "02 01 01 A5");
    cib_bus_expect_checked(&bus, "02 02 00 00 00 10", "02 02 02 00 A0"); /* inputs, then outputs as they are driven */
    cib_bus_send(&bus, "00 41 C1 80");
    cib_bus_to(&bus, 10000);
    ck_assert_str_eq(bus.heard, "");
    end();
}
END_TEST

/* Where bytes take time, units receive the answers of others: a frame for another lasts until silence, and so does its answer. */
START_TEST(bl2_answers_of_others_are_no_requests)
{
    cib_bus_begin(&bus, "1,2,3", true, NULL);
    for (unsigned round = 0; round < 3; round++) {
        cib_bus_send(&bus, "02 04 00 30 00 02 71 F7");
        cib_bus_to(&bus, 50000 * (round + 1));
        ck_assert_str_eq(bus.heard, "02 04 04 08 08 01 02 CB 77");
    }
    for (unsigned number = 1; number <= 3; number += 2) {
        struct device_counters counters = cib_device.counters(sim_core(&bus.sim, number));
        ck_assert_uint_eq(counters.others, 6);
        ck_assert_uint_eq(counters.dropped, 0);
    }
    end();
}
END_TEST

START_TEST(bl2_frames_for_others_end_by_their_length_without_time)
{
    cib_bus_begin(&bus, "1", false, NULL);
    cib_bus_expect(&bus, "02 03 00 00 00 01 84 39 01 04 00 30 00 01 31 C5", "01 04 02 08 08 BF 36");
    ck_assert_uint_eq(cib_device.counters(sim_core(&bus.sim, 1)).others, 1);
    cib_bus_send(&bus, "02 41 C0 E0 01 04 00 30 00 01 31 C5"); /* its function has no length */
    cib_bus_to(&bus, 10000);
    ck_assert_str_eq(bus.heard, "");
    end();
}
END_TEST

START_TEST(bl3_a_bad_frame_drops_everything_up_to_silence)
{
    cib_bus_expect(&bus, "01 03 00 00 00 01 00 00", "");
    cib_bus_to(&bus, 2343);
    cib_bus_expect(&bus, READ_A, "");
    ck_assert_uint_eq(cib_device.counters(sim_core(&bus.sim, 1)).dropped, 1);
    cib_bus_to(&bus, 2343 + 2344);
    cib_bus_expect(&bus, READ_A, "01 04 0E 00 00 00 20 00 00 00 00 00 00 00 00 00 00 06 E7");
}
END_TEST

START_TEST(bl3_a_byte_count_that_makes_too_long_a_frame_is_seen_at_once)
{
    cib_bus_expect(&bus, "01 10 00 00 00 7C F8", "");
    ck_assert_uint_eq(cib_device.counters(sim_core(&bus.sim, 1)).dropped, 1);
    cib_bus_to(&bus, 5000);
    cib_bus_expect(&bus, READ_A, "01 04 0E 00 00 00 20 00 00 00 00 00 00 00 00 00 00 06 E7");
}
END_TEST

START_TEST(bl3_a_frame_has_256_bytes_at_most)
{
    cib_bus_send(&bus, "01 41");
    for (unsigned i = 0; i < 255; i++)
        cib_bus_send(&bus, "55");
    ck_assert_uint_eq(cib_device.counters(sim_core(&bus.sim, 1)).dropped, 1);
    cib_bus_to(&bus, 10000);
    ck_assert_str_eq(bus.heard, "");
    cib_bus_expect(&bus, READ_A, "01 04 0E 00 00 00 20 00 00 00 00 00 00 00 00 00 00 06 E7");
}
END_TEST

START_TEST(bl3_the_option_silence_is_how_long_silence_lasts)
{
    struct device_config config = {.node = 1};
    char error[DEVICE_ERROR_SIZE];
    ck_assert(device_option_named(&cib_device, "silence")->read(&config, "30000", error));
    cib_bus_begin(&bus, "1", false, &config);
    cib_bus_send(&bus, "01 04 00 10");
    cib_bus_to(&bus, 29999);
    cib_bus_expect(&bus, "00 07 B0 0D", "01 04 0E 00 00 00 20 00 00 00 00 00 00 00 00 00 00 06 E7");
    cib_bus_send(&bus, "01 04 00 10");
    cib_bus_to(&bus, 29999 + 30000);
    cib_bus_expect(&bus, "00 07 B0 0D", "");
    ck_assert(!device_option_named(&cib_device, "silence")->read(&config, "2343", error));
    end();
}
END_TEST

/* The first one is answered from 14167 on; the second is whole at 8434, and executed when that answer is out. */
START_TEST(bl4_a_request_before_an_answer_is_out_waits_for_its_end)
{
    cib_bus_begin(&bus, "1", true, NULL);
    bus.sim.segment.config.turnaround = 10000;
    cib_bus_send(&bus, "01 06 00 02 00 07");
    cib_bus_to(&bus, 3126);
    cib_bus_send(&bus, "69 C8");
    cib_bus_to(&bus, 4267);
    cib_bus_send(&bus, READ_A);
    cib_bus_to(&bus, 14000);
    ck_assert_str_eq(bus.heard, "");
    cib_bus_to(&bus, 90000);
    ck_assert_str_eq(bus.heard, "01 06 00 02 00 07 69 C8 01 04 0E 00 00 00 20 00 00 00 00 00 00 00 00 00 00 06 E7");
    end();
}
END_TEST

/* ---- Functions and registers -------------------------------------------------------------------------------------------- */

START_TEST(bl5_every_register_of_the_table_is_read_and_no_other)
{
    for (unsigned function = 3; function <= 4; function++) {
        enum cib_zone zone = function == 3 ? CIB_OUTPUT_ZONE : CIB_INPUT_ZONE;
        const struct cib_unit *unit = &cib_device_of(sim_core(&bus.sim, 1))->unit;
        for (unsigned address = 0; address <= 0x200; address++) {
            char request[64], answer[64];
            unsigned value = cib_read(unit, zone, (uint16_t)address);
            snprintf(request, sizeof request, "01 %02X %02X %02X 00 01", function, address >> 8, address & 0xff);
            if (cib_has_register(zone, (uint16_t)address))
                snprintf(answer, sizeof answer, "01 %02X 02 %02X %02X", function, value >> 8, value & 0xff);
            else
                snprintf(answer, sizeof answer, "01 %02X 02", function | 0x80);
            cib_bus_expect_checked(&bus, request, answer);
        }
    }
}
END_TEST

START_TEST(bl5_exceptions_of_each_function_in_their_order)
{
    static const char *const pairs[][2] = {
        {"01 01 00 00 00 00", "01 81 03"}, {"01 01 00 00 07 D1", "01 81 03"}, {"01 01 00 00 07 D0", "01 81 02"},
        {"01 01 00 00 00 09", "01 81 02"}, {"01 01 00 08 00 01", "01 81 02"}, {"01 01 FF FF 00 01", "01 81 02"},
        {"01 02 00 00 00 10", "01 02 02 00 00"}, {"01 02 00 00 00 11", "01 82 02"}, {"01 02 00 0F 00 01", "01 02 01 00"},
        {"01 03 00 00 00 00", "01 83 03"}, {"01 03 FF FF 00 02", "01 83 02"}, {"01 04 00 00 00 7D", "01 84 02"},
        {"01 04 00 1B 00 01", "01 84 02"}, {"01 05 00 08 12 34", "01 85 03"}, {"01 05 00 08 FF 00", "01 85 02"},
        {"01 06 00 09 00 00", "01 86 02"}, {"01 06 00 00 01 00", "01 86 03"}, {"01 06 01 00 00 02", "01 86 03"},
        {"01 06 00 15 00 00", "01 86 02"}, {"01 0F 00 00 00 00 00", "01 8F 03"}, {"01 0F 00 00 00 08 02 00 00", "01 8F 03"},
        {"01 0F 00 01 00 08 01 FF", "01 8F 02"}, {"01 10 00 00 00 00 00", "01 90 03"},
        {"01 10 00 00 00 01 03 00 00 00", "01 90 03"},
        {"01 10 00 08 00 02 04 00 00 00 00", "01 90 02"}, {"01 10 00 00 00 02 04 00 00 27 11", "01 90 03"},
    };
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++)
        cib_bus_expect_checked(&bus, pairs[i][0], pairs[i][1]);
}
END_TEST

START_TEST(bl5_nothing_of_a_refused_request_is_stored)
{
    cib_bus_expect_checked(&bus, "01 10 00 00 00 02 04 00 55 27 11", "01 90 03");
    cib_bus_expect_checked(&bus, "01 10 00 08 00 02 04 00 55 00 00", "01 90 02");
    cib_bus_expect_checked(&bus, "01 03 00 00 00 09", "01 03 12 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00");
}
END_TEST

START_TEST(bl5_a_whole_write_of_the_coils_leaves_the_others)
{
    use_outputs_5_to_8_as_do();
    cib_bus_expect_checked(&bus, "01 0F 00 00 00 08 01 C3", "01 0F 00 00 00 08");
    cib_bus_expect_checked(&bus, "01 0F 00 02 00 04 01 FF", "01 0F 00 02 00 04");
    cib_bus_expect_checked(&bus, "01 05 00 07 00 00", "01 05 00 07 00 00");
    cib_bus_expect_checked(&bus, "01 01 00 00 00 08", "01 01 01 7F");
    cib_bus_expect_checked(&bus, "01 01 00 03 00 03", "01 01 01 07");
    cib_bus_expect_checked(&bus, "01 02 00 08 00 08", "01 02 01 70"); /* LEDs of outputs that are DO */
}
END_TEST

START_TEST(inputs_and_buttons_are_inputs_of_the_device)
{
    use_outputs_5_to_8_as_do();
    cib_bus_to(&bus, 10000);
    cib_bus_do(&bus, "di.set", "{\"di\": {\"1\": 1, \"3\": 1, \"14\": 1}}");
    cib_bus_to(&bus, 14999);
    ck_assert_uint_eq(cib_bus_input(&bus, 0), 0);
    cib_bus_to(&bus, 15000);
    cib_bus_expect_checked(&bus, "01 04 00 00 00 03", "01 04 06 00 05 00 20 00 20");
}
END_TEST

static Suite *modbus_suite(void)
{
    Suite *suite = suite_create("cib_modbus");
    TCase *one = tcase_create("one module"), *others = tcase_create("other buses");
    tcase_add_checked_fixture(one, begin, end);
    tcase_add_test(one, y1_to_y6_motions_over_the_zone_of_drive_a);
    tcase_add_test(one, y7_to_y10_outputs_and_configuration);
    tcase_add_test(one, y11_exceptions);
    tcase_add_test(one, y12_no_answer);
    tcase_add_test(one, bl3_a_bad_frame_drops_everything_up_to_silence);
    tcase_add_test(one, bl3_a_byte_count_that_makes_too_long_a_frame_is_seen_at_once);
    tcase_add_test(one, bl3_a_frame_has_256_bytes_at_most);
    tcase_add_test(one, bl5_every_register_of_the_table_is_read_and_no_other);
    tcase_add_test(one, bl5_exceptions_of_each_function_in_their_order);
    tcase_add_test(one, bl5_nothing_of_a_refused_request_is_stored);
    tcase_add_test(one, bl5_a_whole_write_of_the_coils_leaves_the_others);
    tcase_add_test(one, inputs_and_buttons_are_inputs_of_the_device);
    suite_add_tcase(suite, one);
    tcase_add_test(others, x38_silence_and_the_begin_of_answers);
    tcase_add_test(others, bl1_a_module_obeys_its_address_from_1_to_247);
    tcase_add_test(others, bl2_all_modules_obey_writes_to_0_and_do_not_answer_reads);
    tcase_add_test(others, bl2_answers_of_others_are_no_requests);
    tcase_add_test(others, bl2_frames_for_others_end_by_their_length_without_time);
    tcase_add_test(others, bl3_the_option_silence_is_how_long_silence_lasts);
    tcase_add_test(others, bl4_a_request_before_an_answer_is_out_waits_for_its_end);
    suite_add_tcase(suite, others);
    return suite;
}

int main(void)
{
    return rig_run(modbus_suite(), "./test_cib_modbus");
}
