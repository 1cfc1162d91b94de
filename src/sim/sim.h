/* SPDX-License-Identifier: MIT */
/* sim.h: a line with its units and everything around them, in virtual time: inputs, the plant that the motors move, flash,
 * injected faults, and everybody who watches. No file, no clock, no event loop: `rkm04 serve` drives it by the clock,
 * `rkm04 test` and `rkm04 replay` as fast as it goes.
 *
 *     sim_begin(&sim, &config);             // units are powered up at tick 0
 *     sim_queue_bytes(&sim, bytes, n, sim_now(&sim));
 *     sim_command(&sim, "di.set", params, &refusal);   // command.h
 *     sim_advance(&sim, tick);              // bytes for the host through config.out, everything else through watchers
 *
 * The same calls at the same ticks give the same bytes and events at the same ticks. Ticks are those of the line; they only
 * grow. A unit's own time begins when it is powered up (segment_since()). */
#ifndef RKM04_SIM_H
#define RKM04_SIM_H

#include <jansson.h>

#include "device/device.h"
#include "fault/fault.h"
#include "plant/plant.h"
#include "text/text.h"
#include "watch.h"
#include "wire/wire.h"

struct sim;
struct sim_snapshots;  /* of the room `record` */
struct sim_services;   /* sim_service.c */
struct command_method; /* command.h */

#define SIM_COMMAND_TABLES 4u /* that rooms above `command` may attach */

/* The flash of unit `number`, as in struct device_port; all functions set. */
struct sim_flash {
    int (*read)(void *context, unsigned number, unsigned block, unsigned offset, void *data, unsigned length);
    int (*erase)(void *context, unsigned number, unsigned block);
    int (*program)(void *context, unsigned number, unsigned block, unsigned offset, const void *data, unsigned length);
    void *context;
};

/* A journal: records everything that comes in from outside, in the order in which it does (record.h). `now` is sim_now(). */
struct sim_journal {
    void (*bytes)(void *context, uint64_t now, uint64_t tick, const uint8_t *bytes, size_t length); /* sim_queue_bytes() */
    void (*purge)(void *context, uint64_t now);
    void (*line_break)(void *context, uint64_t now, bool on);
    void (*timed)(void *context, uint64_t now, bool timed);
    void (*command)(void *context, uint64_t now, const char *method, const json_t *params); /* executed */
    void *context;
};

struct sim_config {
    const struct device_kind *device; /* of all units; NULL: the RKM04 */
    struct device_config unit;     /* of all units; node comes from `nodes` */
    struct node_list nodes;
    bool timed;                    /* false: bytes take no time (--baud 0) */
    uint32_t turnaround;           /* ticks (segment.h) */
    uint64_t seed;                 /* of faults with a probability */
    struct sim_flash flash;        /* all NULL: memory that lives as long as the sim */
    const uint8_t *flash_image;    /* what is in that memory of each unit at first: all its blocks; NULL: it is erased */
    segment_out *out;              /* bytes that reach the host; NULL: none */
    /* Bytes for a client of a server (sim_service_open()); none: it is hung up. NULL: they go nowhere. */
    void (*service_out)(void *context, unsigned client, const uint8_t *bytes, size_t length);
    void (*adapter)(void *context, bool plugged); /* the fault `unplugged` begins or ends; NULL: not reported */
    void *context;                 /* of `out`, `service_out` and `adapter` */
};

struct sim_unit {
    struct sim *sim;
    unsigned number;            /* on the line, 1..16 */
    char name[NODE_NAME_SIZE];  /* its address, as in "3"; with a suffix if it is not the only one with it, "3-2" */
    struct device_port port;    /* `steps` is set while a watcher wants pulses */
    uint32_t di;                /* inputs set by hand: DI 01 in bit 0 */
    uint32_t forward;           /* direction outputs: motor 1 in bit 0 */
    struct plant *plant;        /* NULL: none. Who changes it calls sim_update_inputs() */
    uint8_t *memory;            /* flash without a file, the device's flash_blocks, inverted; NULL: not used yet */
};

