/* SPDX-License-Identifier: MIT */
#include "execute.h"

#include "commands.h"
#include "motion.h"
#include "program.h"
#include "reading.h"
#include "report.h"

static void stop_with_fault(struct rkm04_unit *unit, struct rkm04_motor *motor, enum rkm04_fault fault)
{
    motor->state = RKM04_FAULTY;
    motor->fault = (uint8_t)fault;
    report_event(unit, motor, unit->now, RKM04_EVENT_FAULT, fault);
}

void execute_dwell(const struct rkm04_unit *unit, struct rkm04_motor *motor, uint32_t slots)
{
    motor->state = RKM04_DWELL;
    motor->due = unit->now + (uint64_t)slots * RKM04_SLOT_TICKS;
}

#define COMMAND(name) static void do_##name(struct rkm04_unit *unit, struct rkm04_motor *motor, uint32_t n)
#define UNUSED(x) (void)(x)

static bool is_bit_high(const struct rkm04_unit *unit, uint32_t bit)
{
    if (bit >= RKM04_FIRST_VARIABLE)
        return unit->variables >> (bit - RKM04_FIRST_VARIABLE) & 1;
    return input_is_high(unit, bit);
}

/* Go to the label of J, I or ' if it is in memory; a call notes where to return to. */
static bool find_label(struct rkm04_motor *motor)
{
    uint32_t n = motor->command.argument;
    uint64_t back = motor->next;
    if (!program_label(&motor->program, motor->command.op == 'I' ? n >> 16 : n, &motor->next))
        return false;
    if (motor->command.op == '\'')
        motor->call[motor->calls++] = back;
    return true;
}

/* J, I, ': go to the label, or wait until it has arrived (C7). */
static void jump_to_label(struct rkm04_unit *unit, struct rkm04_motor *motor)
{
    if (find_label(motor))
        return;
    if (READING(unit, label))
        stop_with_fault(unit, motor, RKM04_FAULT_NO_LABEL);
    else
        motor->state = RKM04_WAIT;
}

void execute_simulate(struct rkm04_unit *unit, bool on)
{
    if (unit->simulation == on)
        return;
    unit->simulation = on;
    if (unit->outputs)
        report_outputs(unit, unit->now, on ? 0 : unit->outputs);
    for (unsigned i = 0; i < RKM04_MOTORS; i++)
        if (unit->motor[i].pin_forward)
            report_direction(unit, &unit->motor[i], unit->now, !on);
}

/* T and C: outputs, functions, variables. */
static void write_bit(struct rkm04_unit *unit, struct rkm04_motor *motor, uint32_t n, bool on)
{
    if (n >= RKM04_FIRST_VARIABLE) {
        uint16_t mask = (uint16_t)(1u << (n - RKM04_FIRST_VARIABLE));
        uint16_t variables = (uint16_t)(on ? unit->variables | mask : unit->variables & ~mask);
        if (variables != unit->variables) {
            unit->variables = variables;
            unit->touched = true;
            report_event(unit, NULL, unit->now, RKM04_EVENT_VARIABLE, variables);
        }
    } else if (n <= RKM04_OUTPUTS) {
        uint8_t mask = (uint8_t)(1u << (n - 1));
        write_outputs(unit, unit->now, (uint8_t)(on ? unit->outputs | mask : unit->outputs & ~mask));
    } else if (n == 40) {
        motor->keep = on;
    } else if (n == 41) {
        execute_simulate(unit, on);
    } else if (n >= 51) {
        uint8_t mask = (uint8_t)(1u << (n - 51));
        motor->functions = (uint8_t)(on ? motor->functions | mask : motor->functions & ~mask);
    }
}

static void set_position(struct rkm04_unit *unit, struct rkm04_motor *motor, int32_t position)
{
    if (motor->position != position)
        report_event(unit, motor, unit->now, RKM04_EVENT_POSITION, (uint32_t)position);
    motor->position = position;
}

COMMAND(clear)
{
    if (n == 100)
        set_position(unit, motor, 0);
    else
        write_bit(unit, motor, n, false);
}

COMMAND(set)
{
    write_bit(unit, motor, n, true);
}

