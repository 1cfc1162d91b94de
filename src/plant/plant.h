/* SPDX-License-Identifier: MIT */
/* plant.h: what the motors of a unit move: a true position of each motor, which follows the pulses, end stops, and switches
 * that drive inputs; the face of the room.
 *
 *     plant_read     a plant from a YAML map
 *     plant          the model: pulses in, changes of inputs and reports out
 *     plant_coils    a rotor that follows the field of its coils
 *     plant_stall    what a rotor can follow
 *     plant_json     a plant as JSON
 *     plant_model    the model's data; private to the room
 *
 * Off unless configured; it never changes what the firmware does, only what happens at its pins. docs/PLANT.md describes it.
 *
 * A plant is fed with pulses as they come (each motor's in order of time, T41: none come) and gives changes of inputs back. It
 * lives in ticks of the line. */
#ifndef RKM04_PLANT_H
#define RKM04_PLANT_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "device/device.h"

struct config_node; /* text/config_tree.h */
struct plant;

#define PLANT_POSITION_MAX INT64_C(1000000000000) /* steps, either way, of everything configured */

enum plant_event {
    PLANT_STALL,    /* steps are being lost: too fast, too steep; text says which motor and where */
    PLANT_END_STOP, /* the axis is at an end stop and loses steps */
    PLANT_JAM,
    PLANT_FREE,     /* steps count again */
    PLANT_LEAD,     /* a lead of the motor is missing: it does not turn */
    PLANT_FIELD     /* the field of its coils has come to point away from the rotor: leads are missing or swapped */
};

#define PLANT_TEXT_SIZE 112u

/* Something that a motor of the plant does. */
struct plant_report {
    uint64_t tick; /* of the line: that of the pulse */
    uint8_t motor; /* 1..axes */
    uint8_t news;  /* enum plant_event */
    char text[PLANT_TEXT_SIZE];
};

/* A change of an input that the plant drives. */
struct plant_change {
    uint64_t tick; /* of the line, at which it may be seen: one after the pulse that led to it, later with bouncing */
    uint8_t input; /* 1..inputs */
    bool level;
};

/* What a plant has to know of the device whose motors it moves. */
struct plant_device {
    const struct device_kind *kind;
    int64_t position[DEVICE_AXES_MAX]; /* the counters, in steps */
    bool has_coils[DEVICE_AXES_MAX];   /* the motor follows plant_outputs(), not plant_step() */
    struct device_coils coils[DEVICE_AXES_MAX];
    uint32_t outputs;                  /* as they are */
};

/* Read the plant of one unit from a map, to begin at tick `now`: true positions are the counters plus the configured offsets.
 * `seed` chooses how switches bounce. Returns NULL: errors have been reported. */
struct plant *plant_read(const struct config_node *node, const struct plant_device *device, uint64_t now, uint64_t seed);

/* NULL: nothing. */
void plant_free(struct plant *plant);

/* Inputs it drives, mask; and their levels now. */
uint32_t plant_mask(const struct plant *plant);
uint32_t plant_levels(const struct plant *plant);

/* A pulse. Called from within the unit: must not change the unit. */
void plant_step(struct plant *plant, uint64_t tick, unsigned motor, bool forward);

/* Most pulses of a motor between two calls of plant_take_change(). */
#define PLANT_STEPS_MAX 512u

/* The outputs have changed, as far as they drive a motor's coils. The same restriction. */
void plant_outputs(struct plant *plant, uint64_t tick, unsigned motor, const struct device_coils *coils, uint32_t outputs);

/* The next change with a tick before `tick`, in order of time; it counts for plant_levels() from now on. Returns false if there
 * is none: then everything before `tick` is done. */
bool plant_take_change(struct plant *plant, uint64_t tick, struct plant_change *change);

/* The next thing to report of what has been done, in order of time. Returns false if there is none. */
bool plant_take_report(struct plant *plant, struct plant_report *report);

/* "stall", "end_stop", "jam", "free", "missing_lead", "wrong_field". Never NULL. */
const char *plant_event_name(enum plant_event news);

/* When something changes without a pulse (a switch bounces); DEVICE_NEVER: never. */
uint64_t plant_next(const struct plant *plant);

/* True position of a motor, from 1, in steps. Motors without a plant follow their counter; then false. */
bool plant_position(const struct plant *plant, unsigned motor, int64_t *position);

/* What a hand does, at `tick`: put the carriage somewhere; hold it, or let it go; take a lead of the motor off, or put it on
 * again. Switches follow. Returns false if there is no plant for this motor, or the position lies beyond an end stop: nothing is
 * changed then. */
bool plant_place(struct plant *plant, uint64_t tick, unsigned motor, int64_t position);
bool plant_jam(struct plant *plant, unsigned motor, bool jammed);
bool plant_take_lead(struct plant *plant, unsigned motor, bool missing);

/* The plant as it is, for `state` and plant.get. New reference; NULL: out of memory. No plant (NULL): null. */
json_t *plant_json(const struct plant *plant);

/* A copy with all times `shift` ticks later, for snapshots. NULL: out of memory. */
struct plant *plant_copy(const struct plant *plant, uint64_t shift);

#endif
