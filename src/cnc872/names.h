/* SPDX-License-Identifier: MIT */
/* names.h: the names that a PLC program has of its own, and numbers as a PLC text has them (NP1, NP3). */
#ifndef CNC872_NAMES_H
#define CNC872_NAMES_H

#include "cells.h"

#define CNC_SYMBOLS_MAX 8192u /* names and labels of a PLC program */
#define CNC_NO_SYMBOL UINT16_MAX

enum cnc_symbol_kind {
    CNC_SYMBOL_BIT,      /* BIT, or the bit of a mechanism */
    CNC_SYMBOL_VARIABLE, /* DB, DW, DD, DQ */
    CNC_SYMBOL_CONSTANT, /* EQU */
    CNC_SYMBOL_LABEL
};

struct cnc_symbol {
    char name[CNC_NAME_MAX + 1];
    int64_t value;  /* preset, constant, or instruction behind the label */
    uint32_t line;  /* where it is declared */
    uint16_t next;  /* of the same bucket */
    uint16_t place; /* in memory or bits */
    uint16_t scope; /* of a label: its section or mechanism; else 0 */
    uint8_t kind;   /* enum cnc_symbol_kind */
    uint8_t type;   /* enum cnc_type */
    bool is_mechanism; /* the bit is that of a mechanism */
};

struct cnc_names {
    uint16_t buckets[CNC_SYMBOLS_MAX];
    struct cnc_symbol symbols[CNC_SYMBOLS_MAX];
    uint16_t count;
};

void cnc_clear_names(struct cnc_names *names);

/* The name, letters in either case, in this scope (of a label: 1 and above; of other names: 0). NULL: there is none. */
const struct cnc_symbol *cnc_find_symbol(const struct cnc_names *names, unsigned scope, const char *text, size_t length);

/* Adds a name of 1 ... CNC_NAME_MAX letters; its other members are the caller's. NULL: there is no place left. */
struct cnc_symbol *cnc_add_symbol(struct cnc_names *names, unsigned scope, const char *text, size_t length);

/* May this letter be in a name? */
bool cnc_is_name_letter(char letter);
/* Letters of the name at the beginning of the text; 0: no name begins there. */
size_t cnc_name_length(const char *text, size_t length);
/* Bytes of the letter in quotes at the beginning of the text, with the quotes ('A', also with the marks U+2018 and U+2019);
 * 0: there is none. *value: its code. */
size_t cnc_quoted_length(const char *text, size_t length, int64_t *value);
/* The whole text as a number: 17, 95h, 0FFh, 'A'; at most 2^63 - 1. */
bool cnc_parse_number(const char *text, size_t length, int64_t *value);

/* What the language calls PLCEVENT_START_REQ, BLOCK_IDLE ... BLOCK_DONE. */
bool cnc_find_constant(const char *text, size_t length, int64_t *value);

#endif