COMMAND(acceleration)
{
    UNUSED(unit);
    motor->acceleration = (uint16_t)n;
}

COMMAND(start_speed)
{
    UNUSED(unit);
    motor->start_speed = (uint16_t)n;
}

COMMAND(speed)
{
    UNUSED(unit);
    motor->speed = (uint16_t)n;
}

COMMAND(forward)
{
    UNUSED(unit);
    motor->count = n;
    motor->forward = true;
}

COMMAND(back)
{
    UNUSED(unit);
    motor->count = n;
    motor->forward = false;
}

COMMAND(reverse)
{
    UNUSED(unit), UNUSED(n);
    motor->forward = !motor->forward;
}

COMMAND(write_position)
{
    set_position(unit, motor, (int32_t)n);
}

/* Steps and direction from the counter to a place (no steps: any direction); 64 bits, as the difference may need 33 (U3). */
static uint32_t distance_to(const struct rkm04_motor *motor, int64_t place, bool *forward)
{
    int64_t way = place - motor->position;
    *forward = way > 0;
    return (uint32_t)(way < 0 ? -way : way);
}

COMMAND(absolute)
{
    if (n == RKM04_G_FORWARD || n == RKM04_G_BACK) {
        motion_begin_endless(unit, motor, n == RKM04_G_FORWARD);
        return;
    }
    motor->count = distance_to(motor, n, &motor->forward);
    motion_begin_steps(unit, motor, motor->count, motor->forward);
}

COMMAND(home)
{
    UNUSED(n);
    bool forward;
    uint32_t steps = distance_to(motor, 0, &forward);
    motion_begin_steps(unit, motor, steps, forward);
}

/* There is no motion that does what the segments say. */
static void refuse_motion(struct rkm04_unit *unit, struct rkm04_motor *motor)
{
    motor->segments = 0;
    stop_with_fault(unit, motor, RKM04_FAULT_MOTION);
    write_led(unit, motor, unit->now, RKM04_LED_BLINK);
}

COMMAND(run)
{
    UNUSED(n);
    if (motor->segments == 0) {
        motion_begin_steps(unit, motor, motor->count, motor->forward);
    } else if (motion_compound_possible(motor)) {
        motion_begin_compound(unit, motor);
    } else {
        refuse_motion(unit, motor);
    }
}

COMMAND(segment)
{
    UNUSED(n);
    if (motor->segments == 0) {
        motor->segments_forward = motor->forward;
        motor->segments_bad = false;
        motor->segments_marks = motor->functions;
    }
    if (motor->count == 0 || motor->forward != motor->segments_forward)
        motor->segments_bad = true;
    if (motor->segments < RKM04_SEGMENTS_MAX)
        motor->segment[motor->segments] = (struct rkm04_segment){.steps = motor->count,
                                                                 .speed = motor->speed,
                                                                 .acceleration = motor->acceleration,
                                                                 .deceleration = motor->acceleration};
    if (motor->segments <= RKM04_SEGMENTS_MAX)
        motor->segments++;
    if (READING(unit, y_eleventh) && motor->segments > RKM04_SEGMENTS_MAX)
        refuse_motion(unit, motor);
}

COMMAND(limit_forward)
{
    motion_begin_limit(unit, motor, true, n);
}

COMMAND(limit_back)
{
    motion_begin_limit(unit, motor, false, n);
}

COMMAND(guard_high)
{
    UNUSED(unit);
    motor->guard_m = (uint8_t)n;
}

COMMAND(guard_low)
{
    UNUSED(unit);
    motor->guard_n = (uint8_t)n;
}

COMMAND(guards_off)
{
    UNUSED(unit), UNUSED(n);
    motor->guard_m = motor->guard_n = 0;
}

COMMAND(total_stop)
{
    UNUSED(unit);
    motor->guard_x = (uint8_t)n;
}

COMMAND(label)
{
    UNUSED(unit), UNUSED(motor), UNUSED(n);
}

COMMAND(jump)
{
    UNUSED(n);
    jump_to_label(unit, motor);
}

COMMAND(jump_if)
{
    if (is_bit_high(unit, n & 0xff) == (n >> 8 & 1))
        jump_to_label(unit, motor);
}

