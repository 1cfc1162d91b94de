/* SPDX-License-Identifier: MIT */
/* pmc_motion.h: motions of an axis: begin, pulses, limits, stops, end. */
#ifndef PMC_PMC_MOTION_H
#define PMC_PMC_MOTION_H

#include "pmc.h"

/* How a motion is to go. */
struct pmc_move {
    int64_t way;          /* pulses, forward > 0 */
    uint16_t speed;       /* as it is set */
    uint16_t start_speed; /* as it is set; the speed itself: no ramps */
    bool endless;         /* `way` gives the direction alone */
    bool manual;          /* the fifth speed counts (AM7) */
};

/* Is the limit switch of this direction active, as this slot sees it? */
bool pmc_at_limit(const struct pmc_axis *axis, bool forward);

/* Begin a motion, whatever is in its way; the way is 1 to 2^32-1 pulses. */
void pmc_motion_begin(struct pmc_unit *unit, struct pmc_axis *axis, const struct pmc_move *move);

/* Begin a motion within the limits (AL1, AL3), or raise the error that there is instead. Returns false if the way is 0 or no
 * pulse may be made. */
bool pmc_motion_move(struct pmc_unit *unit, struct pmc_axis *axis, const struct pmc_move *move);

/* Stop with a ramp, or at once (AM8, AM9). */
void pmc_motion_stop(struct pmc_unit *unit, struct pmc_axis *axis);
void pmc_motion_stop_now(struct pmc_unit *unit, struct pmc_axis *axis);

/* The fifth speed is another one (AM7). */
void pmc_motion_change_speed(struct pmc_unit *unit, struct pmc_axis *axis);

/* All pulses due up to `limit`. */
void pmc_motion_run(struct pmc_unit *unit, struct pmc_axis *axis, uint64_t limit);

/* In a slot: a limit switch in the way (AL3). */
void pmc_motion_watch(struct pmc_unit *unit, struct pmc_axis *axis);

/* In a slot: is a motion over now (AT4)? Then an error of a software limit is raised. */
void pmc_motion_finish(struct pmc_unit *unit, struct pmc_axis *axis);

#endif
