/* SPDX-License-Identifier: MIT */
/* What is wrong in PLC texts is named with its line and column, and limits hold (NP1, NP3, NP8). */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "plc_rig.h"

/* The text has exactly these errors, "LINE:COLUMN: text\n" each. */
static void check_errors(const char *text, const char *errors)
{
    ck_assert_msg(!rig_translate(text), "%s", text);
    ck_assert_msg(strcmp(rig.errors, errors) == 0, "%s\nhas\n%sbut not\n%s", text, rig.errors, errors);
}

/* The same of a line in MODULE_MAIN, which is line 2. */
static void check_line(const char *line, const char *error)
{
    char text[400], expected[400];

    snprintf(text, sizeof text, "MODULE_MAIN\n%s\nMODULE_MAIN_END\nDATA\nR DQ 0\nB BIT 0\nC EQU 3\nDATA_END", line);
    snprintf(expected, sizeof expected, "2:%s\n", error);
    check_errors(text, expected);
}

START_TEST(the_bad_programs_of_the_specification)
{
    check_line(" WR MPX", "5: this bit may only be read `MPX'");
    check_line(" STO DWRD.B_POL", "6: this cell may only be read `DWRD.B_POL'");
    check_line(" WR BLK[0].M3", "5: this bit may only be read `BLK[0].M3'");
    check_line(" LOD DWRD.(DIFCIT_X+64)", "12: this lies outside of the cell `DIFCIT_X+64'");
    check_line(" T~M 3", "2: unknown instruction `T~M'");
    check_errors("DATA\n5 DB 0\nDATA_END", "2:1: expected a name of at most 31 letters, digits and _ ? @ `5'\n");
    check_line(" T\xC3M 3", "2: unknown instruction `T?M'");
    check_line(" TIM 3", "2: unknown instruction `TIM'");
    check_line(" LDR NIC", "6: there is no cell `NIC'");
    check_line(" JUM X", "6: this section or mechanism has no label `X'");
    check_line(" EX", "2: only mechanisms, MODULE_BLOCK_INIT and MODULE_BLOCK_DONE have `EX'");
    check_line(" LDR_LIC Foo", "10: there is no licence `Foo'");
    check_errors("\nMODULE_MAIN\n CA\n", "2:1: expected the end of the section that begins here\n");
}
END_TEST

START_TEST(wrong_operands_are_named)
{
    check_line("LDR VYSOVERS", "5: expected a bit; this is a number `VYSOVERS'");
    check_line("LA BLK[0].T", "4: expected a bit; this is a number `BLK[0].T'");
    check_line("LO CNST.1", "4: expected a bit; this is a number `CNST.1'");
    check_line("WR LIMIT_FEED", "4: expected a bit; this is a number `LIMIT_FEED'");
    check_line("LOD STOPPI", "5: expected a number; this is a bit `STOPPI'");
    check_line("EQ BLK[0].M3", "4: expected a number; this is a bit `BLK[0].M3'");
    check_line("STO CNST.4", "5: expected a cell; this is a constant `CNST.4'");
    check_line("STO BLK[0].T", "5: this cell may only be read `BLK[0].T'");
    check_line("STO B", "5: expected a number; this is a bit `B'");
    check_line("FL 1,PO_F", "6: this bit may only be read `PO_F'");
    check_line("FL1 1,R", "7: expected a bit; this is a number `R'");
    check_line("FL 2,B", "4: expected 0 or 1 `2'");
    check_line("FL B,1", "4: expected 0 or 1 `B'\n2:6: expected a cell, or a number as CNST.5 `1'");
    check_line("ORB REAL.R", "5: expected a whole number; this is REAL `REAL.R'");
    check_line("XORB BLK[0].H", "6: expected a whole number; this is REAL `BLK[0].H'");
    check_line("ABS REAL", "5: expected BYTE, WORD, DWRD or QWRD `REAL'");
    check_line("ABS BIT", "5: expected BYTE, WORD, DWRD or QWRD `BIT'");
    check_line("RR CNST.64,DWRD", "4: expected CNST. and a number up to 63 `CNST.64'");
    check_line("RR R,DWRD", "4: expected CNST. and a number up to 63 `R'");
    check_line("RR CNST.3,REAL", "11: expected BYTE, WORD, DWRD or QWRD `REAL'");
    check_line("MOV AX,3", "5: expected BX `AX'");
    check_line("MOV BX,REAL.R", "8: expected a whole number; this is REAL `REAL.R'");
    check_line("MOV BX,B", "8: expected a number; this is a bit `B'");
    check_line("LOD C", "5: a constant is written CNST.name `C'");
    check_line("LDR R.TIME_MIN", "7: the cell has no field `TIME_MIN'");
    check_line("SPI_AX_1", "1: unknown instruction `SPI_AX_1'");
    check_line("SPI_AX_", "1: unknown instruction `SPI_AX_'");
    check_line("SPI_AY_X", "1: unknown instruction `SPI_AY_X'");
}
END_TEST

