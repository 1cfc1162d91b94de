/* SPDX-License-Identifier: MIT */
/* The listings of the source in a whole CNC872, in the T's that the specification gives for them (section 16). */
#include <stdlib.h>

#include "cnc_rig.h"
#include "listings.h"

static const char lag_20[] = "<ChannelConfig><Axis Name=\"Y\" Lag=\"20\"/></ChannelConfig>";

/* The first T from `from` on in which the bit is 1, at most 2000. */
static uint64_t first_bit(const char *name, uint64_t from)
{
    run_to(from);
    while (!bit(name)) {
        ck_assert_uint_lt(cnc.turn, 2000);
        run_to(cnc.turn + 1);
    }
    return cnc.turn;
}

START_TEST(listing_8_1_1_limit_is_reached_in_T_26)
{
    rig_begin_plc(lag_20, "G1 Y-10 F1000", LISTING_8_1_1_LIMIT);
    ck_assert_uint_eq(first_bit("ERR_Y", 1), 26);
}
END_TEST

START_TEST(listing_8_1_1_position_is_in_um)
{
    rig_begin_plc(NULL, "G1 Y1 F1000\nG1 Y1.002", LISTING_8_1_1_POSITION);
    run_to(300);
    ck_assert_int_eq(cell("B_POL", 1), 8000);
    ck_assert_int_eq(cell("B_INK", 1), 16);
    ck_assert_int_eq(cell("POLOHA_Y", 0), 1002);
}
END_TEST

START_TEST(listing_8_1_4_holds_Y_though_the_text_says_Z)
{
    rig_power_plc(NULL, NULL, LISTING_8_1_4);
    set_bit("ERROR_Z", true);
    run_to(1);
    set_bit("ERROR_Z", false);
    run_to(2);
    ck_assert(!bit("MPYPI"));
    ck_assert(bit("MPZPI"));
    ck_assert(!bit("MPY"));
}
END_TEST

START_TEST(listing_8_1_7_X_waits_for_its_clamp_and_Y_does_not)
{
    rig_begin_plc(NULL, "G1 X1 F1000\nG1 Y1", LISTING_8_1_7);
    run_to(49);
    set_bit("VSTUP", true);
    run_to(260);
    ck_assert_int_eq(at(50).x, 0);
    ck_assert_int_gt(at(51).x, 0);
    ck_assert_uint_eq(first_reached(1), 143);
    ck_assert_int_eq(at(144).y, 0);
    ck_assert_int_gt(at(145).y, 0);
}
END_TEST

START_TEST(listing_8_1_8_Y_stands_until_its_clutch_is_in)
{
    for (int is_minus = 0; is_minus < 2; is_minus++) {
        rig_begin_plc(NULL, is_minus ? "G1 Y-10 F1000" : "G1 Y10 F1000", LISTING_8_1_8);
        ck_assert_uint_eq(first_bit(is_minus ? "SPOJ_MINUS_Y_O" : "SPOJ_PLUS_Y_O", 1), 3);
        ck_assert(!bit(is_minus ? "SPOJ_PLUS_Y_O" : "SPOJ_MINUS_Y_O"));
        run_to(99);
        set_bit("KSOJ_Y_I", true);
        run_to(760);
        ck_assert_int_eq(llabs(at(2).y), 32768);
        ck_assert_int_eq(llabs(at(99).y), 32768);
        ck_assert_int_eq(at(100).v, 32768);
        ck_assert_uint_eq(first_reached(2), 732);
    }
}
END_TEST

START_TEST(listing_8_1_9_Z_moves_with_its_loop_closed)
{
    rig_begin_plc(NULL, "G1 Z1 F1000", LISTING_8_1_9);
    run_to(19);
    set_bit("VSTUP", true);
    ck_assert_uint_eq(first_bit("VAZBA_Z", 19), 21);
    run_to(30);
    ck_assert_int_eq(at(20).v, 0);
    ck_assert_int_gt(at(21).v, 0);
}
END_TEST

