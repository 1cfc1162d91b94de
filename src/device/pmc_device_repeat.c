/* SPDX-License-Identifier: MIT */
/* Does a PMC repeat its state without end? Positions count: software limits end what moves ever further. */
#include <string.h>

#include "pmc_device.h"

/* A time that is still to come counts from now. */
static uint64_t from_now(uint64_t tick, uint64_t now)
{
    return tick == PMC_NEVER ? PMC_NEVER : tick > now ? tick - now : 0;
}

static void make_motion_relative(struct pmc_motion *motion, uint64_t now)
{
    if (!motion->active) {
        memset(motion, 0, sizeof *motion);
        return;
    }
    motion->last = from_now(motion->last, now);
    motion->over = from_now(motion->over, now);
    motion->ramp.next = from_now(motion->ramp.next, now);
    motion->ramp.at -= now;
    motion->ramp.end.tick = motion->ramp.end.tick == PMC_NEVER ? PMC_NEVER : motion->ramp.end.tick - now;
}

static void copy_relative(struct pmc_unit *copy, const struct pmc_unit *unit)
{
    memcpy(copy, unit, sizeof *copy);
    for (unsigned i = 0; i < PMC_AXES; i++) {
        struct pmc_axis *axis = &copy->axis[i];
        axis->due = axis->running ? from_now(axis->due, unit->now) : 0;
        axis->off[0] = from_now(axis->off[0], unit->now);
        axis->off[1] = from_now(axis->off[1], unit->now);
        make_motion_relative(&axis->motion, unit->now);
    }
    memset(&copy->face, 0, sizeof copy->face);
    copy->now = unit->now % PMC_SLOT_TICKS;
}

/* Brent: compare with a state that is kept twice as long each time. */
uint64_t pmc_find_repeat(void *memory, const struct device_unit *unit)
{
    struct pmc_repeat *repeat = memory;
    const struct pmc_unit *core = pmc_in(unit);
    copy_relative(&repeat->present, core);
    if (repeat->power > 0 && memcmp(&repeat->present, &repeat->copy, sizeof repeat->copy) == 0)
        return (core->now - repeat->tick) / PMC_TICKS_PER_US;
    if (repeat->looks++ < repeat->power)
        return 0;
    repeat->copy = repeat->present;
    repeat->tick = core->now;
    repeat->power = repeat->power > 0 ? 2 * repeat->power : 1;
    repeat->looks = 0;
    return 0;
}
