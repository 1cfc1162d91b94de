/* SPDX-License-Identifier: MIT */
/* M, T and H functions of blocks (NG1, NG2): the examples W29, W47 of docs/CNC872.md. */
#include <stdlib.h>
#include <string.h>

#include "cnc_rig.h"

static const char config_text[] =
    "<ChannelConfig><Gear No=\"1\" MaxSpeed=\"500\"/><Gear No=\"2\" MaxSpeed=\"1000\"/><MFunctions>"
    "<MFunc No=\"91\" GroupNo=\"10\" BreakCont=\"1\"></MFunc><MFunc No=\"92\" GroupNo=\"12\" BreakCont=\"1\"></MFunc>"
    "<MFunc No=\"93\" GroupNo=\"13\"></MFunc><MFunc No=\"95\" GroupNo=\"11\" BreakContEnd=\"1\"></MFunc>"
    "<MFunc No=\"70\" GroupNo=\"2\"/><MFunc No=\"71\" GroupNo=\"3\"/>"
    "<MFunc No=\"72\" GroupNo=\"5\"/><MFunc No=\"73\" GroupNo=\"8\"/>"
    "</MFunctions></ChannelConfig>";

/* Of these bits, the names of those that are 1, with a space behind each. */
static const char *ones(const char *names)
{
    static char text[500];
    char name[20];
    text[0] = '\0';
    for (size_t length; *names != '\0'; names += length + (names[length] == ' ')) {
        length = strcspn(names, " ");
        memcpy(name, names, length);
        name[length] = '\0';
        if (bit(name))
            strcat(strcat(text, name), " ");
    }
    return text;
}

static const char decoded[] = "M00_PID M01_PID M02_PID M30_PID M03PI M04PI M19PI M41PI M42PI M43PI M44PI M07PI M08PI M50PI M51PI "
                              "M10PID M11PID M06PID M60PI";
static const char changes[] = "ZMM1PI ZMM2PI ZMM3PI ZMM4PI ZMM5PI ZMM6PI ZMM7PI ZMM8PI ZMM9PI ZMM10PI ZMM11PI ZMM12PI ZMM13PI "
                              "ZMM14PI ZMSHPI ZMSTPI";

START_TEST(w29_functions_of_two_blocks)
{
    rig_begin_with(config_text, "M3 M8 M95 M42 S800\nM5 M17 M91 M77");
    run_to(1);
    ck_assert_str_eq(ones(decoded), "M03PI M42PI M08PI ");
    ck_assert_str_eq(ones(changes), "ZMM2PI ZMM3PI ZMM5PI ZMM11PI ");
    ck_assert_int_eq(cell("SPINDLE_GEAR_ACT_1", 0), 2);
    ck_assert_int_eq(cell("PB06", 0), 0x03);
    ck_assert_int_eq(cell("PB13", 0), 0x95);
    run_to(3);
    ck_assert_str_eq(ones(decoded), "M42PI M07PI M08PI ");
    ck_assert_str_eq(ones(changes), "ZMM2PI ZMM5PI ZMM10PI ZMM14PI ");
    ck_assert_int_eq(cell("PB06", 0), 0x05);
    ck_assert_int_eq(cell("PB03", 0), 0x91);
    ck_assert_int_eq(cell("PB16", 0), 0x77);
    ck_assert_int_eq(cell("PB13", 0), 0x95); /* still */
    ck_assert_int_eq(cell("PB14", 0), 0);
    run_to(5);
    ck_assert(!bit("PO_F"));
    ck_assert_str_eq(ones(changes), "");
    ck_assert_str_eq(ones(decoded), "M42PI M07PI M08PI ");
}
END_TEST

