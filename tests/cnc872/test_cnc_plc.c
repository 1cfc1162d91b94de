/* SPDX-License-Identifier: MIT */
/* What the instructions of a PLC program do, and how sections and mechanisms wait (NP2-NP7). */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cnc872/cnc872.h"
#include "plc_rig.h"

START_TEST(bits_go_through_rlo)
{
    static const struct {
        const char *lines;
        int a, b, result;
    } cases[] = {{"LDR A", 0, 1, 0},          {"LDR A", 1, 0, 1},          {"LDR A\nCA", 1, 0, 0},      {"LDR A\nCA", 0, 0, 1},
                 {"LDR A\nLA B", 1, 1, 1},    {"LDR A\nLA B", 1, 0, 0},    {"LDR A\nLA B", 0, 1, 0},    {"LDR A\nLO B", 0, 1, 1},
                 {"LDR A\nLO B", 1, 0, 1},    {"LDR A\nLO B", 0, 0, 0},    {"LDR A\nLX B", 1, 0, 1},    {"LDR A\nLX B", 1, 1, 0},
                 {"LDR A\nLX B", 0, 1, 1},    {"LDR A\nLX B", 0, 0, 0}};

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char data[100], lines[100];
        snprintf(data, sizeof data, "A BIT %d\nB BIT %d\nR BIT %d", cases[i].a, cases[i].b, !cases[i].result);
        snprintf(lines, sizeof lines, "%s\nWR R", cases[i].lines);
        rig_run(data, lines);
        ck_assert_msg(rig_value("R") == cases[i].result, "%s with %d, %d", cases[i].lines, cases[i].a, cases[i].b);
    }
}
END_TEST

START_TEST(fl_sets_bits_and_fl1_if_rlo_is_1)
{
    rig_run("A BIT 0\nB BIT 1\nC BIT 0\nD BIT 1\nE BIT 0\nON EQU 1",
            "LDR E\nFL 1,A\nFL 0, B\nFL1 1,C\nFL1 0,D\nCA\nFL1 ON , E");
    ck_assert_int_eq(rig_value("A"), 1);
    ck_assert_int_eq(rig_value("B"), 0);
    ck_assert_int_eq(rig_value("C"), 0);
    ck_assert_int_eq(rig_value("D"), 1);
    ck_assert_int_eq(rig_value("E"), 1);
}
END_TEST

START_TEST(whole_numbers_are_calculated_in_64_bits)
{
    static const struct {
        const char *lines;
        int64_t result;
    } cases[] = {
        {"LOD CNST.17", 17},
        {"LOD CNST.5\nSU CNST.7", -2},
        {"LOD BYTE_200", 200},
        {"LOD WORD_FFFF", 65535},
        {"LOD DWRD_M1", -1},
        {"LOD BYTE.DWRD_M1", 255},
        {"LOD WORD.(DWRD_M1+2)", 65535},
        {"LOD CNST.3\nAD DWRD_M1", 2},
        {"LOD CNST.12\nORB CNST.3", 15},
        {"LOD CNST.12\nANDB CNST.10", 8},
        {"LOD CNST.12\nXORB CNST.10", 6},
        {"LOD CNST.12\nMULB DWRD_M1", -12},
        {"LOD CNST.7\nDIVB CNST.2", 3},
        {"LOD CNST.7\nMULB DWRD_M1\nDIVB CNST.2", -3},
        {"LOD CNST.7\nDIVB DWRD_M1", -7},
        {"LOD CNST.7FFFFFFFFFFFFFFFh\nAD CNST.1", INT64_MIN},
        {"LOD CNST.7FFFFFFFFFFFFFFFh\nAD CNST.1\nDIVB DWRD_M1", INT64_MIN},
        {"LOD CNST.7FFFFFFFFFFFFFFFh\nMULB CNST.4", -4},
        {"LOD CNST.0\nSU CNST.7FFFFFFFFFFFFFFFh\nSU CNST.2", INT64_MAX},
        {"LOD CNST.80000000h\nABS DWRD", 2147483648},
        {"LOD CNST.0FFFFFFFFh\nABS DWRD", 1},
        {"LOD CNST.5\nABS DWRD", 5},
        {"LOD CNST.1FFh\nABS BYTE", 1},
        {"LOD CNST.8001h\nABS WORD", 0x7FFF},
        {"LOD CNST.0\nSU CNST.9\nABS QWRD", 9},
        {"LOD DWRD_M1\nRR CNST.3,DWRD", 0x1FFFFFFF},
        {"LOD DWRD_M1\nRR CNST.0 , BYTE", 255},
        {"LOD DWRD_M1\nRR CNST.63,QWRD", 1},
        {"LOD CNST.16\nRR CNST.40,DWRD", 0},
        {"LOD CNST.12345h\nRR CNST.4,WORD", 0x234},
        {"LOD CNST.1\nCLI\nSTI", 1},
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        int64_t dr = rig_run("BYTE_200 DB 200\nWORD_FFFF DW 0FFFFh\nDWRD_M1 DD 4294967295", cases[i].lines);
        ck_assert_msg(dr == cases[i].result, "%s: %lld", cases[i].lines, (long long)dr);
        ck_assert_uint_eq(rig.events, 0);
    }
}
END_TEST

