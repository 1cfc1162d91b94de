/* SPDX-License-Identifier: MIT */
/* plant_model.h: the inside of a plant: plant_read.c makes it of a text, plant.c runs it, plant_stall.c knows what a rotor can
 * follow. Plain data without pointers: a copy is a copy. */
#ifndef RKM04_PLANT_MODEL_H
#define RKM04_PLANT_MODEL_H

#include "plant.h"

#define PLANT_SWITCHES 32u
#define PLANT_JAMS 16u
#define PLANT_POINTS 16u  /* of a stall curve */
#define PLANT_PULSES (2u * PLANT_STEPS_MAX) /* of a motor that may wait */
#define PLANT_NO_FIELD 8u /* no coil is driven, or both leads of each in the same way */
#define PLANT_REPORTS 64u
#define PLANT_SPAN 10000u /* ticks over which speed is measured: a tick of rounding is then 1/10 000 of it */

/* Why steps do not count. */
enum plant_hold { PLANT_MOVES, PLANT_AT_STOP, PLANT_JAMMED, PLANT_STALLED, PLANT_NO_LEAD, PLANT_NO_TORQUE };

struct plant_window {
    uint64_t from, until; /* from <= tick < until; DEVICE_NEVER: no end */
};

/* The acceleration that the motor can give at a speed. */
struct plant_point {
    uint32_t speed, acceleration;
};

struct plant_stall {
    uint32_t start;  /* steps/s that it follows from standing, and in any change up to there */
    unsigned points; /* 0: it never stalls */
    struct plant_point point[PLANT_POINTS]; /* speeds increase; beyond the last one it stalls */

    uint64_t last;   /* tick of the last pulse; DEVICE_NEVER: none yet */
    bool forward;    /* its direction */
    bool out_of_step;
    int64_t base;    /* steps/s: highest speed that it may have had when it last was calm: slow, or standing */
    uint32_t run;    /* intervals since then */
    uint64_t begin;  /* tick at which the present span begins */
    uint32_t steps;  /* in it */
    uint64_t before; /* ticks of the span before; 0: none */
    int64_t speed;   /* in that, 1/1000 steps/s */
};

struct plant_motor {
    bool present;
    int64_t low, high; /* end stops; INT64_MIN, INT64_MAX: none */
    int64_t turn;      /* steps of a turn, switches depend on the angle; 0: no turntable */
    unsigned jams;
    struct plant_window jam[PLANT_JAMS];
    bool held, no_lead; /* by hand, or configured */
    struct plant_stall stall;

    int64_t position;
    uint64_t lost;       /* steps, ever */
    uint64_t lost_since; /* of these, since they began to be lost */
    enum plant_hold hold;

    /* A rotor that follows the field of its coils. Angles are eighths of a turn of the field, 0..7. */
    uint8_t lead[4]; /* of the device, 1..4, to which lead 1..4 of the motor is connected; 0: to none */
    uint8_t angle;   /* of the rotor */
    uint8_t field;   /* as last queued; PLANT_NO_FIELD */
    int8_t part;     /* eighths that the rotor is beyond `position` */
    uint8_t eighths; /* of a step; 0: the motor follows pulses */

    /* What has not been done, in a ring: the pulses, or how the field changes. */
    unsigned first, pulses;
    struct {
        uint64_t tick : 56, what : 8; /* what: 0 back, 1 forward; or the field */
    } pulse[PLANT_PULSES];
};

struct plant_switch {
    uint8_t input, motor; /* from 1 */
    bool normally_closed; /* the input is 0 while it is actuated */
    int64_t low, high;    /* actuated from low to high; with `turn` also the other way round */
    int64_t hysteresis;   /* steps beyond that until it is released */
    uint64_t bounce;      /* ticks */

    bool on;              /* actuated */
    bool contact;         /* what it says: differs from `on` while it bounces */
    uint64_t settled;     /* tick at which it no longer bounces */
    uint64_t next;        /* tick of the next bounce; DEVICE_NEVER: it does not */
    uint64_t random;
};

struct plant {
    unsigned switches;
    struct plant_switch contact[PLANT_SWITCHES];
    uint32_t mask, levels; /* as reported */
    uint64_t now;          /* everything before it is done */
    unsigned reports;
    struct plant_report report[PLANT_REPORTS];
    unsigned axes;
    struct plant_motor motor[]; /* one for each axis of the device */
};

/* Set a switch as the position of its motor demands, without bouncing. */
void plant_switch_begin(const struct plant *plant, struct plant_switch *contact);

/* A new plant for a device with so many axes, without motors. NULL: out of memory. */
struct plant *plant_new(unsigned axes);

/* All inputs as its switches have them. */
uint32_t plant_contacts(const struct plant *plant);

/* Is a motor, from 1, jammed now? */
bool plant_is_jammed(const struct plant *plant, unsigned motor);

/* Keep what happens to a motor, from 1, until its time has come. */
void plant_queue(struct plant *plant, uint64_t tick, unsigned number, unsigned what);

/* plant_coils.c: put the rotor of a motor to where these outputs, or rest, hold it. */
void coils_begin(struct plant_motor *motor, const struct device_coils *coils, uint32_t outputs);

/* Eighths by which the field turns the rotor, -3..3; 0: it does not. *opposite: the field points away from it. */
int coils_turn(const struct plant_motor *motor, unsigned field, bool *opposite);

/* A pulse comes: can the rotor follow it? */
bool stall_follows(struct plant_stall *stall, uint64_t tick, bool forward);

/* It could not, for another reason: it follows again when pulses come slowly enough. */
void stall_slips(struct plant_stall *stall);

#endif
