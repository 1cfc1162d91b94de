/* SPDX-License-Identifier: MIT */
/* Operands as PLC texts and the control socket write them (NP4), and numbers (NP1). */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cnc872/operand.h"
#include "text_rig.h"

static struct cnc_names names;
static struct cnc_operand operand;
static struct cnc_text_fault fault;

static void declare_names(void)
{
    cnc_clear_names(&names);
    struct cnc_symbol *symbol = cnc_add_symbol(&names, 0, "LIMIT_Y", 7);
    symbol->kind = CNC_SYMBOL_VARIABLE;
    symbol->type = CNC_DWRD;
    symbol->place = CNC_SYSTEM_MEMORY + 8;
    symbol = cnc_add_symbol(&names, 0, "IN", 2);
    symbol->kind = CNC_SYMBOL_BIT;
    symbol->place = CNC_SYSTEM_BITS + 3;
    symbol = cnc_add_symbol(&names, 0, "FULL", 4);
    symbol->kind = CNC_SYMBOL_CONSTANT;
    symbol->value = 1000;
}

static const struct cnc_operand *parse(const char *text)
{
    const size_t length = strlen(text);
    ck_assert_msg(cnc_parse_operand(text_before_hole(text, length), length, &names, &operand, &fault), "%s: %s", text,
                  fault.reason);
    return &operand;
}

/* The operand is a number of this type at this byte of the cell. */
static void check_number(const char *text, enum cnc_cell cell, unsigned offset, enum cnc_type type)
{
    parse(text);
    ck_assert_msg(operand.kind == CNC_OPERAND_NUMBER && operand.type == type, "%s", text);
    ck_assert_msg(operand.place == cnc_cell_place(cell) + offset, "%s", text);
}

START_TEST(numbers_have_type_offset_element_and_field)
{
    check_number("DWRD.(DIFCIT_X+4)", CNC_CELL_DIFCIT_X, 4, CNC_DWRD);
    check_number("DIFCIT_X", CNC_CELL_DIFCIT_X, 0, CNC_DWRD);
    check_number("DIFCIT_X[15]", CNC_CELL_DIFCIT_X, 60, CNC_DWRD);
    check_number("WORD.DIFCIT_X[1]+2", CNC_CELL_DIFCIT_X, 6, CNC_WORD);
    check_number("WORD.LIMIT_FEED+2", CNC_CELL_LIMIT_FEED, 2, CNC_WORD);
    check_number(" \tword\t. ( limit_feed + 2h )\t", CNC_CELL_LIMIT_FEED, 2, CNC_WORD);
    check_number("WORD.BZH09", CNC_CELL_BZH09, 0, CNC_WORD);
    check_number("BZH10", CNC_CELL_BZH09, 1, CNC_BYTE);
    check_number("DWRD.PB07", CNC_CELL_PB07, 0, CNC_DWRD);
    check_number("BYTE.SYST_TIME_INFO.TIME_SEC", CNC_CELL_SYST_TIME_INFO, 3, CNC_BYTE);
    check_number("UTC_DATE_INFO.DATE_YEAR", CNC_CELL_UTC_DATE_INFO, 0, CNC_WORD);
    check_number("QWRD.FILETIME_INFO", CNC_CELL_FILETIME_INFO, 0, CNC_QWRD);
    check_number("DISPTOC2.TOC_INV", CNC_CELL_DISPTOC2, 7, CNC_BYTE);
    check_number("QWRD.(PLC_MEM_BACKUP+9992)", CNC_CELL_PLC_MEM_BACKUP, 9992, CNC_QWRD);
    check_number("PLC_MEM_BACKUP[9999]", CNC_CELL_PLC_MEM_BACKUP, 9999, CNC_BYTE);
    check_number("rAxNCParabAccel[2]", CNC_CELL_rAxNCParabAccel, 16, CNC_REAL);
    check_number("QWRD.rAxGParabAccel", CNC_CELL_rAxGParabAccel, 0, CNC_QWRD);
    ck_assert(operand.writable);
    ck_assert(!parse("VYSOVERS")->writable);
}
END_TEST