struct sim {
    struct sim_config config;
    struct segment segment;
    struct watch watch;
    struct wire_monitor monitor;
    struct faults faults;
    const struct sim_journal *journal; /* NULL: none */
    struct sim_services *services;     /* NULL: no client yet */
    struct sim_snapshots *snapshots;   /* NULL: none yet */
    void (*free_snapshots)(struct sim_snapshots *snapshots); /* set by who sets `snapshots`; called by sim_end() */
    const struct command_method *commands[SIM_COMMAND_TABLES]; /* command_attach(); the first NULL ends them */
    const char *outer_methods;         /* "wait, advance, ": of those who hand commands on, for hints; NULL: none */
    bool (*interrupted)(void *context); /* is a command that takes long to be given up? NULL: never but by its own limit */
    void *interrupted_context;
    char *plant_text;                  /* what plant.set or --plant gave, for records; NULL: no plant */
    struct sim_unit unit[SEGMENT_UNITS];
};

/* ---- Begin and end ---------------------------------------------------------------------------------------------------- */

/* Power up all units at tick 0. *sim must be zero. Returns false if out of memory. sim_end() is due in either case. */
bool sim_begin(struct sim *sim, const struct sim_config *config);
void sim_end(struct sim *sim);

/* Fill the memory of a unit that has no flash outside, from config.flash_image. Returns false if out of memory. For sim.c. */
bool sim_flash_fill(struct sim_unit *unit);

/* A regular end comes: units that have power store what they keep; flash has to be there still. */
void sim_store(struct sim *sim);

/* ---- Time ------------------------------------------------------------------------------------------------------------- */

/* The end of virtual time: the last tick that can be reached. Everything that has a time fits: recordings, snapshots, sums. */
#define SIM_TIME_MAX TIME_VALUE_MAX

uint64_t sim_now(const struct sim *sim);

/* Has time come to its end? It does not continue then; commands are executed. */
bool sim_time_is_over(const struct sim *sim);

/* Do all ticks before `tick`, but none from SIM_TIME_MAX on, move every byte due by then, and hand out what happened before. */
void sim_advance(struct sim *sim, uint64_t tick);

/* Move what is due by the present tick: what comes in from outside now comes after it. Called by everything that comes in, so
 * that what follows does not depend on how time was cut. */
void sim_finish_tick(struct sim *sim);

/* A tick before which no byte moves; DEVICE_NEVER: none is under way (segment_due()). */
uint64_t sim_due(const struct sim *sim);

/* The earliest tick at which something happens of itself: a unit, a switch of the plant, the begin or end of a fault.
 * DEVICE_NEVER: nothing ever does. */
uint64_t sim_next_event(const struct sim *sim);

/* The same, without pulses that are not reported: for callers that do not read counters on the way. */
uint64_t sim_next_report(const struct sim *sim);

/* ---- The host ------------------------------------------------------------------------------------------------------- */

/* As segment_room(), segment_queue_bytes(), segment_purge(), segment_break(); written to the journal,
 * and subject to injected faults. */
size_t sim_room(const struct sim *sim);
void sim_queue_bytes(struct sim *sim, const uint8_t *bytes, size_t length, uint64_t tick);
size_t sim_purge(struct sim *sim);
void sim_break(struct sim *sim, bool on);

/* Let bytes take their time on the line, or none, from now on. Bytes under way are moved first: time continues as far as that
 * takes. */
void sim_set_timed(struct sim *sim, bool timed);

/* ---- Units: `number` is 1..sim_units() -------------------------------------------------------------------------------- */

unsigned sim_units(const struct sim *sim);

/* Find a unit by its name ("3", "3-2"). Returns its number, 0: there is none. */
unsigned sim_unit_named(const struct sim *sim, const char *name);

/* The names of all units, for messages in words (wire_words.h). They stay the sim's. */
struct wire_names sim_wire_names(const struct sim *sim);

struct device_unit *sim_core(struct sim *sim, unsigned number);

/* The kind of all units. */
const struct device_kind *sim_device(const struct sim *sim);

/* What can be seen of an axis, 1..axes of the kind. */
struct device_axis sim_axis(struct sim *sim, unsigned number, unsigned axis);
bool sim_powered(const struct sim *sim, unsigned number);

/* The power switch: off, or on; one that is on is switched off and on again (reset). */
void sim_power(struct sim *sim, unsigned number, bool on);

/* Inputs set by hand, mask of DI. What the plant drives or a fault holds comes before it. */
void sim_set_di(struct sim *sim, unsigned number, uint32_t mask);

/* Set the inputs of a unit again from what is set by hand, driven by the plant, held by a fault. To be called after a change of
 * one of these. */
void sim_update_inputs(struct sim *sim, unsigned number);

/* Configure the plants of all units from a YAML text: replaces those there are, true positions begin at the counters plus the
 * configured offset. NULL: no plant. Errors are written to `errors` as NAME:LINE:COLUMN: error: expected …, and nothing is
 * changed. Returns false then. Inputs follow at once. */
