/* SPDX-License-Identifier: MIT */
#include "apply.h"

#include "cib_report.h"
#include "drive.h"
#include "outputs.h"
#include "pwm.h"

void apply_setup(struct cib_unit *unit, const struct cib_setup *setup)
{
    unit->setup = *setup;
    unit->since = unit->now;
    unit->outputs = 0;
    pwm_reset(unit);
    for (unsigned i = 0; i < CIB_DRIVES; i++)
        drive_reset(unit, &unit->drive[i]);
    outputs_find_edge(unit, unit->now);
}

/* What of a drive has changed by it. */
static void report_drive(const struct cib_unit *unit, unsigned at, const struct cib_drive_state *before)
{
    const uint64_t tick = unit->now;
    const unsigned status = unit->drive[at].status;
    if (before->moving)
        report_event(unit, tick, at + 1, CIB_EVENT_MOTION, 0);
    if (before->position != 0)
        report_event(unit, tick, at + 1, CIB_EVENT_POSITION, 0);
    if (!before->forward && unit->port->direction)
        unit->port->direction(unit->context, tick, at + 1, true);
    if (before->status != status)
        report_event(unit, tick, at + 1, CIB_EVENT_STATUS, status);
}

void apply_proposal(struct cib_unit *unit)
{
    struct cib_drive_state before[CIB_DRIVES];
    uint16_t duty[CIB_OUTPUTS];
    const struct cib_setup proposal = unit->proposal;
    unit->result = cib_check_setup(&proposal, unit->config.firmware);
    report_event(unit, unit->now, 0, CIB_EVENT_APPLY, unit->result);
    if (unit->result != 0)
        return;
    for (unsigned i = 0; i < CIB_DRIVES; i++)
        cib_drive_state(unit, i, &before[i]);
    for (unsigned i = 0; i < CIB_OUTPUTS; i++)
        duty[i] = unit->pwm[i].duty;
    apply_setup(unit, &proposal);
    for (unsigned i = 0; i < CIB_DRIVES; i++)
        report_drive(unit, i, &before[i]);
    for (unsigned i = 0; i < CIB_OUTPUTS; i++)
        if (duty[i] != 0)
            report_event(unit, unit->now, i + 1, CIB_EVENT_DUTY, 0);
    outputs_changed(unit, unit->now);
}