START_TEST(words_too_many_or_too_few_are_named)
{
    check_line("CA B", "1: expected nothing behind `CA'");
    check_line("LDR", "1: expected one operand of `LDR'");
    check_line("LDR B,B", "1: expected one operand of `LDR'");
    check_line("LDR B B", "7: expected the end of the operand `B'");
    check_line("FL 1", "1: expected two operands of `FL'");
    check_line("FL 1,B,", "1: expected two operands of `FL'");
    check_line("FL 1,", "6: expected a name");
    check_line("FL ,B", "4: expected 0 or 1");
    check_line("RR CNST.3", "1: expected two operands of `RR'");
    check_line("SPI_AX_4 1", "1: expected nothing behind `SPI_AX_4'");
    check_line(": CA", "1: unknown instruction");
    check_line("A:B:CA", "3: unknown instruction `B'");
}
END_TEST

START_TEST(tex0_has_four_words)
{
    static const char begin[] = "DATA\nK DW 0\nR DQ 0\nB BIT 0\nDATA_END\nMODULE_BLOCK_INIT\n";
    static const struct {
        const char *line, *errors;
    } cases[] = {
        {"TEX0 K,1,L", "7:1: expected counter, time, label and code behind `TEX0'\n"},
        {"TEX0 K,1,L,2,3", "7:1: expected counter, time, label and code behind `TEX0'\n"},
        {"TEX0 K,1,L,2,", "7:1: expected counter, time, label and code behind `TEX0'\n"},
        {"TEX0 K,1,L,2,3,", "7:1: expected counter, time, label and code behind `TEX0'\n"},
        {"TEX0 K,1,L,2,3,4", "7:1: expected counter, time, label and code behind `TEX0'\n"},
        {"TEX0 B,1,L,2", "7:6: expected a number; this is a bit `B'\n"},
        {"TEX0 CNST.1,1,L,2", "7:6: expected a cell; this is a constant `CNST.1'\n"},
        {"TEX0 VYSOVERS,1,L,2", "7:6: this cell may only be read `VYSOVERS'\n"},
        {"TEX0 REAL.R,1,L,2", "7:6: expected a whole number; this is REAL `REAL.R'\n"},
        {"TEX0 K,B,L,2", "7:8: expected a number; this is a bit `B'\n"},
        {"TEX0 K,REAL.R,L,2", "7:8: expected a whole number; this is REAL `REAL.R'\n"},
        {"TEX0 K,1,M,2", "7:10: this section or mechanism has no label `M'\n"},
        {"TEX0 K,1,L,K", "7:12: expected a number `K'\n"},
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[400];
        snprintf(text, sizeof text, "%s%s\nL:\nMODULE_BLOCK_INIT_END\n", begin, cases[i].line);
        check_errors(text, cases[i].errors);
    }
}
END_TEST

