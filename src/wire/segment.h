/* SPDX-License-Identifier: MIT */
/* segment.h: one RS485 line in virtual time: a host and up to sixteen units on one pair of wires; or, where the kind of device is
 * full duplex, on a pair for each direction. Pure: no file, no clock.
 *
 *     static struct segment segment;                              // large, zero-initialised
 *     segment_begin(&segment, &config);
 *     number = segment_add_unit(&segment, &unit_config, &port, context);  // power-up; 1, 2, …
 *     segment_queue_bytes(&segment, bytes, length, tick);                // the host sends, length <= segment_room()
 *     segment_advance(&segment, segment_due(&segment));           // config.out gets what the host receives
 *
 * With `timed`, bytes take the time they take at 19200 baud (U7): ten bits, 3125/6 us, in either direction. One of the host
 * sets out when it is handed over or when the one before has passed; every unit gets it at the tick at which its stop bit ends
 * (K4), so byte k of a burst has arrived at ceil(k * 3125 / 6) after its beginning. Gaps stay. The first start bit of an answer
 * follows the end of the request after the turnaround; the bytes of an answer follow one another without a gap.
 *   Every station receives every other one: units receive the answers of other units too, and leave them alone (L1). No station
 * receives while it sends. No unit waits for an idle bus: a unit that begins while another sends collides with it, and
 * the bytes received come out of the levels, bit by bit (wire.h). So two units of the same address answer at once; where their
 * answers are the same the collision cannot be detected, otherwise the check sum fails at the host.
 *   P10: a request received during a unit's turnaround is taken when the last byte of the answer before has set out. What else
 * comes in until then is lost, as it is on a line where no sender can be made to wait; see segment_counters.overruns.
 *
 * Without `timed`, bytes take no time: a byte of the host reaches all units at the tick at which it is handed over, an answer
 * goes out in the tick of its request, whole, and the next byte of the host comes after it (P10). No turnaround, no
 * collisions: of several answers at once the lower number's comes first, and those who answer do not receive one another.
 *
 * Order within a tick: bytes, then what the units do (K2). What a segment does depends on the bytes handed over and their ticks
 * alone, not on how segment_advance cuts the time. */
#ifndef RKM04_WIRE_SEGMENT_H
#define RKM04_WIRE_SEGMENT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "device/device.h"
#include "levels.h"

#define SEGMENT_UNITS 16u               /* on one line (U4) */
#define SEGMENT_ROOM 4096u              /* bytes of the host that may be under way */
#define SEGMENT_TURNAROUND DEVICE_TURNAROUND /* ticks, the default: one character */
#define SEGMENT_UNASKED_MAX 1000u       /* without time: more answers than this without a byte of the host are cut off */
#define SEGMENT_TURNAROUND_MAX 1000000u /* ticks */

/* A byte on the line, for a monitor that receives everything. */
struct segment_byte {
    uint64_t start;   /* tick at which its start bit began, rounded down */
    uint64_t tick;    /* at which it had passed, rounded up: the present one */
    uint32_t senders; /* bit 0: the host; bit n: unit n; several bits: a collision; none: segment_disturb() */
    uint8_t byte;     /* as received by a unit that sends nothing */
    bool lost;        /* framing error: not received */
};

/* Gets the bytes that reach the host, at the tick segment_now(). Must not call back into the segment, but for reading. */
typedef void segment_out(void *context, const uint8_t *bytes, size_t length);

/* Gets every byte on the line when it has passed, after the units. The same restriction. */
typedef void segment_monitor(void *context, const struct segment_byte *byte);

#define SEGMENT_CHANGED_MAX 4u /* bytes that may be sent in place of one */

/* What may go wrong, by injected faults. Any may be NULL. All are called at the tick segment_now(), and must not call
 * back into the segment, but for reading. */
struct segment_hooks {
    /* Unit `number` is to begin with its answer now. Returns by how many ticks later it will, at most SEGMENT_DELAY_MAX. */
    uint64_t (*answer)(void *context, unsigned number);
    /* `station` (0: the host, n: unit n) sends a byte. Writes what passes on the line instead. Returns its length, at most
     * SEGMENT_CHANGED_MAX; 0: silence for as long as the byte would have taken. */
    size_t (*send)(void *context, unsigned station, uint8_t byte, uint8_t *bytes);
    /* Does `station` get what `senders` (as in struct segment_byte) have sent? */
    bool (*is_receiving)(void *context, unsigned station, uint32_t senders);
    /* Does the host receive this byte, which it has sent itself? */
    bool (*has_echo)(void *context, uint8_t byte);
    /* Unit `number` has processed a byte, or fetched one to send: it may have executed a request. This one may switch the unit
     * off or on (segment_power()). */
    void (*processed)(void *context, unsigned number);
};

