/* SPDX-License-Identifier: MIT */
/* bus_time.h: how the units of a bus follow its clock: catch up, sleep, wait, step. It drives the sim and reports to the bus that
 * owns it through the calls given at the beginning. */
#ifndef RKM04_BUS_TIME_H
#define RKM04_BUS_TIME_H

#include <uv.h>

#include "bus_log.h"
#include "bus_options.h"
#include "command/command.h"
#include "condition/condition.h"
#include "line/line.h"
#include "sim/sim.h"
#include "virtual_clock.h"

/* A waiter for a condition or a time on the bus. */
struct bus_waiter {
    struct condition *condition; /* armed; NULL: time alone */
    uint64_t limit;              /* tick up to which it is waited for */
    /* It holds at the present tick, or `limit` has come. The waiter is off the list by then. */
    void (*done)(struct bus_waiter *waiter, bool holds);
    void *context;
    struct bus_waiter *next;     /* inside */
};

struct bus_time_calls {
    uint64_t (*due)(const void *context); /* tick at which gathered bytes are to leave; DEVICE_NEVER: there are none */
    void (*advanced)(void *context);      /* the units have been advanced: gathered bytes may be due */
    void (*before_sleep)(void *context);  /* nothing more to do for now */
};

struct bus_time {
    const struct bus_options *options;
    const struct bus_log *log;
    const struct bus_time_calls *calls;
    void *context;
    struct sim *sim;
    bool timed;           /* bytes take their time unless the clock is stopped */
    uint32_t own_kinds;   /* of watch.h, what the bus itself watches, not for a client */

    struct virtual_clock clock;
    char clock_text[16];  /* as it was set */
    uint64_t last_byte;   /* ns at which the last bytes came */
    uint64_t goal;        /* a stopped clock: tick to which it is advanced */
    uint64_t wake;        /* ns for which the timer is set; 0: it is not */
    struct bus_waiter *waiters;
    struct bus_waiter *advancing; /* of them, the one for whom the clock is moved; NULL: none */
    uint64_t cuts;                /* segment_counters.cuts that are logged */
    bool running;                 /* time has begun */
    bool busy;                    /* within bus_time_catch_up() */
    uint64_t behind;              /* ns since when bus_time_catch_up() has not got as far as the clock; 0: it has */
    bool behind_logged;           /* of this clock */
    bool over_logged;             /* that virtual time has come to its end */
    struct wake_timer timer;
};

/* Tell it what it drives and whom it reports to. *time is zero. */
void bus_time_prepare(struct bus_time *time, const struct bus_options *options, bool timed, struct sim *sim,
                      const struct bus_log *log, const struct bus_time_calls *calls, void *context);

/* Make the timer. Returns false if it did not work (reported). */
bool bus_time_begin(struct bus_time *time, uv_loop_t *loop);

/* Tick 0 is now. */
void bus_time_start(struct bus_time *time);
void bus_time_end(struct bus_time *time);

/* Advance the units to the present as far as that does not take long, send what is due, and set the timer.
 * bus_time_update(): unless that is being done already. bus_time_before_read(): before bytes are read; does nothing with
 * --clock max, which leaps when there is nothing to read. */
void bus_time_catch_up(struct bus_time *time);
void bus_time_update(struct bus_time *time);
void bus_time_before_read(struct bus_time *time);

/* Bytes have come. */
void bus_time_note_bytes(struct bus_time *time);

/* For bus.h, which describes them. */
uint64_t bus_time_present(const struct bus_time *time);
void bus_time_changed(struct bus_time *time);
void bus_time_wait(struct bus_time *time, struct bus_waiter *waiter);
void bus_time_cancel_wait(struct bus_time *time, struct bus_waiter *waiter);
bool bus_time_advance(struct bus_time *time, struct bus_waiter *waiter);
bool bus_time_is_stepped(const struct bus_time *time);
bool bus_time_set_clock(struct bus_time *time, const char *text, struct refusal *refusal);

#endif
