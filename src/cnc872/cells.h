/* SPDX-License-Identifier: MIT */
/* cells.h: the cells of the interface as memory, little endian on every machine; a bit is a byte of its own.
 *
 *     cnc_clear_cells(&cells);                                   // presets
 *     cnc_put_bit(&cells, CNC_BIT_MPxPI + axis, false);          // a bit of an axis, 0 = X
 *     cnc_put_number(&cells, CNC_CELL_B_POL, axis, position);    // an element of an array
 *     if (cnc_bit(&cells, CNC_BIT_STOPPI)) ...
 *
 * Copying a struct cnc_cells is a snapshot. Clauses in brackets refer to docs/CNC872.md. */
#ifndef CNC872_CELLS_H
#define CNC872_CELLS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cell_table.h"

#define CNC_AXES 16u
#define CNC_NAME_MAX 31u          /* letters of a name (NP1) */
#define CNC_OWN_MEMORY 8192u      /* bytes that the variables of a PLC program may take */
#define CNC_OWN_BITS 2048u        /* bits of its own that a PLC program may have, those of its mechanisms with them */

enum cnc_type {
    CNC_BIT,
    CNC_BYTE,      /* without a sign */
    CNC_WORD,      /* without a sign */
    CNC_DWRD,      /* with a sign */
    CNC_QWRD,      /* with a sign */
    CNC_REAL,      /* IEEE double */
    CNC_STRUCTURE, /* read by its fields, or with a type written before it; count is its bytes */
    CNC_TYPES
};

/* Bytes of a number of each type; of a structure as of a byte. */
extern const uint8_t cnc_type_size[CNC_TYPES];
/* As a program writes them: "BYTE", "REAL". */
extern const char *const cnc_type_name[CNC_TYPES];
/* "X", "Y", "Z", "4", ... "16". */
extern const char cnc_axis_names[CNC_AXES][3];

/* ---- Constants ------------------------------------------------------------------------------------------------------- */

/* CNC_CELL_B_POL, ...: cells with a number. */
#define CNC_OWN_(name, type, count, access, fields, preset, section) CNC_CELL_##name,
#define CNC_SAME_(name, other, offset, type, count, access, section) CNC_CELL_##name,
enum cnc_cell { CNC_NUMBERS(CNC_OWN_, CNC_SAME_) CNC_CELLS };
#undef CNC_OWN_
#undef CNC_SAME_

/* CNC_BIT_STOPPI, ...: places of bits. Those of the axes lie one behind the other, 16 of each name, also where a PLC program
 * reaches but the first six: CNC_BIT_MPxPI + axis. CNC_BIT_ZMMnPI + n - 1 is the bit of group n. */
#define CNC_ONE_(name, access, preset, section) CNC_BIT_##name,
#define CNC_SIXTEEN_(name, count, access, preset, section) CNC_BIT_##name, CNC_LAST_BIT_##name = CNC_BIT_##name + 15,
#define CNC_NUMBERED_(name, first, count, access, section) \
    CNC_BIT_##name, CNC_LAST_BIT_##name = CNC_BIT_##name + (count) - 1,
enum cnc_bit { CNC_BITS(CNC_ONE_, CNC_SIXTEEN_, CNC_NUMBERED_) CNC_SYSTEM_BITS };
#undef CNC_ONE_
#undef CNC_SIXTEEN_
#undef CNC_NUMBERED_

/* CNC_QUEUE_FirstBlock, ...: fields of a block in the queue (NQ1). CNC_QUEUE_Mn is the change bit M0 ... M14, by its index;
 * CNC_QUEUE_M the array M[0 ... 14]. */
#define CNC_FLAG_(name, section) CNC_QUEUE_##name,
#define CNC_FLAGS_(name, count, section) CNC_QUEUE_##name,
#define CNC_VALUE_(name, type, count, section) CNC_QUEUE_##name,
enum cnc_queue_field { CNC_QUEUE(CNC_FLAG_, CNC_FLAGS_, CNC_VALUE_) CNC_QUEUE_FIELDS };
#undef CNC_FLAG_
#undef CNC_FLAGS_
#undef CNC_VALUE_

