/* SPDX-License-Identifier: MIT */
/* bus.h: one bus with its units and the ways in for clients, driven by the event loop; the face of the room.
 *
 *     bus_ports --take--> sim (units, two wires, virtual time) --out--> bus_ports
 *     bus_time  --advance--> sim
 *
 * The bus owns the sim, its time, its ports and its files. Each of these knows what it is given at the beginning and reports to
 * the bus by calls; none knows another one.
 *
 * Nothing of a motion is seen outside except in answers, so a line sleeps until a byte is to be moved or comes in, and its units
 * catch up then. Only in order that this never takes long it also wakes now and then while something is going on, and more often
 * while there are watchers or waiters. */
#ifndef RKM04_BUS_H
#define RKM04_BUS_H

#include <uv.h>

#include "bus_files.h"
#include "bus_log.h"
#include "bus_options.h"
#include "bus_ports.h"
#include "bus_service.h"
#include "bus_time.h"
#include "device/device.h"
#include "line/line.h"
#include "sim/sim.h"

struct bus_unit {
    char *flash_path; /* NULL: memory only */
    struct flash_file flash;
    bool open;
};

/* What a bus reports to the program. */
struct bus_calls {
    void (*failed)(void *context);   /* the line is lost (reported) */
    void (*presence)(void *context); /* a client has come or gone, or bytes came */
};

struct bus {
    const struct bus_options *options;
    const struct bus_calls *calls;
    void *context;
    struct coverage *coverage; /* NULL: not wanted */
    struct bus_log log;
    struct watcher news;  /* for the log */
    unsigned injected;    /* acts of injected faults */

    struct sim sim;
    struct bus_time time;   /* drives the sim */
    struct bus_ports ports; /* bytes of clients */
    struct bus_services *services; /* clients of the device's own servers */
    struct bus_files files; /* what is written about it */
    uint64_t taken;       /* tick for which the last bytes were handed over */
    uint64_t answered;    /* a real wire: tick at which the answer in `out` may set out */
    size_t gathered;      /* bytes in `out` */
    uint8_t out[20480];   /* more than the longest answer */
    struct bus_unit unit[NODE_LIST_MAX];
};

/* Prepare line `number`: open its ports and flash images, power its units up at tick 0. *bus must be zero. Failures are reported.
 * Returns false if it did not work; bus_end() is due in either case. */
bool bus_begin(struct bus *bus, unsigned number, const struct bus_options *options, uv_loop_t *loop, struct line_watch *watch,
               struct coverage *coverage, const struct bus_calls *calls, void *context);

/* See that the files of the options can be written; nothing is changed yet. Returns false if one cannot (reported). */
bool bus_reserve_files(const struct bus *bus);

/* Everything is ready: make the link, and let time begin. Returns false if it did not work (reported). */
bool bus_start(struct bus *bus);

/* Open the files that are written about the bus. Failures are reported. Returns false if it did not work. */
bool bus_begin_files(struct bus *bus);

/* Close everything: first the link, so that no client follows it to a pty that is gone. The handles are gone when the loop has
 * run out; then bus_free(). Returns false if a flash image, trace or record could not be written (reported). */
bool bus_end(struct bus *bus);
void bus_free(struct bus *bus);

/* ---- For those who drive it from outside (control.h) ------------------------------------------------------------------- */

/* The line, brought up to the present as far as that does not take long. */
struct sim *bus_sim(struct bus *bus);

/* A command has changed something: do at once what follows. */
void bus_changed(struct bus *bus);

/* Wait for something. done() may be called before this returns. The waiter must stay until then, or until it is taken off. */
void bus_wait(struct bus *bus, struct bus_waiter *waiter);
void bus_cancel_wait(struct bus *bus, struct bus_waiter *waiter);

/* A stopped clock: let time run to where the waiter is done. Returns false if the clock goes by itself, or another client
 * is advancing it. */
bool bus_advance(struct bus *bus, struct bus_waiter *waiter);
bool bus_is_stepped(const struct bus *bus);

/* Another clock from now on, as with --clock. Returns false: refused. */
bool bus_set_clock(struct bus *bus, const char *text, struct refusal *refusal);

/* The present tick, for the log and for bytes that arrive now. The units may be behind it while nothing reads them; when they
 * have too much to do for their clock, it is the one they have reached: they receive bytes at once. */
uint64_t bus_present(const struct bus *bus);

#endif