START_TEST(listing_8_1_12_an_error_stops_the_block)
{
    rig_begin_plc(NULL, "G1 X1 F1000", LISTING_8_1_12);
    ck_assert_uint_eq(first_bit("STOPPI", 1), 501);
    ck_assert_uint_eq(first_stop(1), 501);
    ck_assert_int_eq(cell("PLC_ERROR", 0), 0x15);
    ck_assert_int_eq(cell("STATUS_RESTART", 0), 1);
    run_to(801);
    ck_assert_int_eq(at(801).x, 0);
    set_bit("TLAK_I", true); /* the pressure is back */
    set_bit("STOPPI", false);
    ck_assert_int_eq(cnc_start(&cnc), CNC_OK);
    run_to(950);
    ck_assert_uint_eq(first_end(802), 896);
    ck_assert_int_eq(at(950).x, MM);
}
END_TEST

START_TEST(listing_8_1_12_central_annulment_ends_the_pass)
{
    rig_begin_plc(NULL, "G1 X1 F1000", LISTING_8_1_12);
    run_to(801);
    set_bit("STOPPI", false);
    cnc_reset(&cnc);
    ck_assert_uint_eq(first_bit("CAPI", 802), 802);
    run_to(950);
    ck_assert_uint_eq(first_end(2), 804);
    ck_assert_int_eq(at(950).x, 0);
}
END_TEST

START_TEST(listing_8_1_12_with_pressure_nothing_happens)
{
    rig_begin_plc(NULL, "G1 X1 F1000", LISTING_8_1_12);
    set_bit("TLAK_I", true);
    run_to(120);
    ck_assert_uint_eq(first_end(2), 95);
}
END_TEST

START_TEST(listing_8_1_19_the_override_is_one_and_a_half)
{
    rig_begin_plc(NULL, "G1 X10 F1000", LISTING_8_1_19);
    run_to(300);
    ck_assert_int_eq(cell("BZH09", 0), 0xDC);
    ck_assert_int_eq(cell("BZH10", 0), 0x05);
    ck_assert_int_eq(top_speed(), 1638400);
}
END_TEST

START_TEST(listing_8_2_6_M3_waits_for_the_spindle_and_M5_does_not)
{
    rig_begin_plc(NULL, "M3\nM5", LISTING_8_2_6);
    ck_assert_uint_eq(first_bit("CW", 1), 2);
    run_to(99);
    ck_assert(bit("CW"));
    set_bit("VSTUP", true);
    run_to(100);
    ck_assert(!bit("CW"));
    run_to(150);
    ck_assert_uint_eq(first_end(2), 104);
}
END_TEST

START_TEST(listings_8_3_2_to_8_3_4_read_the_queue)
{
    static const char xml[] = "<ChannelConfig><MFunctions><MFunc No=\"95\" GroupNo=\"11\"/></MFunctions></ChannelConfig>";

    rig_begin_plc(xml, "M95 T7 H12.5 I2=5 R2=1.25 R3=0.5 G1 X1 F1000\nG1 X0 Y0\nG1 X3 Y4", LISTING_8_3_3);
    run_to(3);
    ck_assert(bit("FUN_95"));
    ck_assert(bit("JE_T"));
    ck_assert_int_eq(cell("P3", 0), 5);
    ck_assert_int_eq(cell("rBunH", 0), 0x4029000000000000);   /* 12.5 */
    ck_assert_int_eq(cell("rSoucet", 0), 0x3FFC000000000000); /* 1.75 */
    ck_assert_int_eq(cell("rDelka", 0), 0x4014000000000000);  /* 5.0 */
    ck_assert_int_eq(cell("nDelka", 0), 5);
    rig_begin_plc(NULL, "M3 M41 G1 X1 F1000\nG1 X2 I1=4", LISTING_8_3_2);
    run_to(3);
    ck_assert(bit("A"));
    ck_assert(bit("B"));
    ck_assert(!bit("C"));
    ck_assert(bit("D"));
}
END_TEST

