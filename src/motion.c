/* SPDX-License-Identifier: MIT */
#include "motion.h"

#include "profile.h"
#include "ramp.h"
#include "reading.h"
#include "report.h"

uint64_t motion_free_from(const struct rkm04_unit *unit, const struct rkm04_motor *motor)
{
    uint64_t free_from = motor->last_pulse + RKM04_PULSE_TICKS;
    return free_from > unit->now ? free_from : unit->now; /* without a pulse: long before the first slot */
}

/* ---- End ------------------------------------------------------------------------------------------------------------ */

/* The motion is over, at `tick`: at its last pulse, or in the slot that ended it without one. */
static void end_motion(struct rkm04_unit *unit, struct rkm04_motor *motor, uint64_t tick)
{
    struct rkm04_motion *motion = &motor->motion;
    motion->moving = false;
    motion->ramp.next = RKM04_NEVER;
    motor->change_speed = 0;
    if (motor->led == RKM04_LED_ON)
        write_led(unit, motor, tick, RKM04_LED_OFF);
    if (unit->simulation)
        report_event(unit, motor, tick, RKM04_EVENT_POSITION, (uint32_t)motor->position);
    report_event(unit, motor, tick, RKM04_EVENT_MOTION, 0);
    motor->due = motor->last_pulse + RKM04_PULSE_TICKS;
    switch ((enum rkm04_after)motor->after) {
    case RKM04_AFTER_GO_ON:
        motor->state = RKM04_READY;
        break;
    case RKM04_AFTER_HOLD_REST:
        motor->state = RKM04_HELD;
        motor->held = RKM04_MOVING;
        break;
    case RKM04_AFTER_HOLD_NEXT:
        motor->state = RKM04_HELD;
        motor->held = RKM04_READY;
        break;
    case RKM04_AFTER_END:
        motor->state = RKM04_ENDED;
        report_event(unit, motor, tick, RKM04_EVENT_COMMAND, 0);
        break;
    }
    if (motor->after != RKM04_AFTER_HOLD_REST)
        motion->kind = RKM04_MOTION_NONE;
}

void motion_abort(struct rkm04_unit *unit, struct rkm04_motor *motor)
{
    if (motor->motion.moving) {
        motor->after = RKM04_AFTER_GO_ON;
        end_motion(unit, motor, unit->now);
    }
    motor->motion.kind = RKM04_MOTION_NONE;
}

/* ---- Guards (C5) ------------------------------------------------------------------------------------------------------ */

/* Use up the guards whose condition holds. Returns whether there was one. Before a motion begins there may be none yet (reading
 * `guard-start`). */
static bool use_guards(const struct rkm04_unit *unit, struct rkm04_motor *motor)
{
    if (READING(unit, guard_start) && !motor->motion.moving)
        return false;
    bool m = motor->guard_m != 0 && input_is_high(unit, motor->guard_m);
    bool n = motor->guard_n != 0 && !input_is_high(unit, motor->guard_n);
    if (m)
        motor->guard_m = 0;
    if (n)
        motor->guard_n = 0;
    return m || n;
}

void motion_check_inputs(struct rkm04_unit *unit, struct rkm04_motor *motor)
{
    struct rkm04_motion *motion = &motor->motion;
    if (motion->moving && !motion->stopping && use_guards(unit, motor))
        motion_stop(unit, motor, RKM04_AFTER_GO_ON);
    /* Also on the way to the last step of a stop: no pulse after the slot that saw the input (R5), and no rest of the move. */
    if (motion->moving && motion->kind == RKM04_MOTION_LIMIT && input_is_high(unit, motion->input)) {
        if (motor->after == RKM04_AFTER_HOLD_REST)
            motor->after = RKM04_AFTER_HOLD_NEXT;
        end_motion(unit, motor, unit->now);
    }
}

/* ---- Begin ------------------------------------------------------------------------------------------------------------ */