bool sim_configure_plants(struct sim *sim, const char *name, const char *text, size_t length, FILE *errors);

/* The outputs have changed at a tick of the bus: motors of the plant whose coils they drive follow. For sim.c. */
void sim_drive_coils(const struct sim_unit *unit, uint64_t tick, uint32_t mask);

/* us in which an axis makes no more pulses than its plant can keep. */
uint64_t sim_plant_span(const struct device_kind *kind);

/* Flash of a unit as it is, without injected faults. As in struct device_port. */
int sim_flash_read(struct sim_unit *unit, unsigned block, unsigned offset, void *data, unsigned length);
int sim_flash_erase(struct sim_unit *unit, unsigned block);
int sim_flash_program(struct sim_unit *unit, unsigned block, unsigned offset, const void *data, unsigned length);

/* ---- Servers of the device: sim_service.c. The commands service.* call these ------------------------------------------- */

#define SIM_SERVICE_SENT_MAX 65536u /* bytes that are kept for the result of a command */
#define SIM_SERVICE_ROOM_MAX 32768u /* see sim_service_receive(): an answer more has its place, too */

/* What was sent to a client within a call. */
struct sim_service_sent {
    size_t length;
    bool is_cut; /* it was more */
    uint8_t bytes[SIM_SERVICE_SENT_MAX];
};

/* The server of this name; NULL: the device has none. */
const struct device_service *sim_service_named(const struct sim *sim, const char *name);

/* A client comes from the address `peer`. Returns its number, the lowest that is free, 1..DEVICE_CLIENTS_MAX; 0: there are too
 * many, or out of memory. sim_service_start() is due when its number is known. */
unsigned sim_service_open(struct sim *sim, const struct device_service *service, const char *peer);

/* Send what is to be sent to a client now. `sent`: NULL, or gets it, too. */
void sim_service_start(struct sim *sim, unsigned number, struct sim_service_sent *sent);

/* Bytes of a client. It may be hung up afterwards. After `room` bytes of answers, at most SIM_SERVICE_ROOM_MAX, nothing more is
 * taken; SIZE_MAX: everything is. Returns how many bytes were: the others are to be handed in again, before what comes later. */
size_t sim_service_receive(struct sim *sim, unsigned number, const uint8_t *bytes, size_t length, size_t room,
                           struct sim_service_sent *sent);

/* The client has gone, or is hung up; or all of them. */
void sim_service_close(struct sim *sim, unsigned number);
void sim_services_close(struct sim *sim);
bool sim_service_is_open(const struct sim *sim, unsigned number);
bool sim_services_are_open(const struct sim *sim);

/* When something is to be sent of itself; DEVICE_NEVER. Send what is due. Free all. For sim.c. */
uint64_t sim_services_next(const struct sim *sim);
void sim_services_run(struct sim *sim);
void sim_services_free(struct sim *sim);

/* ---- Watching --------------------------------------------------------------------------------------------------------- */

/* As watch_add_watcher(), watch_remove_watcher(); pulses are reported while a watcher wants them. A watcher gets the events from
 * now on. */
void sim_watch(struct sim *sim, struct watcher *watcher);
void sim_unwatch(struct sim *sim, struct watcher *watcher);

/* A watcher wants an event whenever this cell of a unit has changed at the end of a slot, or by a restore, from now on, until it
 * watches no more. At most WATCH_CELLS_MAX on a line. Returns it with its present value; NULL: refused. */
const struct watch_cell *sim_watch_cell(struct sim *sim, const struct watcher *watcher, unsigned number, const char *name,
                                        struct device_refusal *refusal);

/* A unit has been restored: report its watched cells. */
void sim_report_cells(struct sim *sim, unsigned number);

/* The end of so many slots with a watched cell, the present one counted; DEVICE_NEVER: none is watched. How far time may leap
 * then. Watched cells have changed. For sim.c. */
uint64_t sim_cells_next(const struct sim *sim, unsigned slots);
uint64_t sim_cells_leap(const struct sim *sim);
void sim_update_cell_reports(struct sim *sim);

/* Report that something happens at `tick`. `text`: printf-like, for WATCH_PLANT, WATCH_INJECTED and
 * WATCH_NOTE. */
void sim_report(struct sim *sim, enum watch_phase phase, const struct watch_event *event);
void sim_report_text(struct sim *sim, enum watch_phase phase, const struct watch_event *event, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

#endif