START_TEST(sections_are_closed_in_order)
{
    check_errors("CA", "1:1: expected a section before the instruction `CA'\n");
    check_errors("L:", "1:1: expected a section before the label `L'\n");
    check_errors("MODULE_MAIN_END", "1:1: this section is not open `MODULE_MAIN_END'\n");
    check_errors("MODULE_INIT\nMODULE_MAIN_END\nMODULE_INIT_END", "2:1: this section is not open `MODULE_MAIN_END'\n");
    check_errors("MODULE_INIT\nMODULE_MAIN\nMODULE_MAIN_END", "2:1: a section is open; expected its end before `MODULE_MAIN'\n");
    check_errors("MODULE_INIT\nMODULE_INIT_END\nmodule_init\nMODULE_INIT_END",
                 "3:1: this section is there twice `module_init'\n");
    check_errors("MODULE_INIT\nDATA\nMODULE_INIT_END", "2:1: a section is open; expected its end before `DATA'\n");
    check_errors("MODULE_INIT 1\nMODULE_INIT_END", "1:1: expected nothing behind `MODULE_INIT'\n");
    check_errors("DATA\nA BIT 0\nMODULE_INIT\nMODULE_INIT_END", "3:1: expected DATA_END before `MODULE_INIT'\n");
    check_errors("DATA\nA BIT 0\n", "1:1: expected DATA_END to close DATA\n");
    check_errors("DATA\nA DB", "2:5: expected one number from 0 to 255\n1:1: expected DATA_END to close DATA\n");
    check_errors("DATA\nA", "2:1: expected NAME DB, DW, DD, DQ, BIT or EQU and a value `A'\n"
                            "1:1: expected DATA_END to close DATA\n");
    check_errors("DATA\nDATA\nSTOP\nDATA_END", "2:1: expected NAME DB, DW, DD, DQ, BIT or EQU and a value `DATA'\n"
                                                  "3:1: expected NAME DB, DW, DD, DQ, BIT or EQU and a value `STOP'\n");
    check_errors("DATA\nA BITS 0\nB TIM\nDATA_END", "2:3: expected NAME DB, DW, DD, DQ, BIT or EQU and a value `BITS'\n"
                                                      "3:3: expected NAME DB, DW, DD, DQ, BIT or EQU and a value `TIM'\n");
    check_errors("DATA\nA BIT 2\nB DW 65536\nC DD -1\nDATA_END",
                 "2:7: expected 0 or 1 `2'\n3:6: expected one number from 0 to 65535 `65536'\n"
                 "4:6: expected one number from 0 to 4294967295 `-1'\n");
    check_errors("DATA\nDATA_END\nDATA_END", "3:1: unknown instruction `DATA_END'\n");
    check_errors("PROC_BEGIN\nPROC_END _ON_EVENT", "1:1: expected a name behind `PROC_BEGIN'\n");
    check_errors("PROC_BEGIN _ON_START\nPROC_END _ON_EVENT", "1:12: expected _ON_EVENT; there is no procedure `_ON_START'\n");
    check_errors("PROC_BEGIN _ON_EVENT\nEX\nPROC_END _ON_EVENT",
                 "2:1: only mechanisms, MODULE_BLOCK_INIT and MODULE_BLOCK_DONE have `EX'\n");
    check_errors("STOP\nCA", "2:1: expected nothing behind STOP `CA'\n");
    ck_assert(rig_translate("MODULE_INIT\nMODULE_INIT_END\nSTOP ; the end\n\n ;\n"));
}
END_TEST

START_TEST(mechanisms_stand_in_module_main)
{
    check_errors("MODULE_MAIN\nMECH_BEGIN A\nMECH_BEGIN B\nMECH_END A\nMODULE_MAIN_END",
                 "3:1: a mechanism stands in MODULE_MAIN, not inside another one `MECH_BEGIN'\n");
    check_errors("MODULE_INIT\nMECH_BEGIN A\nMODULE_INIT_END",
                 "2:1: a mechanism stands in MODULE_MAIN, not inside another one `MECH_BEGIN'\n");
    check_errors("MODULE_MAIN\nMECH_END A\nMODULE_MAIN_END", "2:1: no mechanism is open `MECH_END'\n");
    check_errors("MODULE_MAIN\nMECH_BEGIN A\nMECH_END B\nMODULE_MAIN_END",
                 "3:10: expected the name of the mechanism that is open `B'\n");
    check_errors("MODULE_MAIN\nMECH_BEGIN A\nMODULE_MAIN_END",
                 "3:1: expected MECH_END before `MODULE_MAIN_END'\n2:1: expected MECH_END to close the mechanism\n");
    check_errors("MODULE_MAIN\nMECH_BEGIN A\nMECH_END A\nMECH_BEGIN A\nMECH_END A\nMODULE_MAIN_END",
                 "4:12: this name is there twice `A'\n5:10: expected the name of the mechanism that is open `A'\n");
    check_errors("MODULE_MAIN\nMECH_BEGIN\nMECH_END A\nMODULE_MAIN_END",
                 "2:1: expected a name behind `MECH_BEGIN'\n2:11: expected a name of at most 31 letters, digits and _ ? @\n"
                 "3:10: expected the name of the mechanism that is open `A'\n");
    /* labels of a mechanism are its own */
    check_errors("MODULE_MAIN\nMECH_BEGIN A\nL:\nMECH_END A\nJUM L\nMODULE_MAIN_END",
                 "5:5: this section or mechanism has no label `L'\n");
}
END_TEST