START_TEST(comparisons_set_rlo)
{
    static const char *const names[] = {"EQ", "LE", "LT", "GE", "GT"};
    static const int expected[5][3] = {{0, 1, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 1}, {0, 0, 1}}; /* DR is less, equal, more */

    for (int i = 0; i < 5; i++)
        for (int j = 0; j < 3; j++) {
            char lines[100];
            snprintf(lines, sizeof lines, "LOD CNST.%d\n%s CNST.5\nWR R", 4 + j, names[i]);
            ck_assert_int_eq(rig_run("R BIT 0", lines), 4 + j); /* DR is not changed */
            ck_assert_int_eq(rig_value("R"), expected[i][j]);
            snprintf(lines, sizeof lines, "LOD REAL.X%d\n%s REAL.X1\nWR R", j, names[i]);
            rig_run("R BIT 0\nX0 DQ 0\nX1 DQ 3FE0000000000000h\nX2 DQ 3FF8000000000000h", lines); /* 0, 0.5, 1.5 */
            ck_assert_msg(rig_value("R") == expected[i][j], "%s", lines);
        }
}
END_TEST

START_TEST(numbers_are_stored_in_the_width_of_the_operand)
{
    rig_run("D DD 0FFFFFFFFh\nQ DQ 0", "LOD CNST.12345h\nSTO WORD.D+2\nSTO Q\nSTO PLC_MEM_BACKUP[9999]\nSTO BYTE.Q+7");
    ck_assert_int_eq(rig_value("D"), 0x2345FFFF);
    ck_assert_int_eq(rig_value("Q"), 0x4500000000012345);
    ck_assert_int_eq(rig_value("PLC_MEM_BACKUP[9999]"), 0x45);
    ck_assert_int_eq(rig_value("dwAxNCAcceleration"), 0); /* what lies behind it */
}
END_TEST

START_TEST(reals_go_through_dr_real_and_cut_into_dr)
{
    /* 1.25, 0.5, 0 */
    const char *data = "A DQ 3FF4000000000000h\nB DQ 3FE0000000000000h\nZ DQ 0\nR DQ 0\nHUGE DQ 7FE0000000000000h";

    rig_run(data, "LOD REAL.A\nAD REAL.B\nSTO REAL.R");
    ck_assert_double_eq(rig_real("R"), 1.75);
    ck_assert_int_eq(rig.plc.dr, 1);
    rig_run(data, "LOD REAL.B\nSU REAL.A\nSU REAL.A\nSTO REAL.R");
    ck_assert_double_eq(rig_real("R"), -2.0);
    ck_assert_int_eq(rig.plc.dr, -2);
    rig_run(data, "LOD REAL.A\nMULB REAL.B\nSTO REAL.R");
    ck_assert_double_eq(rig_real("R"), 0.625);
    rig_run(data, "LOD REAL.Z\nSU REAL.A\nDIVB REAL.B\nSTO REAL.R");
    ck_assert_double_eq(rig_real("R"), -2.5);
    ck_assert_int_eq(rig.plc.dr, -2); /* towards 0 */
    ck_assert_uint_eq(rig.events, 0);
    rig_run(data, "LOD REAL.A\nLOD CNST.9\nSTO REAL.R"); /* whole operations do not change DR_REAL */
    ck_assert_double_eq(rig_real("R"), 1.25);
    ck_assert_int_eq(rig.plc.dr, 9);
    ck_assert_uint_eq(rig.events, 0);
    ck_assert_int_eq(rig_run(data, "LOD REAL.HUGE"), INT64_MAX);
    ck_assert_int_eq(rig_run("A DQ 43E0000000000000h", "LOD REAL.A"), INT64_MAX); /* 2^63 */
    ck_assert_int_eq(rig_run("A DQ 43DFFFFFFFFFFFFFh", "LOD REAL.A"), 0x7FFFFFFFFFFFFC00);
    ck_assert_int_eq(rig_run(data, "LOD REAL.Z\nSU REAL.HUGE"), INT64_MIN);
    ck_assert_int_eq(rig_run(data, "LOD REAL.HUGE\nMULB REAL.HUGE\nMULB REAL.Z"), 0); /* not a number */
    rig_run(data, "LOD rAxGParabAccel\nAD REAL.A\nSTO rAxGParabAccel");
    ck_assert_double_eq(rig_real("rAxGParabAccel"), 1.25);
}
END_TEST

