/* SPDX-License-Identifier: MIT */
/* The rest of a motion of a PMC as its planner has it: speed over time from corner to corner (AM2). */
#include <math.h>

#include "pmc_device.h"

#define RATE ((double)PMC_TICKS_PER_SECOND)
#define ENDLESS_US 1e15 /* a leg without end is drawn so far */
#define ALIKE 0.5       /* pulses/s: rounding, no jump */

/* On the way from corner to corner. */
struct walk {
    struct device_plan_point *point;
    size_t room, count;
    double us, speed, place; /* place: as the points count it */
};

static double place_of(const struct pmc_break *at)
{
    return (double)at->at.high * 0x1p-32 + (double)at->at.low * 0x1p-96;
}

static double speed_of(const struct pmc_break *at)
{
    return (double)at->w.whole / (2 * RATE);
}

static void add_corner(struct walk *walk)
{
    if (walk->count < walk->room)
        walk->point[walk->count++] = (struct device_plan_point){walk->us, walk->speed, walk->place};
}

/* The present place and speed (ramp.h: y and w, d ticks after ramp->at). */
static void begin_walk(struct walk *walk, const struct pmc_unit *unit, const struct pmc_motion *motion)
{
    const struct rkm04_ramp *ramp = &motion->ramp;
    double d = (double)(int64_t)(unit->now - ramp->at), slope = ramp->slope;
    double y = (double)ramp->y.whole, w = (double)ramp->w.whole;
    walk->us = (double)unit->now / PMC_TICKS_PER_US;
    walk->speed = fmax(0, (w + 2 * slope * d) / (2 * RATE));
    walk->place = (double)motion->done + 1 - ramp->sent + (y + d * (w + slope * d)) / (double)ramp->step;
    add_corner(walk);
}

/* Continue with acceleration `slope` to the corner `to`. */
static void walk_leg(struct walk *walk, const struct pmc_break *to, int32_t slope)
{
    double way = fmax(0, place_of(to) - walk->place);
    double speed = sqrt(fmax(0, walk->speed * walk->speed + 2.0 * slope * way));
    if (walk->speed + speed > 0)
        walk->us += 2e6 * way / (walk->speed + speed);
    walk->speed = speed;
    walk->place += way;
    add_corner(walk);
}

static void walk_legs(struct walk *walk, const struct pmc_motion *motion)
{
    for (unsigned i = motion->leg + 1u; i < motion->count; i++) {
        walk_leg(walk, &motion->point[i], motion->point[i - 1u].slope);
        double next = speed_of(&motion->point[i]);
        if (i + 1u < motion->count && fabs(next - walk->speed) > ALIKE) {
            walk->speed = next;
            add_corner(walk);
        }
    }
    if (motion->endless) {
        walk->us += ENDLESS_US;
        walk->place += walk->speed * ENDLESS_US * 1e-6;
    } else {
        walk->speed = 0;
    }
    add_corner(walk);
}

size_t pmc_device_plan(const struct device_unit *unit, unsigned number, struct device_plan_point *point, size_t room)
{
    const struct pmc_unit *core = pmc_in(unit);
    const struct pmc_axis *axis = &core->axis[number - 1u];
    const struct pmc_motion *motion = &axis->motion;
    struct walk walk = {.point = point, .room = room};
    if (!motion->moving)
        return 0;
    begin_walk(&walk, core, motion);
    walk_legs(&walk, motion);
    for (size_t i = 0; i < walk.count; i++) {
        double ahead = point[i].position - (double)motion->done;
        point[i].position = axis->commanded + (motion->forward ? ahead : -ahead);
        point[i].speed = motion->forward ? point[i].speed : 0 - point[i].speed;
    }
    return walk.count;
}
