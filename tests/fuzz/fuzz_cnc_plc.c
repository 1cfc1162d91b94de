/* SPDX-License-Identifier: MIT */
/* fuzz_cnc_plc.c: any bytes as a PLC program of a CNC872. What has no errors is run: calls end, cells that may only be read do
 * not change, and a copy of the state gives the same again. */
#include <stdlib.h>
#include <string.h>

#include "cnc872/cnc872.h"
#include "fuzz.h"

#define TICKS 4u

static struct cnc_plc_program program;

struct machine {
    struct cnc_plc plc;
    struct cnc_cells cells;
    unsigned calls; /* of the surroundings */
};

struct reading {
    uint32_t lines, errors;
};

static void report_error(void *context, const struct cnc_text_error *error)
{
    struct reading *reading = context;
    FUZZ_CHECK(error->line >= 1 && error->line <= reading->lines, "line %u of %u", error->line, reading->lines);
    FUZZ_CHECK(error->column >= 1 && strlen(error->text) < CNC_TEXT_ERROR_SIZE, "column %u", error->column);
    reading->errors++;
}

static int64_t queue_number(void *context, unsigned block, enum cnc_queue_field field, unsigned index)
{
    struct machine *machine = context;
    FUZZ_CHECK(field < CNC_QUEUE_FIELDS && cnc_queue_rows[field].type != CNC_REAL, "field %d", (int)field);
    FUZZ_CHECK(index < cnc_queue_rows[field].count, "index %u", index);
    machine->calls++;
    return cnc_queue_rows[field].type == CNC_BIT ? (block + index) % 2 : (int64_t)(block * 7919u + index) * 100003;
}

static double queue_real(void *context, unsigned block, enum cnc_queue_field field, unsigned index)
{
    struct machine *machine = context;
    FUZZ_CHECK(field < CNC_QUEUE_FIELDS && cnc_queue_rows[field].type == CNC_REAL, "field %d", (int)field);
    FUZZ_CHECK(index < cnc_queue_rows[field].count, "index %u", index);
    machine->calls++;
    return (double)block * 1e300 - index;
}

static void seek_zero_pulse(void *context, unsigned axis)
{
    struct machine *machine = context;
    FUZZ_CHECK(axis < CNC_AXES, "axis %u", axis);
    machine->calls++;
}

static void report_event(void *context, enum cnc_plc_event event, int64_t value, uint32_t line)
{
    struct machine *machine = context;
    FUZZ_CHECK(line >= 1 && event <= CNC_PLC_FAULT && (event == CNC_PLC_ERROR_SET || value == 0), "line %u", line);
    machine->calls++;
}

static const struct cnc_plc_surroundings surroundings = {queue_number, queue_real, seek_zero_pulse, report_event};

/* What may only be read is as it was. */
static void check_cells(const struct cnc_cells *cells, const struct cnc_cells *before)
{
    for (unsigned i = 0; i < cnc_row_count; i++) {
        const struct cnc_row *row = &cnc_rows[i];
        if (row->writable || i == CNC_CELL_PLC_ERROR)
            continue;
        if (row->type == CNC_BIT)
            FUZZ_CHECK(memcmp(cells->bits + row->place, before->bits + row->place, row->count) == 0, "%s", row->name);
        else
            FUZZ_CHECK(memcmp(cells->memory + row->place, before->memory + row->place,
                              (size_t)row->count * cnc_type_size[row->type]) == 0, "%s", row->name);
    }
    for (unsigned i = 0; i < sizeof cells->bits; i++)
        FUZZ_CHECK(cells->bits[i] <= 1, "bit %u is %u", i, cells->bits[i]);
}

static void run(struct machine *machine)
{
    for (unsigned tick = 0; tick < TICKS; tick++) {
        machine->plc.dr = 1;
        for (unsigned section = CNC_PLC_SECTIONS; section-- > CNC_PLC_MAIN;) {
            bool has_ended = cnc_pass_plc(&machine->plc, &program, &machine->cells, (enum cnc_plc_section)section, &surroundings,
                                          machine);
            bool may_wait = section == CNC_PLC_BLOCK_INIT || section == CNC_PLC_BLOCK_DONE || machine->plc.is_halted;
            FUZZ_CHECK(has_ended || may_wait, "section %u waits", section);
        }
        if (tick == TICKS / 2)
            cnc_restart_section(&machine->plc, &program, CNC_PLC_BLOCK_INIT);
    }
}

static void run_program(void)
{
    static struct machine machine, twin, fresh;
    cnc_clear_cells(&fresh.cells);
    machine = fresh;
    cnc_begin_plc(&machine.plc, &program, &machine.cells);
    (void)cnc_pass_plc(&machine.plc, &program, &machine.cells, CNC_PLC_INIT, &surroundings, &machine);
    memcpy(&twin, &machine, sizeof twin);
    run(&machine);
    run(&twin);
    FUZZ_CHECK(memcmp(&machine.cells, &twin.cells, sizeof machine.cells) == 0, "the copy has other cells");
    FUZZ_CHECK(machine.plc.dr == twin.plc.dr && machine.calls == twin.calls, "the copy has another state");
    check_cells(&machine.cells, &fresh.cells);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct reading reading = {.lines = 1};
    for (size_t i = 0; i < size; i++)
        reading.lines += data[i] == '\n';
    bool is_right = cnc_translate_plc((const char *)data, size, &program, report_error, &reading);
    FUZZ_CHECK(is_right == (reading.errors == 0), "%u errors", reading.errors);
    if (is_right)
        run_program();
    return 0;
}