/* From here on the outputs move: direction, LED, pulse generator. */
static void start_outputs(struct rkm04_unit *unit, struct rkm04_motor *motor)
{
    struct rkm04_motion *motion = &motor->motion;
    if (motor->pin_forward != motion->forward) {
        motor->pin_forward = motion->forward;
        if (!unit->simulation)
            report_direction(unit, motor, unit->now, motion->forward);
    }
    write_led(unit, motor, unit->now, RKM04_LED_ON);
    report_event(unit, motor, unit->now, RKM04_EVENT_MOTION, 1);
    profile_plan(motion);
    ramp_begin(&motion->ramp, &motion->profile, unit->now, RKM04_TICKS_PER_SECOND);
    motion->moving = true;
    motion->stopping = false;
    motor->after = RKM04_AFTER_GO_ON;
    motor->state = RKM04_MOVING;
    if (READING(unit, guard_start))
        unit->touched = true; /* the next slot checks M and N */
}

/* Prepare a motion of one segment with the present parameters. Returns false if a guard ends it before its first step. */
static bool prepare_motion(struct rkm04_unit *unit, struct rkm04_motor *motor, enum rkm04_motion_kind kind, bool forward)
{
    struct rkm04_motion *motion = &motor->motion;
    if (use_guards(unit, motor))
        return false;
    motion->kind = (uint8_t)kind;
    motion->forward = forward;
    motion->done = 0;
    motion->total = 0;
    motion->mark = 0;
    motion->changed = false;
    motion->start_speed = motor->start_speed;
    motion->segments = 1;
    motion->segment[0] = (struct rkm04_segment){
        .speed = motor->speed, .acceleration = motor->acceleration, .deceleration = motor->acceleration};
    motion->profile.count = 0;
    return true;
}

void motion_begin_steps(struct rkm04_unit *unit, struct rkm04_motor *motor, uint32_t steps, bool forward)
{
    if (steps == 0 || !prepare_motion(unit, motor, RKM04_MOTION_STEPS, forward))
        return;
    motor->motion.segment[0].steps = steps;
    motor->motion.total = steps;
    start_outputs(unit, motor);
}

void motion_begin_endless(struct rkm04_unit *unit, struct rkm04_motor *motor, bool forward)
{
    if (prepare_motion(unit, motor, RKM04_MOTION_ENDLESS, forward))
        start_outputs(unit, motor);
}

void motion_begin_limit(struct rkm04_unit *unit, struct rkm04_motor *motor, bool forward, unsigned input)
{
    if (input_is_high(unit, input) || !prepare_motion(unit, motor, RKM04_MOTION_LIMIT, forward))
        return;
    motor->motion.input = (uint8_t)input;
    motor->motion.segment[0].speed = motor->start_speed;
    start_outputs(unit, motor);
}

bool motion_compound_possible(const struct rkm04_motor *motor)
{
    uint64_t steps = 0;
    if (motor->segments > RKM04_SEGMENTS_MAX || motor->segments_bad)
        return false;
    for (unsigned i = 0; i < motor->segments; i++)
        steps += motor->segment[i].steps;
    return steps <= RKM04_COMPOUND_STEPS_MAX;
}

void motion_begin_compound(struct rkm04_unit *unit, struct rkm04_motor *motor)
{
    struct rkm04_motion *motion = &motor->motion;
    unsigned segments = motor->segments;
    motor->segments = 0;
    if (!prepare_motion(unit, motor, RKM04_MOTION_STEPS, motor->segments_forward))
        return;
    motion->segments = (uint8_t)segments;
    motion->marks = motor->segments_marks & motor->functions;
    for (unsigned i = 0; i < segments; i++) {
        motion->segment[i] = motor->segment[i];
        motion->mark = motion->total;
        motion->total += motor->segment[i].steps;
    }
    if (segments == 1)
        write_outputs(unit, unit->now, unit->outputs | motion->marks);
    if (motion->marks == 0)
        motion->mark = 0;
    start_outputs(unit, motor);
}

