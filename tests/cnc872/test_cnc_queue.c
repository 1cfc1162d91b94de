/* SPDX-License-Identifier: MIT */
/* BLK[n], the present block of a CNC872 and the next ones; the choice of a block (NQ1, NQ2 of docs/CNC872.md). */
#include "cnc_rig.h"

START_TEST(W48_the_next_blocks)
{
    rig_begin("G1 X10 F1000\nG1 X10 Y5\nG1 X0 M30");
    run_to(1);
    ck_assert_int_eq(cell("CNT_NEXT_BLOCKS", 0), 2);
    ck_assert_int_eq(cnc_queue_number(&cnc, 0, CNC_QUEUE_FirstBlock, 0), 1);
    ck_assert_int_eq(cnc_queue_number(&cnc, 0, CNC_QUEUE_AxNCnMove, 0), 1);
    ck_assert_int_eq(cnc_queue_number(&cnc, 1, CNC_QUEUE_FirstBlock, 0), 0);
    ck_assert_int_eq(cnc_queue_number(&cnc, 1, CNC_QUEUE_AxNCnMove, 0), 0);
    ck_assert_int_eq(cnc_queue_number(&cnc, 1, CNC_QUEUE_AxNCnMove, 1), 1);
    ck_assert_int_eq(cnc_queue_number(&cnc, 2, CNC_QUEUE_LastBlock, 0), 1);
    ck_assert(cnc_queue_has(&cnc, 2) && !cnc_queue_has(&cnc, 3));
    ck_assert_int_eq(cnc_queue_number(&cnc, 3, CNC_QUEUE_LastBlock, 0), 0);
    ck_assert_double_eq(cnc_queue_real(&cnc, 3, CNC_QUEUE_Scale, 0), 0);
    ck_assert_double_eq(cnc_queue_real(&cnc, 2, CNC_QUEUE_Scale, 0), 1);
}
END_TEST

