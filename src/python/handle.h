/* SPDX-License-Identifier: MIT */
/* handle.h: a bus that a program holds in its own process: a sim in virtual time with a host at its end. The face that the
 * Python extension has of the simulation; no Python in it, no clock, no event loop.
 *
 * Everything happens at the present tick, and time passes only in the calls that say so. Not for two threads at once. */
#ifndef RKM04_PYTHON_HANDLE_H
#define RKM04_PYTHON_HANDLE_H

#include "command/command.h"
#include "condition/condition.h"
#include "line/line.h"
#include "record/record.h"
#include "trace/trace.h"

#define HANDLE_SUBSCRIPTIONS 16u
#define HANDLE_EVENTS_MAX (64u << 20)   /* bytes of JSON that a subscription keeps until they are taken; then events are lost */
#define HANDLE_HEARD_MAX (1u << 20)     /* bytes that the host keeps until they are read; then bytes are lost */

/* The events of a subscription, as lines of JSON. */
struct handle_subscription {
    struct sim *sim;
    unsigned number; /* 0: this place is free */
    struct event_filter filter;
    struct watcher watcher;
    char *text;
    size_t length, room;
    uint64_t lost, lost_since; /* events that found no room, and the tick of the first */
};

/* A byte that has come to the host. */
struct handle_byte {
    uint64_t tick; /* at which it had passed */
    uint8_t byte;
};

struct handle_host {
    struct line_settings unit;  /* those of the units */
    struct line_settings settings;
    bool differs;               /* they are not those of the units */
    struct line_receiver to_units, to_host;
    struct handle_byte *heard;  /* a queue: begins at `head` */
    size_t head, count, room;
    uint64_t lost;              /* bytes that found no room */
    uint64_t free;              /* tick at which the host's last byte will have passed */
};

struct handle {
    struct sim sim;
    json_t *options;            /* what the settings of the units point into */
    struct trace_set traces;
    struct handle_subscription subscription[HANDLE_SUBSCRIPTIONS];
    unsigned subscribed;        /* number given last */
    struct record *record;      /* NULL: none is being written */
    FILE *record_stream;
    char *record_path;
    struct handle_host host;
    bool (*paused)(void *context); /* asked now and then while time passes: true ends the call. NULL: none */
    void *paused_context;
};

/* Make a bus from a JSON object: the keys of docs/PYTHON.md, `Bus`. NULL: refused. handle_free() is due. */
struct handle *handle_new(const json_t *options, struct refusal *refusal);

/* End its files and free it. NULL: nothing. */
void handle_free(struct handle *handle);

/* Do a method of docs/CONTROL.md at the present tick. Returns its result, a new reference; NULL: refused. Time passes in
 * `advance` and `wait`. */
json_t *handle_call(struct handle *handle, const char *method, const json_t *params, struct refusal *refusal);

/* ---- Time ------------------------------------------------------------------------------------------------------------- */

/* Let time pass up to `tick`. Returns false if it was paused before. */
bool handle_advance(struct handle *handle, uint64_t tick);

/* The same, but no further than to where the host has `count` bytes to read, or one of them is `stop` (-1: none is meant). */
bool handle_advance_to_bytes(struct handle *handle, uint64_t tick, size_t count, int stop);

/* Let time pass until the condition holds, at most up to `end`. *holds: it does. Returns false if it was paused before. */
bool handle_advance_until(struct handle *handle, struct condition *condition, uint64_t end, bool *holds);

/* ---- The host at the end of the bus ------------------------------------------------------------------------------------ */

/* Speed and characters of the host's port. They need not be those of the units: both then receive what comes of it. */
void handle_host_configure(struct handle *handle, struct line_settings settings);

/* Send bytes from the present tick on, after those under way. Time passes only while more are under way than the bus takes.
 * Returns false if it was paused before all were handed over. */
bool handle_host_write(struct handle *handle, const uint8_t *bytes, size_t length);

/* Take up to `length` bytes that have come. Returns their number. */
size_t handle_host_read(struct handle *handle, struct handle_byte *bytes, size_t length);

/* For the config of the sim: bytes that reach the host. */
void handle_host_receive(void *context, const uint8_t *bytes, size_t length);

/* What is under way to the host in characters of its own is received to its end, if the bus is at rest. */
void handle_host_finish(struct handle *handle);

/* ---- Events ------------------------------------------------------------------------------------------------------------ */

/* The methods subscribe and unsubscribe. */
json_t *handle_subscribe(struct handle *handle, const json_t *params, struct refusal *refusal);
json_t *handle_unsubscribe(struct handle *handle, const json_t *params, struct refusal *refusal);

/* The subscription of this number; NULL: there is none. Who has read `text` sets `length`, `lost` to 0. */
struct handle_subscription *handle_subscription(struct handle *handle, unsigned number);

void handle_free_subscriptions(struct handle *handle);

#endif