START_TEST(names_are_there_once)
{
    check_errors("DATA\nA BIT 0\na DB 1\nDATA_END", "3:1: this name is there twice `a'\n");
    check_errors("DATA\nSTOPPI BIT 0\nMP4PI DB 0\nSYST_TIME_INFO DB 1\nBLOCK_IDLE EQU 1\nWORD DB 0\n"
                 "BX DB 0\nBLK DB 0\nCNST DB 0\nDATA_END",
                 "2:1: the system or the language has this name `STOPPI'\n"
                 "3:1: the system or the language has this name `MP4PI'\n"
                 "4:1: the system or the language has this name `SYST_TIME_INFO'\n"
                 "5:1: the system or the language has this name `BLOCK_IDLE'\n"
                 "6:1: the system or the language has this name `WORD'\n"
                 "7:1: the system or the language has this name `BX'\n"
                 "8:1: the system or the language has this name `BLK'\n"
                 "9:1: the system or the language has this name `CNST'\n");
    check_errors("MODULE_INIT\nL: CA\nL:\nMODULE_INIT_END", "3:1: this name is there twice `L'\n");
    check_errors("DATA\nA BIT 0\nDATA_END\nMODULE_MAIN\nMECH_BEGIN A\nMECH_END A\nMODULE_MAIN_END",
                 "5:12: this name is there twice `A'\n6:10: expected the name of the mechanism that is open `A'\n");
    ck_assert(rig_translate("MODULE_INIT\nL: CA\nMODULE_INIT_END\n"
                            "MODULE_MAIN\nL: JUM L\nMODULE_MAIN_END\nDATA\nL BIT 0\nDATA_END"));
}
END_TEST

START_TEST(data_has_a_name_a_kind_and_a_number)
{
    static const char kinds[] = "expected NAME DB, DW, DD, DQ, BIT or EQU and a value";
    static const struct {
        const char *line, *error;
    } cases[] = {
        {"A", "1: %s `A'"},          {"A DT 1", "3: %s `DT'"},      {"A: DB 1", "4: %s `DB'"},
        {"A DB", "5: expected one number from 0 to 255"},          {"A DB 256", "6: expected one number from 0 to 255 `256'"},
        {"A DW 65536", "6: expected one number from 0 to 65535 `65536'"},
        {"A DD 100000000h", "6: expected one number from 0 to 4294967295 `100000000h'"},
        {"A DQ 8000000000000000h", "6: expected one number from 0 on `8000000000000000h'"},
        {"A BIT 2", "7: expected 0 or 1 `2'"},   {"A DB X", "6: expected one number from 0 to 255 `X'"},
        {"A DB 1,2", "6: expected one number from 0 to 255 `1'"},  {"A DB 1 2", "6: expected one number from 0 to 255 `1 2'"},
        {"1A DB 1", "1: expected a name of at most 31 letters, digits and _ ? @ `1A'"},
        {"A- DB 1", "1: expected a name of at most 31 letters, digits and _ ? @ `A-'"},
        {"A2345678901234567890123456789012 DB 1",
         "1: expected a name of at most 31 letters, digits and _ ? @ `A2345678901234567890123456789012'"},
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[200], format[200], errors[400];
        snprintf(text, sizeof text, "DATA\n%s\nDATA_END", cases[i].line);
        snprintf(format, sizeof format, "2:%s\n", cases[i].error);
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
        snprintf(errors, sizeof errors, format, kinds);
#pragma GCC diagnostic pop
        check_errors(text, errors);
    }
    rig_load("DATA\nA234567890123456789012345678901 db 0FFh\n"
             "_?@\tDW  ';'\nN EQU 12\nE DD\tN\nF DQ 7FFFFFFFFFFFFFFFh\nG BIT 1\nDATA_END");
    ck_assert_int_eq(rig_value("A234567890123456789012345678901"), 255);
    ck_assert_int_eq(rig_value("_?@"), ';');
    ck_assert_int_eq(rig_value("E"), 12);
    ck_assert_int_eq(rig_value("F"), INT64_MAX);
    ck_assert_int_eq(rig_value("G"), 1);
}
END_TEST