/* Processors differ in what a number that is none looks like; a program that stores it and reads it as whole sees one. */
START_TEST(a_real_that_is_no_number_is_the_same_on_every_machine)
{
    const char *data = "Z DQ 0\nHUGE DQ 7FE0000000000000h\nR DQ 0";
    static const char *const lines[] = {
        "LOD REAL.HUGE\nMULB REAL.HUGE\nMULB REAL.Z\nSTO REAL.R",               /* infinite x 0 */
        "LOD REAL.HUGE\nMULB REAL.HUGE\nSTO REAL.R\nSU REAL.R\nSTO REAL.R",     /* infinite - infinite */
        "LOD REAL.HUGE\nMULB REAL.HUGE\nSTO REAL.R\nDIVB REAL.R\nSTO REAL.R",   /* infinite / infinite */
        "LOD REAL.HUGE\nMULB REAL.HUGE\nSTO REAL.R\nSU REAL.R\nAD REAL.Z\nSTO REAL.R",
    };
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        rig_run(data, lines[i]);
        ck_assert_int_eq(rig_value("R"), INT64_C(0x7FF8000000000000));
        ck_assert_int_eq(rig.plc.dr, 0);
    }
}
END_TEST

START_TEST(division_by_0_gives_0_and_an_event)
{
    ck_assert_int_eq(rig_run("Z DD 0", "LOD CNST.7\nDIVB Z"), 0);
    ck_assert_uint_eq(rig.events, 1);
    ck_assert_int_eq(rig.event, CNC_PLC_DIVISION);
    ck_assert_uint_eq(rig.event_line, 6);
    ck_assert_int_eq(rig_run("Z DQ 0\nA DQ 3FF4000000000000h\nR DQ 1", "LOD REAL.A\nDIVB REAL.Z\nSTO REAL.R"), 0);
    ck_assert_uint_eq(rig.events, 1);
    ck_assert_double_eq(rig_real("R"), 0.0);
}
END_TEST

START_TEST(the_queue_is_read_by_number_and_by_bx)
{
    rig_load("DATA\nN DW 2\nR BIT 0\nW DW 0\nX DQ 0\nDATA_END\nMODULE_MAIN\n"
             "MOV BX,1\nLDR BLK[BX].M3\nWR R\nLOD BLK[0].BYTE.M[12]\nSTO W\nMOV BX,N\nLOD BLK[BX].REAL.AxNC[15]\nSTO REAL.X\n"
             "MODULE_MAIN_END");
    rig.queue[1][CNC_QUEUE_Mn][3] = 1;
    rig.queue[0][CNC_QUEUE_M][12] = 0x195;
    rig.queue_real[2][CNC_QUEUE_AxNC][15] = -7.75;
    ck_assert(rig_pass(CNC_PLC_MAIN));
    ck_assert_int_eq(rig_value("R"), 1);
    ck_assert_int_eq(rig_value("W"), 0x95);
    ck_assert_double_eq(rig_real("X"), -7.75);
    ck_assert_int_eq(rig.plc.dr, -7);
    rig_run("A DD 1FFFFh", "MOV BX,A\nLOD BLK[BX].T"); /* BX is a word; the queue is not as long */
    ck_assert_uint_eq(rig.plc.bx, 0xFFFF);
    ck_assert_int_eq(rig.plc.dr, 0);
}
END_TEST

