/* SPDX-License-Identifier: MIT */
#include "interp.h"

#include "execute.h"
#include "motion.h"
#include "profile.h"
#include "program.h"
#include "ramp.h"
#include "reading.h"
#include "report.h"

uint64_t interp_slot(uint64_t tick)
{
    if (tick > UINT64_MAX - RKM04_SLOT_TICKS)
        return RKM04_NEVER;
    uint64_t slot = (tick + RKM04_SLOT_TICKS - 1) / RKM04_SLOT_TICKS * RKM04_SLOT_TICKS;
    return slot ? slot : RKM04_SLOT_TICKS;
}

static uint64_t later(uint64_t a, uint64_t b)
{
    return a > b ? a : b;
}

static bool is_at_rest(const struct rkm04_motor *motor)
{
    return motor->state == RKM04_HELD || motor->state == RKM04_ENDED || motor->state == RKM04_FAULTY;
}

unsigned interp_index(const struct rkm04_motor *motor)
{
    uint64_t number = motor->number, oldest = program_oldest(&motor->program);
    if (is_at_rest(motor) && motor->fresh != RKM04_NEVER)
        number = later(motor->fresh, oldest);
    else if (motor->state == RKM04_IDLE || motor->state == RKM04_ENDED)
        return 0;
    else if (motor->state == RKM04_HELD && motor->held == RKM04_READY && motor->next < motor->program.written)
        number = later(motor->next, oldest);
    return program_place(number);
}

/* ---- What arrives ----------------------------------------------------------------------------------------------------- */

static void clear_stacks(struct rkm04_motor *motor)
{
    motor->loops = 0;
    motor->calls = 0;
}

void interp_reset(struct rkm04_unit *unit, struct rkm04_motor *motor)
{
    bool busy = interp_index(motor) != 0;
    motion_abort(unit, motor);
    write_led(unit, motor, unit->now, RKM04_LED_OFF);
    program_clear(&motor->program);
    clear_stacks(motor);
    motor->next = 0;
    motor->fresh = RKM04_NEVER;
    motor->wake = RKM04_NEVER;
    motor->state = RKM04_IDLE;
    motor->resume = false;
    motor->pendings = 0;
    motor->start_speed = 100; /* U8 */
    motor->speed = 1000;
    motor->acceleration = 2000;
    motor->forward = true;
    motor->count = 0;
    motor->segments = 0;
    motor->functions = 0;
    motor->keep = false;
    motor->guard_m = motor->guard_n = motor->guard_x = 0;
    if (READING(unit, reset_t41))
        execute_simulate(unit, false);
    if (motor->fault != RKM04_FAULT_NONE) {
        motor->fault = RKM04_FAULT_NONE;
        report_event(unit, motor, unit->now, RKM04_EVENT_FAULT, RKM04_FAULT_NONE);
    }
    if (busy)
        report_event(unit, motor, unit->now, RKM04_EVENT_COMMAND, 0);
}

/* The next command to be executed is this one; it is shown until its slot (P9). */
static void begin_at_command(struct rkm04_motor *motor, uint64_t number)
{
    motor->next = number;
    motor->number = later(number, program_oldest(&motor->program));
    motor->state = RKM04_READY;
}

/* Has the motor a command to execute, or is it in one? (C6) */
static bool has_work(const struct rkm04_motor *motor)
{
    switch ((enum rkm04_state)motor->state) {
    case RKM04_READY:
        return motor->next < motor->program.written;
    case RKM04_MOVING:
    case RKM04_DWELL:
    case RKM04_WAIT:
    case RKM04_BLOCK:
    case RKM04_HELD:
        return true;
    default:
        return false;
    }
}

/* Will the motor wait, until new commands come or longer? */
static bool is_started_by_new(const struct rkm04_unit *unit, const struct rkm04_motor *motor)
{
    bool moving = motor->state == RKM04_MOVING;
    if (motor->state == RKM04_ENDED || (moving && motor->after == RKM04_AFTER_END))
        return true;
    if (motor->state == RKM04_FAULTY)
        return READING(unit, fault_exit);
    if (READING(unit, hold_exit))
        return false;
    if (motor->pendings > 0)
        return motor->pending[motor->pendings - 1] == 'K';
    return !motor->resume && (motor->state == RKM04_HELD || (moving && motor->after != RKM04_AFTER_GO_ON));
}

