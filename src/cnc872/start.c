/* SPDX-License-Identifier: MIT */
/* start.c: starts, stops and restarts (NE4, NB3, NB7). */
#include "frame.h"

#define SHORTEST_STOPPI 200u /* T's */

enum cnc_result cnc_start_refusal(const struct cnc *cnc)
{
    const struct cnc_machine *machine = &cnc->machine;
    if (cnc_is_set(cnc, CNC_BIT_START_DISABLE))
        return CNC_DISABLED;
    if (cnc->program == NULL || cnc->program->block_count == 0)
        return CNC_NO_PROGRAM;
    if (machine->annulment != CNC_ANNULMENT_NONE || (machine->phase != CNC_IDLE && !cnc_is_set(cnc, CNC_BIT_PO_STOP)))
        return cnc->machine.is_reference ? CNC_IN_REFERENCE : CNC_UNDER_WAY;
    if (cnc_is_set(cnc, CNC_BIT_ACK_AUTMAN))
        return CNC_MANUAL;
    if (cnc_number(&cnc->cells, CNC_CELL_BZH13, 0) != 0)
        return CNC_CRITICAL;
    if (cnc_is_set(cnc, CNC_BIT_STOPPI))
        return CNC_STOPPI;
    const int64_t homing = cnc_number(&cnc->cells, CNC_CELL_HOMING, 0);
    for (unsigned i = 0; i < CNC_AXES; i++)
        if (cnc_has_axis(cnc->program_axes, i) && cnc->config->axis[i].needs_reference && (homing >> i & 1) == 0)
            return CNC_NO_REFERENCE;
    return CNC_OK;
}

/* Drop the start, and say why. */
static enum cnc_result refuse(struct cnc *cnc, enum cnc_result why)
{
    cnc->machine.start = CNC_START_NONE;
    cnc_report_event(cnc, CNC_EVENT_START_REFUSED, why);
    return why;
}

enum cnc_result cnc_start(struct cnc *cnc)
{
    const enum cnc_result why = cnc_start_refusal(cnc);
    if (why != CNC_OK)
        return refuse(cnc, why);
    if (cnc->machine.start == CNC_START_NONE)
        cnc->machine.start = CNC_START_ASKED;
    return CNC_OK;
}

void cnc_begin_start(struct cnc *cnc)
{
    if (cnc->machine.start != CNC_START_ASKED)
        return;
    const enum cnc_result why = cnc_start_refusal(cnc);
    if (why != CNC_OK) {
        refuse(cnc, why);
        return;
    }
    cnc->machine.start = CNC_START_WAITS;
    cnc_set(cnc, CNC_BIT_START_SUSPEND, false);
    cnc_call_start_event(cnc);
}

/* The stopped block from its INIT pass on, or the rest of its DONE pass (NB7). */
static void restart_block(struct cnc *cnc)
{
    struct cnc_machine *machine = &cnc->machine;
    if (machine->phase != CNC_DONE) {
        cnc_set(cnc, CNC_BIT_BLOCK_RESTART, true);
        cnc_begin_phase(cnc, CNC_INIT);
    } else if (machine->is_passed) {
        cnc_end_block(cnc);
    }
}

bool cnc_finish_start(struct cnc *cnc)
{
    struct cnc_machine *machine = &cnc->machine;
    if (machine->start != CNC_START_WAITS)
        return false;
    const enum cnc_result why = cnc_start_refusal(cnc);
    if (why != CNC_OK)
        refuse(cnc, why);
    if (why != CNC_OK || cnc_is_set(cnc, CNC_BIT_START_SUSPEND))
        return false;
    const bool is_restart = machine->is_stopped;
    machine->start = CNC_START_NONE;
    machine->is_stopped = machine->was_stop = false;
    cnc_set(cnc, CNC_BIT_SF_STOP, false);
    cnc_set(cnc, CNC_BIT_PO_STOP, false);
    if (is_restart)
        restart_block(cnc);
    else
        cnc_publish_block(cnc);
    return true;
}

/* The rising edge of STOPPI; the length of its pulse is looked at (NB3). */
static bool watch_stoppi(struct cnc *cnc)
{
    struct cnc_machine *machine = &cnc->machine;
    const bool stoppi = cnc_is_set(cnc, CNC_BIT_STOPPI);
    const bool rises = stoppi && !machine->was_stoppi;
    if (!stoppi && machine->was_stoppi && machine->stoppi_turns < SHORTEST_STOPPI)
        cnc_report_event(cnc, CNC_EVENT_SHORT_STOPPI, machine->stoppi_turns);
    if (rises)
        machine->stoppi_turns = 0;
    if (stoppi && machine->stoppi_turns < SHORTEST_STOPPI)
        machine->stoppi_turns++;
    machine->was_stoppi = stoppi;
    return rises;
}

void cnc_take_stop(struct cnc *cnc)
{
    struct cnc_machine *machine = &cnc->machine;
    const bool emergency = cnc_is_set(cnc, CNC_BIT_STOP_EMERGENCY_REQ);
    const bool by_bits = watch_stoppi(cnc) || cnc_is_set(cnc, CNC_BIT_STOP_REQ) || emergency;
    const bool stop = by_bits || machine->stop_requested;
    machine->stop_requested = false;
    cnc_set(cnc, CNC_BIT_STOP_REQ, false);
    cnc_set(cnc, CNC_BIT_STOP_EMERGENCY_REQ, false);
    if (!stop)
        return;
    /* The panel's STOP has dropped what came before it; bits have no order: the stop counts. */
    if (machine->start == CNC_START_WAITS && (by_bits || cnc_is_set(cnc, CNC_BIT_START_SUSPEND)))
        refuse(cnc, CNC_STOPPED);
    cnc_stop_manual(cnc, emergency);
    cnc_stop_references(cnc, emergency);
    if (machine->block == CNC_NO_BLOCK)
        return;
    if (emergency)
        machine->stop = CNC_HOLD_EMERGENCY;
    else if (!machine->is_stopped)
        machine->stop = CNC_HOLD_STOP;
    machine->is_stopped = true;
}

void cnc_stop(struct cnc *cnc)
{
    if (cnc->machine.start == CNC_START_ASKED) /* it came before the stop */
        refuse(cnc, CNC_STOPPED);
    cnc->machine.stop_requested = true;
}

void cnc_reset(struct cnc *cnc)
{
    cnc->machine.stop_requested = true;
    if (cnc->machine.annulment == CNC_ANNULMENT_NONE)
        cnc->machine.annulment = CNC_ANNULMENT_ASKED;
    if (cnc->machine.start != CNC_START_NONE)
        refuse(cnc, CNC_STOPPED);
}