START_TEST(errors_licences_and_the_spindle_reach_the_surroundings)
{
    ck_assert_int_eq(rig_run("A BIT 0\nB BIT 0",
                             "LOD CNST.15h\nESET\nLDR_LIC HwKeyConnected\nWR A\nSPI_AX_X\nSPI_AX_4\nSPI_AX_16"), 0x15);
    ck_assert_int_eq(rig.event, CNC_PLC_ERROR_SET);
    ck_assert_int_eq(rig.event_value, 0x15);
    ck_assert_int_eq(rig_value("PLC_ERROR"), 0x15);
    ck_assert_int_eq(rig_value("A"), 1);
    ck_assert_int_eq(rig_value("MPXPI"), 1); /* what is in the first place is as it was */
    ck_assert_int_eq(rig_value("B_POL"), 0);
    ck_assert_uint_eq(rig.axes, 1u | 1u << 3 | 1u << 15);
    rig_load("DATA\nA BIT 0\nB BIT 0\nDATA_END\n"
             "MODULE_MAIN\nLDR_LIC FeaturePlc9\nWR A\nLDR_LIC FeaturePlc8\nWR B\nMODULE_MAIN_END");
    rig.plc.no_license = 1u << 10;
    cnc_begin_plc(&rig.plc, &rig.program, &rig.cells); /* power-up keeps the licences */
    ck_assert(rig_pass(CNC_PLC_MAIN));
    ck_assert_int_eq(rig_value("A"), 0);
    ck_assert_int_eq(rig_value("B"), 1);
}
END_TEST

START_TEST(jumps_stay_in_their_section)
{
    ck_assert_int_eq(rig_run("A BIT 1\nB BIT 0", "LOD CNST.1\nLDR A\nJL0 E\nAD CNST.2\nJL1 F\nAD CNST.4\nF: AD CNST.8\nLDR B\n"
                                                 "JL1 E\nAD CNST.16\nJL0 G\nAD CNST.32\nG:\nJUM E\nAD CNST.64\nE:"), 27);
    /* the same label in another part, a loop backwards */
    rig_load("DATA\nN DD 5\nS DD 0\nDATA_END\nMODULE_INIT\nA: LOD S\nAD N\nSTO S\nLOD N\nSU CNST.1\nSTO N\nGT CNST.0\nJL1 A\n"
             "MODULE_INIT_END\nMODULE_MAIN\nA: JUM B\nB:\nMODULE_MAIN_END");
    ck_assert_int_eq(rig_value("S"), 15);
    ck_assert(rig_pass(CNC_PLC_MAIN));
}
END_TEST

START_TEST(ex_ends_a_call_and_ex0_waits_behind_it)
{
    rig_load("DATA\nIN BIT 0\nN DD 0\nDATA_END\nMODULE_BLOCK_INIT\nLOD CNST.1\nSTO N\nEX\nLOD N\nAD CNST.10\nSTO N\nLDR IN\nEX0\n"
             "LOD N\nAD CNST.100\nSTO N\nLDR IN\nEX1\nLOD CNST.7\nSTO N\nMODULE_BLOCK_INIT_END");
    ck_assert(!rig_pass(CNC_PLC_BLOCK_INIT)); /* EX */
    ck_assert_int_eq(rig_value("N"), 1);
    ck_assert(!rig_pass(CNC_PLC_BLOCK_INIT));
    ck_assert(!rig_pass(CNC_PLC_BLOCK_INIT)); /* anew from behind EX */
    ck_assert_int_eq(rig_value("N"), 21);
    rig_put("IN", 1);
    ck_assert(!rig_pass(CNC_PLC_BLOCK_INIT)); /* through EX0, held by EX1 */
    ck_assert_int_eq(rig_value("N"), 131);
    ck_assert(!rig_pass(CNC_PLC_BLOCK_INIT)); /* now from behind EX0 */
    ck_assert_int_eq(rig_value("N"), 231);
    rig_put("IN", 0);
    ck_assert(rig_pass(CNC_PLC_BLOCK_INIT));
    ck_assert_int_eq(rig_value("N"), 7);
    ck_assert(!rig_pass(CNC_PLC_BLOCK_INIT)); /* its beginning again */
    ck_assert_int_eq(rig_value("N"), 1);
    ck_assert(!rig_pass(CNC_PLC_BLOCK_INIT));
    cnc_restart_section(&rig.plc, &rig.program, CNC_PLC_BLOCK_INIT);
    ck_assert(!rig_pass(CNC_PLC_BLOCK_INIT));
    ck_assert_int_eq(rig_value("N"), 1);
}
END_TEST

