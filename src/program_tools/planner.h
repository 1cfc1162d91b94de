/* SPDX-License-Identifier: MIT */
/* planner.h: the break points of a motion, asked of an RKM04: it gets the commands and message 6 (Get Tabul Run). */
#ifndef RKM04_PROGRAM_TOOLS_PLANNER_H
#define RKM04_PROGRAM_TOOLS_PLANNER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <rkm04/limits.h>

struct rkm04_unit;

struct planner_segment {
    uint32_t steps;                /* single motion 1..2 000 000 000, of a compound 1..16 000 000 */
    uint16_t speed, acceleration;
};

/* As Get Tabul Run shows it: from this step on this speed holds (P7). */
struct planner_point {
    uint32_t step, speed; /* steps/s, rounded down */
};

#define PLANNER_POINTS_MAX (RKM04_BREAKS_MAX + 2)

struct planner {
    struct rkm04_unit *unit; /* NULL: not used yet */
};

/* The break points of a motion from rest with start speed S. Returns their number, 0: out of memory. All zero is a planner;
 * planner_end() is due. */
size_t planner_ask(struct planner *planner, uint16_t start_speed, const struct planner_segment *segments, size_t count,
                   struct planner_point points[PLANNER_POINTS_MAX]);
void planner_end(struct planner *planner);

/* Read a whole answer of message 6, with ` n;[(s;v),…]` after its first two bytes. Returns the number of points. */
size_t planner_read(const uint8_t *answer, size_t length, struct planner_point points[PLANNER_POINTS_MAX]);

#endif
