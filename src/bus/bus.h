/* SPDX-License-Identifier: MIT */
/* bus.h: one line with its units and the ways in for clients, driven by the event loop.
 *
 *     bus_ports --bus_take--> sim (units, two wires, virtual time) --> bus_ports
 *     clock     --on_timer--> sim
 *
 * Nothing of a motion is seen outside except in answers, so a line sleeps until a byte is to be moved or comes in, and its units
 * catch up then. Only in order that this never takes long it also wakes now and then while something is going on, and more often
 * while somebody watches or waits. */
#ifndef RKM04_HOST_BUS_H
#define RKM04_HOST_BUS_H

#include <uv.h>

#include "bus_coverage.h"
#include "bus_files.h"
#include "bus_ports.h"
#include "command/command.h"
#include "condition/condition.h"
#include "line/line.h"
#include "bus_options.h"
#include "sim/sim.h"

struct bus_unit {
    char *flash_path; /* NULL: memory only */
    struct flash_file flash;
    bool open;
};

/* What a line tells the program. */
struct bus_calls {
    void (*failed)(void *context);   /* the line is lost (reported) */
    void (*presence)(void *context); /* a client has come or gone, or bytes came */
};

/* Somebody who waits for something on the line. */
struct bus_waiter {
    struct condition *condition; /* armed; NULL: time alone */
    uint64_t limit;              /* tick up to which it is waited for */
    /* It holds at the present tick, or `limit` has come. The waiter is off the list by then. */
    void (*done)(struct bus_waiter *waiter, bool holds);
    void *context;
    struct bus_waiter *next;     /* inside */
};

struct bus {
    unsigned number;      /* 0, 1, … */
    const struct bus_options *options;
    const struct bus_calls *calls;
    void *context;
    struct coverage *coverage; /* NULL: not wanted */
    struct watcher news;  /* for the log */
    unsigned injected;    /* acts of faults on demand */

    struct sim sim;
    struct virtual_clock clock;
    char clock_text[16];  /* as it was set */
    uint64_t heard;       /* ns at which the last bytes came */
    uint64_t taken;       /* tick for which the last bytes were handed over */
    uint64_t answered;    /* a real wire: tick at which the answer in `out` may set out */
    uint64_t goal;        /* a clock that stands: tick to which it is advanced */
    uint64_t wake;        /* ns for which the timer is set; 0: it is not */
    struct bus_waiter *waiters;
    struct bus_waiter *advancing; /* of them, the one for whom the clock is moved; NULL: none */
    uint64_t cuts;        /* segment_counters.cuts that are told */
    bool running;         /* time has begun */
    bool busy;            /* within bus_catch_up() */
    uint64_t behind;      /* ns since when bus_catch_up() has not got as far as the clock; 0: it has */
    bool behind_told;     /* of this clock */
    bool over_told;       /* that virtual time has come to its end */
    int timer_fd;
    uv_poll_t timer;

    struct bus_ports ports;
    struct bus_files files;
    size_t gathered;      /* bytes in `out` */
    uint8_t out[20480];   /* more than the longest answer */
    struct bus_unit unit[NODE_LIST_MAX];
};

/* Prepare line `number`: open its ports and flash images, power its units up at tick 0. *bus must be zero. Failures are reported.
 * Returns false if it did not work; bus_end() is due in either case. */
bool bus_begin(struct bus *bus, unsigned number, const struct bus_options *options, uv_loop_t *loop, struct line_watch *watch,
               struct coverage *coverage, const struct bus_calls *calls, void *context);

/* Everything is ready: make the link, and let time begin. Returns false if it did not work (reported). */
bool bus_start(struct bus *bus);

/* Close everything: first the link, so that nobody follows it to a pty that is gone. The handles are gone when the loop has run
 * out; then bus_free(). Returns false if a flash image, trace or record could not be written (reported). */
bool bus_end(struct bus *bus);
void bus_free(struct bus *bus);

/* ---- For those who drive it from outside (control.h) ------------------------------------------------------------------- */

/* The line, brought up to the present as far as that does not take long. */
struct sim *bus_sim(struct bus *bus);

/* Something was changed by a command: look at once what follows. */
void bus_changed(struct bus *bus);

/* Wait for something. done() may be called before this returns. The waiter must stay until then, or until it is taken off. */
void bus_wait(struct bus *bus, struct bus_waiter *waiter);
void bus_wait_cancel(struct bus *bus, struct bus_waiter *waiter);

/* A clock that stands: let time run to where the waiter is done. Returns false if the clock goes by itself, or somebody else is
 * moving it. */
bool bus_advance(struct bus *bus, struct bus_waiter *waiter);
bool bus_stepped(const struct bus *bus);

/* Another clock from now on, as with --clock. Returns false: refused. */
bool bus_set_clock(struct bus *bus, const char *text, struct refusal *refusal);

/* ---- For the ports ---------------------------------------------------------------------------------------------------- */

/* The present tick, for the log and for bytes that arrive now. The units may be behind it while nobody looks; when they have too
 * much to do for their clock, it is the one they have reached: they hear what comes at once. */
uint64_t bus_present(const struct bus *bus);

/* Bytes that can be taken now. */
size_t bus_room(const struct bus *bus);

/* Before bytes are read, and before bus_room() is asked: the units catch up, as far as that does not take long. */
void bus_expect(struct bus *bus);

/* The master sends, at `tick` (bus_present() or later) or when what it sent before is out. `length` <= bus_room(). */
void bus_take(struct bus *bus, const uint8_t *bytes, size_t length, uint64_t tick);

/* Bring the units up to the present, send what is due, and sleep. */
void bus_catch_up(struct bus *bus);

/* One line in the log, at the present; with the number of the line if there are several. */
void bus_log(const struct bus *bus, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* The same with --verbose only: what happens at every call of a client. */
void bus_log_detail(const struct bus *bus, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* ---- Between bus.c and bus_time.c ------------------------------------------------------------------------------------- */

bool bus_time_begin(struct bus *bus, uv_loop_t *loop);
void bus_say(const struct bus *bus, uint64_t tick, const char *format, ...) __attribute__((format(printf, 3, 4)));

#endif