START_TEST(a_wait_without_ex_begins_at_the_beginning)
{
    rig_load("DATA\nIN BIT 0\nN DD 0\nDATA_END\nMODULE_BLOCK_DONE\nLOD N\nAD CNST.1\nSTO N\nLDR IN\nEX0\nMODULE_BLOCK_DONE_END");
    for (int i = 1; i <= 5; i++) {
        ck_assert(!rig_pass(CNC_PLC_BLOCK_DONE));
        ck_assert_int_eq(rig_value("N"), i);
    }
    rig_put("IN", 1);
    ck_assert(rig_pass(CNC_PLC_BLOCK_DONE));
    ck_assert_int_eq(rig_value("N"), 6);
}
END_TEST

static const char mechanisms[] = "DATA\nIN BIT 0\nN DD 0\nK DD 0\nDATA_END\nMODULE_MAIN\nLOD K\nAD CNST.1\nSTO K\n"
                                 "MECH_BEGIN ONE\nLOD N\nAD CNST.1\nSTO N\nEX\nLOD N\nAD CNST.10\nSTO N\nLDR IN\nEX0\n"
                                 "MECH_END ONE\nLOD K\nAD CNST.100\nSTO K\nMECH_BEGIN TWO\nLOD N\nAD CNST.1000\nSTO N\n"
                                 "MECH_END TWO\nMODULE_MAIN_END\nSTOP";

START_TEST(a_mechanism_runs_while_its_bit_is_1_beside_the_others)
{
    rig_load(mechanisms);
    ck_assert(rig_pass(CNC_PLC_MAIN));
    ck_assert_int_eq(rig_value("N"), 0);
    ck_assert_int_eq(rig_value("K"), 101);
    rig_put("ONE", 1);
    rig_put("TWO", 1);
    ck_assert(rig_pass(CNC_PLC_MAIN));
    ck_assert_int_eq(rig_value("N"), 1001);
    ck_assert_int_eq(rig_value("TWO"), 0); /* has come to its end */
    ck_assert_int_eq(rig_value("ONE"), 1);
    ck_assert(rig_pass(CNC_PLC_MAIN));
    ck_assert(rig_pass(CNC_PLC_MAIN));
    ck_assert_int_eq(rig_value("N"), 1021);
    ck_assert_int_eq(rig_value("K"), 404); /* what stands behind a mechanism that waits is run */
    rig_put("IN", 1);
    ck_assert(rig_pass(CNC_PLC_MAIN));
    ck_assert_int_eq(rig_value("N"), 1031);
    ck_assert_int_eq(rig_value("ONE"), 0);
    rig_put("ONE", 1);
    ck_assert(rig_pass(CNC_PLC_MAIN)); /* from its beginning */
    ck_assert_int_eq(rig_value("N"), 1032);
}
END_TEST

START_TEST(a_bit_cleared_from_outside_puts_a_mechanism_back)
{
    rig_load(mechanisms);
    rig_put("ONE", 1);
    rig_pass(CNC_PLC_MAIN);
    rig_pass(CNC_PLC_MAIN);
    ck_assert_int_eq(rig_value("N"), 11);
    rig_put("ONE", 0);
    rig_pass(CNC_PLC_MAIN);
    rig_put("ONE", 1);
    rig_pass(CNC_PLC_MAIN);
    ck_assert_int_eq(rig_value("N"), 12);
    cnc_begin_plc(&rig.plc, &rig.program, &rig.cells); /* so does power-up, with its presets */
    rig_pass(CNC_PLC_MAIN);
    ck_assert_int_eq(rig_value("ONE"), 0);
    ck_assert_int_eq(rig_value("N"), 0);
    ck_assert_int_eq(rig_value("K"), 101);
}
END_TEST

static const char timed[] = "DATA\nIN BIT 0\nC DW 7\nT DW 3\nN DD 0\nDATA_END\nMODULE_BLOCK_INIT\nLDR IN\nTEX0 C,T,LATE,15h\n"
                            "LOD CNST.1\nSTO N\nEX\nJUM E\nLATE: STO N\nLDR IN\nEX0\nE:\nMODULE_BLOCK_INIT_END";