START_TEST(bits_and_names_of_the_program_are_found)
{
    parse("mpypi");
    ck_assert_int_eq(operand.kind, CNC_OPERAND_BIT);
    ck_assert_uint_eq(operand.place, CNC_BIT_MPxPI + 1);
    ck_assert(operand.writable);
    ck_assert(!parse("MPY")->writable);
    parse("In");
    ck_assert_int_eq(operand.kind, CNC_OPERAND_BIT);
    ck_assert_uint_eq(operand.place, CNC_SYSTEM_BITS + 3);
    ck_assert(operand.writable);
    parse("WORD.LIMIT_Y+2");
    ck_assert_int_eq(operand.kind, CNC_OPERAND_NUMBER);
    ck_assert_int_eq(operand.type, CNC_WORD);
    ck_assert_uint_eq(operand.place, CNC_SYSTEM_MEMORY + 10);
    ck_assert(operand.writable);
    ck_assert(!cnc_parse_operand("LIMIT_Y", 7, NULL, &operand, &fault));
    ck_assert(cnc_parse_operand("CNST.5", 6, NULL, &operand, &fault));
    ck_assert(!cnc_parse_operand("CNST.FULL", 9, NULL, &operand, &fault));
    ck_assert_uint_eq(cnc_name_length("A_1-", 4), 3);
    ck_assert_uint_eq(cnc_name_length("1A", 2), 0);
    ck_assert_uint_eq(cnc_name_length("", 0), 0);
}
END_TEST

START_TEST(fields_of_the_queue_are_bits_whole_or_real)
{
    parse("BLK[0].M3");
    ck_assert_int_eq(operand.kind, CNC_OPERAND_QUEUE_BIT);
    ck_assert_uint_eq(operand.place, CNC_QUEUE_Mn);
    ck_assert_uint_eq(operand.index, 3);
    ck_assert_uint_eq(operand.block, 0);
    ck_assert(!operand.writable);
    parse("blk[bx].IPlc1");
    ck_assert_uint_eq(operand.place, CNC_QUEUE_IPlcn);
    ck_assert_uint_eq(operand.index, 1);
    ck_assert_uint_eq(operand.block, CNC_BLOCK_BX);
    for (unsigned group = 0; group < 15; group++) {
        char text[20];
        snprintf(text, sizeof text, "BLK[0].M%u", group);
        ck_assert_uint_eq(parse(text)->index, group);
    }
    ck_assert_uint_eq(parse("BLK[1].AxNC15Move")->index, 15);
    parse("BLK[ 15 ] . M [ 14 ]");
    ck_assert_int_eq(operand.kind, CNC_OPERAND_QUEUE);
    ck_assert_int_eq(operand.type, CNC_DWRD);
    ck_assert_uint_eq(operand.place, CNC_QUEUE_M);
    ck_assert_uint_eq(operand.index, 14);
    ck_assert_uint_eq(operand.block, 15);
    ck_assert_int_eq(parse("BLK[0].BYTE.M[12]")->type, CNC_BYTE);
    ck_assert_int_eq(parse("BLK[0].WORD.T")->type, CNC_WORD);
    ck_assert_int_eq(parse("BLK[0].REAL.RPlcParams[4]")->type, CNC_REAL);
    ck_assert_uint_eq(operand.index, 4);
    ck_assert_int_eq(parse("BLK[0].BlockLen")->type, CNC_REAL);
    ck_assert_uint_eq(parse("BLK[100000].T")->block, 254); /* behind every queue */
}
END_TEST

START_TEST(constants_are_numbers_letters_and_names)
{
    static const struct {
        const char *text;
        int64_t value;
    } constants[] = {{"CNST.17", 17},       {"CNST.95h", 0x95},       {"CNST.0FFh", 255},        {"CNST.0ffH", 255},
                     {"CNST.'A'", 'A'},     {"CNST.‘b‘", 'b'},        {"CNST.‘c’", 'c'},         {"CNST.';'", ';'},
                     {"CNST. 5 ", 5},       {"CNST.FULL", 1000},      {"cnst.block_move", 2},    {"CNST.' '", ' '},
                     {"CNST.0", 0},         {"CNST.'~'", '~'},        {"CNST.BLOCK_DONE", 4},    {"CNST.PLCEVENT_START_REQ", 1},
                     {"CNST.9223372036854775807", INT64_MAX},         {"CNST.7FFFFFFFFFFFFFFFh", INT64_MAX}};

    for (size_t i = 0; i < sizeof constants / sizeof *constants; i++) {
        parse(constants[i].text);
        ck_assert_int_eq(operand.kind, CNC_OPERAND_CONSTANT);
        ck_assert_msg(operand.value == constants[i].value, "%s: %lld", constants[i].text, (long long)operand.value);
        ck_assert(!operand.writable);
    }
}
END_TEST

