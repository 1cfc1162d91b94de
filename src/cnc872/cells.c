/* SPDX-License-Identifier: MIT */
/* The cells: the table made from the lists of cell_table.h, and access to their memory. */
#include <string.h>

#include "cells.h"

const uint8_t cnc_type_size[CNC_TYPES] = {0, 1, 2, 4, 8, 8, 1};
const char *const cnc_type_name[CNC_TYPES] = {"BIT", "BYTE", "WORD", "DWRD", "QWRD", "REAL", "structure"};
const char cnc_axis_names[CNC_AXES][3] = {"X", "Y", "Z", "4", "5", "6", "7", "8", "9", "10", "11", "12", "13", "14", "15", "16"};

/* ---- The table ------------------------------------------------------------------------------------------------------- */

#define IS_R false
#define IS_RW true
#define OWN(name, type, count, access, fields, preset, section)                                                       \
    {#name, CNC_##type, CNC_PLAIN, 0, CNC_FIELDS_##fields, IS_##access, count, offsetof(struct cnc_layout, name),      \
     preset, section},
#define SAME(name, other, offset, type, count, access, section)                                                       \
    {#name, CNC_##type, CNC_PLAIN, 0, CNC_FIELDS_NONE, IS_##access, count, offsetof(struct cnc_layout, other) + (offset), \
     0, section},
