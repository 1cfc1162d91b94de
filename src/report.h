/* SPDX-License-Identifier: MIT */
/* report.h: reports to the port what happened. Callbacks that the port does not have are passed over. */
#ifndef RKM04_SRC_REPORT_H
#define RKM04_SRC_REPORT_H

#include <rkm04/unit.h>

/* 1..4 */
static inline unsigned motor_number(const struct rkm04_unit *unit, const struct rkm04_motor *motor)
{
    return (unsigned)(motor - unit->motor) + 1;
}

static inline void report_event(struct rkm04_unit *unit, const struct rkm04_motor *motor, uint64_t tick, enum rkm04_event what,
                                uint32_t value)
{
    if (unit->port->event)
        unit->port->event(unit->context, tick, motor ? motor_number(unit, motor) : 0, what, value);
}

/* Is there anybody to see single pulses? */
static inline bool pulses_are_seen(const struct rkm04_unit *unit)
{
    return (unit->port->steps || unit->port->step) && !unit->simulation;
}

/* The same for a port that takes them one by one. A function of its own file: it is the one loop that is run for every pulse,
 * and deserves the registers. */
void report_single_steps(const struct rkm04_unit *unit, const struct rkm04_motor *motor, const uint64_t *tick, size_t count);

/* The next `count` steps of the present motion, at these ticks, if the port takes them. */
static inline void report_steps(const struct rkm04_unit *unit, const struct rkm04_motor *motor, const uint64_t *tick,
                                size_t count)
{
    if (unit->simulation)
        return;
    if (unit->port->steps) {
        const bool forward = motor->motion.forward;
        uint32_t position = (uint32_t)motor->position;
        unit->port->steps(unit->context, motor_number(unit, motor), tick, count,
                          (int32_t)(forward ? position + 1 : position - 1), forward);
    } else if (unit->port->step) {
        report_single_steps(unit, motor, tick, count);
    }
}

/* What the direction terminal shows: held at 0 in simulation mode (C11). */
static inline void report_direction(struct rkm04_unit *unit, const struct rkm04_motor *motor, uint64_t tick, bool forward)
{
    if (unit->port->direction)
        unit->port->direction(unit->context, tick, motor_number(unit, motor), forward);
}

static inline void report_outputs(struct rkm04_unit *unit, uint64_t tick, uint8_t mask)
{
    if (unit->port->outputs)
        unit->port->outputs(unit->context, tick, mask);
}

/* Change the register DO; in simulation mode the terminals do not see it. */
static inline void write_outputs(struct rkm04_unit *unit, uint64_t tick, uint8_t mask)
{
    bool changed = unit->outputs != mask;
    unit->outputs = mask;
    if (changed && !unit->simulation)
        report_outputs(unit, tick, mask);
}

static inline void write_led(struct rkm04_unit *unit, struct rkm04_motor *motor, uint64_t tick, enum rkm04_led led)
{
    if (motor->led == led)
        return;
    motor->led = (uint8_t)led;
    motor->blink_from = tick;
    report_event(unit, motor, tick, RKM04_EVENT_LED, led);
}

static inline bool input_is_high(const struct rkm04_unit *unit, unsigned input)
{
    return unit->seen >> (input - 1) & 1;
}

#endif
