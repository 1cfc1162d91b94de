/* SPDX-License-Identifier: MIT */
/* fixed.h: arithmetic on 64.64 numbers, and the way of a motion of constant acceleration. */
#ifndef RKM04_SRC_FIXED_H
#define RKM04_SRC_FIXED_H

#include <rkm04/motion.h>

#include "wide.h"

static inline struct rkm04_fixed fixed_sum(struct rkm04_fixed a, struct rkm04_fixed b)
{
    uint64_t part = a.part + b.part;
    return (struct rkm04_fixed){(int64_t)((uint64_t)a.whole + (uint64_t)b.whole + (part < a.part)), part};
}

static inline struct rkm04_fixed fixed_difference(struct rkm04_fixed a, struct rkm04_fixed b)
{
    return (struct rkm04_fixed){(int64_t)((uint64_t)a.whole - (uint64_t)b.whole - (a.part < b.part)), a.part - b.part};
}

static inline bool fixed_less(struct rkm04_fixed a, struct rkm04_fixed b)
{
    return a.whole < b.whole || (a.whole == b.whole && a.part < b.part);
}

/* y and w of a pulse generator (ramp.h). */
struct motion_state {
    struct rkm04_fixed y, w;
};

/* d ticks on along a slope, or back if d < 0. */
static inline struct motion_state motion_moved(struct rkm04_fixed y, struct rkm04_fixed w, int64_t slope, int64_t d)
{
    int64_t half = slope * d;
    struct wide part = wide_product(w.part, (uint64_t)d);
    uint64_t whole = d < 0 ? part.high - w.part : part.high; /* (uint64_t)d is 2^64 more than d */
    struct rkm04_fixed way = {d * (w.whole + half) + (int64_t)whole, part.low};
    return (struct motion_state){fixed_sum(y, way), {w.whole + 2 * half, w.part}};
}

#endif