/* ---- Memory ---------------------------------------------------------------------------------------------------------- */

#define CNC_SIZE_BYTE 1
#define CNC_SIZE_WORD 2
#define CNC_SIZE_DWRD 4
#define CNC_SIZE_QWRD 8
#define CNC_SIZE_REAL 8
#define CNC_SIZE_STRUCTURE 1
#define CNC_OWN_(name, type, count, access, fields, preset, section) uint8_t name[CNC_SIZE_##type * (count)];
#define CNC_SAME_(name, other, offset, type, count, access, section)
struct cnc_layout { /* bytes alone: nothing lies between them */
    CNC_NUMBERS(CNC_OWN_, CNC_SAME_)
};
#undef CNC_OWN_
#undef CNC_SAME_
#define CNC_SYSTEM_MEMORY sizeof(struct cnc_layout)

struct cnc_cells {
    uint8_t memory[CNC_SYSTEM_MEMORY + CNC_OWN_MEMORY]; /* the cells, then the variables of the PLC program */
    uint8_t bits[CNC_SYSTEM_BITS + CNC_OWN_BITS];       /* 0 or 1 each; those of the PLC program last */
};

/* All cells to their presets (NT3), the PLC program's own to 0. */
void cnc_clear_cells(struct cnc_cells *cells);

/* A bit; place: CNC_BIT_..., below CNC_SYSTEM_BITS + CNC_OWN_BITS. */
static inline bool cnc_bit(const struct cnc_cells *cells, unsigned place)
{
    return cells->bits[place] != 0;
}

static inline void cnc_put_bit(struct cnc_cells *cells, unsigned place, bool value)
{
    cells->bits[place] = value;
}

/* Where a cell is and what it is, known to the compiler: access to a cell by its constant is a load or a store. */
struct cnc_shape {
    uint16_t place;
    uint8_t type; /* enum cnc_type */
};
#define CNC_OWN_(name, type, count, access, fields, preset, section) {offsetof(struct cnc_layout, name), CNC_##type},
#define CNC_SAME_(name, other, offset, type, count, access, section) {offsetof(struct cnc_layout, other) + (offset), CNC_##type},
static const struct cnc_shape cnc_shapes[CNC_CELLS] = {CNC_NUMBERS(CNC_OWN_, CNC_SAME_)};
#undef CNC_OWN_
#undef CNC_SAME_

static inline unsigned cnc_cell_place(enum cnc_cell cell)
{
    return cnc_shapes[cell].place;
}

