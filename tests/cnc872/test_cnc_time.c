/* SPDX-License-Identifier: MIT */
/* Time of a CNC872: cut in any way it gives the same; a copy of the struct is a snapshot (NT1 of docs/CNC872.md). */
#include <string.h>

#include "cnc_rig.h"

#define PARABOLIC "<ChannelConfig AccelerationType=\"1\"/>"

static const char story[] = "G23 G1 X3 F1000\nX6 Y0.3 F600\nX9 Y0.6 F1000\nG24 G0 X0 Y0 Z1\nG4 P0.05\nG1 X1 F500 M30";
static const char waits[] = "DATA\nTURNS DW 0\nDATA_END\nMODULE_MAIN\n LOD TURNS\n AD CNST.1\n STO TURNS\nMODULE_MAIN_END\n"
                            "MODULE_BLOCK_INIT\n LDR G00PI\n JL0 E\n EX\nE:\nMODULE_BLOCK_INIT_END\n";

/* What comes from outside, before the T's of these numbers. */
static void disturb(uint64_t turn)
{
    switch (turn) {
    case 150:
        cnc.panel.feed = 70;
        break;
    case 300:
        cnc_stop(&cnc);
        break;
    case 400:
        ck_assert_int_eq(cnc_start(&cnc), CNC_OK);
        break;
    case 700:
        set_bit("MPXPI", false);
        break;
    case 760:
        set_bit("MPXPI", true);
        break;
    default:
        break;
    }
}

/* The story in pieces of ticks, whose lengths come from a seed; 0: 1 tick each for a while, then 1 T each. */
static void run_story(const char *xml, unsigned seed)
{
    rig_begin_plc(xml, story, waits);
    uint64_t turn = 1, random = seed;
    while (cnc.tick < 2500 * (uint64_t)CNC_TICKS_PER_T) {
        random = random * UINT64_C(6364136223846793005) + 1442695040888963407u;
        uint64_t piece = seed == 0 ? (cnc.tick < 5000 ? 1 : 1000) : (random >> 40) % 4000;
        for (; turn * CNC_TICKS_PER_T <= cnc.tick; turn++) {
        }
        const uint64_t next = turn * CNC_TICKS_PER_T; /* the T that is not yet done */
        piece = cnc.tick + piece > next ? next - cnc.tick : piece;
        if (cnc.tick + piece == next)
            disturb(turn);
        cnc_advance(&cnc, piece);
    }
}

START_TEST(time_cut_in_any_way)
{
    static struct cnc whole;
    const char *const xml = _i == 0 ? NULL : PARABOLIC;
    run_story(xml, 0);
    whole = cnc;
    ck_assert(bit("PO_F") == false && bit("SF_STOP"));
    ck_assert_int_eq(cell("TURNS", 0), 2500);
    for (unsigned seed = 1; seed < 20; seed++) {
        run_story(xml, seed);
        ck_assert_uint_eq(cnc.tick, whole.tick);
        ck_assert_int_eq(memcmp(&cnc, &whole, sizeof cnc), 0);
    }
}
END_TEST

START_TEST(many_T_at_once)
{
    rig_begin(story);
    cnc_advance(&cnc, 1999);
    ck_assert_uint_eq(cnc.turn, 1);
    ck_assert_uint_eq(cnc.tick, 1999);
    cnc_advance(&cnc, 1);
    ck_assert_uint_eq(cnc.turn, 2);
    cnc_advance(&cnc, 98 * CNC_TICKS_PER_T);
    const int64_t x = cnc.axis[0].position;
    rig_begin(story);
    run_to(100);
    ck_assert_int_eq(at(100).x, x);
}
END_TEST

START_TEST(a_copy_goes_on_alike)
{
    static struct cnc copy, end;
    rig_begin_plc(_i == 0 ? NULL : PARABOLIC, story, waits);
    for (uint64_t turn = 1; turn <= 200; turn++) {
        disturb(turn);
        run_to(turn);
    }
    copy = cnc;
    run_to(1500);
    end = cnc;
    cnc = copy;
    run_to(1500);
    ck_assert_int_eq(memcmp(&cnc, &end, sizeof cnc), 0);
}
END_TEST

START_TEST(a_cnc_takes_64_KiB_at_most)
{
    ck_assert_uint_le(sizeof(struct cnc), 65536);
}
END_TEST

static Suite *time_suite(void)
{
    Suite *suite = suite_create("cnc_time");
    TCase *all = tcase_create("all");
    tcase_set_timeout(all, 60);
    tcase_add_loop_test(all, time_cut_in_any_way, 0, 2);
    tcase_add_test(all, many_T_at_once);
    tcase_add_loop_test(all, a_copy_goes_on_alike, 0, 2);
    tcase_add_test(all, a_cnc_takes_64_KiB_at_most);
    suite_add_tcase(suite, all);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(time_suite());
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? 0 : 1;
}