/* ---- Stop, hold, rest ------------------------------------------------------------------------------------------------- */

void motion_stop(struct rkm04_unit *unit, struct rkm04_motor *motor, enum rkm04_after after)
{
    motor->motion.stopping = true;
    motor->after = (uint8_t)after;
    if (!profile_stop(&motor->motion, unit->now))
        end_motion(unit, motor, unit->now);
}

void motion_resume(struct rkm04_unit *unit, struct rkm04_motor *motor)
{
    struct rkm04_motion *motion = &motor->motion;
    bool over = motion->kind == RKM04_MOTION_STEPS && motion->done == motion->total;
    bool at_limit = motion->kind == RKM04_MOTION_LIMIT && input_is_high(unit, motion->input);
    if (!over && !at_limit && !use_guards(unit, motor)) {
        start_outputs(unit, motor);
        return;
    }
    motion->kind = RKM04_MOTION_NONE;
    motor->state = RKM04_READY;
    motor->due = unit->now + (over ? 0 : RKM04_SLOT_TICKS); /* no further step takes its one slot (K4) */
}

/* ---- Pulses ----------------------------------------------------------------------------------------------------------- */

static void count_pulses(struct rkm04_motor *motor, uint32_t count)
{
    uint32_t position = (uint32_t)motor->position;
    motor->position = (int32_t)(motor->motion.forward ? position + count : position - count);
    motor->motion.done += count;
}

/* Send up to `room` pulses due up to `limit`, and end the motion at its last one. */
static void run_pulses(struct rkm04_unit *unit, struct rkm04_motor *motor, uint64_t limit, uint32_t room)
{
    struct rkm04_motion *motion = &motor->motion;
    uint64_t tick[64];
    const uint32_t most = sizeof tick / sizeof *tick;
    size_t count = ramp_pulses(&motion->ramp, &motion->profile, limit, tick, room < most ? room : most);
    if (count > 0) {
        motor->last_pulse = tick[count - 1];
        report_steps(unit, motor, tick, count);
        count_pulses(motor, (uint32_t)count);
    }
    if (motion->ramp.next == RKM04_NEVER)
        end_motion(unit, motor, motor->last_pulse);
}

/* Pulses that may be sent before the one that sets outputs. */
static uint32_t room_before_mark(const struct rkm04_motion *motion)
{
    return motion->done < motion->mark ? motion->mark - motion->done - 1 : UINT32_MAX;
}

void motion_run(struct rkm04_unit *unit, struct rkm04_motor *motor, uint64_t limit)
{
    struct rkm04_motion *motion = &motor->motion;
    while (motion->ramp.next <= limit) {
        uint32_t room = room_before_mark(motion);
        if (room == 0)
            return;
        if (!pulses_are_seen(unit)) {
            count_pulses(motor, ramp_skip(&motion->ramp, limit, room));
            room = room_before_mark(motion);
        }
        run_pulses(unit, motor, limit, room);
    }
}

uint64_t motion_next_report(const struct rkm04_unit *unit, const struct rkm04_motor *motor)
{
    const struct rkm04_motion *motion = &motor->motion;
    return pulses_are_seen(unit) ? motion->ramp.next : ramp_quiet_pulses(&motion->ramp, room_before_mark(motion));
}

uint64_t motion_mark_due(const struct rkm04_motor *motor)
{
    return room_before_mark(&motor->motion) == 0 ? motor->motion.ramp.next : RKM04_NEVER;
}

void motion_pass_mark(struct rkm04_unit *unit, struct rkm04_motor *motor)
{
    struct rkm04_motion *motion = &motor->motion;
    uint32_t before = motion->done;
    run_pulses(unit, motor, motion->ramp.next, 1);
    if (motion->done != before) /* it may have been the change to the next leg only */
        write_outputs(unit, motor->last_pulse, unit->outputs | motion->marks);
}