START_TEST(fields_of_a_block)
{
    rig_begin("G1 X3 Y4 F1000 H12.5 T7 I2=5 R3=-0.5 G4 P1.5\nG95 G23 G1 X6 Y8 F0.2 M0\nG96 S100 L2000 M1 X7\nG97 S500 G0 X0");
    run_to(10);
    ck_assert_double_eq(cnc_queue_real(&cnc, 0, CNC_QUEUE_BlockLen, 0), 5);
    ck_assert_double_eq(cnc_queue_real(&cnc, 1, CNC_QUEUE_BlockLen, 0), 5);
    ck_assert_double_eq(cnc_queue_real(&cnc, 2, CNC_QUEUE_BlockLen, 0), 1);
    ck_assert_double_eq(cnc_queue_real(&cnc, 1, CNC_QUEUE_AxNC, 1), 8);
    ck_assert_double_eq(cnc_queue_real(&cnc, 2, CNC_QUEUE_AxNC, 1), 8);
    ck_assert_double_eq(cnc_queue_real(&cnc, 0, CNC_QUEUE_H, 0), 12.5);
    ck_assert_double_eq(cnc_queue_real(&cnc, 0, CNC_QUEUE_RPlcParams, 3), -0.5);
    ck_assert_double_eq(cnc_queue_real(&cnc, 0, CNC_QUEUE_Delay, 0), 1.5);
    ck_assert_double_eq(cnc_queue_real(&cnc, 0, CNC_QUEUE_FeedProgr, 0), 1000);
    ck_assert_double_eq(cnc_queue_real(&cnc, 0, CNC_QUEUE_FeedMax, 0), 15000); /* 12 000 / 0.8 */
    ck_assert_double_eq(cnc_queue_real(&cnc, 0, CNC_QUEUE_LinearAccel, 0), 40960);
    ck_assert_double_eq(cnc_queue_real(&cnc, 0, CNC_QUEUE_ParabAccel, 0), 819.2);
    ck_assert_double_eq(cnc_queue_real(&cnc, 2, CNC_QUEUE_ConstCuttingSpeed, 0), 100000);
    ck_assert_double_eq(cnc_queue_real(&cnc, 2, CNC_QUEUE_SpindleSpeedLimit, 0), 2000);
    ck_assert_double_eq(cnc_queue_real(&cnc, 3, CNC_QUEUE_SpindleSpeed, 0), 500);
    ck_assert_int_eq(cnc_queue_number(&cnc, 0, CNC_QUEUE_T, 0), 7);
    ck_assert_int_eq(cnc_queue_number(&cnc, 0, CNC_QUEUE_IPlcParams, 2), 5);
    ck_assert_int_eq(cnc_queue_number(&cnc, 0, CNC_QUEUE_IPlcn, 2), 1);
    ck_assert_int_eq(cnc_queue_number(&cnc, 0, CNC_QUEUE_IPlcn, 1), 0);
    ck_assert_int_eq(cnc_queue_number(&cnc, 0, CNC_QUEUE_RPlcn, 3), 1);
    ck_assert_int_eq(cnc_queue_number(&cnc, 0, CNC_QUEUE_HProg, 0), 1);
    ck_assert_int_eq(cnc_queue_number(&cnc, 0, CNC_QUEUE_TProg, 0), 1);
    ck_assert_int_eq(cnc_queue_number(&cnc, 1, CNC_QUEUE_TProg, 0), 0);
    ck_assert_int_eq(cnc_queue_number(&cnc, 1, CNC_QUEUE_RevFeed, 0), 1);
    ck_assert_int_eq(cnc_queue_number(&cnc, 1, CNC_QUEUE_ContinuousMode, 0), 1);
    ck_assert_int_eq(cnc_queue_number(&cnc, 1, CNC_QUEUE_Stop, 0), 1);
    ck_assert_int_eq(cnc_queue_number(&cnc, 1, CNC_QUEUE_Mn, 1), 1);
    ck_assert_int_eq(cnc_queue_number(&cnc, 1, CNC_QUEUE_Mn, 0), 0);
    ck_assert_int_eq(cnc_queue_number(&cnc, 2, CNC_QUEUE_CondStop, 0), 1);
    ck_assert_int_eq(cnc_queue_number(&cnc, 2, CNC_QUEUE_ConstCutSpeed, 0), 1);
    ck_assert_int_eq(cnc_queue_number(&cnc, 2, CNC_QUEUE_M, 1), 1);
    ck_assert_int_eq(cnc_queue_number(&cnc, 3, CNC_QUEUE_M, 1), 1);
    ck_assert_int_eq(cnc_queue_number(&cnc, 3, CNC_QUEUE_M, 0), 0);
    ck_assert_int_eq(cnc_queue_number(&cnc, 0, CNC_QUEUE_AxG, 2), 2);
    ck_assert_int_eq(cnc_queue_number(&cnc, 0, CNC_QUEUE_Backward, 0), 0);
}
END_TEST

START_TEST(the_speed_at_a_border)
{
    rig_begin("G23 G1 X10 F1000\nX20 Y1 F600\nX30 Y2 F1000");
    run_to(10);
    ck_assert_double_eq(cnc_queue_real(&cnc, 0, CNC_QUEUE_FeedCriterial, 0), 0);
    ck_assert_double_eq(cnc_queue_real(&cnc, 1, CNC_QUEUE_FeedCriterial, 0), 600);
    ck_assert_double_eq(cnc_queue_real(&cnc, 2, CNC_QUEUE_FeedCriterial, 0), 600);
    rig_begin_with("<ChannelConfig><Axis Name=\"X\" FeedRT=\"450\"/></ChannelConfig>",
                   "G23 G1 X10 F1000\nX20 F600\nX30 F300\nG24 X40 F1000");
    run_to(10);
    ck_assert_double_eq(cnc_queue_real(&cnc, 1, CNC_QUEUE_FeedCriterial, 0), 450); /* FeedMax */
    ck_assert_double_eq(cnc_queue_real(&cnc, 2, CNC_QUEUE_FeedCriterial, 0), 300);
    ck_assert_double_eq(cnc_queue_real(&cnc, 3, CNC_QUEUE_FeedCriterial, 0), 0); /* behind the section */
    rig_begin("G1 X10 F1000\nX20 F600");
    run_to(10);
    ck_assert_double_eq(cnc_queue_real(&cnc, 1, CNC_QUEUE_FeedCriterial, 0), 0); /* there is no section */
}
END_TEST

