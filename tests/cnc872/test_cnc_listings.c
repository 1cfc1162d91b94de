/* SPDX-License-Identifier: MIT */
/* Every listing of the source does what its text says (section 16), with the cells put by hand. */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "listings.h"
#include "plc_rig.h"

/* A cycle while the pass of preparatory functions is under way: true, it has ended. */
static bool cycle(void)
{
    bool has_ended = rig_pass(CNC_PLC_BLOCK_INIT);
    ck_assert(rig_pass(CNC_PLC_MAIN));
    return has_ended;
}

START_TEST(listing_8_1_1_watches_the_following_error)
{
    rig_load(LISTING_8_1_1_LIMIT);
    for (int i = 0; i < 4; i++) {
        static const int errors[] = {99, -99, 100, -100};
        rig_put("ERR_Y", 0);
        rig_put("DIFCIT_X[1]", errors[i]);
        ck_assert(rig_pass(CNC_PLC_MAIN));
        ck_assert_int_eq(rig_value("ERR_Y"), i >= 2);
    }
}
END_TEST

START_TEST(listing_8_1_1_calculates_the_position)
{
    rig_load(LISTING_8_1_1_POSITION);
    rig_put("B_POL[1]", 8000);
    rig_put("B_INK[1]", 16);
    ck_assert(rig_pass(CNC_PLC_MAIN));
    ck_assert_int_eq(rig_value("POLOHA_Y"), 1002);
}
END_TEST

START_TEST(listing_8_1_4_forbids_motion)
{
    rig_load(LISTING_8_1_4);
    ck_assert(rig_pass(CNC_PLC_MAIN));
    ck_assert_int_eq(rig_value("MPYPI"), 1);
    rig_put("ERROR_Z", 1);
    ck_assert(rig_pass(CNC_PLC_MAIN));
    rig_put("ERROR_Z", 0);
    ck_assert(rig_pass(CNC_PLC_MAIN));
    ck_assert_int_eq(rig_value("MPYPI"), 0); /* as printed: nothing sets it again */
    ck_assert_int_eq(rig_value("MPZPI"), 1);
}
END_TEST

START_TEST(listing_8_1_7_opens_the_clamp_first)
{
    rig_load(LISTING_8_1_7);
    ck_assert(cycle()); /* a block without X is not held */
    rig_put("PO_OSXPI", 1);
    for (int i = 0; i < 5; i++)
        ck_assert(!cycle());
    ck_assert_int_eq(rig_value("UVOL_X"), 1);
    rig_put("VSTUP", 1);
    ck_assert(!cycle()); /* the mechanism comes to its end behind the pass */
    ck_assert_int_eq(rig_value("UVOL_X"), 0);
    ck_assert(cycle());
}
END_TEST

START_TEST(listing_8_1_8_switches_the_clutches)
{
    for (int is_minus = 0; is_minus < 2; is_minus++) {
        rig_load(LISTING_8_1_8);
        rig_put("PO_OSYPI", 1);
        ck_assert(cycle()); /* does not wait for the mechanism */
        ck_assert_int_eq(rig_value("MPYPI"), 1);
        rig_put("SM_POYPI", is_minus);
        ck_assert(rig_pass(CNC_PLC_MAIN));
        ck_assert_int_eq(rig_value("MPYPI"), 0);
        ck_assert_int_eq(rig_value("SPOJ_MINUS_Y_O"), is_minus);
        ck_assert_int_eq(rig_value("SPOJ_PLUS_Y_O"), !is_minus);
        ck_assert(rig_pass(CNC_PLC_MAIN));
        ck_assert_int_eq(rig_value("MPYPI"), 0);
        rig_put("KSOJ_Y_I", 1);
        ck_assert(rig_pass(CNC_PLC_MAIN));
        ck_assert_int_eq(rig_value("MPYPI"), 1);
        ck_assert_int_eq(rig_value("SPOJKA_Y"), 0);
    }
}
END_TEST

START_TEST(listing_8_1_9_closes_the_position_loop)
{
    rig_load(LISTING_8_1_9);
    rig_put("PO_OSZPI", 1);
    ck_assert(!cycle());
    ck_assert(!cycle());
    ck_assert_int_eq(rig_value("VAZBA_Z"), 0);
    rig_put("VSTUP", 1);
    ck_assert(!cycle());
    ck_assert(cycle());
    ck_assert_int_eq(rig_value("VAZBA_Z"), 1);
}
END_TEST

