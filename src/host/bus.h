/* bus.h: one line with its units and the ways in for clients, driven by the event loop.
 *
 *     bus_ports --bus_take--> segment (units, two wires, virtual time) --> bus_ports
 *     clock     --on_timer--> segment
 *
 * Nothing of a motion is seen outside except in answers, so a line sleeps until a byte is to be moved or comes in, and its units
 * catch up then. Only in order that this never takes long it also wakes now and then while something is going on. */
#ifndef RKM04_HOST_BUS_H
#define RKM04_HOST_BUS_H

#include <uv.h>

#include "bus_coverage.h"
#include "bus_ports.h"
#include "flash_file.h"
#include "segment.h"
#include "serve_options.h"

struct bus_unit {
    struct bus *bus;
    unsigned number;              /* on the segment, 1..16 */
    char name[NODE_NAME_SIZE];    /* its address; with a suffix if it is not the only one with it */
    uint32_t place[RKM04_MOTORS]; /* of the command executed last, for the log */
    char *flash_path;             /* NULL: memory only */
    struct flash_file flash;
};

/* What a line tells the program. */
struct bus_calls {
    void (*failed)(void *context);   /* the line is lost (reported) */
    void (*presence)(void *context); /* a client has come or gone, or bytes came */
};

struct bus {
    unsigned number;      /* 0, 1, … */
    const struct serve_options *options;
    const struct bus_calls *calls;
    void *context;
    struct coverage *coverage; /* NULL: not wanted */
    struct bus_listener listener;

    struct segment segment;
    struct virtual_clock clock;
    uint64_t heard;       /* ns at which the last bytes came */
    uint64_t taken;       /* tick for which the last bytes were handed over */
    uint64_t answered;    /* a real wire: tick at which the answer in `out` may set out */
    bool running;         /* time has begun */
    bool busy;            /* within bus_catch_up() */
    int timer_fd;
    uv_poll_t timer;

    struct bus_ports ports;
    size_t gathered;      /* bytes in `out` */
    uint8_t out[20480];   /* more than the longest answer */
    struct bus_unit unit[NODE_LIST_MAX];
};

/* Prepare line `number`: open its ports and flash images, power its units up at tick 0. *bus must be zero. Failures are reported.
 * Returns false if it did not work; bus_end() is due in either case. */
bool bus_begin(struct bus *bus, unsigned number, const struct serve_options *options, uv_loop_t *loop, struct line_watch *watch,
               struct coverage *coverage, const struct bus_calls *calls, void *context);

/* Everything is ready: make the link, and let time begin. Returns false if it did not work (reported). */
bool bus_start(struct bus *bus);

/* Close everything: first the link, so that nobody follows it to a pty that is gone. The handles are gone when the loop has run
 * out; then bus_free(). Returns false if a flash image could not be written (reported). */
bool bus_end(struct bus *bus);
void bus_free(struct bus *bus);

/* The power switch of a unit, by its name ("3", "3-2"), now. Returns false if there is no such unit. */
bool bus_power(struct bus *bus, const char *name, bool on);

/* ---- For the ports ---------------------------------------------------------------------------------------------------- */

/* The present tick, for the log; the units may be behind it while nobody looks. */
uint64_t bus_present(const struct bus *bus);

/* Bytes that can be taken now. */
size_t bus_room(const struct bus *bus);

/* The master sends, at `tick` or as soon as it may: now, and after what it sent before. `length` <= bus_room(). */
void bus_take(struct bus *bus, const uint8_t *bytes, size_t length, uint64_t tick);

/* Bring the units up to the present, send what is due, and sleep. */
void bus_catch_up(struct bus *bus);

/* One line in the log, at the present; with the number of the line if there are several. */
void bus_log(const struct bus *bus, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