/* F a revolution: with the actual speed of the spindle, 1000 rev/min here. */
START_TEST(the_speed_at_a_border_with_a_feed_a_revolution)
{
    static const char *const programs[] = {"M3\nG95 G23 G1 X10 F0.6\nX20 F0.3", "M3\nG23 G33 X10 F0.6\nX20 F0.3"};
    for (unsigned i = 0; i < 2; i++) {
        rig_begin(programs[i]);
        set_cell("SIM_SPEED_PT", 0, 6000);
        run_to(10);
        ck_assert_int_eq(cell("ACT_SPEED_PM", 0), 1000000);
        ck_assert_uint_eq(cnc.machine.block, 1);
        ck_assert_double_eq(cnc_queue_real(&cnc, 1, CNC_QUEUE_FeedCriterial, 0), 300);
    }
}
END_TEST

START_TEST(a_block_without_motion_has_no_way)
{
    static const enum cnc_queue_field ways[] = {CNC_QUEUE_BlockLen, CNC_QUEUE_FeedMax, CNC_QUEUE_ParabAccel,
                                                CNC_QUEUE_LinearAccel};
    rig_begin("M8\nG1 X1 F1000");
    run_to(1);
    for (unsigned i = 0; i < sizeof ways / sizeof *ways; i++) {
        ck_assert_double_eq(cnc_queue_real(&cnc, 0, ways[i], 0), 0);
        ck_assert_double_gt(cnc_queue_real(&cnc, 1, ways[i], 0), 0);
    }
    ck_assert_int_eq(cnc_queue_number(&cnc, 0, CNC_QUEUE_AxNCnMove, 0), 0);
    ck_assert_double_eq(cnc_queue_real(&cnc, 1, CNC_QUEUE_FeedCriterial, 0), 0);
}
END_TEST

/* Before START: BLK[0] is not there, BLK[1] is the first block. */
START_TEST(a_queue_before_the_start)
{
    rig_power(NULL, "G1 X1 Y2 F1000 M8\nM3 X4");
    ck_assert(!cnc_queue_has(&cnc, 0) && cnc_queue_has(&cnc, 2) && !cnc_queue_has(&cnc, 3));
    ck_assert_double_eq(cnc_queue_real(&cnc, 1, CNC_QUEUE_AxNC, 1), 2);
    ck_assert_double_eq(cnc_queue_real(&cnc, 2, CNC_QUEUE_AxNC, 0), 4);
    ck_assert_double_eq(cnc_queue_real(&cnc, 2, CNC_QUEUE_BlockLen, 0), 3);
    ck_assert_int_eq(cnc_queue_number(&cnc, 1, CNC_QUEUE_M, 2), 0);
    ck_assert_int_eq(cnc_queue_number(&cnc, 2, CNC_QUEUE_M, 2), 3);
    ck_assert_int_eq(cnc_queue_number(&cnc, 2, CNC_QUEUE_M, 5), 8);
    ck_assert_int_eq(cnc_queue_number(&cnc, 0, CNC_QUEUE_M, 5), 0);
    rig_power(NULL, NULL);
    ck_assert(!cnc_queue_has(&cnc, 0) && !cnc_queue_has(&cnc, 1));
}
END_TEST

/* NB7: Partial is 1 in a block that has been started again, and there alone. */
START_TEST(a_part_of_a_block)
{
    rig_begin("G1 X10 F1000\nX20");
    run_to(100);
    ck_assert_int_eq(cnc_queue_number(&cnc, 0, CNC_QUEUE_Partial, 0), 0);
    cnc_stop(&cnc);
    run_to(199);
    ck_assert_int_eq(cnc_start(&cnc), CNC_OK);
    run_to(201);
    ck_assert_int_eq(cnc_queue_number(&cnc, 0, CNC_QUEUE_Partial, 0), 1);
    ck_assert_int_eq(cnc_queue_number(&cnc, 1, CNC_QUEUE_Partial, 0), 0);
    run_to(900);
    ck_assert_uint_eq(cnc.machine.block, 1);
    ck_assert_int_eq(cnc_queue_number(&cnc, 0, CNC_QUEUE_Partial, 0), 0);
}
END_TEST

