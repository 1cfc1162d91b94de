/* SPDX-License-Identifier: MIT */
/* plc_line.h: the parts of a line of a PLC text (NP1). */
#ifndef CNC872_PLC_LINE_H
#define CNC872_PLC_LINE_H

#include <stdbool.h>
#include <stddef.h>

#define CNC_ARGUMENTS_MAX 5u /* one more than any instruction has */

struct cnc_word {
    const char *text;
    size_t length;
};

struct cnc_plc_line {
    const char *begin;     /* its first letter */
    unsigned number;       /* from 1 on */
    struct cnc_word label; /* length 0: none */
    struct cnc_word name;  /* of the instruction, length 0: none */
    struct cnc_word argument[CNC_ARGUMENTS_MAX]; /* between commas, without blanks around */
    unsigned arguments;
};

/* Takes the line at *text apart and puts *text behind it. length: letters to the end of the text. line->number counts on. */
void cnc_read_plc_line(const char **text, size_t *length, struct cnc_plc_line *line);

#endif
