/* SPDX-License-Identifier: MIT */
/* program.c: the PLC program in a T of the cnc (NT2, NT3, NE4). */
#include "frame.h"

#define START_REQUESTED 1 /* PLCEVENT_START_REQ, in DR */

/* One event of a kind in a T: a program may bring about thousands of them. */
static void report_once(struct cnc *cnc, enum cnc_event event, int64_t value)
{
    const uint32_t bit = (uint32_t)1 << event;
    if ((cnc->reported & bit) == 0)
        cnc_report_event(cnc, event, value);
    cnc->reported |= bit;
}

static void note_block(struct cnc *cnc, unsigned n)
{
    if (cnc_queue_has(cnc, n))
        return;
    cnc->beyond_queue++;
    report_once(cnc, CNC_EVENT_BEYOND_QUEUE, n);
}

static int64_t get_queue_number(void *context, unsigned n, enum cnc_queue_field field, unsigned index)
{
    note_block(context, n);
    return cnc_queue_number(context, n, field, index);
}

static double get_queue_real(void *context, unsigned n, enum cnc_queue_field field, unsigned index)
{
    note_block(context, n);
    return cnc_queue_real(context, n, field, index);
}

static void seek_zero_pulse(void *context, unsigned axis)
{
    cnc_position_spindle(context, axis);
}

static void report_program(void *context, enum cnc_plc_event event, int64_t value, uint32_t line)
{
    static const enum cnc_event ours[] = {[CNC_PLC_ERROR_SET] = CNC_EVENT_PLC_ERROR,
                                          [CNC_PLC_DIVISION] = CNC_EVENT_PLC_DIVISION,
                                          [CNC_PLC_FAULT] = CNC_EVENT_PLC_FAULT};
    report_once(context, ours[event], event == CNC_PLC_ERROR_SET ? value : (int64_t)line);
}

bool cnc_call_plc(struct cnc *cnc, enum cnc_plc_section section)
{
    static const struct cnc_plc_surroundings surroundings = {
        .queue_number = get_queue_number,
        .queue_real = get_queue_real,
        .seek_zero_pulse = seek_zero_pulse,
        .report = report_program,
    };
    if (cnc->plc_program == NULL)
        return true;
    return cnc_pass_plc(&cnc->plc, cnc->plc_program, &cnc->cells, section, &surroundings, cnc);
}

void cnc_rewind_plc(struct cnc *cnc, enum cnc_plc_section section)
{
    if (cnc->plc_program != NULL)
        cnc_restart_section(&cnc->plc, cnc->plc_program, section);
}

void cnc_call_start_event(struct cnc *cnc)
{
    cnc_rewind_plc(cnc, CNC_PLC_EVENT);
    cnc->plc.dr = START_REQUESTED;
    cnc_call_plc(cnc, CNC_PLC_EVENT);
}

void cnc_run_pass(struct cnc *cnc)
{
    struct cnc_machine *machine = &cnc->machine;
    if ((machine->phase != CNC_INIT && machine->phase != CNC_DONE) || machine->is_passed)
        return;
    if (!machine->text_passed)
        machine->text_passed = cnc_call_plc(cnc, machine->phase == CNC_INIT ? CNC_PLC_BLOCK_INIT : CNC_PLC_BLOCK_DONE);
    if (cnc_is_set(cnc, CNC_BIT_EXT_PLC) && cnc_is_set(cnc, CNC_BIT_PLC_PASS_DONE)) {
        cnc_set(cnc, CNC_BIT_PLC_PASS_DONE, false);
        machine->outside_passed = true;
    }
    machine->is_passed = machine->text_passed && (machine->outside_passed || !cnc_is_set(cnc, CNC_BIT_EXT_PLC));
}
