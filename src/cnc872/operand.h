/* SPDX-License-Identifier: MIT */
/* operand.h: operands as a PLC text and the control socket write them (NP4):
 *
 *     [BLK[n].][BYTE. | WORD. | DWRD. | QWRD. | REAL.]name[.field][+offset]     (name+offset)     name[i]     CNST.value */
#ifndef CNC872_OPERAND_H
#define CNC872_OPERAND_H

#include "cells.h"
#include "names.h"

#define CNC_BLOCK_BX 255u /* BLK[BX]: the number is in the register BX */

enum cnc_operand_kind {
    CNC_OPERAND_BIT,       /* cnc_bit() at `place` */
    CNC_OPERAND_NUMBER,    /* cnc_read_number(), cnc_read_real() at `place` */
    CNC_OPERAND_QUEUE_BIT, /* field `place` of block `block` */
    CNC_OPERAND_QUEUE,     /* the same, a number; cut to `type` */
    CNC_OPERAND_CONSTANT   /* `value` */
};

struct cnc_operand {
    int64_t value;
    uint16_t place; /* in bits or memory, or enum cnc_queue_field */
    uint8_t kind;   /* enum cnc_operand_kind */
    uint8_t type;   /* enum cnc_type; of a constant QWRD */
    uint8_t block;  /* BLK[block]; CNC_BLOCK_BX */
    uint8_t index;  /* element of a field of the queue */
    bool writable;
};

/* What is wrong with a text. */
struct cnc_text_fault {
    const char *reason; /* "there is no such cell" */
    size_t at, length;  /* which letters of the text */
};

/* Reads an operand; blanks may stand between its parts. names: those of a PLC program, NULL without. False: *fault says why. */
bool cnc_parse_operand(const char *text, size_t length, const struct cnc_names *names, struct cnc_operand *operand,
                       struct cnc_text_fault *fault);

/* The type of this name ("BYTE" ... "REAL"), CNC_TYPES if there is none. */
enum cnc_type cnc_find_type(const char *text, size_t length);

/* Least and greatest number of a type of whole numbers. */
int64_t cnc_type_least(enum cnc_type type);
int64_t cnc_type_greatest(enum cnc_type type);
/* A number cut to the width of the type, with the type's sign. */
int64_t cnc_cut_number(int64_t value, enum cnc_type type);

#endif