START_TEST(tex0_waits_no_longer_than_its_time)
{
    rig_load(timed);
    rig_put("C", 0);
    ck_assert(!rig_pass(CNC_PLC_BLOCK_INIT));
    ck_assert(!rig_pass(CNC_PLC_BLOCK_INIT));
    ck_assert_int_eq(rig_value("C"), 2);
    ck_assert_int_eq(rig_value("N"), 0);
    ck_assert(!rig_pass(CNC_PLC_BLOCK_INIT)); /* the third call: late */
    ck_assert_int_eq(rig_value("N"), 0x15);
    ck_assert_int_eq(rig_value("C"), 0);
    rig_put("N", 0);
    rig.plc.dr = 4;
    ck_assert(!rig_pass(CNC_PLC_BLOCK_INIT)); /* the label is the place now */
    ck_assert_int_eq(rig_value("N"), 4);
    rig_put("IN", 1);
    ck_assert(rig_pass(CNC_PLC_BLOCK_INIT));
}
END_TEST

START_TEST(tex0_goes_on_if_rlo_is_1)
{
    rig_load(timed);
    rig_put("C", 0);
    ck_assert(!rig_pass(CNC_PLC_BLOCK_INIT));
    ck_assert_int_eq(rig_value("C"), 1);
    rig_put("IN", 1);
    ck_assert(!rig_pass(CNC_PLC_BLOCK_INIT)); /* EX behind it */
    ck_assert_int_eq(rig_value("C"), 0);
    ck_assert_int_eq(rig_value("N"), 1);
    ck_assert(rig_pass(CNC_PLC_BLOCK_INIT));
    /* time as a number or constant; behind TEX0 is a place */
    rig_load("DATA\nIN BIT 1\nC DB 0\nN DD 0\nTWO EQU 2\nDATA_END\n"
             "MODULE_BLOCK_INIT\nLOD CNST.5\nSTO N\nLDR IN\nTEX0 C,TWO,L,CODE\nLOD N\nAD CNST.1\nSTO N\nLDR IN\nEX1\n"
             "L:\nMODULE_BLOCK_INIT_END\nDATA\nCODE EQU 9\nDATA_END");
    ck_assert(!rig_pass(CNC_PLC_BLOCK_INIT));
    ck_assert(!rig_pass(CNC_PLC_BLOCK_INIT));
    ck_assert_int_eq(rig_value("N"), 7);
    rig_load("DATA\nIN BIT 0\nC DB 0\nDATA_END\nMODULE_BLOCK_INIT\nLDR IN\nTEX0 C,1,L,BLOCK_DONE\nL:\nMODULE_BLOCK_INIT_END");
    ck_assert(rig_pass(CNC_PLC_BLOCK_INIT));
    ck_assert_int_eq(rig.plc.dr, CNC_DONE); /* a constant of the language */
    rig_load("DATA\nIN BIT 0\nC DB 0\nDATA_END\nMODULE_BLOCK_INIT\nLDR IN\nTEX0 C,2,L,9\nL:\nMODULE_BLOCK_INIT_END");
    ck_assert(!rig_pass(CNC_PLC_BLOCK_INIT));
    ck_assert(rig_pass(CNC_PLC_BLOCK_INIT));
    ck_assert_int_eq(rig.plc.dr, 9);
}
END_TEST

START_TEST(a_mechanism_may_wait_with_tex0)
{
    rig_load("DATA\nIN BIT 0\nC DD 0\nK DD 0\nDATA_END\nMODULE_INIT\nFL 1,M\nMODULE_INIT_END\nMODULE_MAIN\nMECH_BEGIN M\nLDR IN\n"
             "TEX0 C,CNST.2,L,1\nL: STO K\nMECH_END M\nLOD CNST.0\nMODULE_MAIN_END");
    ck_assert(rig_pass(CNC_PLC_MAIN));
    ck_assert_int_eq(rig_value("K"), 0);
    ck_assert_int_eq(rig_value("M"), 1);
    ck_assert(rig_pass(CNC_PLC_MAIN));
    ck_assert_int_eq(rig_value("K"), 1);
    ck_assert_int_eq(rig_value("M"), 0);
    ck_assert_int_eq(rig.plc.dr, 0);
}
END_TEST

