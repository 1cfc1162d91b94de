/* SPDX-License-Identifier: MIT */
/* plc_subject.c: PLC programs that are given by cnc872_plc.py. Input, any number of times:
 *
 *     program TICKS SEED    TICKS cycles, in which the bits IN0 ... IN3 follow from SEED
 *     the text              to a line with a point alone
 *
 * Printed is a line for each cycle: whether MODULE_BLOCK_INIT has ended, all bits and variables in the order of their
 * declaration (those whose names begin with R as REAL), DR, RLO, DR_REAL; then an empty line. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cnc872/cnc872.h"

#define TEXT_MAX 100000u

static struct cnc_plc_program program;
static struct cnc_plc plc;
static struct cnc_cells cells;

static void report_error(void *context, const struct cnc_text_error *error)
{
    (void)context;
    printf("%u:%u: %s\n", error->line, error->column, error->text);
}

static int64_t queue_number(void *context, unsigned block, enum cnc_queue_field field, unsigned index)
{
    (void)context;
    return (int64_t)(block * 1000 + (unsigned)field * 16 + index);
}

static double queue_real(void *context, unsigned block, enum cnc_queue_field field, unsigned index)
{
    return (double)queue_number(context, block, field, index) / 4;
}

static void seek_zero_pulse(void *context, unsigned axis)
{
    (void)context, (void)axis;
}

static void report_event(void *context, enum cnc_plc_event event, int64_t value, uint32_t line)
{
    (void)context, (void)event, (void)value, (void)line;
}

static bool pass(enum cnc_plc_section section)
{
    static const struct cnc_plc_surroundings surroundings = {queue_number, queue_real, seek_zero_pulse, report_event};
    return cnc_pass_plc(&plc, &program, &cells, section, &surroundings, NULL);
}

static void set_inputs(uint32_t *seed)
{
    for (unsigned i = 0; i < 4; i++) {
        char name[4];
        snprintf(name, sizeof name, "IN%u", i);
        *seed = *seed * 1103515245u + 12345u;
        cnc_put_bit(&cells, cnc_find_symbol(&program.names, 0, name, 3)->place, *seed >> 16 & 1);
    }
}

static void print_cells(bool has_ended)
{
    printf("%d", has_ended);
    for (unsigned i = 0; i < program.names.count; i++) {
        const struct cnc_symbol *symbol = &program.names.symbols[i];
        if (symbol->kind == CNC_SYMBOL_BIT)
            printf(" %d", cnc_bit(&cells, symbol->place));
        else if (symbol->kind == CNC_SYMBOL_VARIABLE && symbol->name[0] == 'R')
            printf(" %.17g", cnc_read_real(&cells, symbol->place));
        else if (symbol->kind == CNC_SYMBOL_VARIABLE)
            printf(" %" PRId64, cnc_read_number(&cells, symbol->place, (enum cnc_type)symbol->type));
    }
    printf(" %" PRId64 " %d %.17g\n", plc.dr, plc.rlo, plc.real);
}

static void run(const char *text, unsigned ticks, uint32_t seed)
{
    if (!cnc_translate_plc(text, strlen(text), &program, report_error, NULL))
        return;
    cnc_clear_cells(&cells);
    cnc_begin_plc(&plc, &program, &cells);
    pass(CNC_PLC_INIT);
    for (unsigned tick = 0; tick < ticks; tick++) {
        set_inputs(&seed);
        bool has_ended = pass(CNC_PLC_BLOCK_INIT);
        pass(CNC_PLC_MAIN);
        print_cells(has_ended);
    }
}

int main(void)
{
    static char text[TEXT_MAX], line[400];
    unsigned ticks;
    uint32_t seed;

    while (fgets(line, sizeof line, stdin)) {
        if (sscanf(line, "program %u %" SCNu32, &ticks, &seed) != 2)
            return EXIT_FAILURE;
        text[0] = 0;
        while (fgets(line, sizeof line, stdin) && strcmp(line, ".\n") != 0)
            strncat(text, line, sizeof text - strlen(text) - 1);
        run(text, ticks, seed);
        putchar('\n');
    }
    return EXIT_SUCCESS;
}