#define SEGMENT_DELAY_MAX UINT64_C(1000000000000) /* ticks */

struct segment_config {
    bool timed;             /* false: bytes take no time (--baud 0) */
    bool is_full_duplex;    /* with `timed`: a pair of wires for each direction */
    uint32_t baud;          /* 0: DEVICE_BAUD */
    bool echo;              /* the host receives its own bytes, too (a two-wire adapter with local echo) */
    uint32_t turnaround;    /* ticks, 0..SEGMENT_TURNAROUND_MAX, from the end of a request to the start bit of the answer */
    const struct device_kind *kind; /* of all units; NULL: the RKM04 */
    segment_out *out;       /* NULL: none */
    segment_monitor *monitor; /* NULL: none */
    void *context;          /* of these two */
    const struct segment_hooks *hooks; /* NULL: nothing goes wrong */
    void *hooks_context;
};

/* A unit on the line. Who may read it: all. */
struct segment_unit {
    struct device_unit *unit; /* its us 0 is `since`; without power: as it stood when it lost it */
    struct device_config config; /* at the next power-up */
    const struct device_port *port;
    void *context;          /* of the port */
    uint64_t since;         /* tick of the segment at which it was powered up */
    bool powered;
    bool in_frame;          /* what it has received so far does not end with a whole frame */
    uint32_t frames;        /* seen by the unit */
    bool begun;             /* its answer has begun to go out: the hook has been asked */
    uint64_t heard;         /* parts: end of the last byte that it has received */
    uint64_t lost;          /* bytes without a stop bit that have come to it, as wire.receiver[].framing_errors has them */
    uint64_t next;          /* parts (wire.h): start bit of the next byte of its answer; DEVICE_NEVER: no answer goes out */
};

/* Bytes that a hook has put in the place of one, and that have not set out. */
struct segment_more {
    uint8_t at, count;
    uint8_t byte[SEGMENT_CHANGED_MAX];
};

struct segment_counters {
    uint64_t bytes;          /* sent by anyone */
    uint64_t collisions;     /* of these, bytes during which another station was sending, too */
    uint64_t framing_errors; /* bytes lost to everybody: the stop bit was 0 */
    uint64_t overruns;       /* bytes lost to a unit that had a request waiting (P10) */
    uint64_t cuts;           /* how often units that answered one another without a request were cut off */
    uint64_t cut_ticks;      /* how long they had done so, together */
};

struct segment {
    struct segment_config config;
    uint64_t now;            /* first tick that is not yet done */
    bool advancing;          /* what units do now comes of time going on; else of what they are given */
    unsigned units;
    struct segment_unit unit[SEGMENT_UNITS]; /* unit n is unit[n - 1] */

    /* Inside. */
    bool is_plain;           /* there is one pair of wires, and no unit counts lost bytes */
    struct wire wire, back;  /* back: on which units send to the host alone if the line is full duplex */
    uint64_t quiet_bytes;    /* sent, without time */
    uint64_t overruns;
    unsigned unasked;         /* answers without time since the host's last byte */
    uint64_t asked;           /* tick of that byte, or of the last cut */
    uint64_t cuts, cut_ticks; /* as in struct segment_counters */
    uint64_t again;           /* without time: tick at which units answer without being asked again; DEVICE_NEVER: they do not */
    bool disturbed, held;     /* segment_disturb(), segment_break() */
    uint64_t more_start;      /* parts: start bit of the next of the host's more[0] */
    struct segment_more more[WIRE_STATIONS];
    uint64_t host_free;    /* parts: when the host's last byte will have passed */
    size_t head, count;    /* of the queue */
    struct {
        uint64_t start;      /* parts */
        uint8_t byte;
    } queue[SEGMENT_ROOM];   /* bytes of the host that have not set out */
};

/* ---- Begin ------------------------------------------------------------------------------------------------------------ */

/* A line without units at tick 0. segment_end() is due. */
void segment_begin(struct segment *segment, const struct segment_config *config);

/* Free the units. The segment may begin again. */
void segment_end(struct segment *segment);

/* Add a unit and power it up at the present tick. config, port, context: as for device_kind.begin; all units of a line should
 * have the same framing. The ticks that the port gets are the unit's own: add segment_since(). Several units may have the same
 * address. Returns its number on the line, 1..16 in the order of adding; 0: no place is left, or
 * memory runs out. */