static const struct {
    const char *text, *reason, *word;
} wrong[] = {
    {"NIC", "there is no cell", "NIC"},
    {"BZH08PI", "there is no cell", "BZH08PI"},
    {"", "expected a name", ""},
    {"WORD.", "expected a name", ""},
    {"WORD X", "expected `.' and a name behind the type", ""},
    {"DWRD.(DIFCIT_X+64)", "this lies outside of the cell", "DIFCIT_X+64"},
    {"DIFCIT_X+61", "this lies outside of the cell", "DIFCIT_X+61"},
    {"QWRD.LIMIT_FEED", "this lies outside of the cell", "LIMIT_FEED"},
    {"WORD.BZH10", "this lies outside of the cell", "BZH10"},
    {"DIFCIT_X[16]", "there is no such element", "[16]"},
    {"DIFCIT_X[", "expected a number and `]'", ""},
    {"DIFCIT_X[1", "expected a number and `]'", ""},
    {"LIMIT_Y[1]", "there is no such element", "[1]"},
    {"SYST_TIME_INFO[0]", "there is no such element", "[0]"},
    {"SYST_TIME_INFO", "expected a field, or a type before the structure", "SYST_TIME_INFO"},
    {" SYST_TIME_INFO", "expected a field, or a type before the structure", "SYST_TIME_INFO"},
    {"DISPTOC1[2].TOC_ROW", "expected the end of the operand", ".TOC_ROW"},
    {"SYST_TIME_INFO.DATE_DAY", "the cell has no field", "DATE_DAY"},
    {"VYSOVERS.TIME_MIN", "the cell has no field", "TIME_MIN"},
    {"DWRD.UTC_TIME_INFO.TIME_HOUR", "this lies outside of the cell", "UTC_TIME_INFO.TIME_HOUR"},
    {"DIFCIT_X+", "expected a number", ""},
    {"DIFCIT_X+Y", "expected a number", "Y"},
    {"BYTE.STOPPI", "expected a number; this is a bit", "STOPPI"},
    {"STOPPI+1", "expected the end of the operand", "+1"},
    {"(DIFCIT_X+4", "expected `)'", ""},
    {"FULL", "a constant is written CNST.name", "FULL"},
    {"CNST", "expected CNST.value", ""},
    {"CNST.", "expected a number or a constant", ""},
    {"CNST.LIMIT_Y", "expected a number or a constant", "LIMIT_Y"},
    {"CNST.12AB", "expected a number or a constant", "12AB"},
    {"CNST.12Gh", "expected a number or a constant", "12Gh"},
    {"CNST.FFh", "expected a number or a constant", "FFh"},
    {"CNST.9223372036854775808", "expected a number or a constant", "9223372036854775808"},
    {"CNST.'AB'", "expected a number or a constant", ""},
    {"CNST.'A", "expected a number or a constant", ""},
    {"CNST.5 5", "expected the end of the operand", "5"},
    {"BLK[0].Foo", "a block has no field", "Foo"},
    {"BLK[0].M15", "a block has no field", "M15"},
    {"BLK[0].M011", "a block has no field", "M011"},
    {"BLK[0].Mx", "a block has no field", "Mx"},
    {"BLK[0].M1x", "a block has no field", "M1x"},
    {"BLK[0].M01", "a block has no field", "M01"},
    {"BLK[0].AxNC16Move", "a block has no field", "AxNC16Move"},
    {"BLK[0].STOPPI", "a block has no field", "STOPPI"},
    {"BLK[0].(T)", "expected a name", ""},
    {"BLK[0].M", "expected the number of an element, `[0]'", ""},
    {"BLK[0].M[15]", "there is no such element", "[15]"},
    {"BLK[0].T+2", "expected the end of the operand", "+2"},
    {"BLK[0].WORD.H", "expected REAL before it", "H"},
    {"BLK[0].REAL.T", "this is not REAL", "T"},
    {"BLK[0].BYTE.M3", "expected a number; this is a bit", "M3"},
    {"BLK[X].T", "expected a number or BX", ""},
    {"BLK[].T", "expected a number or BX", ""},
    {"BLK[0]T", "expected `].' and a field of the block", ""},
    {"BLK[0", "expected `].' and a field of the block", ""},
    {"BLK.T", "there is no cell", "BLK"},
    {"BLK", "there is no cell", "BLK"},
    {"CNST.'\x01'", "expected a number or a constant", ""},
    {"CNST.'\x7F'", "expected a number or a constant", ""},
    {"CNST.'", "expected a number or a constant", ""},
    {"CNST.'A", "expected a number or a constant", ""},
    {"CNST.\xE2\x80\x98", "expected a number or a constant", ""},
    {"CNST.\xE2\x80", "expected a number or a constant", ""},
    {"CNST.9223372036854775810", "expected a number or a constant", "9223372036854775810"},
    {"BLK", "there is no cell", "BLK"},
    {"CNST", "expected CNST.value", ""},
    {"WORD", "expected `.' and a name behind the type", ""},
    {"STRUCTURE.T", "there is no cell", "STRUCTURE"},
    {"BIT.STOPPI", "there is no cell", "BIT"},
};