START_TEST(blanks_comments_and_cases_are_as_one_likes)
{
    rig_load("; nothing\r\n\tdata ; Č\r\n a\tdb 1;x\r\n data_end\r\nModule_Main\r\n"
             "\tLod  a ; 'x\r\nAD CNST.';' ; it's\r\nl1 :sto byte . a\r\n"
             "L2:\r\n\r\nL3:CA\r\nmodule_main_end");
    ck_assert(rig_pass(CNC_PLC_MAIN));
    ck_assert_int_eq(rig_value("A"), 1 + ';');
    ck_assert(rig.plc.rlo);
}
END_TEST

START_TEST(twenty_errors_are_reported_and_strange_bytes_shown_as_marks)
{
    char text[1000] = "MODULE_MAIN\n";

    for (int i = 0; i < 30; i++)
        strcat(text, "NO\n");
    ck_assert(!rig_translate(text));
    ck_assert_uint_eq(rig.error_count, 20);
    ck_assert_ptr_nonnull(strstr(rig.errors, "21:1: unknown instruction `NO'\n"));
    check_errors("MODULE_MAIN\n\xC4\x8C\x01\nMODULE_MAIN_END", "2:1: unknown instruction `\?\?\?'\n");
}
END_TEST

/* ---- Limits ---------------------------------------------------------------------------------------------------------- */

static char *big;

static void make_big(void)
{
    big = malloc(CNC_PLC_TEXT_MAX + 2);
    ck_assert_ptr_nonnull(big);
}

static void free_big(void)
{
    free(big);
}

/* The lines, each with its number in the place of %u, between begin and end. */
static const char *repeat(const char *begin, unsigned count, const char *name, const char *rest, const char *end)
{
    size_t at = (size_t)sprintf(big, "%s", begin);

    for (unsigned i = 0; i < count; i++)
        at += (size_t)sprintf(big + at, "%s%u%s", name, i, rest);
    sprintf(big + at, "%s", end);
    return big;
}

START_TEST(a_program_has_at_most_65535_instructions)
{
    ck_assert(rig_translate(repeat("MODULE_MAIN\n", CNC_PLC_CODE_MAX - 1, "LOD CNST.", "\n", "MODULE_MAIN_END")));
    check_errors(repeat("MODULE_MAIN\n", CNC_PLC_CODE_MAX, "LOD CNST.", "\n", "MODULE_MAIN_END"),
                 "65537:1: the program has more than 65535 instructions `MODULE_MAIN_END'\n");
    check_errors(repeat("MODULE_MAIN\n", CNC_PLC_CODE_MAX + 9, "LOD CNST.", "\n", "MODULE_MAIN_END"),
                 "65537:1: the program has more than 65535 instructions `LOD'\n");
    ck_assert(!rig_translate(repeat("DATA\nC DB 0\nDATA_END\nMODULE_BLOCK_INIT\nL:\n", 21844, "TEX0 C,1,L,", "\n",
                                    "LOD CNST.1\nLOD CNST.1\nLOD CNST.1\nMODULE_BLOCK_INIT_END")));
    ck_assert_uint_eq(rig.error_count, 1);
    ck_assert(rig_translate(repeat("DATA\nC DB 0\nDATA_END\nMODULE_BLOCK_INIT\nL:\n", 21844, "TEX0 C,1,L,", "\n",
                                   "LOD CNST.1\nLOD CNST.1\nMODULE_BLOCK_INIT_END")));
}
END_TEST

