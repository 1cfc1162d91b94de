/* SPDX-License-Identifier: MIT */
#include "check_cnc_names.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cnc872/cnc872.h"
#include "text/text.h"

#define NO_CELL "there is no cell `"
#define NO_INSTRUCTION "unknown instruction `"
#define INSTRUCTIONS \
    "LDR, LA, LO, LX, WR, CA, FL, FL1, JUM, JL0, JL1, EX, EX0, EX1, TEX0, LOD, STO, AD, SU, ORB, ANDB, XORB, MULB, DIVB, EQ, " \
    "LE, LT, GE, GT, ABS, RR, ESET, LDR_LIC, CLI, STI, MOV"
#define NAME_SIZE 40u /* longer names have no near one */

/* Bits with a numbering: "MPxPI" for each axis, "ZMMnPI" for each number. */
static void put_numbered(FILE *out, const struct cnc_row *row)
{
    const char *mark = strchr(row->name, row->numbering == CNC_BY_AXIS ? 'x' : 'n');
    for (unsigned at = 0; at < row->count; at++) {
        fprintf(out, "%.*s", (int)(mark - row->name), row->name);
        if (row->numbering == CNC_BY_AXIS)
            fputs(cnc_axis_names[at], out);
        else
            fprintf(out, "%u", row->first + at);
        fprintf(out, "%s, ", mark + 1);
    }
}

/* The word that comes next in its line, if it is short. Returns the place behind it. */
static const char *take_word(const char *at, const char *end, char word[NAME_SIZE])
{
    size_t length = 0;
    while (at < end && (*at == ' ' || *at == '\t'))
        at++;
    for (; at < end && (isalnum((unsigned char)*at) || strchr("_?@", *at)) && *at != '\0'; at++)
        if (length + 1u < NAME_SIZE)
            word[length++] = (char)toupper((unsigned char)*at);
    word[length] = '\0';
    return at;
}

/* Variables between DATA and DATA_END, and mechanisms. */
static void put_own(FILE *out, const char *at, const char *end)
{
    bool is_data = false;
    for (const char *next; at < end; at = next) {
        char word[NAME_SIZE];
        const char *line_end = memchr(at, '\n', (size_t)(end - at));
        next = line_end ? line_end + 1 : end;
        at = take_word(at, next, word);
        if (strcmp(word, "DATA") == 0 || strcmp(word, "DATA_END") == 0) {
            is_data = word[4] == '\0';
            continue;
        }
        const bool is_mechanism = strcmp(word, "MECH_BEGIN") == 0;
        if (is_mechanism)
            take_word(at, next, word);
        if ((is_mechanism || is_data) && word[0] != '\0')
            fprintf(out, "%s, ", word);
    }
}

/* All names of cells; to be freed, NULL: out of memory. */
static char *list_cells(const struct program_source *source)
{
    char *list = NULL;
    size_t size;
    FILE *out = open_memstream(&list, &size);
    if (out == NULL)
        return NULL;
    put_own(out, source->text, source->text + source->length);
    for (unsigned at = 0; at < cnc_row_count; at++) {
        if (cnc_rows[at].numbering != CNC_PLAIN)
            put_numbered(out, &cnc_rows[at]);
        else
            fprintf(out, "%s, ", cnc_rows[at].name);
    }
    return fclose(out) == 0 ? list : (free(list), NULL);
}

const char *check_cnc_hint(const struct program_source *source, const char *error)
{
    static char hint[NAME_SIZE + 20u];
    const bool is_cell = strncmp(error, NO_CELL, strlen(NO_CELL)) == 0;
    if (!is_cell && strncmp(error, NO_INSTRUCTION, strlen(NO_INSTRUCTION)) != 0)
        return NULL;
    char word[NAME_SIZE];
    take_word(strchr(error, '`') + 1, error + strlen(error), word);
    char *cells = is_cell ? list_cells(source) : NULL;
    const char *name = nearest_name(word, cells ? cells : is_cell ? "" : INSTRUCTIONS);
    snprintf(hint, sizeof hint, "did you mean `%s'?", name);
    free(cells);
    return name[0] != '\0' ? hint : NULL;
}
