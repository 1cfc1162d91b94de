/* SPDX-License-Identifier: MIT */
#include "pmc_report.h"

void pmc_report(struct pmc_unit *unit, struct pmc_axis *axis, uint64_t tick, enum pmc_event what, uint32_t value)
{
    if (unit->port->event)
        unit->port->event(unit->context, tick, pmc_index(unit, axis), what, value);
}

void pmc_write_outputs(struct pmc_unit *unit, uint8_t outputs)
{
    if (unit->outputs == outputs)
        return;
    unit->outputs = outputs;
    if (unit->port->outputs)
        unit->port->outputs(unit->context, unit->now, outputs);
}

void pmc_end_program(struct pmc_unit *unit, struct pmc_axis *axis)
{
    axis->running = axis->run_after = axis->after_move = false;
    if (axis->executing)
        pmc_report(unit, axis, unit->now, PMC_EVENT_COMMAND, 0);
    axis->executing = false;
}

void pmc_raise(struct pmc_unit *unit, struct pmc_axis *axis, unsigned errors)
{
    const uint8_t before = axis->errors;
    axis->errors = (uint8_t)(axis->errors | errors);
    if (axis->errors != before)
        pmc_report(unit, axis, unit->now, PMC_EVENT_ERRORS, axis->errors);
    pmc_end_program(unit, axis);
}

void pmc_clear_errors(struct pmc_unit *unit, struct pmc_axis *axis)
{
    if (axis->errors != 0)
        pmc_report(unit, axis, unit->now, PMC_EVENT_ERRORS, 0);
    axis->errors = 0;
    axis->not_homed = false;
}

void pmc_set_commanded(struct pmc_unit *unit, struct pmc_axis *axis, int32_t position)
{
    if (axis->commanded != position)
        pmc_report(unit, axis, unit->now, PMC_EVENT_POSITION, (uint32_t)position);
    axis->commanded = position;
}
