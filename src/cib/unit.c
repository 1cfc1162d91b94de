/* SPDX-License-Identifier: MIT */
#include "cib.h"

#include "apply.h"
#include "cib_report.h"
#include "drive.h"
#include "outputs.h"
#include "phase.h"
#include "ramp.h"

void cib_begin(struct cib_unit *unit, const struct cib_config *config, const struct cib_port *port, void *context)
{
    uint8_t *byte = (uint8_t *)unit; /* not from a second unit on the stack */
    for (size_t i = 0; i < sizeof *unit; i++)
        byte[i] = 0;
    unit->config = *config;
    unit->proposal = config->setup;
    unit->port = port;
    unit->context = context;
    unit->stop_slot = CIB_NEVER;
    for (unsigned i = 0; i < CIB_INPUTS; i++)
        unit->input_due[i] = CIB_NEVER;
    cib_note_request(unit);
    apply_setup(unit, &config->setup);
}

void cib_attach(struct cib_unit *unit, const struct cib_port *port, void *context)
{
    unit->port = port;
    unit->context = context;
    outputs_attach(unit);
}

uint64_t cib_now(const struct cib_unit *unit)
{
    return unit->now;
}

/* ---- Inputs and buttons (BU2, BU7) --------------------------------------------------------------------------------- */

uint8_t cib_inputs(const struct cib_unit *unit)
{
    return unit->lines;
}

/* Inputs that show what they have been at for long enough in front of what happens at `tick`. */
static uint8_t shown_at(const struct cib_unit *unit, uint64_t tick)
{
    unsigned shown = unit->shown;
    for (unsigned i = 0; i < CIB_INPUTS; i++)
        if (unit->input_due[i] <= tick)
            shown ^= 1u << i;
    return (uint8_t)shown;
}

uint8_t cib_shown_inputs(const struct cib_unit *unit)
{
    return shown_at(unit, unit->now);
}

static void show_inputs(struct cib_unit *unit, uint64_t tick)
{
    const uint8_t shown = shown_at(unit, tick);
    for (unsigned i = 0; i < CIB_INPUTS; i++)
        if (unit->input_due[i] <= tick)
            unit->input_due[i] = CIB_NEVER;
    if (shown != unit->shown)
        report_event(unit, tick, 0, CIB_EVENT_INPUTS, shown);
    unit->shown = shown;
}

void cib_set_inputs(struct cib_unit *unit, uint8_t mask)
{
    const unsigned changed = unit->lines ^ mask;
    const uint64_t due = unit->now == 0 ? 0 : unit->now + CIB_INPUT_TICKS; /* those of power-up show at once */
    show_inputs(unit, unit->now);
    for (unsigned i = 0; i < CIB_INPUTS; i++)
        if ((changed >> i & 1) != 0)
            unit->input_due[i] = ((mask ^ unit->shown) >> i & 1) != 0 ? due : CIB_NEVER;
    unit->lines = mask;
    show_inputs(unit, unit->now);
}

void cib_set_buttons(struct cib_unit *unit, uint8_t mask)
{
    unit->buttons = mask;
    outputs_changed(unit, unit->now);
}

/* ---- No requests (BC9) --------------------------------------------------------------------------------------------- */

void cib_note_request(struct cib_unit *unit)
{
    const uint32_t limit = unit->config.comm_timeout;
    unit->request_due = limit > 0 ? unit->now + (uint64_t)limit * (CIB_TICKS_PER_SECOND / 1000) : CIB_NEVER;
}

static void miss_request(struct cib_unit *unit, uint64_t tick)
{
    unit->request_due = CIB_NEVER;
    unit->stop_slot = drive_slot_from(tick);
    report_event(unit, tick, 0, CIB_EVENT_TIMEOUT, 0);
}

/* ---- Time (section 2) ---------------------------------------------------------------------------------------------- */