START_TEST(a_function_ends_the_queue)
{
    rig_begin_with("<ChannelConfig><MFunctions><MFunc No=\"6\" ChangePos=\"1\"/></MFunctions></ChannelConfig>",
                   "M3\nM5\nM6\nM8\nM9");
    run_to(1);
    ck_assert_int_eq(cell("CNT_NEXT_BLOCKS", 0), 2);
    ck_assert(cnc_queue_has(&cnc, 2) && !cnc_queue_has(&cnc, 3));
    run_to(5);
    ck_assert_uint_eq(cnc.machine.block, 2);
    ck_assert_int_eq(cell("CNT_NEXT_BLOCKS", 0), 0);
    run_to(7);
    ck_assert_int_eq(cell("CNT_NEXT_BLOCKS", 0), 1);
}
END_TEST

START_TEST(a_long_queue)
{
    rig_begin("M3\nM3\nM3\nM3\nM3\nM3\nM3\nM3\nM3\nM3\nM3\nM3\nM3\nM3\nM3\nM3\nM3\nM3");
    run_to(1);
    ck_assert_int_eq(cell("CNT_NEXT_BLOCKS", 0), 15);
    ck_assert(cnc_queue_has(&cnc, 15) && !cnc_queue_has(&cnc, 16));
}
END_TEST

START_TEST(a_selected_block)
{
    rig_power(NULL, "G1 X1 F1000\nG1 X2 Y1\nG1 X3\nG1 X4");
    ck_assert_int_eq(cnc_select(&cnc, 4, true), CNC_NO_SUCH_BLOCK);
    ck_assert_int_eq(cnc_select(&cnc, 2, false), CNC_OK);
    ck_assert_int_eq(cnc_queue_number(&cnc, 1, CNC_QUEUE_SelBlock, 0), 1);
    ck_assert_int_eq(cnc_queue_number(&cnc, 1, CNC_QUEUE_TchlOff, 0), 1);
    ck_assert_int_eq(cnc_queue_number(&cnc, 1, CNC_QUEUE_Cont, 0), 1);
    ck_assert_int_eq(cnc_start(&cnc), CNC_OK);
    run_to(2);
    ck_assert_uint_eq(cnc.machine.block, 2);
    ck_assert_int_eq(cnc_queue_number(&cnc, 0, CNC_QUEUE_SelBlock, 0), 1);
    ck_assert_int_eq(cnc_queue_number(&cnc, 0, CNC_QUEUE_Cont, 0), 1);
    ck_assert_int_eq(cnc_queue_number(&cnc, 1, CNC_QUEUE_SelBlock, 0), 0);
    run_to(900);
    ck_assert_int_eq(at(900).x, 4 * MM);
    ck_assert_int_eq(at(900).y, 0);
    ck_assert_int_eq(cnc_select(&cnc, 0, true), CNC_OK); /* nothing lies before the first block */
    ck_assert_int_eq(cnc_queue_number(&cnc, 1, CNC_QUEUE_Cont, 0), 0);
    ck_assert_int_eq(cnc_queue_number(&cnc, 1, CNC_QUEUE_TchlOff, 0), 0);
}
END_TEST

static Suite *queue_suite(void)
{
    Suite *suite = suite_create("cnc_queue");
    TCase *queue = tcase_create("queue");
    tcase_add_test(queue, W48_the_next_blocks);
    tcase_add_test(queue, fields_of_a_block);
    tcase_add_test(queue, the_speed_at_a_border);
    tcase_add_test(queue, the_speed_at_a_border_with_a_feed_a_revolution);
    tcase_add_test(queue, a_block_without_motion_has_no_way);
    tcase_add_test(queue, a_queue_before_the_start);
    tcase_add_test(queue, a_part_of_a_block);
    tcase_add_test(queue, a_function_ends_the_queue);
    tcase_add_test(queue, a_long_queue);
    tcase_add_test(queue, a_selected_block);
    suite_add_tcase(suite, queue);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(queue_suite());
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? 0 : 1;
}
