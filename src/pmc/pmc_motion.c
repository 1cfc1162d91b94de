/* SPDX-License-Identifier: MIT */
#include "pmc_motion.h"

#include "pmc_plan.h"
#include "pmc_report.h"
#include "ramp.h"

/* A number as the counter has it: 24 bits, two's complement. */
static int32_t wrapped(int64_t number)
{
    return (int32_t)(((uint64_t)number & 0xFFFFFF) ^ 0x800000) - 0x800000;
}

bool pmc_at_limit(const struct pmc_axis *axis, bool forward)
{
    return (axis->inputs & (forward ? PMC_LIMIT_PLUS : PMC_LIMIT_MINUS)) != 0;
}

/* A software limit in pulses, within the counter's range (AL1). */
static int32_t soft_limit(const struct pmc_axis *axis, bool forward)
{
    const int32_t units = axis->parameters.value[forward ? PMC_SOFT_PLUS : PMC_SOFT_MINUS];
    const int64_t pulses = pmc_pulses_of(&axis->parameters, 10 * (int64_t)units);
    if (pulses < PMC_COUNTER_MIN)
        return PMC_COUNTER_MIN;
    return pulses > PMC_COUNTER_MAX ? PMC_COUNTER_MAX : (int32_t)pulses;
}

/* ---- End ----------------------------------------------------------------------------------------------------------- */

/* No further pulse comes. */
static void end_motion(struct pmc_unit *unit, struct pmc_axis *axis, uint64_t tick)
{
    struct pmc_motion *motion = &axis->motion;
    motion->moving = false;
    motion->ramp.next = PMC_NEVER;
    motion->over = pmc_slot_at(motion->last + PMC_PULSE_TICKS);
    if (motion->over < tick)
        motion->over = tick;
    pmc_report(unit, axis, tick, PMC_EVENT_MOTION, 0);
}

void pmc_motion_finish(struct pmc_unit *unit, struct pmc_axis *axis)
{
    struct pmc_motion *motion = &axis->motion;
    if (!motion->active || motion->moving || motion->over > unit->now)
        return;
    motion->active = false;
    if (motion->limited && axis->commanded == soft_limit(axis, motion->forward))
        pmc_raise(unit, axis, motion->forward ? PMC_ERROR_SL_PLUS : PMC_ERROR_SL_MINUS);
}

void pmc_motion_stop_now(struct pmc_unit *unit, struct pmc_axis *axis)
{
    if (axis->motion.moving)
        end_motion(unit, axis, unit->now);
}

void pmc_motion_stop(struct pmc_unit *unit, struct pmc_axis *axis)
{
    struct pmc_motion *motion = &axis->motion;
    if (!motion->moving || motion->stopping)
        return;
    motion->stopping = true;
    if (!pmc_plan_stop(motion, &axis->parameters, unit->now))
        end_motion(unit, axis, unit->now);
}

/* ---- Begin --------------------------------------------------------------------------------------------------------- */

void pmc_motion_begin(struct pmc_unit *unit, struct pmc_axis *axis, const struct pmc_move *move)
{
    struct pmc_motion *motion = &axis->motion;
    motion->forward = move->way > 0;
    motion->endless = move->endless;
    motion->manual = move->manual;
    motion->total = (uint32_t)(motion->forward ? move->way : -move->way);
    motion->top = move->speed;
    motion->made = 0;
    motion->moving = motion->active = true;
    motion->stopping = motion->limited = false;
    if (axis->forward != motion->forward && unit->port->direction)
        unit->port->direction(unit->context, unit->now, pmc_index(unit, axis), motion->forward);
    axis->forward = motion->forward;
    pmc_report(unit, axis, unit->now, PMC_EVENT_MOTION, 1);
    pmc_plan_begin(motion, &axis->parameters, unit->now, move->speed, move->start_speed);
}

