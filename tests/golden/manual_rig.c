/* SPDX-License-Identifier: MIT */
#include "manual_rig.h"

struct rig rig;
size_t seen;

void setup(void)
{
    rig_power_up(&rig, NULL);
    seen = 0;
}

void teardown(void)
{
    rig_free(&rig);
}

uint64_t moved(uint64_t slot, uint64_t v, size_t steps, bool forward)
{
    uint64_t end = slot + move_ticks(100, v, 2000, steps);
    rig_expect_motion(&rig, 1, ++seen, slot, end, steps, forward);
    return slot_behind(end);
}

void expect_rest(int32_t position)
{
    ck_assert_int_eq(rig_motor(&rig, 1).state, RKM04_IDLE);
    ck_assert_uint_eq(rig_motions(&rig, 1), seen);
    ck_assert_int_eq(rig_motor(&rig, 1).position, position);
}