START_TEST(listing_8_1_12_stops_without_pressure)
{
    rig_load(LISTING_8_1_12);
    for (int i = 1; i < 500; i++)
        ck_assert(!rig_pass(CNC_PLC_BLOCK_INIT));
    ck_assert_int_eq(rig_value("STOPPI"), 0);
    ck_assert(!rig_pass(CNC_PLC_BLOCK_INIT));
    ck_assert_int_eq(rig_value("STOPPI"), 1);
    ck_assert_int_eq(rig_value("PLC_ERROR"), 0x15);
    for (int i = 0; i < 1000; i++) /* without end: the pressure does not matter any more */
        ck_assert(!rig_pass(CNC_PLC_BLOCK_INIT));
    rig_put("CAPI", 1);
    ck_assert(rig_pass(CNC_PLC_BLOCK_INIT));
    ck_assert_uint_eq(rig.events, 1);
    rig_load(LISTING_8_1_12);
    rig_put("TLAK_I", 1);
    ck_assert(rig_pass(CNC_PLC_BLOCK_INIT));
}
END_TEST

START_TEST(listing_8_1_19_sets_the_override)
{
    rig_load(LISTING_8_1_19);
    ck_assert(rig_pass(CNC_PLC_MAIN));
    ck_assert_int_eq(rig_value("FEED_OVR"), 1);
    ck_assert_int_eq(rig_value("BZH09"), 0xDC);
    ck_assert_int_eq(rig_value("BZH10"), 0x05);
}
END_TEST

START_TEST(listing_8_2_6_starts_the_spindle)
{
    rig_load(LISTING_8_2_6);
    ck_assert(cycle()); /* nothing of group 2 */
    rig_put("ZMM2PI", 1);
    ck_assert(cycle()); /* M5 */
    ck_assert_int_eq(rig_value("CW"), 0);
    rig_put("M03PI", 1);
    ck_assert(!cycle());
    ck_assert(!cycle());
    ck_assert_int_eq(rig_value("CW"), 1);
    rig_put("VSTUP", 1);
    ck_assert(!cycle());
    ck_assert(cycle());
    ck_assert_int_eq(rig_value("CW"), 0);
}
END_TEST

START_TEST(listing_8_3_2_reads_bits_of_blocks)
{
    static const struct {
        unsigned block;
        enum cnc_queue_field field;
        unsigned index;
        const char *name;
    } jumps[] = {{0, CNC_QUEUE_Mn, 3, "A"}, {0, CNC_QUEUE_Mn, 2, NULL}, {0, CNC_QUEUE_FirstBlock, 0, "B"},
                 {1, CNC_QUEUE_TchlOff, 0, "C"}, {1, CNC_QUEUE_IPlcn, 1, "D"}};

    rig_load(LISTING_8_3_2);
    for (size_t i = 0; i < sizeof jumps / sizeof *jumps; i++) {
        rig.queue[jumps[i].block][jumps[i].field][jumps[i].index] = 1;
        ck_assert(rig_pass(CNC_PLC_BLOCK_INIT));
        for (size_t j = 0; j < sizeof jumps / sizeof *jumps; j++)
            if (jumps[j].name)
                ck_assert_msg(rig_value(jumps[j].name) == (j <= i), "%s after %zu", jumps[j].name, i);
    }
}
END_TEST

START_TEST(listings_8_3_3_and_8_3_4_read_numbers_of_blocks)
{
    rig_load(LISTING_8_3_3);
    ck_assert(rig_pass(CNC_PLC_BLOCK_INIT));
    ck_assert_int_eq(rig_value("M12"), 0xFFFF); /* the jump is taken */
    rig.queue[0][CNC_QUEUE_Mn][11] = 1;
    rig.queue[0][CNC_QUEUE_M][11] = 0x95;
    rig.queue[0][CNC_QUEUE_M][12] = 0x192;
    rig.queue[0][CNC_QUEUE_IPlcParams][2] = 5;
    rig.queue[0][CNC_QUEUE_T][0] = 7;
    rig.queue_real[0][CNC_QUEUE_H][0] = 12.5;
    rig.queue_real[0][CNC_QUEUE_RPlcParams][2] = 1.25;
    rig.queue_real[0][CNC_QUEUE_RPlcParams][3] = 0.5;
    rig.queue_real[2][CNC_QUEUE_BlockLen][0] = 5.0;
    ck_assert(rig_pass(CNC_PLC_BLOCK_INIT));
    ck_assert_int_eq(rig_value("FUN_95"), 1);
    ck_assert_int_eq(rig_value("P3"), 5);
    ck_assert_int_eq(rig_value("JE_T"), 1);
    ck_assert_int_eq(rig_value("M12"), 0x92);
    ck_assert_double_eq(rig_real("rBunH"), 12.5);
    ck_assert_double_eq(rig_real("rSoucet"), 1.75);
    ck_assert_double_eq(rig_real("rDelka"), 5.0);
    ck_assert_int_eq(rig_value("nDelka"), 5);
}
END_TEST