/* A number of any type at a place in memory: cnc_cell_place() + a byte offset (SYST_TIME_INFO's fields), or an operand's. */
static inline int64_t cnc_read_number(const struct cnc_cells *cells, unsigned place, enum cnc_type type)
{
    const uint8_t *at = cells->memory + place;
    uint32_t low = at[0];

    if (type == CNC_BYTE)
        return low;
    low |= (uint32_t)at[1] << 8;
    if (type == CNC_WORD)
        return low;
    low |= (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
    if (type == CNC_DWRD)
        return (int32_t)low;
    uint32_t high = at[4] | (uint32_t)at[5] << 8 | (uint32_t)at[6] << 16 | (uint32_t)at[7] << 24;
    return (int64_t)((uint64_t)high << 32 | low);
}

/* The same is written, cut to the width of the type. */
static inline void cnc_write_number(struct cnc_cells *cells, unsigned place, enum cnc_type type, int64_t value)
{
    uint8_t *at = cells->memory + place;
    uint64_t bits = (uint64_t)value;

    at[0] = (uint8_t)bits;
    if (type == CNC_BYTE)
        return;
    at[1] = (uint8_t)(bits >> 8);
    if (type == CNC_WORD)
        return;
    at[2] = (uint8_t)(bits >> 16);
    at[3] = (uint8_t)(bits >> 24);
    if (type == CNC_DWRD)
        return;
    at[4] = (uint8_t)(bits >> 32);
    at[5] = (uint8_t)(bits >> 40);
    at[6] = (uint8_t)(bits >> 48);
    at[7] = (uint8_t)(bits >> 56);
}

/* What operations of REAL that have no number as their result give: processors differ in theirs. */
double cnc_no_number(void);

double cnc_read_real(const struct cnc_cells *cells, unsigned place);
void cnc_write_real(struct cnc_cells *cells, unsigned place, double value);

/* The place of element `index` of a cell, which is below its count. */
static inline unsigned cnc_element_place(enum cnc_cell cell, unsigned index)
{
    static const uint8_t sizes[CNC_TYPES] = {0, 1, 2, 4, 8, 8, 1};

    return cnc_shapes[cell].place + index * sizes[cnc_shapes[cell].type];
}

/* Element `index` of a cell of whole numbers. */
static inline int64_t cnc_number(const struct cnc_cells *cells, enum cnc_cell cell, unsigned index)
{
    return cnc_read_number(cells, cnc_element_place(cell, index), (enum cnc_type)cnc_shapes[cell].type);
}

static inline void cnc_put_number(struct cnc_cells *cells, enum cnc_cell cell, unsigned index, int64_t value)
{
    cnc_write_number(cells, cnc_element_place(cell, index), (enum cnc_type)cnc_shapes[cell].type, value);
}

/* Element `index` of a cell of type REAL. */
static inline double cnc_real(const struct cnc_cells *cells, enum cnc_cell cell, unsigned index)
{
    return cnc_read_real(cells, cnc_element_place(cell, index));
}

static inline void cnc_put_real(struct cnc_cells *cells, enum cnc_cell cell, unsigned index, double value)
{
    cnc_write_real(cells, cnc_element_place(cell, index), value);
}

/* ---- The table ------------------------------------------------------------------------------------------------------- */

enum cnc_numbering {
    CNC_PLAIN,
    CNC_BY_AXIS,  /* the name of an axis stands in the place of x */
    CNC_BY_NUMBER /* a number from `first` on stands in the place of n */
};

/* Structures with fields. */
enum cnc_fields { CNC_FIELDS_NONE, CNC_FIELDS_TIME, CNC_FIELDS_DATE, CNC_FIELDS_FILETIME, CNC_FIELDS_DISPLAY };

struct cnc_row {
    const char *name;     /* "B_POL"; "MPxPI", "ZMMnPI" by numbering */
    uint8_t type;         /* enum cnc_type */
    uint8_t numbering;    /* enum cnc_numbering */
    uint8_t first;        /* CNC_BY_NUMBER: number of the first */
    uint8_t fields;       /* enum cnc_fields */
    bool writable;        /* by the PLC program and over the control socket */
    uint16_t count;       /* elements of an array, bytes of a structure, or bits with a numbering */
    uint16_t place;       /* of the first in memory or bits, or enum cnc_queue_field */
    uint16_t preset;
    const char *section;  /* of the source, "8.1.4"; "own": not in the source */
};

struct cnc_field {
    const char *name;
    uint8_t fields; /* enum cnc_fields that it belongs to */
    uint8_t offset, type;
};

/* All cells: rows 0 ... CNC_CELLS - 1 are those of enum cnc_cell, bits follow. */
extern const struct cnc_row cnc_rows[];
extern const unsigned cnc_row_count;
/* The fields of a block in the queue, in the order of enum cnc_queue_field. */
extern const struct cnc_row cnc_queue_rows[CNC_QUEUE_FIELDS];
extern const struct cnc_field cnc_fields[];
extern const unsigned cnc_field_count;

/* Does the text (letters in either case) name this row? *index: which of its bits, 0 without a numbering. */
bool cnc_name_matches(const struct cnc_row *row, const char *text, size_t length, unsigned *index);
/* The first of these rows that the text names, NULL if none does. */
const struct cnc_row *cnc_find_row(const struct cnc_row *rows, unsigned count, const char *text, size_t length, unsigned *index);
/* The axis of this name, -1 if there is none. */
int cnc_find_axis(const char *text, size_t length);
/* Are the texts the same but for the case of ASCII letters? `name` ends with 0. */
bool cnc_same_name(const char *name, const char *text, size_t length);

#endif
