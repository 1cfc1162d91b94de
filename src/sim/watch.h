/* SPDX-License-Identifier: MIT */
/* watch.h: what happens on a line, for everybody who wants to know: traces, logs, clients of the control socket, recorders.
 *
 * Happenings are gathered as they come, put in the order of time (K2 within a tick), and handed to the watchers when nothing
 * earlier can come any more: at the end of each sim_advance(), and at least every slot while a watcher wants pulses. The order
 * does not depend on how time was cut into pieces. */
#ifndef RKM04_SIM_WATCH_H
#define RKM04_SIM_WATCH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "wire/wire.h"

enum watch_kind {
    WATCH_STEP,      /* a pulse; value: position of the counter after it */
    WATCH_DIRECTION, /* value: 1 forward, 0 back */
    WATCH_MOTION,    /* value: 1 begins, 0 has ended */
    WATCH_COMMAND,   /* value: place 1..700 of the command being executed, 0: idle */
    WATCH_LED,       /* value: enum rkm04_led */
    WATCH_FAULT,     /* of a motor; value: enum rkm04_fault */
    WATCH_POSITION,  /* value: counter, where no pulse led there: set (C100, =), restored, or after a motion under T41 */
    WATCH_INPUTS,    /* value: mask of DI, bit 0 is DI 01; likewise: */
    WATCH_OUTPUTS,
    WATCH_VARIABLES, /* bit 0 is VAR 80 */
    WATCH_POWER,     /* value: 1 the unit has been powered up, 0 it has lost its power */
    WATCH_BYTE,      /* unit 0; `byte` */
    WATCH_MESSAGE,   /* unit 0; `message`: a frame or what was dropped of one */
    WATCH_PLANT,     /* value: enum plant_event (plant.h); `text` says what */
    WATCH_INJECTED,  /* a fault on demand has acted; value: its number; `text` says what it did */
    WATCH_SERVICE,   /* unit 0; value: number of the client of a server; `service` says what */
    WATCH_VALUE,     /* value: what value `number` of the unit is now (device_kind.value) */
    WATCH_NOTE,      /* value 0; `text`: what the device reports in words */
    WATCH_CELL,      /* `cell`: what watched cell `number` is now; for who has named it alone: event_filter_passes() */
    WATCH_KINDS
};

enum watch_service_act { WATCH_SERVICE_OPEN, WATCH_SERVICE_CLOSED, WATCH_SERVICE_RECEIVED, WATCH_SERVICE_SENT };

/* What passes between a server and a client. */
struct watch_service {
    const char *name; /* of the server */
    enum watch_service_act act;
    size_t length;    /* bytes that the server has received, or sent */
    uint8_t bytes[];
};

#define WATCH_BIT(kind) (UINT32_C(1) << (kind))
#define WATCH_ALL ((WATCH_BIT(WATCH_KINDS) - 1u) & ~WATCH_BIT(WATCH_CELL)) /* cells concern only who has named them */

/* Order within a tick (K2). */
enum watch_phase {
    WATCH_DELIVERED, /* what came from outside, and what it led to at once */
    WATCH_PULSES,
    WATCH_TURNS      /* ends of motions, and the motors' turns */
};

struct wire_message; /* wire_monitor.h */

struct watch_event {
    uint64_t tick;  /* of the line */
    uint64_t order; /* among those of the tick: watch_ns() in front. For watch_add(): ns after the tick, 0..999 */
    int32_t value;
    uint8_t kind;   /* enum watch_kind */
    uint8_t unit;   /* 1..16, its number on the line; 0: the line */
    uint8_t motor;  /* 1..4; 0: none */
    uint8_t number; /* WATCH_VALUE: from 1; WATCH_CELL: place in struct watch; others 0 */
    union {
        struct segment_byte byte;           /* WATCH_BYTE */
        const struct wire_message *message; /* WATCH_MESSAGE; valid during the call */
        const char *text;                   /* WATCH_PLANT, WATCH_INJECTED, WATCH_NOTE; valid during the call */
        const struct watch_service *service; /* WATCH_SERVICE; valid during the call */
        uint32_t pulse_ns;                  /* WATCH_STEP: length of the pulse; 0: device_kind.pulse */
        int64_t cell;                       /* WATCH_CELL */
    };
};

#define WATCH_ORDER_NS 54u /* bit of the ns in watch_event.order */

/* ns after the tick of an event, 0..999: where a unit counts finer than 1 us. */
static inline unsigned watch_ns(const struct watch_event *event)
{
    return (unsigned)(event->order >> WATCH_ORDER_NS);
}

struct watcher {
    uint32_t kinds; /* WATCH_BIT()s of what it wants to see */
    /* Must not advance or change the line. */
    void (*on_event)(void *context, const struct watch_event *event);
    void *context;
    struct watcher *next; /* inside */
};

#define WATCH_CELLS_MAX 256u    /* cells that are watched on a line at a time; struct watch_event.number */
#define WATCH_CELL_NAME_SIZE 64u /* bytes */

/* A cell of a device that a watcher wants to see change (sim_watch_cell()). */
struct watch_cell {
    const struct watcher *owner; /* NULL: the place is free */
    uint64_t code;               /* as device_kind.find_cell() has found it */
    int64_t value;               /* that was reported last */
    uint8_t unit;                /* 1..16 */
    char name[WATCH_CELL_NAME_SIZE];
};

/* Inside: gathers, sorts, hands out. */
struct watch {
    struct watcher *watchers;
    uint32_t kinds; /* that anybody wants */
    uint64_t sequence;
    size_t count, room;
    struct watch_event *events;
    bool short_of_memory; /* events were lost */
    struct watch_cell *cells; /* WATCH_CELLS_MAX places; NULL: none has been watched yet */
    unsigned cell_count;      /* places up to the last that is taken */
};

/* "step", "direction", "motion", … as in traces and in the control protocol. Never NULL. */
const char *watch_kind_name(enum watch_kind kind);

/* Find a kind by its name. Returns WATCH_KINDS if there is none of that name. */
enum watch_kind watch_kind_named(const char *name);

/* "open", "closed", "received", "sent". Never NULL. */
const char *watch_service_act_name(enum watch_service_act act);

/* Gather a copy of one, whose `order` is set here. A message, text or service must be a copy of its own, from malloc(): it is
 * freed after the watchers have seen it, or at once if there is no watcher for it. */
void watch_add(struct watch *watch, enum watch_phase phase, const struct watch_event *event);

/* Hand everything before `tick` to the watchers, in order. */
void watch_deliver(struct watch *watch, uint64_t tick);

/* Forget everybody and everything. */
void watch_end(struct watch *watch);

/* A watcher, which must stay, wants to see from now on; no more. */
void watch_add_watcher(struct watch *watch, struct watcher *watcher);
void watch_remove_watcher(struct watch *watch, struct watcher *watcher);

#endif