#define ONE(name, access, preset, section) \
    {#name, CNC_BIT, CNC_PLAIN, 0, CNC_FIELDS_NONE, IS_##access, 1, CNC_BIT_##name, preset, section},
#define SIXTEEN(name, count, access, preset, section) \
    {#name, CNC_BIT, CNC_BY_AXIS, 0, CNC_FIELDS_NONE, IS_##access, count, CNC_BIT_##name, preset, section},
#define NUMBERED(name, first, count, access, section) \
    {#name, CNC_BIT, CNC_BY_NUMBER, first, CNC_FIELDS_NONE, IS_##access, count, CNC_BIT_##name, 0, section},
const struct cnc_row cnc_rows[] = {CNC_NUMBERS(OWN, SAME) CNC_BITS(ONE, SIXTEEN, NUMBERED)};
const unsigned cnc_row_count = sizeof cnc_rows / sizeof *cnc_rows;

#define FLAG(name, section) {#name, CNC_BIT, CNC_PLAIN, 0, CNC_FIELDS_NONE, false, 1, CNC_QUEUE_##name, 0, section},
#define FLAGS(name, count, section) \
    {#name, CNC_BIT, CNC_BY_NUMBER, 0, CNC_FIELDS_NONE, false, count, CNC_QUEUE_##name, 0, section},
#define VALUE(name, type, count, section) \
    {#name, CNC_##type, CNC_PLAIN, 0, CNC_FIELDS_NONE, false, count, CNC_QUEUE_##name, 0, section},
const struct cnc_row cnc_queue_rows[CNC_QUEUE_FIELDS] = {CNC_QUEUE(FLAG, FLAGS, VALUE)};

const struct cnc_field cnc_fields[] = {
    {"TIME_MIN", CNC_FIELDS_TIME, 0, CNC_BYTE},
    {"TIME_HOUR", CNC_FIELDS_TIME, 1, CNC_BYTE},
    {"TIME_HUND", CNC_FIELDS_TIME, 2, CNC_BYTE},
    {"TIME_SEC", CNC_FIELDS_TIME, 3, CNC_BYTE},
    {"DATE_YEAR", CNC_FIELDS_DATE, 0, CNC_WORD},
    {"DATE_DAY", CNC_FIELDS_DATE, 2, CNC_BYTE},
    {"DATE_MON", CNC_FIELDS_DATE, 3, CNC_BYTE},
    {"LOW_FILETIME", CNC_FIELDS_FILETIME, 0, CNC_DWRD},
    {"HIGH_FILETIME", CNC_FIELDS_FILETIME, 4, CNC_DWRD},
    {"TOC_ROW", CNC_FIELDS_DISPLAY, 0, CNC_BYTE},
    {"TOC_COLUMN", CNC_FIELDS_DISPLAY, 1, CNC_BYTE},
    {"TOC_CHAR1", CNC_FIELDS_DISPLAY, 2, CNC_BYTE},
    {"TOC_CHAR2", CNC_FIELDS_DISPLAY, 3, CNC_BYTE},
    {"TOC_CHAR3", CNC_FIELDS_DISPLAY, 4, CNC_BYTE},
    {"TOC_CHAR4", CNC_FIELDS_DISPLAY, 5, CNC_BYTE},
    {"TOC_SIZE", CNC_FIELDS_DISPLAY, 6, CNC_BYTE},
    {"TOC_INV", CNC_FIELDS_DISPLAY, 7, CNC_BYTE},
};
const unsigned cnc_field_count = sizeof cnc_fields / sizeof *cnc_fields;

/* ---- Names ----------------------------------------------------------------------------------------------------------- */

static char lower(char letter)
{
    return letter >= 'A' && letter <= 'Z' ? (char)(letter - 'A' + 'a') : letter;
}

/* Does `name` begin with these letters? */
static bool same_letters(const char *name, const char *text, size_t length)
{
    while (length > 0 && *name != '\0' && lower(*name) == lower(*text))
        name++, text++, length--;
    return length == 0;
}

bool cnc_same_name(const char *name, const char *text, size_t length)
{
    return same_letters(name, text, length) && name[length] == '\0';
}

int cnc_find_axis(const char *text, size_t length)
{
    for (unsigned axis = 0; axis < CNC_AXES; axis++)
        if (cnc_same_name(cnc_axis_names[axis], text, length))
            return (int)axis;
    return -1;
}

/* A number of one or two digits, without zeros before it; -1: it is none. length: at least 1. */
static int read_index(const char *text, size_t length)
{
    int value = 0;

    if (length > 2 || (length == 2 && text[0] == '0'))
        return -1;
    for (; length > 0; text++, length--) {
        if (*text < '0' || *text > '9')
            return -1;
        value = value * 10 + (*text - '0');
    }
    return value;
}

bool cnc_name_matches(const struct cnc_row *row, const char *text, size_t length, unsigned *index)
{
    *index = 0;
    if (row->numbering == CNC_PLAIN)
        return cnc_same_name(row->name, text, length);
    const char *mark = strchr(row->name, row->numbering == CNC_BY_AXIS ? 'x' : 'n');
    size_t before = (size_t)(mark - row->name);
    if (length <= before || !same_letters(row->name, text, before))
        return false;
    size_t after = strlen(mark + 1);
    if (length <= before + after || !same_letters(mark + 1, text + length - after, after))
        return false;
    size_t middle = length - before - after;
    int number = row->numbering == CNC_BY_AXIS ? cnc_find_axis(text + before, middle) : read_index(text + before, middle);
    if (number < row->first || number >= row->first + row->count)
        return false;
    *index = (unsigned)(number - row->first);
    return true;
}

const struct cnc_row *cnc_find_row(const struct cnc_row *rows, unsigned count, const char *text, size_t length, unsigned *index)
{
    for (unsigned i = 0; i < count; i++)
        if (cnc_name_matches(&rows[i], text, length, index))
            return &rows[i];
    return NULL;
}

/* ---- Memory ---------------------------------------------------------------------------------------------------------- */

double cnc_read_real(const struct cnc_cells *cells, unsigned place)
{
    int64_t bits = cnc_read_number(cells, place, CNC_QWRD);
    double value;

    memcpy(&value, &bits, sizeof value);
    return value;
}

double cnc_no_number(void)
{
    const int64_t bits = INT64_C(0x7FF8000000000000);
    double value;

    memcpy(&value, &bits, sizeof value);
    return value;
}

void cnc_write_real(struct cnc_cells *cells, unsigned place, double value)
{
    int64_t bits;

    memcpy(&bits, &value, sizeof bits);
    cnc_write_number(cells, place, CNC_QWRD, bits);
}

void cnc_clear_cells(struct cnc_cells *cells)
{
    memset(cells, 0, sizeof *cells);
    for (const struct cnc_row *row = cnc_rows; row < cnc_rows + cnc_row_count; row++) {
        if (row->type == CNC_BIT)
            memset(cells->bits + row->place, row->preset, row->count);
        else if (row->preset != 0)
            cnc_write_number(cells, row->place, (enum cnc_type)row->type, row->preset);
    }
}
