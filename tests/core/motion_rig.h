/* SPDX-License-Identifier: MIT */
/* motion_rig.h: one motor under test against the reference: its pulses as bare ticks, so that 16 000 000 of them fit.
 *
 * A rig can be branched: `save = *rig; …; *rig = save;` takes everything back, the unit included (its state is plain data). */
#ifndef RKM04_TESTS_MOTION_RIG_H
#define RKM04_TESTS_MOTION_RIG_H

#include <check.h>
#include <inttypes.h>
#include <rkm04/unit.h>

#include "reference.h"

#define MOTION_ROOM (1u << 18) /* pulses remembered one by one */

struct motion_rig {
    struct rkm04_unit unit;
    uint64_t steps;             /* pulses of motor 1 */
    uint64_t *tick;             /* of pulse k at tick[k - 1]; with `wanted`: of pulse wanted[i] at tick[i] */
    const uint64_t *wanted;     /* ascending; NULL: every pulse */
    size_t wanted_count, wanted_next;
    uint64_t last, spacing;     /* tick of the last pulse; least distance of two pulses */
    int32_t position;
    bool torn;                  /* a pulse that is not 1 away from the one before, or of another motor */
    uint64_t begin, end;        /* last events of a motion */
    unsigned begins, ends;
    unsigned turns;             /* changes of the direction output */
    uint64_t turned;            /* tick of the last one */
    bool forward;               /* false at power-up: the output is at 0 */
    uint8_t outputs;
    uint64_t outputs_tick;      /* of the last change */
};

/* Power-up at tick 0. The ticks go to a buffer that is made once. */
void motion_start(struct motion_rig *rig, uint16_t speed_change_latency);

/* Remember these pulses only. */
void motion_want(struct motion_rig *rig, const uint64_t *wanted, size_t count);

/* Send motor 1 a text at the present tick; it must be taken. */
void motion_send(struct motion_rig *rig, const char *text);

/* From now on pulses are not listened to, or are again; rig->steps continues where the unit is. */
void motion_listen(struct motion_rig *rig, bool listen);

/* Do all ticks before this one. */
void motion_to(struct motion_rig *rig, uint64_t tick);

/* Message 6 (P7) at the present tick: the text after the motor's digit. Valid until the next call. */
const char *motion_table(struct motion_rig *rig);

/* State of motor 1. */
enum rkm04_state motion_state(const struct motion_rig *rig);

/* Send `S V A F R` (back: B) and note the tick of the slot of R in rig->begin. Must be called at a slot's tick or 0. */
void motion_single(struct motion_rig *rig, unsigned start_speed, const struct ref_segment *motion, bool back);

/* Send S, then A V F Y for every segment, then R. Returns the tick of the slot of R. */
uint64_t motion_compound(struct motion_rig *rig, unsigned start_speed, const struct ref_segment *segment, unsigned segments);

/* ck_assert_msg writes to a file each time it passes; this one is free until it fails. */
#define motion_check(condition, ...) \
    do { \
        if (!(condition)) \
            ck_abort_msg(__VA_ARGS__); \
    } while (0)

/* Report what is being tried; every failure below repeats it. */
void motion_trying(const char *format, ...) __attribute__((format(printf, 1, 2)));
const char *motion_what(void);

/* Append the parameters of a motion to what is being tried. */
void motion_trying_segments(unsigned start_speed, const struct ref_segment *segment, unsigned segments);

/* Pulses first+1 … first+track->steps of the rig are those of the track begun at tick `begin`, each within `slack` ticks,
 * from the track's pulse k = `from` on, and no pulse follows. */
void motion_expect(const struct motion_rig *rig, const struct ref_track *track, uint64_t begin, uint64_t first, uint64_t from,
                   unsigned slack);

/* Of all pulses that motion_expect() has seen, at most one in 10 000 is off at all. */
void motion_expect_few_off(void);

/* ---- Random parameters ---- */

/* RKM04_TEST_SEED, or a fixed number. */
uint64_t motion_seed(void);

/* `normal` times RKM04_TEST_SCALE (1 if not set). */
unsigned motion_count(unsigned normal);

/* Begin a series of random numbers that depends on the seed and this number. */
void motion_randomize(uint64_t run);
uint64_t motion_random(uint64_t below);

/* low..high, evenly over the logarithm; the limits themselves come often. */
unsigned motion_pick(unsigned low, unsigned high);

#endif