/* The innermost loop opened in the present call level. */
static struct rkm04_loop *innermost_loop(struct rkm04_motor *motor)
{
    if (motor->loops == 0 || motor->loop[motor->loops - 1].level != motor->calls)
        return NULL;
    return &motor->loop[motor->loops - 1];
}

COMMAND(loop_begin)
{
    unsigned depth = motor->loops;
    for (unsigned i = depth; i-- > 0 && motor->loop[i].level == motor->calls;)
        if (motor->loop[i].start == motor->number)
            depth = i; /* the same L again: restart it, close what is inside (C7) */
    if (depth == RKM04_LOOP_LEVELS) {
        stop_with_fault(unit, motor, RKM04_FAULT_LOOP_LEVELS);
        return;
    }
    motor->loop[depth] = (struct rkm04_loop){.start = motor->number, .left = (uint8_t)n, .level = motor->calls};
    motor->loops = (uint8_t)(depth + 1);
}

COMMAND(loop_end)
{
    UNUSED(n);
    struct rkm04_loop *loop = innermost_loop(motor);
    if (!loop) {
        stop_with_fault(unit, motor, RKM04_FAULT_NO_LOOP);
    } else if (loop->start < program_oldest(&motor->program)) {
        stop_with_fault(unit, motor, RKM04_FAULT_OVERWRITTEN);
    } else if (--loop->left > 0) {
        motor->next = loop->start + 1;
    } else {
        motor->loops--;
    }
}

COMMAND(call)
{
    UNUSED(n);
    if (motor->calls == RKM04_CALL_LEVELS)
        stop_with_fault(unit, motor, RKM04_FAULT_CALL_LEVELS);
    else
        jump_to_label(unit, motor);
}

COMMAND(call_return)
{
    UNUSED(n);
    if (motor->calls == 0) {
        stop_with_fault(unit, motor, RKM04_FAULT_NO_CALL);
        return;
    }
    uint64_t back = motor->call[motor->calls - 1];
    if (back < program_oldest(&motor->program)) {
        stop_with_fault(unit, motor, RKM04_FAULT_OVERWRITTEN);
        return;
    }
    while (innermost_loop(motor))
        motor->loops--;
    motor->calls--;
    motor->next = back;
}

COMMAND(dwell)
{
    execute_dwell(unit, motor, n);
}

bool execute_wait_is_over(const struct rkm04_unit *unit, struct rkm04_motor *motor)
{
    switch (motor->command.op) {
    case 'O':
        return is_bit_high(unit, motor->command.argument);
    case 'Z':
        return !is_bit_high(unit, motor->command.argument);
    case '[':
        return program_closed_after(&motor->program, motor->number);
    default: /* J, I, ' */
        return find_label(motor);
    }
}

static void begin_wait(struct rkm04_unit *unit, struct rkm04_motor *motor, enum rkm04_state state)
{
    if (!execute_wait_is_over(unit, motor))
        motor->state = (uint8_t)state;
}

COMMAND(wait_high)
{
    UNUSED(n);
    begin_wait(unit, motor, RKM04_WAIT);
}

COMMAND(wait_low)
{
    UNUSED(n);
    begin_wait(unit, motor, RKM04_WAIT);
}

COMMAND(block_begin)
{
    UNUSED(n);
    begin_wait(unit, motor, RKM04_BLOCK);
}

COMMAND(block_end)
{
    UNUSED(unit), UNUSED(motor), UNUSED(n);
}

/* Obeyed when they arrive, never stored (C1, C3). */
COMMAND(reset)
{
    UNUSED(unit), UNUSED(motor), UNUSED(n);
}

COMMAND(halt)
{
    UNUSED(unit), UNUSED(motor), UNUSED(n);
}

void execute_command(struct rkm04_unit *unit, struct rkm04_motor *motor)
{
    uint32_t n = motor->command.argument;
    switch (motor->command.op) {
#define ROW(character, name, ...)     \
    case (uint8_t)character:          \
        do_##name(unit, motor, n);    \
        break;
        COMMAND_TABLE(ROW)
#undef ROW
    default:
        break;
    }
}