void interp_note_stored(const struct rkm04_unit *unit, struct rkm04_motor *motor, uint64_t first)
{
    if (motor->fresh != RKM04_NEVER) { /* those before run first */
        if (!READING(unit, hold_exit))
            motor->hold_fresh = false;
    } else if (is_started_by_new(unit, motor)) {
        motor->fresh = first;
        motor->hold_fresh = false;
    }
    if (motor->state == RKM04_IDLE) {
        begin_at_command(motor, first);
        motor->due = motion_free_from(unit, motor);
    }
}

void interp_request(struct rkm04_motor *motor, char request)
{
    unsigned n = motor->pendings;
    if (motor->fresh != RKM04_NEVER) { /* it is about the new commands, which wait for the end of the ramp or for the slot */
        motor->hold_fresh = request == 'K';
        return;
    }
    if (request == 'K' && !has_work(motor)) /* nothing to hold, whatever arrives after it */
        return;
    if (n > 0 && motor->pending[n - 1] == request)
        return;
    if (n > 1 && request == 'K') { /* K C75 K is the same as K */
        motor->pendings--;
        return;
    }
    motor->pending[motor->pendings++] = request;
}

bool interp_change_speed(const struct rkm04_unit *unit, struct rkm04_motor *motor, uint16_t speed)
{
    if (!motor->motion.moving)
        return false;
    for (unsigned i = 0; i < motor->pendings; i++)
        if (motor->pending[i] == 'K')
            return true; /* the stop ramp swallows it */
    if (motor->change_speed == 0)
        motor->change_due = unit->now + unit->config.readings.speed_change * RKM04_SLOT_TICKS;
    motor->change_speed = speed;
    return true;
}

/* ---- X (C6) --------------------------------------------------------------------------------------------------- */

static void apply_total_stop(struct rkm04_unit *unit, struct rkm04_motor *motor)
{
    if (motor->guard_x == 0 || !input_is_high(unit, motor->guard_x) || !has_work(motor))
        return;
    if (READING(unit, x_after))
        motor->guard_x = 0;
    motor->fresh = RKM04_NEVER;
    motor->resume = false;
    if (motor->state != RKM04_MOVING) {
        motor->motion.kind = RKM04_MOTION_NONE;
        motor->state = RKM04_ENDED;
        report_event(unit, motor, unit->now, RKM04_EVENT_COMMAND, 0);
    } else if (motor->motion.stopping) {
        motor->after = RKM04_AFTER_END;
    } else {
        motion_stop(unit, motor, RKM04_AFTER_END);
    }
}

/* ---- K, C75, V (C3, C4) ------------------------------------------------------------------------------------------------- */

static void apply_halt(struct rkm04_unit *unit, struct rkm04_motor *motor)
{
    motor->resume = false;
    switch ((enum rkm04_state)motor->state) {
    case RKM04_DWELL:
        motor->due = later(motor->due, unit->now) - unit->now;
        break;
    case RKM04_READY:
    case RKM04_WAIT:
    case RKM04_BLOCK:
        break;
    case RKM04_MOVING:
        if (!motor->motion.stopping)
            motion_stop(unit, motor, RKM04_AFTER_HOLD_REST);
        else if (motor->after == RKM04_AFTER_GO_ON)
            motor->after = RKM04_AFTER_HOLD_NEXT;
        return;
    default:
        return;
    }
    motor->held = motor->state;
    motor->state = RKM04_HELD;
}

static void apply_speed_change(struct rkm04_unit *unit, struct rkm04_motor *motor)
{
    if (motor->change_speed == 0 || motor->change_due > unit->now)
        return;
    struct rkm04_motion *motion = &motor->motion;
    if (motion->moving && !motion->stopping && motion->kind != RKM04_MOTION_LIMIT)
        profile_change_speed(motion, unit->now, motor->change_speed);
    motor->change_speed = 0;
}

static bool is_to_hold(const struct rkm04_motor *motor)
{
    return motor->state == RKM04_HELD ||
           (motor->state == RKM04_MOVING && (motor->after == RKM04_AFTER_HOLD_REST || motor->after == RKM04_AFTER_HOLD_NEXT));
}

static void apply_requests(struct rkm04_unit *unit, struct rkm04_motor *motor)
{
    apply_speed_change(unit, motor); /* came before them */
    for (unsigned i = 0; i < motor->pendings; i++) {
        if (motor->pending[i] == 'K')
            apply_halt(unit, motor);
        else if (is_to_hold(motor))
            motor->resume = true;
    }
    motor->pendings = 0;
}

/* Execution continues at the commands stored since K, X or a fault, or is held before them; the rest of what was before is
 * dropped (C3). */