START_TEST(what_is_wrong_is_named)
{
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        const char *shown = wrong[i].text, *text = text_before_hole(shown, strlen(shown));
        ck_assert_msg(!cnc_parse_operand(text, strlen(shown), &names, &operand, &fault), "%s", shown);
        ck_assert_str_eq(fault.reason, wrong[i].reason);
        ck_assert_uint_le(fault.at + fault.length, strlen(shown));
        if (wrong[i].word[0])
            ck_assert_msg(fault.length == strlen(wrong[i].word) &&
                          strncmp(text + fault.at, wrong[i].word, fault.length) == 0, "%s: `%.*s'", shown, (int)fault.length,
                          text + fault.at);
    }
}
END_TEST

START_TEST(numbers_are_cut_to_their_width_with_their_sign)
{
    ck_assert_int_eq(cnc_cut_number(-1, CNC_BYTE), 255);
    ck_assert_int_eq(cnc_cut_number(0x12345, CNC_WORD), 0x2345);
    ck_assert_int_eq(cnc_cut_number(0x180000000, CNC_DWRD), INT32_MIN);
    ck_assert_int_eq(cnc_cut_number(INT64_MIN, CNC_QWRD), INT64_MIN);
    ck_assert_int_eq(cnc_type_least(CNC_DWRD), INT32_MIN);
    ck_assert_int_eq(cnc_type_least(CNC_QWRD), INT64_MIN);
    ck_assert_int_eq(cnc_type_least(CNC_WORD), 0);
    ck_assert_int_eq(cnc_type_greatest(CNC_BIT), 1);
    ck_assert_int_eq(cnc_type_greatest(CNC_BYTE), 255);
    ck_assert_int_eq(cnc_type_greatest(CNC_WORD), 65535);
    ck_assert_int_eq(cnc_type_greatest(CNC_DWRD), INT32_MAX);
    ck_assert_int_eq(cnc_type_greatest(CNC_QWRD), INT64_MAX);
}
END_TEST

START_TEST(names_are_found_until_the_table_is_full)
{
    char name[16];

    cnc_clear_names(&names);
    for (unsigned i = 0; i < CNC_SYMBOLS_MAX; i++) {
        snprintf(name, sizeof name, "L%u", i);
        struct cnc_symbol *symbol = cnc_add_symbol(&names, 1 + i % 3, name, strlen(name));
        ck_assert_ptr_nonnull(symbol);
        symbol->value = i;
    }
    ck_assert_ptr_null(cnc_add_symbol(&names, 0, "ONE_MORE", 8));
    for (unsigned i = 0; i < CNC_SYMBOLS_MAX; i++) {
        snprintf(name, sizeof name, "l%u", i);
        ck_assert_int_eq(cnc_find_symbol(&names, 1 + i % 3, name, strlen(name))->value, i);
        ck_assert_ptr_null(cnc_find_symbol(&names, 1 + (i + 1) % 3, name, strlen(name)));
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("cnc_operand");
    TCase *tcase = tcase_create("operand");

    tcase_add_checked_fixture(tcase, declare_names, NULL);
    tcase_add_test(tcase, numbers_have_type_offset_element_and_field);
    tcase_add_test(tcase, bits_and_names_of_the_program_are_found);
    tcase_add_test(tcase, fields_of_the_queue_are_bits_whole_or_real);
    tcase_add_test(tcase, constants_are_numbers_letters_and_names);
    tcase_add_test(tcase, what_is_wrong_is_named);
    tcase_add_test(tcase, numbers_are_cut_to_their_width_with_their_sign);
    tcase_add_test(tcase, names_are_found_until_the_table_is_full);
    suite_add_tcase(suite, tcase);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