START_TEST(listing_8_4_1_17_mm_a_second)
{
    rig_begin_plc(NULL, "G1 X10 F2000", LISTING_8_4_1);
    run_to(200);
    ck_assert_int_eq(top_speed(), 1114112);
}
END_TEST

START_TEST(listing_8_4_2_at_25_hours)
{
    rig_power_plc(NULL, NULL, LISTING_8_4_2);
    cnc.turn = 90061499;
    cnc_tick(&cnc);
    ck_assert_int_eq(cell("N1", 0), 1);
    ck_assert_int_eq(cell("N2", 0), 1);
    ck_assert_int_eq(cell("N3", 0), 1);
    ck_assert_int_eq(cell("N4", 0), 2000);
    ck_assert_int_eq(cell("N5", 0), 2);
    ck_assert_int_eq(cell("N6", 0), 1);
    ck_assert_int_eq(cell("N7", 0), 1);
    ck_assert_int_eq(cell("N8", 0), 125912484615000000);
}
END_TEST

START_TEST(listing_8_4_3_shows_Abc)
{
    rig_power_plc(NULL, NULL, LISTING_8_4_3);
    run_to(1);
    for (unsigned line = 0; line < CNC_DISPLAY_LINES; line++)
        for (unsigned column = 0; column < CNC_DISPLAY_COLUMNS; column++) {
            bool is_letter = line == 0 && column >= 2 && column <= 4;
            ck_assert_int_eq(cnc.display[0].text[line][column], is_letter ? "Abc"[column - 2] : 0);
        }
}
END_TEST

START_TEST(listing_8_4_5_is_saved_in_T_1_and_ends_in_T_2)
{
    rig_power_plc(NULL, NULL, LISTING_8_4_5);
    run_to(1);
    ck_assert(bit("ULOZ"));
    ck_assert(!bit("REQ_BACKUP_MEM"));
    run_to(2);
    ck_assert(!bit("ULOZ"));
}
END_TEST

START_TEST(listing_8_4_7_goes_by_the_configuration)
{
    rig_power_plc("<ChannelConfig NoLicense=\"FeaturePlc1\"></ChannelConfig>", NULL, LISTING_8_4_7);
    run_to(1);
    ck_assert(bit("ZAKAZ"));
    rig_power_plc(NULL, NULL, LISTING_8_4_7);
    run_to(1);
    ck_assert(!bit("ZAKAZ"));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("cnc_listings_motion");
    TCase *tcase = tcase_create("listings");

    tcase_add_test(tcase, listing_8_1_1_limit_is_reached_in_T_26);
    tcase_add_test(tcase, listing_8_1_1_position_is_in_um);
    tcase_add_test(tcase, listing_8_1_4_holds_Y_though_the_text_says_Z);
    tcase_add_test(tcase, listing_8_1_7_X_waits_for_its_clamp_and_Y_does_not);
    tcase_add_test(tcase, listing_8_1_8_Y_stands_until_its_clutch_is_in);
    tcase_add_test(tcase, listing_8_1_9_Z_moves_with_its_loop_closed);
    tcase_add_test(tcase, listing_8_1_12_an_error_stops_the_block);
    tcase_add_test(tcase, listing_8_1_12_central_annulment_ends_the_pass);
    tcase_add_test(tcase, listing_8_1_12_with_pressure_nothing_happens);
    tcase_add_test(tcase, listing_8_1_19_the_override_is_one_and_a_half);
    tcase_add_test(tcase, listing_8_2_6_M3_waits_for_the_spindle_and_M5_does_not);
    tcase_add_test(tcase, listings_8_3_2_to_8_3_4_read_the_queue);
    tcase_add_test(tcase, listing_8_4_1_17_mm_a_second);
    tcase_add_test(tcase, listing_8_4_2_at_25_hours);
    tcase_add_test(tcase, listing_8_4_3_shows_Abc);
    tcase_add_test(tcase, listing_8_4_5_is_saved_in_T_1_and_ends_in_T_2);
    tcase_add_test(tcase, listing_8_4_7_goes_by_the_configuration);
    suite_add_tcase(suite, tcase);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