static void start_new_commands(struct rkm04_unit *unit, struct rkm04_motor *motor)
{
    if (!is_at_rest(motor) || motor->fresh == RKM04_NEVER ||
        (!motor->hold_fresh && motion_free_from(unit, motor) > unit->now))
        return;
    clear_stacks(motor);
    motor->motion.kind = RKM04_MOTION_NONE;
    motor->due = unit->now;
    if (motor->hold_fresh) {
        motor->state = RKM04_HELD;
        motor->held = RKM04_READY;
        return;
    }
    begin_at_command(motor, motor->fresh);
    motor->fresh = RKM04_NEVER;
}

/* After C75 a held motor continues with what it was doing. */
static void resume_from_hold(struct rkm04_unit *unit, struct rkm04_motor *motor)
{
    if (motor->state != RKM04_HELD || !motor->resume || motion_free_from(unit, motor) > unit->now)
        return;
    motor->resume = false;
    motor->state = motor->held;
    if (motor->held == RKM04_MOVING)
        motion_resume(unit, motor);
    else if (motor->held == RKM04_DWELL)
        motor->due += unit->now;
}

/* ---- The turn ----------------------------------------------------------------------------------------------------------- */

static bool is_motion(struct rkm04_command command)
{
    return command.op == 'R' || command.op == 'G' || command.op == 'H' || command.op == '(' || command.op == ')';
}

static void execute_next(struct rkm04_unit *unit, struct rkm04_motor *motor)
{
    uint64_t oldest = program_oldest(&motor->program);
    if (motor->next < oldest) /* overwritten (C10) */
        motor->next = oldest;
    if (motor->next == motor->program.written) {
        motor->state = RKM04_IDLE;
        report_event(unit, motor, unit->now, RKM04_EVENT_COMMAND, 0);
        return;
    }
    if (motor->fault != RKM04_FAULT_NONE) {
        motor->fault = RKM04_FAULT_NONE;
        report_event(unit, motor, unit->now, RKM04_EVENT_FAULT, RKM04_FAULT_NONE);
    }
    motor->number = motor->next++;
    motor->command = program_at(&motor->program, motor->number);
    report_event(unit, motor, unit->now, RKM04_EVENT_COMMAND, program_place(motor->number));
    if (READING(unit, planning) != 0 && is_motion(motor->command)) {
        execute_dwell(unit, motor, READING(unit, planning));
        return;
    }
    execute_command(unit, motor);
}

static void run_program(struct rkm04_unit *unit, struct rkm04_motor *motor)
{
    if (motor->state == RKM04_DWELL && unit->now >= motor->due) {
        motor->state = RKM04_READY;
        if (motor->command.op != 'W') { /* it has been planned */
            execute_command(unit, motor);
            return;
        }
    }
    if ((motor->state == RKM04_WAIT || motor->state == RKM04_BLOCK) && execute_wait_is_over(unit, motor)) {
        motor->state = RKM04_READY;
        motor->due = unit->now + RKM04_SLOT_TICKS;
    }
    if (motor->state == RKM04_READY && unit->now >= motor->due)
        execute_next(unit, motor);
}

/* The slot in which the next turn is needed if nothing comes in from outside. */
static uint64_t next_turn_slot(const struct rkm04_unit *unit, const struct rkm04_motor *motor)
{
    uint64_t quiet;
    switch ((enum rkm04_state)motor->state) {
    case RKM04_READY:
    case RKM04_DWELL:
        return interp_slot(later(motor->due, unit->now + 1));
    case RKM04_HELD:
    case RKM04_ENDED:
    case RKM04_FAULTY:
        if (!motor->resume && (motor->fresh == RKM04_NEVER || motor->hold_fresh))
            return RKM04_NEVER;
        return interp_slot(later(motion_free_from(unit, motor), unit->now + 1));
    case RKM04_MOVING:
        quiet = ramp_quiet_until(&motor->motion.ramp);
        if (motor->change_speed != 0 && motor->change_due < quiet)
            quiet = motor->change_due;
        return interp_slot(later(quiet, unit->now + 1));
    default:
        return RKM04_NEVER;
    }
}

void interp_turn(struct rkm04_unit *unit, struct rkm04_motor *motor)
{
    apply_requests(unit, motor);
    start_new_commands(unit, motor);
    apply_total_stop(unit, motor);
    motion_check_inputs(unit, motor);
    start_new_commands(unit, motor); /* an input may have ended the last steps before it */
    resume_from_hold(unit, motor);
    if (unit->busy == 0)
        run_program(unit, motor);
    motor->wake = next_turn_slot(unit, motor);
}
