/* SPDX-License-Identifier: MIT */
#include <check.h>
#include <stdio.h>
#include <string.h>

#include "plc_rig.h"
#include "text_rig.h"

struct plc_rig rig;

static int64_t queue_number(void *context, unsigned block, enum cnc_queue_field field, unsigned index)
{
    struct plc_rig *own = context;
    return block < 3 ? own->queue[block][field][index] : 0;
}

static double queue_real(void *context, unsigned block, enum cnc_queue_field field, unsigned index)
{
    struct plc_rig *own = context;
    return block < 3 ? own->queue_real[block][field][index] : 0;
}

static void seek_zero_pulse(void *context, unsigned axis)
{
    struct plc_rig *own = context;
    own->axes |= 1u << axis;
}

static void report_event(void *context, enum cnc_plc_event event, int64_t value, uint32_t line)
{
    struct plc_rig *own = context;
    own->event = event;
    own->event_value = value;
    own->event_line = line;
    own->events++;
}

const struct cnc_plc_surroundings plc_rig_surroundings = {queue_number, queue_real, seek_zero_pulse, report_event};

static void report_error(void *context, const struct cnc_text_error *error)
{
    struct plc_rig *own = context;
    size_t at = strlen(own->errors);
    snprintf(own->errors + at, sizeof own->errors - at, "%u:%u: %s\n", error->line, error->column, error->text);
    own->error_count++;
}

bool rig_translate(const char *text)
{
    memset(&rig, 0, sizeof rig);
    return cnc_translate_plc(text_before_hole(text, strlen(text)), strlen(text), &rig.program, report_error, &rig);
}

void rig_load(const char *text)
{
    ck_assert_msg(rig_translate(text), "%s", rig.errors);
    cnc_clear_cells(&rig.cells);
    cnc_begin_plc(&rig.plc, &rig.program, &rig.cells);
    ck_assert(rig_pass(CNC_PLC_INIT));
}

bool rig_pass(enum cnc_plc_section section)
{
    return cnc_pass_plc(&rig.plc, &rig.program, &rig.cells, section, &plc_rig_surroundings, &rig);
}

static struct cnc_operand find(const char *text)
{
    struct cnc_operand operand;
    struct cnc_text_fault fault;

    ck_assert_msg(cnc_parse_operand(text, strlen(text), &rig.program.names, &operand, &fault), "%s: %s", text, fault.reason);
    return operand;
}

int64_t rig_value(const char *text)
{
    struct cnc_operand operand = find(text);

    if (operand.kind == CNC_OPERAND_BIT)
        return cnc_bit(&rig.cells, operand.place);
    return cnc_read_number(&rig.cells, operand.place, (enum cnc_type)operand.type);
}

double rig_real(const char *text)
{
    return cnc_read_real(&rig.cells, find(text).place);
}

void rig_put(const char *text, int64_t value)
{
    struct cnc_operand operand = find(text);

    if (operand.kind == CNC_OPERAND_BIT)
        cnc_put_bit(&rig.cells, operand.place, value != 0);
    else
        cnc_write_number(&rig.cells, operand.place, (enum cnc_type)operand.type, value);
}

int64_t rig_run(const char *data, const char *lines)
{
    char text[4000];

    snprintf(text, sizeof text, "DATA\n%s\nDATA_END\nMODULE_MAIN\n%s\nMODULE_MAIN_END\n", data, lines);
    rig_load(text);
    ck_assert_msg(rig_pass(CNC_PLC_MAIN), "%s", lines);
    return rig.plc.dr;
}