static uint64_t earlier(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

static uint64_t next_input(const struct cib_unit *unit)
{
    uint64_t next = CIB_NEVER;
    for (unsigned i = 0; i < CIB_INPUTS; i++)
        next = earlier(next, unit->input_due[i]);
    return next;
}

/* What is due besides inputs, pulses and edges. */
static uint64_t next_due(const struct cib_unit *unit)
{
    uint64_t next = earlier(unit->request_due, unit->stop_slot);
    for (unsigned i = 0; i < CIB_DRIVES; i++)
        next = earlier(next, drive_next_due(&unit->drive[i]));
    return next;
}

static void do_due(struct cib_unit *unit, uint64_t tick)
{
    for (unsigned i = 0; i < CIB_DRIVES; i++)
        drive_do_due(unit, &unit->drive[i], tick);
    if (unit->request_due == tick)
        miss_request(unit, tick);
    for (unsigned i = 0; i < CIB_DRIVES; i++)
        drive_do_slot(unit, &unit->drive[i], tick);
    if (unit->stop_slot == tick)
        unit->stop_slot = CIB_NEVER;
}

/* Pulses and edges up to `limit` in the order of time; in one tick first those of drive A, then B. Returns false if one led to
 * something that may be due. */
static bool run_in_order(struct cib_unit *unit, uint64_t limit)
{
    struct cib_drive *const a = &unit->drive[0], *const b = &unit->drive[1];
    for (;;) {
        const uint64_t of_a = drive_next_pulse(a), of_b = drive_next_pulse(b), edge = unit->edge;
        if (earlier(earlier(of_a, of_b), edge) > limit)
            return true;
        const uint64_t until = earlier(limit, edge);
        if (of_a <= earlier(of_b, until)) {
            if (!drive_run(unit, a, earlier(of_b, until)))
                return false;
        } else if (of_b <= until) {
            if (!drive_run(unit, b, earlier(of_a - 1, until)))
                return false;
        } else {
            outputs_pass_edge(unit, edge);
        }
    }
}

/* Pulses and edges up to and including `limit`; the drives meet in nothing but the order of what is reported. */
static bool run_until(struct cib_unit *unit, uint64_t limit)
{
    if (unit->port->outputs || unit->port->edges)
        return run_in_order(unit, limit);
    bool done = true;
    for (unsigned i = 0; i < CIB_DRIVES; i++)
        done = drive_run(unit, &unit->drive[i], limit) && done;
    return done;
}

void cib_advance(struct cib_unit *unit, uint64_t ticks)
{
    const uint64_t end = unit->now > CIB_NEVER - ticks ? CIB_NEVER : unit->now + ticks;
    while (unit->now < end) {
        const uint64_t input = next_input(unit);
        if (input <= unit->now)
            show_inputs(unit, unit->now);
        const uint64_t due = next_due(unit), last = earlier(end, next_input(unit)) - 1, limit = earlier(due, last);
        if (!run_until(unit, limit))
            continue;
        if (due == limit)
            do_due(unit, due);
        unit->now = limit + 1;
    }
}

uint64_t cib_next_event(const struct cib_unit *unit)
{
    uint64_t next = earlier(earlier(next_input(unit), next_due(unit)), unit->edge);
    for (unsigned i = 0; i < CIB_DRIVES; i++)
        next = earlier(next, drive_next_pulse(&unit->drive[i]));
    return next > unit->now ? next : unit->now;
}

uint64_t cib_next_report(const struct cib_unit *unit)
{
    uint64_t next = earlier(earlier(next_input(unit), next_due(unit)), unit->edge);
    for (unsigned i = 0; i < CIB_DRIVES; i++)
        next = earlier(next, drive_next_report(unit, &unit->drive[i]));
    return next > unit->now ? next : unit->now;
}

/* ---- What can be seen ---------------------------------------------------------------------------------------------- */

/* With its sign, cut to a whole number. */
static int32_t speed_of(const struct rkm04_motion *motion, uint64_t tick)
{
    struct rkm04_fixed y, w;
    if (!motion->moving)
        return 0;
    ramp_state_at(&motion->ramp, tick, &y, &w);
    const int32_t speed = (int32_t)(w.whole / ramp_speed_unit(&motion->ramp));
    return motion->forward ? speed : -speed;
}

void cib_drive_state(const struct cib_unit *unit, unsigned at, struct cib_drive_state *state)
{
    const struct cib_drive *drive = &unit->drive[at];
    const struct rkm04_motion *motion = &drive->motion;
    *state = (struct cib_drive_state){.configured = cib_has_drive(unit, at),
                                      .position = drive->position,
                                      .speed = speed_of(motion, unit->now),
                                      .steps = motion->done,
                                      .status = drive->status,
                                      .error = drive->error,
                                      .ack = drive->ack,
                                      .start_speed = drive->start_speed,
                                      .acceleration = drive->acceleration,
                                      .deceleration = drive->deceleration,
                                      .stop_deceleration = drive->stop_deceleration,
                                      .moving = motion->moving,
                                      .stopping = motion->moving && drive_is_stopping(drive),
                                      .turning = motion->moving && drive_is_turning(drive),
                                      .waiting = drive->slot != CIB_NEVER,
                                      .forward = (drive->status & CIB_DIR) == 0,
                                      .off = drive->off};
    if (drive->started)
        state->row = drive->row == 0 ? (uint16_t)phase_rows(unit->setup.drive[at].mode) : drive->row;
}