START_TEST(listing_8_4_1_limits_the_feed)
{
    rig_load(LISTING_8_4_1);
    ck_assert(rig_pass(CNC_PLC_MAIN));
    ck_assert_int_eq(rig_value("LIMIT_FEED"), 1114112);
    ck_assert_int_eq(rig_value("LIMIT_FEED_REQ"), 1);
}
END_TEST

START_TEST(listing_8_4_2_reads_time_and_date)
{
    static const char *const cells[] = {"SYST_TIME_INFO.TIME_MIN", "SYST_TIME_INFO.TIME_HOUR", "SYST_TIME_INFO.TIME_SEC",
                                        "SYST_DATE_INFO.DATE_YEAR", "SYST_DATE_INFO.DATE_DAY", "SYST_DATE_INFO.DATE_MON",
                                        "UTC_TIME_INFO.TIME_HOUR"};
    char name[] = "N1";

    rig_load(LISTING_8_4_2);
    for (int i = 0; i < 7; i++)
        rig_put(cells[i], 11 * (i + 1));
    rig_put("SYST_DATE_INFO.DATE_YEAR", 2000);
    rig_put("QWRD.FILETIME_INFO", 125912484615000000);
    ck_assert(rig_pass(CNC_PLC_MAIN));
    for (int i = 0; i < 7; i++, name[1]++)
        ck_assert_int_eq(rig_value(name), i == 3 ? 2000 : 11 * (i + 1));
    ck_assert_int_eq(rig_value("N8"), 125912484615000000);
}
END_TEST

START_TEST(listing_8_4_3_writes_on_the_display)
{
    static const uint8_t shown[] = {0x00, 0x10, 0x41, 0x62, 0x63, 0xFF, 0x00, 0x00};

    rig_load(LISTING_8_4_3);
    ck_assert(rig_pass(CNC_PLC_MAIN));
    ck_assert_mem_eq(rig.cells.memory + cnc_cell_place(CNC_CELL_DISPTOC1), shown, sizeof shown);
    ck_assert_int_eq(rig_value("BUSY_DISPTOC1"), 0);
}
END_TEST

START_TEST(listing_8_4_5_waits_until_the_memory_is_saved)
{
    rig_load(LISTING_8_4_5);
    for (int i = 0; i < 3; i++)
        ck_assert(rig_pass(CNC_PLC_MAIN));
    ck_assert_int_eq(rig_value("REQ_BACKUP_MEM"), 1);
    ck_assert_int_eq(rig_value("ULOZ"), 1);
    rig_put("REQ_BACKUP_MEM", 0);
    ck_assert(rig_pass(CNC_PLC_MAIN));
    ck_assert_int_eq(rig_value("ULOZ"), 0);
}
END_TEST

START_TEST(listing_8_4_7_jumps_without_a_licence)
{
    rig_load(LISTING_8_4_7);
    ck_assert(rig_pass(CNC_PLC_MAIN));
    ck_assert_int_eq(rig_value("ZAKAZ"), 0);
    rig.plc.no_license = 1u << 2;
    ck_assert(rig_pass(CNC_PLC_MAIN));
    ck_assert_int_eq(rig_value("ZAKAZ"), 1);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("cnc_listings");
    TCase *tcase = tcase_create("listings");

    tcase_add_test(tcase, listing_8_1_1_watches_the_following_error);
    tcase_add_test(tcase, listing_8_1_1_calculates_the_position);
    tcase_add_test(tcase, listing_8_1_4_forbids_motion);
    tcase_add_test(tcase, listing_8_1_7_opens_the_clamp_first);
    tcase_add_test(tcase, listing_8_1_8_switches_the_clutches);
    tcase_add_test(tcase, listing_8_1_9_closes_the_position_loop);
    tcase_add_test(tcase, listing_8_1_12_stops_without_pressure);
    tcase_add_test(tcase, listing_8_1_19_sets_the_override);
    tcase_add_test(tcase, listing_8_2_6_starts_the_spindle);
    tcase_add_test(tcase, listing_8_3_2_reads_bits_of_blocks);
    tcase_add_test(tcase, listings_8_3_3_and_8_3_4_read_numbers_of_blocks);
    tcase_add_test(tcase, listing_8_4_1_limits_the_feed);
    tcase_add_test(tcase, listing_8_4_2_reads_time_and_date);
    tcase_add_test(tcase, listing_8_4_3_writes_on_the_display);
    tcase_add_test(tcase, listing_8_4_5_waits_until_the_memory_is_saved);
    tcase_add_test(tcase, listing_8_4_7_jumps_without_a_licence);
    suite_add_tcase(suite, tcase);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