START_TEST(w47_t_h_and_bits_of_the_block)
{
    rig_begin("T1234 H5.7 M10 M50 M60\nM52 M11 M6\nT98765432 H123.9");
    run_to(1);
    ck_assert_int_eq(cell("PB07", 0), 0x34);
    ck_assert_int_eq(cell("PB08", 0), 0x12);
    ck_assert_int_eq(cell("PB09", 0), 0);
    ck_assert_int_eq(cell("PB05", 0), 0x05);
    ck_assert_str_eq(ones(decoded), "M50PI M10PID M60PI ");
    ck_assert_str_eq(ones(changes), "ZMM6PI ZMM7PI ZMM9PI ZMSHPI ZMSTPI ");
    run_to(3);
    ck_assert_str_eq(ones(decoded), "M50PI M51PI M11PID M06PID ");
    ck_assert_str_eq(ones(changes), "ZMM6PI ZMM7PI ZMM9PI ");
    ck_assert_int_eq(cell("PB07", 0), 0x34);
    run_to(5);
    ck_assert_str_eq(ones(decoded), "M50PI M51PI ");
    ck_assert_int_eq(cell("PB07", 0), 0x32);
    ck_assert_int_eq(cell("PB08", 0), 0x54);
    ck_assert_int_eq(cell("PB09", 0), 0x76);
    ck_assert_int_eq(cell("PB10", 0), 0x98);
    ck_assert_int_eq(cell("PB05", 0), 0x23); /* the lowest two digits */
}
END_TEST

/* What is 1 in the first T of the last block of this program, whose blocks have no motion. */
static const char *ones_after(const char *nc, uint64_t blocks)
{
    rig_begin_with(config_text, nc);
    run_to(2 * blocks - 1);
    ck_assert(bit("PO_F"));
    return ones(decoded);
}

START_TEST(ng2_table_of_groups)
{
    static const struct {
        const char *nc;
        uint64_t blocks;
        const char *ones;
    } rows[] = {
        {"M1", 1, "M01_PID "}, {"M2", 1, "M02_PID "}, {"M30", 1, "M30_PID "}, {"M0", 1, "M00_PID "},
        {"M3\nM4", 2, "M04PI "}, {"M4\nM19", 2, "M19PI "}, {"M19\nM3", 2, "M03PI "}, {"M4\nM5", 2, ""}, {"M3\nM70", 2, ""},
        {"M41\nM44", 2, "M44PI "}, {"M43\nM8", 2, "M43PI M08PI "}, {"M43\nM71", 2, "M43PI "},
        {"M7", 1, "M07PI "}, {"M7\nM8", 2, "M08PI "}, {"M17\nM7", 2, "M07PI "}, {"M17\nM9", 2, ""}, {"M17", 1, "M07PI M08PI "},
        {"M17\nM72", 2, ""},
        {"M50\nM51", 2, "M51PI "}, {"M52", 1, "M50PI M51PI "}, {"M52\nM53", 2, ""},
        {"M10", 1, "M10PID "}, {"M10\nM11", 2, "M11PID "}, {"M6\nM60", 2, "M60PI "}, {"M6\nM77", 2, ""},
    };
    for (unsigned i = 0; i < sizeof rows / sizeof *rows; i++)
        ck_assert_str_eq(ones_after(rows[i].nc, rows[i].blocks), rows[i].ones);
}
END_TEST

START_TEST(ng2_bytes_of_groups)
{
    rig_begin_with(config_text, "M70 M92 M93 M100");
    run_to(1);
    ck_assert_int_eq(cell("PB06", 0), 0x70);
    ck_assert_int_eq(cell("PB14", 0), 0x92);
    ck_assert_int_eq(cell("PB15", 0), 0x93);
    ck_assert_int_eq(cell("PB16", 0), 0x00); /* of M100 */
    ck_assert(bit("ZMM14PI"));
}
END_TEST

START_TEST(ng1_bits_of_the_block_end_with_it)
{
    rig_begin_with(config_text, "M0 M10 M60 M95 T12 H3");
    run_to(1);
    ck_assert_str_eq(ones(decoded), "M00_PID M10PID M60PI ");
    ck_assert_str_eq(ones(changes), "ZMM1PI ZMM7PI ZMM9PI ZMM11PI ZMSHPI ZMSTPI ");
    ck_assert_int_eq(cell("PB13", 0), 0x95);
    run_to(3);
    ck_assert(!bit("PO_F"));
    ck_assert_str_eq(ones(decoded), "");
    ck_assert_str_eq(ones(changes), "");
}
END_TEST