START_TEST(names_bits_and_bytes_have_limits)
{
    static const char full[] = "there is no room for one more name";
    char errors[100];

    ck_assert(rig_translate(repeat("DATA\n", CNC_OWN_BITS, "B", " BIT 1\n", "DATA_END")));
    snprintf(errors, sizeof errors, "%u:1: %s `B%u'\n", CNC_OWN_BITS + 2, full, CNC_OWN_BITS);
    check_errors(repeat("DATA\n", CNC_OWN_BITS + 1, "B", " BIT 1\n", "DATA_END"), errors);
    rig_load(repeat("DATA\n", CNC_OWN_MEMORY / 8, "Q", " DQ 5\n", "DATA_END"));
    ck_assert_int_eq(rig_value("Q1023"), 5);
    snprintf(errors, sizeof errors, "%u:1: %s `Q%u'\n", CNC_OWN_MEMORY / 8 + 2, full, CNC_OWN_MEMORY / 8);
    check_errors(repeat("DATA\n", CNC_OWN_MEMORY / 8 + 1, "Q", " DQ 5\n", "DATA_END"), errors);
    ck_assert(rig_translate(repeat("MODULE_MAIN\n", CNC_SYMBOLS_MAX, "L", ":\n", "MODULE_MAIN_END")));
    snprintf(errors, sizeof errors, "%u:1: %s `L%u'\n", CNC_SYMBOLS_MAX + 2, full, CNC_SYMBOLS_MAX);
    check_errors(repeat("MODULE_MAIN\n", CNC_SYMBOLS_MAX + 1, "L", ":\n", "MODULE_MAIN_END"), errors);
}
END_TEST

START_TEST(there_are_at_most_250_mechanisms)
{
    size_t at = (size_t)sprintf(big, "MODULE_MAIN\n");

    for (unsigned i = 0; i < CNC_PLC_MECHANISMS_MAX; i++)
        at += (size_t)sprintf(big + at, "MECH_BEGIN M%u\nFL 1,M0\nMECH_END M%u\n", i, i);
    sprintf(big + at, "MODULE_MAIN_END");
    rig_load(big);
    rig_put("M249", 1);
    ck_assert(rig_pass(CNC_PLC_MAIN));
    ck_assert_int_eq(rig_value("M249"), 0);
    ck_assert_int_eq(rig_value("M0"), 1);
    sprintf(big + at, "MECH_BEGIN M\nMECH_END M\nMODULE_MAIN_END");
    check_errors(big, "752:1: there are more than 250 mechanisms `MECH_BEGIN'\n753:1: no mechanism is open `MECH_END'\n");
}
END_TEST

START_TEST(a_text_has_at_most_16_mib)
{
    memset(big, '\n', CNC_PLC_TEXT_MAX + 1);
    big[CNC_PLC_TEXT_MAX] = 0;
    ck_assert(rig_translate(big));
    big[CNC_PLC_TEXT_MAX] = '\n';
    big[CNC_PLC_TEXT_MAX + 1] = 0;
    check_errors(big, "1:1: the text has more than 16777216 bytes\n");
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("cnc_plc_text");
    TCase *tcase = tcase_create("errors");

    tcase_add_test(tcase, the_bad_programs_of_the_specification);
    tcase_add_test(tcase, wrong_operands_are_named);
    tcase_add_test(tcase, words_too_many_or_too_few_are_named);
    tcase_add_test(tcase, tex0_has_four_words);
    tcase_add_test(tcase, sections_are_closed_in_order);
    tcase_add_test(tcase, mechanisms_stand_in_module_main);
    tcase_add_test(tcase, names_are_there_once);
    tcase_add_test(tcase, data_has_a_name_a_kind_and_a_number);
    tcase_add_test(tcase, blanks_comments_and_cases_are_as_one_likes);
    tcase_add_test(tcase, twenty_errors_are_reported_and_strange_bytes_shown_as_marks);
    suite_add_tcase(suite, tcase);
    tcase = tcase_create("limits");
    tcase_set_timeout(tcase, 60);
    tcase_add_checked_fixture(tcase, make_big, free_big);
    tcase_add_test(tcase, a_program_has_at_most_65535_instructions);
    tcase_add_test(tcase, names_bits_and_bytes_have_limits);
    tcase_add_test(tcase, there_are_at_most_250_mechanisms);
    tcase_add_test(tcase, a_text_has_at_most_16_mib);
    suite_add_tcase(suite, tcase);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
