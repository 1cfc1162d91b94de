/* SPDX-License-Identifier: MIT */
/* collect.h: fills curves from a unit of a sim while it runs. */
#ifndef RKM04_PLOT_COLLECT_H
#define RKM04_PLOT_COLLECT_H

#include "curves.h"
#include "sim/sim.h"

struct collector {
    struct plot_curves *curves;
    struct sim *sim;
    unsigned unit;
    struct watcher watcher;
    uint64_t looked;              /* us of the last look */
    double begin[PLOT_MOTORS];    /* us of a motion that began since then; < 0: none */
    double truth_every;           /* us between two true positions */
};

/* Begin to watch unit 1.. of `sim`; it must stay until collector_end(). `follow`: read each slot in which something happens,
 * for who cannot call collector_update() after each advance. */
void collector_begin(struct collector *collector, struct plot_curves *curves, struct sim *sim, unsigned unit, bool follow);

/* Read the present plans. To be called after each advance that ended with something happening. */
void collector_update(struct collector *collector);

/* The run has ended. */
void collector_end(struct collector *collector);

#endif