unsigned segment_add_unit(struct segment *segment, const struct device_config *config, const struct device_port *port,
                          void *context);

/* The kind of all units. */
const struct device_kind *segment_kind(const struct segment *segment);

/* Let bytes take time from now on, or none. None may be under way (segment_idle()). */
void segment_set_timed(struct segment *segment, bool timed);

/* ---- Units: `number` is 1..segment->units ------------------------------------------------------------------------------ */

/* The unit, at the present tick. For inputs (which count from the present tick on), states and counters; no bytes. */
struct device_unit *segment_unit(struct segment *segment, unsigned number);

/* The port of a unit has changed. */
void segment_port_changed(struct segment *segment, unsigned number);

/* The address that a unit will have from its next power-up on. */
void segment_set_node(struct segment *segment, unsigned number, uint8_t node);

/* The tick of the segment at which this unit's time began. */
uint64_t segment_since(const struct segment *segment, unsigned number);

/* Switch a unit off at the present tick: it stops in the middle of everything, also of a byte. Or on: power-up (U5, U8); one that
 * is on is switched off and on again. */
void segment_power(struct segment *segment, unsigned number, bool on);

/* ---- The host ------------------------------------------------------------------------------------------------------- */

/* Bytes that can be handed over now. */
size_t segment_room(const struct segment *segment);

/* The host hands over `length` <= segment_room() bytes at `tick` >= segment_now(); ticks must not decrease from call to
 * call. */
void segment_queue_bytes(struct segment *segment, const uint8_t *bytes, size_t length, uint64_t tick);

/* Forget the bytes handed over that have not set out at the present tick (purge of RFC 2217). Returns their number. */
size_t segment_purge(struct segment *segment);

/* The host holds the line at 0 from the present tick on, or lets it go (break). Without `timed` nothing comes
 * of it until bytes take time again. */
void segment_break(struct segment *segment, bool on);

/* Something that is no station holds the line at 0 from the present tick on, or lets it go. Without `timed`: no byte gets
 * through. */
void segment_disturb(struct segment *segment, bool on);

/* ---- Time ------------------------------------------------------------------------------------------------------------- */

/* The first tick that is not yet done. */
uint64_t segment_now(const struct segment *segment);

/* Do all ticks before `tick`, and move every byte that is due by `tick`. Does nothing if `tick` < segment_now(), apart from
 * moving what is due. */
void segment_advance(struct segment *segment, uint64_t tick);

/* Make everything later by `ticks`, the present tick included: what follows is what would have followed, so much later. For
 * snapshots. */
void segment_shift(struct segment *segment, uint64_t ticks);

/* Make `to` like `from`, units included. `to` is zero, or has as many units of the same kind: then its config but for echo and
 * hooks stays, and its ports, and the pointers in its units' settings. For snapshots; segment_end() is due. Returns false if
 * memory runs out: then `to` is as it was, or, if it was zero, fit for segment_end() alone. */
bool segment_copy(struct segment *to, const struct segment *from);

/* A tick before which no byte reaches anybody if the host hands over nothing more: advancing in one go up to it changes nothing
 * that can be seen on the line. Mostly the tick of the next byte; DEVICE_NEVER: nothing is under way. May lie before
 * segment_now(): then there is something to do at once. */
uint64_t segment_due(const struct segment *segment);

/* The earliest tick at which a unit does something of itself (device_kind.next_event); DEVICE_NEVER if none ever does. */
uint64_t segment_next_event(const struct segment *segment);

/* Has the host left a frame unfinished: did the bytes passed so far end in the middle of one, as the units see it? */
bool segment_in_frame(const struct segment *segment);

/* The same, without pulses that are not reported (device_kind.next_report). */
uint64_t segment_next_report(const struct segment *segment);

/* Is the line at rest: no byte under way, no answer to come? (Motors may run: segment_next_event().) */
bool segment_idle(const struct segment *segment);

struct segment_counters segment_counters(const struct segment *segment);

/* ---- Inside: segment_silence.c, requests that end with a silence (device_kind.silence_end) ----------------------------- */

/* The first tick at which a silence is over that a unit waits for; DEVICE_NEVER: none waits. */
uint64_t segment_silence_end(const struct segment *segment);

/* Tell one unit whose silence is over at the present tick; its answer, if there is one, is due then. Returns its number; 0: there
 * is none. */
unsigned segment_pass_silence(struct segment *segment);

/* The unit has processed what it has received: has a frame ended with it? */
void segment_note_frames(const struct segment *segment, struct segment_unit *unit);

#endif