bool pmc_motion_move(struct pmc_unit *unit, struct pmc_axis *axis, const struct pmc_move *move)
{
    struct pmc_move limited = *move;
    const bool forward = move->way > 0;
    if (move->way == 0)
        return false;
    if (pmc_at_limit(axis, forward)) {
        pmc_raise(unit, axis, forward ? PMC_ERROR_HL_PLUS : PMC_ERROR_HL_MINUS);
        return false;
    }
    if (axis->parameters.value[PMC_FLAGS] & PMC_FLAG_SOFT_LIMITS) {
        const int64_t room = (int64_t)soft_limit(axis, forward) - axis->commanded; /* of the other sign: beyond the limit */
        const bool passes = move->endless || (forward ? move->way > room : move->way < room);
        if (passes && (forward ? room <= 0 : room >= 0)) {
            pmc_raise(unit, axis, forward ? PMC_ERROR_SL_PLUS : PMC_ERROR_SL_MINUS);
            return false;
        }
        if (passes) {
            limited.way = room;
            limited.endless = false;
        }
        pmc_motion_begin(unit, axis, &limited);
        axis->motion.limited = passes;
        return true;
    }
    pmc_motion_begin(unit, axis, &limited);
    return true;
}

/* ---- On the way ---------------------------------------------------------------------------------------------------- */

void pmc_motion_change_speed(struct pmc_unit *unit, struct pmc_axis *axis)
{
    struct pmc_motion *motion = &axis->motion;
    if (!motion->moving || !motion->manual || motion->stopping)
        return;
    if (pmc_plan_speed(motion, &axis->parameters, unit->now, axis->speed) && motion->top < axis->speed)
        motion->top = axis->speed;
}

void pmc_motion_watch(struct pmc_unit *unit, struct pmc_axis *axis)
{
    struct pmc_motion *motion = &axis->motion;
    if (!motion->moving || !pmc_at_limit(axis, motion->forward))
        return;
    pmc_raise(unit, axis, motion->forward ? PMC_ERROR_HL_PLUS : PMC_ERROR_HL_MINUS);
    if (axis->parameters.value[PMC_FLAGS] & PMC_FLAG_SLOW_LIMIT)
        pmc_motion_stop(unit, axis);
    else
        pmc_motion_stop_now(unit, axis);
}

static void count_pulses(struct pmc_axis *axis, uint32_t count)
{
    const int64_t change = axis->motion.forward ? (int64_t)count : -(int64_t)count;
    axis->motion.done += count;
    axis->motion.made += count;
    axis->commanded = wrapped(axis->commanded + change);
    axis->actual = wrapped(axis->actual + change);
}

/* Send pulses of one leg that are due up to `limit`, within the range of the counter, and end the motion at its last one. */
static void send_pulses(struct pmc_unit *unit, struct pmc_axis *axis, uint64_t limit)
{
    struct pmc_motion *motion = &axis->motion;
    uint64_t tick[64];
    const int32_t first = wrapped(axis->commanded + (motion->forward ? 1 : -1));
    size_t room = (size_t)(motion->forward ? PMC_COUNTER_MAX - first : first - PMC_COUNTER_MIN) + 1;
    if (room > sizeof tick / sizeof *tick)
        room = sizeof tick / sizeof *tick;
    const size_t count = pmc_plan_pulses(motion, limit, tick, room);
    if (count > 0) {
        motion->last = tick[count - 1];
        if (unit->port->steps)
            unit->port->steps(unit->context, pmc_index(unit, axis), tick, count, first, motion->forward);
        count_pulses(axis, (uint32_t)count);
    }
    if (motion->ramp.next == PMC_NEVER)
        end_motion(unit, axis, motion->last);
}

void pmc_motion_run(struct pmc_unit *unit, struct pmc_axis *axis, uint64_t limit)
{
    while (axis->motion.ramp.next <= limit) {
        if (!unit->port->steps)
            count_pulses(axis, ramp_skip(&axis->motion.ramp, limit, UINT32_MAX));
        send_pulses(unit, axis, limit);
    }
}
