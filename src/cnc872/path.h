/* SPDX-License-Identifier: MIT */
/* path.h: one motion along a path, in whole units of 2^-16 um (u) and of 1 ms (T): an input stage with a limit of acceleration
 * and, if the change of the acceleration is limited too, a moving average behind it. Pure: it knows neither axes nor cells.
 * Clauses NM1 to NM4, NM8 and NM10 of docs/CNC872.md. */
#ifndef CNC872_PATH_H
#define CNC872_PATH_H

#include <stdbool.h>
#include <stdint.h>

#define CNC_AVERAGE_MAX 1000u             /* values in the moving average */
#define CNC_SPEED_LIMIT INT64_C(1000000000000) /* u/T; no speed and no acceleration is above it */
#define CNC_ENDLESS INT64_MAX             /* length of a motion without an end */
#define CNC_BORDERS_MAX 14u               /* inside a section of 15 blocks */

/* The average is over the last n speeds of the input stage, which stand in a ring that the caller owns (CNC_AVERAGE_MAX numbers):
 * motions with n = 1 need none. */
struct cnc_path {
    int64_t length;       /* u; or CNC_ENDLESS */
    int64_t done;         /* u, way that the path has gone */
    int64_t left;         /* u, way that the input stage has not yet given */
    int64_t u, v;         /* u/T, speed of the input stage and of the path */
    int64_t acceleration; /* u/T^2, 1 or more */
    int64_t sum;          /* of the ring; 0 with n = 1 */
    uint16_t n, at, carry;
};

/* What lies ahead of the input stage: from `at` u of the path on the speed may be `speed` at most. In order of `at`. */
struct cnc_border {
    int64_t at, speed;
};
struct cnc_borders {
    struct cnc_border border[CNC_BORDERS_MAX];
    unsigned count;
};

/* Begin a motion of `length` u at rest. acceleration: 1 ... CNC_SPEED_LIMIT; n: 1 ... CNC_AVERAGE_MAX. ring: NULL with n = 1. */
void cnc_path_begin(struct cnc_path *path, int64_t *ring, int64_t length, int64_t acceleration, unsigned n);

/* Go on with another acceleration and another n at the present speed (NM4). Returns false if the way left is too short for the
 * new acceleration: the motion then is as it was. */
bool cnc_path_change(struct cnc_path *path, int64_t *ring, int64_t acceleration, unsigned n);

/* Speed 0 at once; the way left stays. */
void cnc_path_halt(struct cnc_path *path, int64_t *ring);

/* One T (NM2, NM3). target: u/T, 0 ... CNC_SPEED_LIMIT. hold: 0, or the deceleration in u/T^2 of a hold (NM10, linear ramps).
 * borders: NULL, or what lies ahead. Returns the new speed, by which `done` has grown. */
int64_t cnc_path_step(struct cnc_path *path, int64_t *ring, int64_t target, int64_t hold, const struct cnc_borders *borders);

/* Advance by as many T's as are known beforehand, `limit` at most: T's in which the speed is the target, neither the final ramp
 * nor the ramp before a border begins, the input stage begins before `input_until` u, and the path before `path_until` u. Returns
 * how many those were; 0 if the next T is none. For looking ahead (TIME_DIST). */
int64_t cnc_path_glide(struct cnc_path *path, const int64_t *ring, int64_t target, const struct cnc_borders *borders,
                       int64_t input_until, int64_t path_until, int64_t limit);

/* Nothing moves, neither the path nor what the average still holds. */
static inline bool cnc_path_is_at_rest(const struct cnc_path *path)
{
    return path->u == 0 && path->v == 0 && path->sum == 0;
}

/* Way to the end, u. */
static inline int64_t cnc_path_rest(const struct cnc_path *path)
{
    return path->length - path->done;
}

#endif