START_TEST(sections_that_are_not_there_have_ended)
{
    rig_load("");
    for (unsigned section = 0; section < CNC_PLC_SECTIONS; section++)
        ck_assert(rig_pass((enum cnc_plc_section)section));
    rig_load("PROC_BEGIN _ON_EVENT\nEQ CNST.PLCEVENT_START_REQ\nFL1 1,START_SUSPEND\nPROC_END _ON_EVENT");
    rig.plc.dr = 1;
    ck_assert(rig_pass(CNC_PLC_EVENT));
    ck_assert_int_eq(rig_value("START_SUSPEND"), 1);
}
END_TEST

START_TEST(a_call_without_end_halts_the_program)
{
    rig_load("DATA\nN DD 0\nDATA_END\nMODULE_MAIN\nA: LOD N\nAD CNST.1\nSTO N\nJUM A\nMODULE_MAIN_END\n"
             "MODULE_BLOCK_INIT\nMODULE_BLOCK_INIT_END");
    ck_assert(!rig_pass(CNC_PLC_MAIN));
    ck_assert_int_eq(rig_value("N"), CNC_PLC_CALL_MAX / 4);
    ck_assert_int_eq(rig.event, CNC_PLC_FAULT);
    ck_assert_uint_eq(rig.event_line, 5);
    ck_assert_int_eq(rig_value("STOP_EMERGENCY_REQ"), 1);
    ck_assert(!rig_pass(CNC_PLC_MAIN)); /* nothing runs any more */
    ck_assert(!rig_pass(CNC_PLC_BLOCK_INIT));
    ck_assert(rig_pass(CNC_PLC_BLOCK_DONE)); /* is not there */
    ck_assert_uint_eq(rig.events, 1);
    cnc_begin_plc(&rig.plc, &rig.program, &rig.cells);
    ck_assert(rig_pass(CNC_PLC_BLOCK_INIT));
}
END_TEST

START_TEST(a_call_of_100000_instructions_is_none_too_long)
{
    /* 2 + 3 * 33332 + 1 + END is 100000 */
    rig_load("DATA\nN DD 33332\nDATA_END\nMODULE_MAIN\nCA\nCA\nLOD N\nA: SU CNST.1\nGT CNST.0\nJL1 A\nMODULE_MAIN_END");
    ck_assert(rig_pass(CNC_PLC_MAIN));
    rig_load("DATA\nN DD 33332\nDATA_END\nMODULE_MAIN\nCA\nCA\nCA\n"
             "LOD N\nA: SU CNST.1\nGT CNST.0\nJL1 A\nMODULE_MAIN_END");
    ck_assert(!rig_pass(CNC_PLC_MAIN));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("cnc_plc");
    TCase *tcase = tcase_create("plc");

    tcase_add_test(tcase, bits_go_through_rlo);
    tcase_add_test(tcase, fl_sets_bits_and_fl1_if_rlo_is_1);
    tcase_add_test(tcase, whole_numbers_are_calculated_in_64_bits);
    tcase_add_test(tcase, comparisons_set_rlo);
    tcase_add_test(tcase, numbers_are_stored_in_the_width_of_the_operand);
    tcase_add_test(tcase, reals_go_through_dr_real_and_cut_into_dr);
    tcase_add_test(tcase, a_real_that_is_no_number_is_the_same_on_every_machine);
    tcase_add_test(tcase, division_by_0_gives_0_and_an_event);
    tcase_add_test(tcase, the_queue_is_read_by_number_and_by_bx);
    tcase_add_test(tcase, errors_licences_and_the_spindle_reach_the_surroundings);
    tcase_add_test(tcase, jumps_stay_in_their_section);
    tcase_add_test(tcase, ex_ends_a_call_and_ex0_waits_behind_it);
    tcase_add_test(tcase, a_wait_without_ex_begins_at_the_beginning);
    tcase_add_test(tcase, a_mechanism_runs_while_its_bit_is_1_beside_the_others);
    tcase_add_test(tcase, a_bit_cleared_from_outside_puts_a_mechanism_back);
    tcase_add_test(tcase, tex0_waits_no_longer_than_its_time);
    tcase_add_test(tcase, tex0_goes_on_if_rlo_is_1);
    tcase_add_test(tcase, a_mechanism_may_wait_with_tex0);
    tcase_add_test(tcase, sections_that_are_not_there_have_ended);
    tcase_add_test(tcase, a_call_without_end_halts_the_program);
    tcase_add_test(tcase, a_call_of_100000_instructions_is_none_too_long);
    suite_add_tcase(suite, tcase);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
