/* SPDX-License-Identifier: MIT */
/* section.h: the way of a block, or of a section of up to 15 blocks of a continuous path, through the axes (NM5, NM6, NM8). Pure
 * geometry: it knows the configuration and the NC program, not the cells. */
#ifndef CNC872_SECTION_H
#define CNC872_SECTION_H

#include <stdbool.h>
#include <stdint.h>

#include "config.h"
#include "nc.h"
#include "path.h"

#define CNC_SEGMENTS_MAX 15u

static inline bool cnc_has_axis(uint16_t axes, unsigned axis)
{
    return ((unsigned)axes >> axis & 1u) != 0;
}

/* The way of one block. */
struct cnc_segment {
    int64_t way[CNC_AXES];  /* u, 0: the axis does not move */
    int64_t length, border; /* u; border: where it ends, from the begin of the section */
    int64_t rapid, slow;    /* u/T along the path: the axes' FeedRT and FeedSlow (NM6, NM7) */
    uint16_t axes;          /* that move */
};

struct cnc_section {
    int64_t start[CNC_AXES]; /* u, POS0 */
    int64_t length;          /* u */
    int64_t acceleration[CNC_SETS]; /* u/T^2 along the path: the smallest of the blocks */
    uint16_t n[CNC_SETS];           /* the greatest of the blocks; 1 with linear ramps */
    uint16_t axes;                  /* that move in any of the blocks */
    uint8_t count;                  /* of segments; 0: no motion */
    uint32_t first;                 /* block of the NC program to which the first segment belongs */
    struct cnc_segment segment[CNC_SEGMENTS_MAX];
};

/* The way of block `first` from the positions, and of those that follow in the same section; only_one: of the block alone (M01
 * and block by block stop after it). section->count = 0 if the block has no motion. */
void cnc_section_build(struct cnc_section *section, const struct cnc_config *config, const struct cnc_nc_program *program,
                       uint32_t first, const int64_t position[CNC_AXES], bool only_one);

/* REQ_LINEARACCEL and REQ_PARABACCEL of a motion that is neither rapid nor with linear ramps: replace the normal set (NM5).
 * acceleration: u/T^2, 0: as configured; change: u/T^3, 0: as configured. */
void cnc_section_request(struct cnc_section *section, const struct cnc_config *config, int64_t acceleration, double change);

/* The segment in which the path is after `done` u; the last one at the end. */
unsigned cnc_section_at(const struct cnc_section *section, int64_t done);

/* Positions of the moved axes after `done` u; others are left as they are. */
void cnc_section_place(const struct cnc_section *section, int64_t done, int64_t position[CNC_AXES]);

/* Of one segment, along the path (NM5): the acceleration of a set, u/T^2; LinearAccel and ParabAccel of the set for feed, u/T^2
 * and u/T^3 (dwAxGLinearAccel, rAxGParabAccel). */
int64_t cnc_segment_acceleration(const struct cnc_segment *segment, const struct cnc_config *config, enum cnc_set set);
int64_t cnc_segment_linear(const struct cnc_segment *segment, const struct cnc_config *config);
double cnc_segment_change(const struct cnc_segment *segment, const struct cnc_config *config);

/* Way of the axes of a block from `from`, where they were before it, to its targets, its length, its limits. `border` is its
 * length. Returns whether it has motion. */
bool cnc_segment_build(struct cnc_segment *segment, const struct cnc_config *config, const struct cnc_nc_program *program,
                       uint32_t block, const int64_t from[CNC_AXES]);

/* Has an M function of the block this attribute, CNC_M_BREAK_CONT ...? */
bool cnc_has_attribute(const struct cnc_config *config, const struct cnc_nc_block *block, unsigned attribute);

/* value * by / |divisor|, rounded down, at most CNC_SPEED_LIMIT: what an axis' limit is along a path of length `by` on which its
 * way is `divisor` (NM5). value, by: 0 or more; divisor: not 0. */
int64_t cnc_scale(int64_t value, int64_t by, int64_t divisor);

#endif
