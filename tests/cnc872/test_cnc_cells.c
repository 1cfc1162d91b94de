/* SPDX-License-Identifier: MIT */
/* The cells of the CNC872: names, places, presets and bytes (section 3). */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "cnc872/cells.h"

static struct cnc_cells cells;

static const struct cnc_row *find(const char *name, unsigned *index)
{
    const struct cnc_row *found = NULL;

    for (unsigned i = 0; i < cnc_row_count; i++) {
        unsigned here;
        if (cnc_name_matches(&cnc_rows[i], name, strlen(name), &here)) {
            ck_assert_msg(!found, "%s is named twice", name);
            found = &cnc_rows[i];
            *index = here;
        }
    }
    return found;
}

static unsigned bit_place(const char *name)
{
    unsigned index = 0;
    const struct cnc_row *row = find(name, &index);

    ck_assert_msg(row && row->type == CNC_BIT, "%s is not a bit", name);
    return row->place + index;
}

START_TEST(bits_of_axes_have_the_axis_in_the_name)
{
    ck_assert_uint_eq(bit_place("MPXPI"), CNC_BIT_MPxPI);
    ck_assert_uint_eq(bit_place("MP4PI"), CNC_BIT_MPxPI + 3);
    ck_assert_uint_eq(bit_place("mp16pi"), CNC_BIT_MPxPI + 15);
    ck_assert_uint_eq(bit_place("mpzpi"), CNC_BIT_MPxPI + 2);
    ck_assert_int_eq(cnc_find_axis("16", 2), 15);
    ck_assert_int_eq(cnc_find_axis("1", 1), -1);
    ck_assert_int_eq(cnc_find_axis("17", 2), -1);
    ck_assert_uint_eq(bit_place("KH100"), CNC_BIT_KHx0 + 9);
    ck_assert_uint_eq(bit_place("KHX1"), CNC_BIT_KHx1);
    ck_assert_uint_eq(bit_place("KRRY"), CNC_BIT_KRRx + 1);
    ck_assert_uint_eq(bit_place("EXM_Z1"), CNC_BIT_EXM_x1 + 2);
    ck_assert_uint_eq(bit_place("VAZBA_5"), CNC_BIT_VAZBA_x + 4);
    ck_assert_uint_eq(bit_place("SM_POYPI"), CNC_BIT_SM_POxPI + 1);
    ck_assert_uint_eq(bit_place("MP6"), CNC_BIT_MPx + 5);
    ck_assert_uint_eq(bit_place("ZMM14PI"), CNC_BIT_ZMMnPI + 13);
}
END_TEST

START_TEST(what_is_not_in_the_table_is_not_found)
{
    static const char *const absent[] = {"MP7",    "PO_OS7", "MP1PI", "MPPI",   "MP17PI", "MP04PI", "ZMM0PI", "ZMM15PI",
                                         "ZMMPI",  "KH10",   "BZH08PI", "PB20PI", "",     "M0",     "x",      "B_POLX",
                                         "ZMM01PI", "ZMM1aPI", "ZMM111PI", "ZMM001PI", "ZMM1 PI"};
    unsigned index;

    for (size_t i = 0; i < sizeof absent / sizeof *absent; i++)
        ck_assert_msg(!find(absent[i], &index), "%s is found", absent[i]);
}
END_TEST

START_TEST(each_name_is_there_once)
{
    for (unsigned i = 0; i < cnc_row_count; i++)
        for (unsigned j = 0; j < i; j++)
            ck_assert_msg(strcasecmp(cnc_rows[i].name, cnc_rows[j].name) != 0, "%s", cnc_rows[i].name);
    for (unsigned axis = 0; axis < CNC_AXES; axis++) { /* no bit of an axis has the name of another cell */
        for (unsigned i = 0; i < cnc_row_count; i++) {
            unsigned index;
            char name[80];
            if (cnc_rows[i].numbering != CNC_BY_AXIS || axis >= cnc_rows[i].count)
                continue;
            int before = (int)strcspn(cnc_rows[i].name, "x");
            snprintf(name, sizeof name, "%.*s%s%s", before, cnc_rows[i].name, cnc_axis_names[axis],
                     cnc_rows[i].name + before + 1);
            ck_assert_ptr_eq(find(name, &index), &cnc_rows[i]);
            ck_assert_uint_eq(index, axis);
        }
    }
}
END_TEST

START_TEST(presets_are_those_of_the_table)
{
    memset(&cells, 0x5A, sizeof cells);
    cnc_clear_cells(&cells);
    for (unsigned axis = 0; axis < CNC_AXES; axis++) {
        ck_assert(cnc_bit(&cells, CNC_BIT_MPxPI + axis));
        ck_assert(cnc_bit(&cells, CNC_BIT_MPxMAN + axis));
        ck_assert(cnc_bit(&cells, CNC_BIT_VAZBA_x + axis));
        ck_assert(!cnc_bit(&cells, CNC_BIT_PO_OSxPI + axis));
    }
    ck_assert(cnc_bit(&cells, CNC_BIT_EN_AUTMAN));
    ck_assert_int_eq(cnc_number(&cells, CNC_CELL_FEED_OVR_MULTIPLIER, 0), 1000);
    ck_assert_int_eq(cnc_number(&cells, CNC_CELL_SPEED_OVR_MULTIPLIER, 0), 1000);
    ck_assert_int_eq(cnc_number(&cells, CNC_CELL_SPINDLE_GEAR_ACT_1, 0), 1);
    ck_assert_int_eq(cnc_number(&cells, CNC_CELL_NlcServoEnable, 0), 0xFFFF);
    unsigned set = 0, filled = 0;
    for (size_t i = 0; i < sizeof cells.bits; i++)
        set += cells.bits[i];
    for (size_t i = 0; i < sizeof cells.memory; i++)
        filled += cells.memory[i] != 0;
    ck_assert_uint_eq(set, 3 * CNC_AXES + 1); /* all others are 0 */
    ck_assert_uint_eq(filled, 2 + 2 + 1 + 2);
}
END_TEST

