/* SPDX-License-Identifier: MIT */
/* wire_monitor.h: listens to the two wires and takes the messages out of the bytes, whole ones and what was dropped, with the
 * reason. */
#ifndef RKM04_SIM_WIRE_MONITOR_H
#define RKM04_SIM_WIRE_MONITOR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <rkm04/link.h>

#include "segment.h"

#define WIRE_ANSWER_MAX 9216u                             /* bytes of the longest message of a unit, however small requests are */
#define WIRE_RAW_MAX (2u * (WIRE_ANSWER_MAX + 4u) + 2u) /* bytes on the wire that are kept of one frame: the longest there is */

struct sim;

/* What became of bytes on the wire. */
enum wire_fate {
    WIRE_WHOLE,
    WIRE_WRONG_CHECK,   /* hdlc: wrong FCS */
    WIRE_ABORTED,       /* hdlc: 7D 7E */
    WIRE_TOO_SHORT,     /* hdlc: less than 5 bytes */
    WIRE_TOO_LONG,
    WIRE_OUTSIDE,       /* hdlc: before any flag */
    WIRE_NO_ADDRESS,    /* plain: no DNode, above 16 */
    WIRE_NO_LENGTH,     /* plain: length 0 or above 9216 */
    WIRE_SILENT,        /* plain: 100 ms of silence inside the frame */
    WIRE_MALFORMED,     /* another framing's */
    WIRE_UNFINISHED,    /* the record ends in the middle of a frame */
    WIRE_FRAMING_ERROR, /* one byte, wrong stop bit: nobody has got it. The frame around it is told of by itself */
    WIRE_BREAK          /* the same with all bits 0 */
};

/* A frame as heard. `raw` are its bytes on the wire. */
struct wire_message {
    uint64_t start;       /* tick at which its first byte began */
    uint64_t end;         /* tick at which its last byte had passed; watch_event.tick, or before it if that was noticed later */
    uint32_t senders;     /* bit 0: the master; bit n: unit n */
    uint32_t collided;    /* those who have sent at the same time as another one */
    unsigned lost;        /* bytes inside that nobody has got (framing errors); they are not in `raw` */
    enum wire_fate fate;
    bool answer;          /* from a unit */
    uint8_t dnode, snode; /* 0 where the framing has none, or it was dropped before */
    const char *dropped;  /* NULL: whole; or why it is none: "wrong FCS", "aborted", "too long", … */
    const char *refused;  /* of an answer: what the unit objects to, in words (flag 1, 2, 3, message 255 …); NULL: nothing */
    const char *ignored;  /* of a whole request: why no unit obeys it; NULL: one may */
    size_t raw_total;     /* bytes on the wire; more than raw_length if some were not kept */
    size_t raw_length, length;
    const uint8_t *raw, *message; /* message: empty if it was dropped */
    uint8_t bytes[];      /* inside: what the pointers point into */
};

/* One for each direction, so that an answer in the middle of a request does not confuse either. A byte that belongs to a
 * collision of both counts in both. */
struct wire_ear_monitor {
    struct rkm04_receiver receiver;
    uint8_t *message; /* `room` bytes */
    size_t room;
    uint8_t *raw;     /* WIRE_RAW_MAX bytes */
    size_t raw_length, raw_total;
    uint64_t start, last; /* ticks: the first byte began; the last one had passed */
    uint32_t senders, collided;
    unsigned lost;
    uint64_t overruns;    /* bytes lost to a unit that had a request waiting (P10) */
    enum wire_fate astray; /* what the bytes gathered are, if they are no frame; WIRE_WHOLE: they are one */
    bool answer;
};

struct wire_monitor {
    const struct rkm04_framing *framing;
    uint64_t overruns; /* of the segment, up to now */
    struct wire_ear_monitor requests, answers;
};

/* Returns false if memory is short; wire_monitor_end() is due in either case. */
bool wire_monitor_begin(struct wire_monitor *monitor, const struct rkm04_framing *framing);
void wire_monitor_end(struct wire_monitor *monitor);

/* Make `to` like `from`, what is half heard included, all times later by `later` ticks (mod 2^64). Both have been begun, with the
 * same framing. For snapshots. */
void wire_monitor_copy(struct wire_monitor *to, const struct wire_monitor *from, uint64_t later);

/* A byte has passed: tell the watchers of `sim` what it completed (WATCH_MESSAGE), if anybody wants to know. */
void wire_monitor_hear(struct sim *sim, const struct segment_byte *byte);

/* What has been heard of a request, or of an answer, that is not complete. Returns NULL if there is nothing (or memory is short),
 * otherwise a message to be freed. */
struct wire_message *wire_monitor_rest(const struct sim *sim, bool answer);

#endif