START_TEST(ng1_t_and_h_on_their_own)
{
    rig_begin("T5\nH7\nM8");
    run_to(1);
    ck_assert_str_eq(ones(changes), "ZMSTPI ");
    run_to(3);
    ck_assert_str_eq(ones(changes), "ZMSHPI ");
    ck_assert_int_eq(cell("PB05", 0), 0x07);
    ck_assert_int_eq(cell("PB07", 0), 0x05);
    run_to(5);
    ck_assert_str_eq(ones(changes), "ZMM5PI ");
}
END_TEST

START_TEST(nq1_functions_in_force)
{
    rig_begin_with(config_text, "M95 M3\nM8\nM5");
    run_to(3);
    ck_assert_int_eq(cnc_queue_number(&cnc, 0, CNC_QUEUE_M, 11), 0x95);
    ck_assert_int_eq(cnc_queue_number(&cnc, 0, CNC_QUEUE_M, 5), 0x08);
    ck_assert_int_eq(cnc_queue_number(&cnc, 0, CNC_QUEUE_M, 2), 0x03);
    ck_assert_int_eq(cnc_queue_number(&cnc, 1, CNC_QUEUE_M, 2), 0x05);
    ck_assert_int_eq(cnc_queue_number(&cnc, 0, CNC_QUEUE_M, 14), 0);
}
END_TEST

START_TEST(ng2_a_new_function_of_group_8_leaves_the_override)
{
    rig_begin_with(config_text, "M48\nM73 G1 X10 F1000");
    cnc.panel.feed = 50;
    run_to(300);
    ck_assert_int_eq(top_speed(), 1092266);
}
END_TEST

START_TEST(ng1_a_function_in_a_stop_and_restart)
{
    rig_begin("M3 G1 X10 F1000\nM8");
    run_to(99);
    set_bit("STOP_REQ", true);
    run_to(300);
    ck_assert_str_eq(ones(changes), "ZMM2PI ");
    cnc_start(&cnc);
    run_to(400);
    ck_assert_str_eq(ones(changes), "ZMM2PI ");
    cnc_reset(&cnc);
    run_to(500);
    ck_assert_str_eq(ones(changes), "");
    ck_assert_str_eq(ones(decoded), "M03PI "); /* static functions stay */
}
END_TEST

START_TEST(nq2_a_block_without_technology)
{
    rig_power(NULL, "M3 T1 S100\nM8 T12 H3 S200 M48 G1 X1 F1000\nM7");
    ck_assert_int_eq(cnc_select(&cnc, 1, false), CNC_OK);
    cnc_start(&cnc);
    run_to(1);
    ck_assert_str_eq(ones(decoded), "");
    ck_assert_str_eq(ones(changes), "");
    ck_assert_int_eq(cell("PB07", 0) + cell("PB05", 0) + cell("PB11", 0) + cell("VYSOVERS", 0), 0);
    ck_assert_int_eq(cnc_queue_number(&cnc, 0, CNC_QUEUE_TchlOff, 0), 1);
    ck_assert_int_eq(cnc_queue_number(&cnc, 0, CNC_QUEUE_SelBlock, 0), 1);
    while (bit("PO_F") && !bit("M07PI")) /* of the next one it is published */
        run_to(cnc.turn + 1);
    ck_assert(bit("M07PI") && !bit("M08PI"));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("cnc_functions");
    TCase *all = tcase_create("functions");
    tcase_add_test(all, w29_functions_of_two_blocks);
    tcase_add_test(all, w47_t_h_and_bits_of_the_block);
    tcase_add_test(all, ng2_table_of_groups);
    tcase_add_test(all, ng2_bytes_of_groups);
    tcase_add_test(all, ng1_bits_of_the_block_end_with_it);
    tcase_add_test(all, ng1_t_and_h_on_their_own);
    tcase_add_test(all, nq1_functions_in_force);
    tcase_add_test(all, ng2_a_new_function_of_group_8_leaves_the_override);
    tcase_add_test(all, ng1_a_function_in_a_stop_and_restart);
    tcase_add_test(all, nq2_a_block_without_technology);
    suite_add_tcase(suite, all);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
