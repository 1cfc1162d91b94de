/* SPDX-License-Identifier: MIT */
#include "motion_plan.h"

#include <math.h>

#define SPEED2_UNIT 0x1p-35    /* of rkm04_break.speed2, in steps^2/s^2 */
#define ENDLESS_US 1e15        /* a leg without end is drawn so far */
#define ALIKE 0.5              /* steps/s: rounding in a break point's speed, no jump */

/* On the way from corner to corner. */
struct walk {
    struct device_plan_point *point;
    size_t room, count;
    double us, speed, place; /* of the motion: speed and place are not negative */
};

double plan_place(struct rkm04_place place)
{
    return (double)place.high * 0x1p-32 + (double)place.low * 0x1p-96;
}

static void add_corner(struct walk *walk)
{
    if (walk->count < walk->room)
        walk->point[walk->count++] = (struct device_plan_point){walk->us, walk->speed, walk->place};
}

/* The present place and speed (ramp.h: y and w, d ticks after ramp->at). */
static void begin_walk(struct walk *walk, const struct plan_motion *motion)
{
    const struct rkm04_ramp *ramp = motion->ramp;
    double d = (double)(int64_t)(motion->now - ramp->at), slope = ramp->slope;
    double y = (double)ramp->y.whole, w = (double)ramp->w.whole;
    walk->us = (double)motion->now / motion->ticks_per_us;
    walk->speed = fmax(0, (w + 2 * slope * d) / (2.0 * ramp->rate));
    walk->place = (double)motion->done + 1 - ramp->sent + (y + d * (w + slope * d)) / (double)ramp->step;
    add_corner(walk);
}

/* Continue with acceleration `slope` to `place`. */
static void walk_leg(struct walk *walk, double place, int32_t slope)
{
    double way = fmax(0, place - walk->place);
    double speed = sqrt(fmax(0, walk->speed * walk->speed + 2.0 * slope * way));
    if (walk->speed + speed > 0)
        walk->us += 2e6 * way / (walk->speed + speed);
    walk->speed = speed;
    walk->place += way;
    add_corner(walk);
}

static void end_walk(struct walk *walk, bool endless)
{
    if (endless) {
        walk->us += ENDLESS_US;
        walk->place += walk->speed * ENDLESS_US * 1e-6;
    } else {
        walk->speed = 0;
    }
    add_corner(walk);
}

size_t plan_motion(const struct plan_motion *motion, struct device_plan_point *point, size_t room)
{
    struct walk walk = {.point = point, .room = room};
    begin_walk(&walk, motion);
    for (unsigned i = 1; i < motion->count; i++) {
        walk_leg(&walk, motion->corner[i].place, motion->corner[i - 1u].slope);
        if (i + 1u < motion->count && fabs(motion->corner[i].speed - walk.speed) > ALIKE) {
            walk.speed = motion->corner[i].speed;
            add_corner(&walk);
        }
    }
    end_walk(&walk, motion->endless);
    for (size_t i = 0; i < walk.count; i++) {
        double ahead = point[i].position - (double)motion->done;
        point[i].position = motion->position + (motion->forward ? ahead : -ahead);
        point[i].speed = motion->forward ? point[i].speed : 0 - point[i].speed;
    }
    return walk.count;
}

size_t motion_plan(const struct rkm04_motion *motion, uint64_t now, int32_t position, struct device_plan_point *point,
                   size_t room)
{
    const struct rkm04_profile *profile = &motion->profile;
    struct plan_corner corner[RKM04_BREAKS_MAX];
    struct plan_motion plan = {.ramp = &motion->ramp,
                               .now = now,
                               .ticks_per_us = 1,
                               .done = motion->done,
                               .position = position,
                               .forward = motion->forward,
                               .endless = profile->endless,
                               .corner = corner};
    if (!motion->moving)
        return 0;
    for (const struct rkm04_break *from = &profile->point[profile->leg]; from < &profile->point[profile->count]; from++)
        corner[plan.count++] =
            (struct plan_corner){plan_place(from->at), sqrt((double)from->speed2 * SPEED2_UNIT), from->slope};
    return plan_motion(&plan, point, room);
}
