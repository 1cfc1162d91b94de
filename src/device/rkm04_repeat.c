/* SPDX-License-Identifier: MIT */
#include "rkm04_repeat.h"

#include <string.h>

/* Does what follows depend on the counter? */
static bool has_absolute_motion(const struct rkm04_motor *motor)
{
    for (unsigned i = 0; i < RKM04_PROGRAM_MAX; i++)
        if (motor->program.op[i] == 'G' || motor->program.op[i] == 'H')
            return true;
    return false;
}

/* G+, G-, ) or ( at its constant speed. Nothing comes that could end it: its guards have been checked, and inputs stay. */
static bool is_endless_motion(const struct rkm04_unit *unit, const struct rkm04_motor *motor)
{
    const struct rkm04_motion *motion = &motor->motion;
    bool limit = motion->kind == RKM04_MOTION_LIMIT && ((unsigned)unit->inputs >> (motion->input - 1u) & 1u) == 0;
    return motor->state == RKM04_MOVING && (motion->kind == RKM04_MOTION_ENDLESS || limit) && !motion->stopping &&
           motion->profile.leg + 1u == motion->profile.count && motor->pendings == 0 && motor->change_speed == 0;
}

/* A time that is still to come counts from now. */
static uint64_t ticks_from_now(uint64_t tick, uint64_t now)
{
    return tick == RKM04_NEVER ? RKM04_NEVER : tick > now ? tick - now : 0;
}

static void make_motion_relative(struct rkm04_motion *motion, uint64_t now)
{
    struct rkm04_ramp *ramp = &motion->ramp;
    if (motion->kind == RKM04_MOTION_NONE) {
        memset(motion, 0, sizeof *motion);
        return;
    }
    ramp->next = ramp->next == RKM04_NEVER ? RKM04_NEVER : ramp->next - now;
    ramp->at -= now;
    ramp->end.tick = ramp->end.tick == RKM04_NEVER ? RKM04_NEVER : ramp->end.tick - now;
}

static void make_relative(const struct rkm04_unit *unit, struct rkm04_motor *motor)
{
    uint64_t now = unit->now;
    bool for_ever = is_endless_motion(unit, motor);
    motor->due = ticks_from_now(motor->due, now);
    motor->wake = ticks_from_now(motor->wake, now);
    motor->change_due = motor->change_speed != 0 ? ticks_from_now(motor->change_due, now) : 0;
    motor->last_pulse = ticks_from_now(motor->last_pulse + RKM04_PULSE_TICKS, now);
    motor->blink_from = 0;
    if (for_ever || !has_absolute_motion(motor))
        motor->position = 0;
    if (for_ever) {
        memset(&motor->motion, 0, sizeof motor->motion);
        motor->last_pulse = 0;
        motor->wake = RKM04_NEVER;
        return;
    }
    make_motion_relative(&motor->motion, now);
}

static void copy_without(struct rkm04_unit *copy, const struct rkm04_unit *unit)
{
    memcpy(copy, unit, sizeof *copy);
    for (unsigned i = 0; i < RKM04_MOTORS; i++)
        make_relative(unit, &copy->motor[i]);
    copy->now = unit->now % RKM04_SLOT_TICKS;
}

/* Cheap: what differs between most states. */
static uint64_t key_of(const struct rkm04_unit *unit)
{
    uint64_t key = unit->variables + ((uint64_t)unit->outputs << 16);
    for (unsigned i = 0; i < RKM04_MOTORS; i++) {
        const struct rkm04_motor *motor = &unit->motor[i];
        key = (key * 31u + motor->number) * 31u + motor->state;
        for (unsigned level = 0; level < motor->loops; level++)
            key = key * 31u + motor->loop[level].left;
    }
    return key;
}

uint64_t rkm04_repeat_check(struct rkm04_repeat *repeat, const struct rkm04_unit *unit)
{
    uint64_t key = key_of(unit);
    if (repeat->power > 0 && key == repeat->key) {
        copy_without(&repeat->present, unit);
        if (memcmp(&repeat->present, &repeat->copy, sizeof repeat->copy) == 0)
            return unit->now - repeat->tick;
    }
    if (repeat->looks++ < repeat->power)
        return 0;
    copy_without(&repeat->copy, unit);
    repeat->key = key;
    repeat->tick = unit->now;
    repeat->power = repeat->power > 0 ? 2 * repeat->power : 1;
    repeat->looks = 0;
    return 0;
}
