/* SPDX-License-Identifier: MIT */
/* plant_stall.c: which pulses a rotor can follow.
 *
 * Up to the speed `start` it follows anything. Above it, its speed may change only as fast as the motor has torque for; if it is
 * asked for more, it falls out of step and stops until pulses come at no more than `start` again. Speeds are measured from
 * the pulses, whose ticks are rounded up: a motion is given the benefit of that, so one exactly at the limit never stalls. */
#include "plant_model.h"

#define MICRO UINT64_C(1000000)  /* ticks in a second */
#define MILLI INT64_C(1000)      /* of struct plant_stall.speed */

/* The acceleration that there is torque for at `speed`, in steps/s². */
static int64_t limit_at(const struct plant_stall *stall, int64_t speed)
{
    const struct plant_point *point = stall->point;
    unsigned at = 0;
    while (at < stall->points && (int64_t)point[at].speed < speed)
        at++;
    if (at == 0)
        return point[0].acceleration;
    if (at == stall->points)
        return point[at - 1u].acceleration;
    int64_t width = (int64_t)point[at].speed - point[at - 1u].speed, into = speed - point[at - 1u].speed;
    int64_t rise = (int64_t)point[at].acceleration - point[at - 1u].acceleration;
    return point[at - 1u].acceleration + rise * into / width;
}

static int64_t larger(int64_t a, int64_t b)
{
    return a > b ? a : b;
}

static void begin_span(struct plant_stall *stall, uint64_t tick)
{
    stall->begin = tick;
    stall->steps = 0;
}

/* It is at rest, or so slow that it follows anything. The interval before it may have been up to a tick shorter. */
static void restart_from_rest(struct plant_stall *stall, uint64_t tick, uint64_t interval)
{
    stall->base = larger(stall->start, interval > 1 ? (int64_t)(MICRO / (interval - 1)) + 1 : (int64_t)MICRO);
    stall->out_of_step = false;
    stall->run = 0;
    stall->before = 0;
    begin_span(stall, tick);
}

/* The square of the speed that it may reach from `from` within so many steps: v² = from² + 2·a·k. */
static int64_t square_after(const struct plant_stall *stall, int64_t from, int64_t speed, int64_t steps)
{
    return from * from + 2 * larger(limit_at(stall, from), limit_at(stall, speed)) * steps;
}

/* Check the interval before a pulse: may it have stood in it, or gone so slowly that it follows anything? From `start` it may
 * have come to this speed within a step: a motion ended, and the next one began. */
static bool may_be_slow(const struct plant_stall *stall, uint64_t interval)
{
    if (interval >= MICRO || interval * stall->start >= MICRO)
        return true;
    int64_t speed = (int64_t)(MICRO / (interval + 1));
    return !stall->out_of_step && speed * speed <= square_after(stall, stall->start, speed, 1);
}

/* In the first span since it was calm. */
static bool starts_too_fast(const struct plant_stall *stall, int64_t speed)
{
    return stall->before == 0 && speed * speed > square_after(stall, stall->base, speed, (int64_t)stall->run + 1);
}

/* A span is over: did the speed change too fast since the one before? */
static bool changes_too_fast(const struct plant_stall *stall, int64_t ticks, int64_t speed)
{
    int64_t before = (int64_t)stall->before, change = speed > stall->speed ? speed - stall->speed : stall->speed - speed;
    if (before == 0)
        return false;
    int64_t limit = larger(limit_at(stall, speed / MILLI), limit_at(stall, stall->speed / MILLI));
    change -= speed / ticks + stall->speed / before + 2; /* a tick at the end of each */
    return change * 2 * (int64_t)MICRO / MILLI > limit * (before + ticks);
}

static bool is_span_too_much(struct plant_stall *stall, uint64_t tick)
{
    int64_t ticks = (int64_t)(tick - stall->begin);
    if (ticks < (int64_t)PLANT_SPAN)
        return false;
    int64_t speed = (int64_t)(stall->steps * MICRO) * MILLI / ticks;
    int64_t top = (int64_t)stall->point[stall->points - 1u].speed * MILLI;
    bool too_much = speed - speed / ticks - 1 > top || changes_too_fast(stall, ticks, speed);
    stall->before = (uint64_t)ticks;
    stall->speed = speed;
    begin_span(stall, tick);
    return too_much;
}

bool stall_follows(struct plant_stall *stall, uint64_t tick, bool forward)
{
    if (stall->points == 0)
        return true;
    uint64_t interval = stall->last == DEVICE_NEVER ? MICRO : tick - stall->last;
    if (forward != stall->forward)
        interval = MICRO; /* however short it was: it stood in between */
    bool slow = may_be_slow(stall, interval);
    stall->last = tick;
    stall->forward = forward;
    if (slow) {
        restart_from_rest(stall, tick, interval);
        return true;
    }
    stall->run++;
    stall->steps++;
    int64_t speed = (int64_t)(MICRO / (interval + 1)); /* at least */
    bool too_fast = speed > (int64_t)stall->point[stall->points - 1u].speed || starts_too_fast(stall, speed);
    if (is_span_too_much(stall, tick) || too_fast)
        stall->out_of_step = true;
    return !stall->out_of_step;
}

void stall_slips(struct plant_stall *stall)
{
    stall->out_of_step = stall->points > 0;
}
