/* SPDX-License-Identifier: MIT */
/* plc_translator.h: what the parts of the translator share. The text is translated twice: the first time declares names and
 * labels, the second time reports what is wrong. */
#ifndef CNC872_PLC_TRANSLATOR_H
#define CNC872_PLC_TRANSLATOR_H

#include "plc.h"
#include "plc_code.h"
#include "plc_line.h"

#define CNC_NOWHERE (-1) /* outside of sections, or of mechanisms */

struct translator {
    struct cnc_plc_program *program;
    struct cnc_text_errors errors;
    struct cnc_plc_line line;
    struct cnc_instruction spare; /* takes what the program has no place for */
    int section, mechanism; /* where the line stands, CNC_NOWHERE outside */
    unsigned section_line, mechanism_line, data_line; /* where they begin */
    bool is_second, in_data, is_full, has_stopped;
};

/* Reports what is wrong with these letters of the line: "reason `letters'". */
void cnc_plc_wrong(struct translator *translator, const char *reason, struct cnc_word word);

/* The part of the program to which the line belongs, as struct cnc_plc_program counts them; its labels have scope part + 1. */
unsigned cnc_plc_part_of(const struct translator *translator);

/* Appends an instruction of this code. */
struct cnc_instruction *cnc_plc_emit(struct translator *translator, enum cnc_plc_code code);

/* Translates the instruction of the line, which is no mark of a section or mechanism. */
void cnc_translate_instruction(struct translator *translator);

/* A number, or a constant by its name. */
bool cnc_plc_value(const struct translator *translator, struct cnc_word word, int64_t *value);

#endif
