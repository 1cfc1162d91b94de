/* SPDX-License-Identifier: MIT */
/* curves.h: what a picture of a run shows: for each motor the planned speed and position over time, what it waits for, and the
 * levels of inputs, outputs and variables. Filled by collect.c from a sim, or by read_trace.c from a trace. */
#ifndef RKM04_PLOT_CURVES_H
#define RKM04_PLOT_CURVES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define PLOT_MOTORS 16u
#define PLOT_POINTS_MAX 4000000u /* of a list: a run with more is cut off there */
#define PLOT_TEXT_SIZE 24u

/* A corner of the speed. Between two the acceleration is constant; two at one time are a jump. */
struct plot_point {
    double us, speed, position; /* steps/s, < 0: back; counter */
};

/* A motor does something else than move: it dwells, waits, is held. */
struct plot_band {
    double from, to; /* us */
    char state[PLOT_TEXT_SIZE], command[PLOT_TEXT_SIZE];
};

/* From its first to its last pulse. */
struct plot_motion {
    double from, to; /* us */
};

struct plot_motor {
    struct plot_point *point;
    struct plot_band *band;
    struct plot_motion *motion;
    struct plot_point *truth; /* where the plant is; speed is not used */
    size_t points, points_room, bands, bands_room, motions, motions_room, truths, truths_room;
    bool is_moving;           /* the last motion has no end yet */
    bool is_used;             /* something happened */
};

enum plot_mask { PLOT_INPUTS, PLOT_OUTPUTS, PLOT_VARIABLES, PLOT_MASKS };

struct plot_level {
    double us;
    uint32_t mask; /* from then on */
};

struct plot_levels {
    struct plot_level *level;
    size_t levels, levels_room;
    unsigned first; /* number of bit 0 */
};

struct plot_curves {
    struct plot_motor motor[PLOT_MOTORS];
    struct plot_levels mask[PLOT_MASKS];
    unsigned motors;
    double end;          /* us */
    bool from_pulses;    /* speeds are means over pulses: the plan is not known */
    bool is_cut;         /* PLOT_POINTS_MAX was reached */
    bool short_of_memory;
};

/* Make room for one more in a list of `count` members of `size` bytes; *room: those it has room for. Returns the list, which may
 * have moved; NULL: there is no room, the curves say why, and the list stays as it was. */
void *plot_grow_list(struct plot_curves *curves, void *list, size_t count, size_t *room, size_t size);

/* Append a corner. One that lies on the straight line between its neighbours is left out. */
void plot_add_point(struct plot_curves *curves, struct plot_motor *motor, struct plot_point point);

/* Drop what lies after `us`; there, the curve has the value that it would have had. */
void plot_cut(struct plot_curves *curves, struct plot_motor *motor, double us);

void plot_add_level(struct plot_curves *curves, enum plot_mask mask, double us, uint32_t value);

/* Begin or end a motion. */
void plot_mark_motion(struct plot_curves *curves, struct plot_motor *motor, double us, bool begins);

/* The motor is in this state at `us`: the band before continues, or another one begins. NULL: in none that is shown. */
void plot_mark_state(struct plot_curves *curves, struct plot_motor *motor, double us, const char *state, const char *command);

/* Speed and position at `us`. */
struct plot_point plot_point_at(const struct plot_motor *motor, double us);

/* The first corner not before `us`; motor->points: none. */
size_t plot_find(const struct plot_motor *motor, double us);

/* Where a motion has its highest speed, either way: a corner, or the middle between two. */
struct plot_point plot_peak(const struct plot_motor *motor, const struct plot_motion *motion);

void plot_free(struct plot_curves *curves);

#endif