START_TEST(numbers_are_little_endian_and_have_their_sign)
{
    cnc_clear_cells(&cells);
    cnc_put_number(&cells, CNC_CELL_BZH09, 0, 0xDC);
    cnc_put_number(&cells, CNC_CELL_BZH10, 0, 0x05);
    ck_assert_int_eq(cnc_read_number(&cells, cnc_cell_place(CNC_CELL_BZH09), CNC_WORD), 1500);
    cnc_put_number(&cells, CNC_CELL_LIMIT_FEED, 0, 17 * 65536);
    ck_assert_int_eq(cnc_read_number(&cells, cnc_cell_place(CNC_CELL_LIMIT_FEED) + 2, CNC_WORD), 17);
    cnc_put_number(&cells, CNC_CELL_B_INK, 5, -1);
    ck_assert_int_eq(cnc_number(&cells, CNC_CELL_B_INK, 5), -1);
    ck_assert_int_eq(cnc_number(&cells, CNC_CELL_B_INK, 4), 0);
    cnc_put_number(&cells, CNC_CELL_POSITION_POS5_EX, 15, INT64_MIN + 1);
    ck_assert_int_eq(cnc_number(&cells, CNC_CELL_POSITION_POS5_EX, 15), INT64_MIN + 1);
    ck_assert_int_eq(cnc_number(&cells, CNC_CELL_POSITION_POS5_EX, 14), 0);
    ck_assert_int_eq(cnc_number(&cells, CNC_CELL_DIFCIT_X, 0), 0);
    cnc_put_number(&cells, CNC_CELL_VYSOVERS, 0, 0x1FFFF); /* cut to its width */
    ck_assert_int_eq(cnc_number(&cells, CNC_CELL_VYSOVERS, 0), 0xFFFF);
    ck_assert_int_eq(cnc_number(&cells, CNC_CELL_REQ_SPEED_PM, 0), 0);
    cnc_put_real(&cells, CNC_CELL_rAxNCParabAccel, 1, 1.0);
    ck_assert_int_eq(cells.memory[cnc_cell_place(CNC_CELL_rAxNCParabAccel) + 15], 0x3F);
    ck_assert_int_eq(cells.memory[cnc_cell_place(CNC_CELL_rAxNCParabAccel) + 14], 0xF0);
    ck_assert_double_eq(cnc_real(&cells, CNC_CELL_rAxNCParabAccel, 1), 1.0);
    cnc_put_number(&cells, CNC_CELL_OTACKY_VR, 0, 1234);
    ck_assert_int_eq(cnc_number(&cells, CNC_CELL_SIM_SPEED_PT, 0), 1234);
}
END_TEST

START_TEST(cells_lie_inside_the_memory_and_their_rows_are_true)
{
    size_t bytes = 0;

    for (unsigned i = 0; i < cnc_row_count; i++) {
        const struct cnc_row *row = &cnc_rows[i];
        ck_assert_uint_le(strlen(row->name), CNC_NAME_MAX);
        ck_assert_uint_gt(row->count, 0);
        ck_assert(strcmp(row->section, "own") == 0 || strncmp(row->section, "8.", 2) == 0);
        if (i < CNC_CELLS) {
            ck_assert_int_ne(row->type, CNC_BIT);
            size_t size = (size_t)row->count * cnc_type_size[row->type];
            ck_assert_uint_le(row->place + size, CNC_SYSTEM_MEMORY);
            bytes += size;
        } else {
            ck_assert_int_eq(row->type, CNC_BIT);
            ck_assert_uint_le((size_t)row->place + row->count, CNC_SYSTEM_BITS);
        }
    }
    ck_assert_uint_eq(bytes - 1 - 4 - 1 - 3, CNC_SYSTEM_MEMORY); /* PB12, OTACKY_VR, BZH10, PB08 ... PB10 are others' */
    ck_assert_str_eq(cnc_rows[CNC_CELL_PLC_ERROR].name, "PLC_ERROR");
    for (unsigned i = 0; i < CNC_QUEUE_FIELDS; i++)
        ck_assert_uint_eq(cnc_queue_rows[i].place, i);
    for (unsigned i = 0; i < cnc_field_count; i++)
        ck_assert_int_le(cnc_fields[i].offset + cnc_type_size[cnc_fields[i].type], 8);
    ck_assert_uint_le(sizeof cells, 24 * 1024);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("cnc_cells");
    TCase *tcase = tcase_create("cells");

    tcase_add_test(tcase, bits_of_axes_have_the_axis_in_the_name);
    tcase_add_test(tcase, what_is_not_in_the_table_is_not_found);
    tcase_add_test(tcase, each_name_is_there_once);
    tcase_add_test(tcase, presets_are_those_of_the_table);
    tcase_add_test(tcase, numbers_are_little_endian_and_have_their_sign);
    tcase_add_test(tcase, cells_lie_inside_the_memory_and_their_rows_are_true);
    suite_add_tcase(suite, tcase);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
