/* SPDX-License-Identifier: MIT */
/* condition.h: something to wait for, from JSON: control methods `wait` and `advance`, and scenarios; the face of the room.
 *
 *     condition          does it hold, and when may it hold next
 *     condition_read     a condition from JSON
 *     condition_term     what a condition consists of, and its relations
 *     condition_until    parameters and answers of `wait` and `advance`
 *     exchange           the method of a device that takes time
 *
 *     {"unit": 3, "motor": 1, "position": 5000}          the counter is there; or ">=": {"position": {">=": 5000}}
 *     {"motor": 2, "true_position": {"<=": 0}}           of the plant
 *     {"motor": 1, "state": "idle"} {"idle": true}       one motor; all motors of the unit
 *     {"motor": 1, "led": "blink"} {"motor": 1, "fault": "no_label"} {"motor": 1, "steps": {">": 10}}
 *     {"do": {"3": 1}} {"di": {"08": 0}} {"var": {"80": 1}}
 *     {"message": {"number": 2, "from": "master"}}       one that passes from now on
 *     {"t": "2.5s"}                                      the time of the bus
 *     {"all": [ … ]} {"any": [ … ]}                      of several
 *
 * Plain: condition_read(), condition_arm(), then condition_holds() after each step of time; or condition_run(). */
#ifndef RKM04_CONDITION_H
#define RKM04_CONDITION_H

#include "command/command.h"
#include "sim/sim.h"

struct condition;

/* Read and check all of it. Returns NULL if it is wrong: refused. */
struct condition *condition_read(struct sim *sim, const json_t *json, struct refusal *refusal);
void condition_free(struct condition *condition);

/* Begin: messages count from now on. The sim must outlive the condition. */
void condition_arm(struct condition *condition);

/* Does it hold at the present tick? A pulse at tick t counts from t + 1 on. */
bool condition_holds(struct condition *condition);

/* When it may hold next if nothing comes from outside: no need to look before. DEVICE_NEVER: never of itself. */
uint64_t condition_next(const struct condition *condition);

/* One step of time towards `limit`, no further than to where the condition may have come to hold. Returns whether it holds. */
bool condition_step(struct condition *condition, uint64_t limit);

/* Advance the sim until it holds, to the tick, or up to `limit`. Returns true if it holds. */
bool condition_run(struct condition *condition, uint64_t limit);

/* What it says and what there is instead, for messages: "motor 1 position >= 5000 (is 1200)". Returns a string to be freed;
 * NULL: out of memory. */
char *condition_text(struct condition *condition);

/* The same in two: "motor 1 position >= 5000", "motor 1 position 1200". */
char *condition_wanted_text(struct condition *condition);
char *condition_found_text(struct condition *condition);

/* ---- What the methods `advance` and `wait` are given and what they answer (docs/CONTROL.md) ---------------------------- */

struct until {
    struct condition *condition; /* NULL: until the time is over; to be freed */
    uint64_t end;                /* tick at which it is over, at most SIM_TIME_MAX */
};

/* Read the parameters of `advance`, or of `wait`, at the present tick. Returns false: refused. */
bool until_read_advance(struct until *until, struct sim *sim, const json_t *params, struct refusal *refusal);
bool until_read_wait(struct until *until, struct sim *sim, const json_t *params, struct refusal *refusal);

/* The answer at the present tick. `condition`: NULL: there is none. Returns a new reference, or NULL if out of memory. */
json_t *until_answer(const struct sim *sim, struct condition *condition, bool holds);

/* ---- The exchange of a device (struct device_exchange), a method that takes time ----------------------------------------- */

struct exchange {
    const char *get;  /* the method whose result is the answer; NULL: it is none */
    json_t *params;   /* of it */
    uint64_t end;     /* tick at which it is asked, not before the present one */
};

/* Has the device such a method, and is this its name? */
bool exchange_is_named(const struct sim *sim, const char *method);

/* Read {set, slots, get, unit}, and do what `set` has, at the present tick. Returns false: refused, nothing has changed. */
bool exchange_begin(struct exchange *exchange, struct sim *sim, const json_t *params, struct refusal *refusal);

/* Its answer, at its end, a new reference; NULL: refused. exchange_drop() is due in any case; also for one that is all zero. */
json_t *exchange_answer(const struct exchange *exchange, struct sim *sim, struct refusal *refusal);
void exchange_drop(struct exchange *exchange);

/* The other parts that rooms above use. */
#include "condition_term.h"

#endif
