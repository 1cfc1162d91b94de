/* SPDX-License-Identifier: MIT */
/* goal_subject.c: an axis that goes where goal.py says, by profile_go() and the pulse generator. A line of input is a command,
 *
 *     TICK pos TARGET SPEED START_SPEED ACCELERATION DECELERATION
 *     TICK vel SPEED 0 START_SPEED ACCELERATION DECELERATION      (SPEED with its sign)
 *     TICK stop 0 0 START_SPEED ACCELERATION DECELERATION
 *     TICK end 0 0 0 0 0
 *
 * in the order of ticks; `end` prints TICK POSITION of every pulse up to there, an empty line, and begins again. */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "profile.h"
#include "ramp.h"

#define PULSES_MAX 200000

static struct rkm04_motion motion;
static struct profile_goal goal; /* of the motion, or of the one after the turn */
static int64_t target, position;
static bool turning;
static unsigned count;
static struct {
    uint64_t tick;
    int64_t position;
} pulse[PULSES_MAX];

static void go(uint64_t tick)
{
    goal.way = target - position;
    turning = profile_go(&motion, tick, RKM04_TICKS_PER_SECOND, &goal) == PROFILE_TURNS;
}

/* Pulses due up to and including `limit`. */
static bool run(uint64_t limit)
{
    uint64_t tick[64];
    while (motion.moving && motion.ramp.next <= limit) {
        size_t n = ramp_pulses(&motion.ramp, &motion.profile, limit, tick, 64);
        motion.done += (uint32_t)n;
        for (size_t i = 0; i < n; i++) {
            if (count == PULSES_MAX)
                return false;
            position += motion.forward ? 1 : -1;
            pulse[count].tick = tick[i];
            pulse[count++].position = position;
        }
        if (motion.ramp.next == RKM04_NEVER) {
            motion.moving = false;
            if (turning)
                go(pulse[count - 1].tick);
        }
    }
    return true;
}

static void end(void)
{
    for (unsigned i = 0; i < count; i++)
        printf("%" PRIu64 " %" PRId64 "\n", pulse[i].tick, pulse[i].position);
    puts("");
    fflush(stdout);
    motion = (struct rkm04_motion){.moving = false};
    position = target = 0;
    turning = false;
    count = 0;
}

int main(void)
{
    uint64_t tick;
    char what[8];
    long long value;
    unsigned speed, start_speed, acceleration, deceleration;
    while (scanf("%" SCNu64 " %7s %lld %u %u %u %u", &tick, what, &value, &speed, &start_speed, &acceleration, &deceleration) ==
           7) {
        if (!run(tick))
            return 1;
        if (strcmp(what, "end") == 0) {
            end();
            continue;
        }
        goal = (struct profile_goal){.kind = PROFILE_TO_STOP,
                                     .start_speed = (uint16_t)start_speed,
                                     .acceleration = (uint16_t)acceleration,
                                     .deceleration = (uint16_t)deceleration};
        if (strcmp(what, "pos") == 0) {
            goal.kind = PROFILE_TO_PLACE;
            goal.speed = (int32_t)speed;
            target = value;
        } else if (strcmp(what, "vel") == 0) {
            goal.kind = PROFILE_FOR_EVER;
            goal.speed = (int32_t)value;
        }
        go(tick);
    }
    return 0;
}
