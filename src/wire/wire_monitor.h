/* SPDX-License-Identifier: MIT */
/* wire_monitor.h: finds the messages in the bytes on the two wires, whole ones and what was dropped, with the reason. */
#ifndef RKM04_WIRE_MONITOR_H
#define RKM04_WIRE_MONITOR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <rkm04/link.h>

#include "segment.h"
#include "wire_message.h"

#define WIRE_RAW_MAX (2u * (WIRE_ANSWER_MAX + 4u) + 2u) /* bytes on the wire that are kept of a frame, of any kind */

/* One for each direction, so that an answer in the middle of a request does not confuse either. A byte that belongs to a
 * collision of both counts in both. */
struct wire_frame {
    struct rkm04_receiver receiver;
    uint8_t *message; /* `room` bytes */
    size_t room;
    uint8_t *raw;     /* `raw_room` bytes */
    size_t raw_room;
    size_t raw_length, raw_total;
    uint64_t start, last; /* ticks: the first byte began; the last one had passed */
    uint32_t senders, collided;
    unsigned lost;
    uint64_t overruns;    /* bytes lost to a unit that had a request waiting (P10) */
    enum wire_fate astray; /* what the bytes gathered are, if they are no frame; WIRE_WHOLE: they are one */
    bool answer;
};

/* Who gets the messages. */
struct wire_monitor_calls {
    /* Does a watcher want messages now? NULL: none. */
    bool (*is_wanted)(void *context);
    /* A message was completed or dropped at `tick`; it is the callee's, from malloc(). NULL: out of memory for it. */
    void (*message)(void *context, uint64_t tick, struct wire_message *message);
    void *context;
};

struct wire_monitor {
    const struct device_framing *framing;
    const struct segment *segment; /* whose bytes these are */
    struct wire_monitor_calls calls;
    uint64_t overruns; /* of the segment, up to now */
    struct wire_frame requests, answers;
};

/* Find messages of units of this kind in the bytes of `segment`, which may be NULL for a copy that gets none. Returns false if
 * out of memory; wire_monitor_end() is due in either case. */
bool wire_monitor_begin(struct wire_monitor *monitor, const struct device_kind *kind, const struct device_framing *framing,
                        const struct segment *segment, struct wire_monitor_calls calls);
void wire_monitor_end(struct wire_monitor *monitor);

/* Make `to` like `from`, what is half received included, all times later by `later` ticks (mod 2^64). Both have been begun,
 * with the same framing; segment and calls stay. For snapshots. */
void wire_monitor_copy(struct wire_monitor *to, const struct wire_monitor *from, uint64_t later);

/* A byte has passed: report the message that it completes, if any. */
void wire_monitor_add_byte(struct wire_monitor *monitor, const struct segment_byte *byte);

/* Messages that end with a silence: the tick at which the present one ends if nothing more comes; DEVICE_NEVER: there is none, or
 * no watcher wants it. */
uint64_t wire_monitor_due(const struct wire_monitor *monitor);

/* No byte comes before `tick` any more: report what ends with the silence. */
void wire_monitor_pass_time(struct wire_monitor *monitor, uint64_t tick);

/* What has been received of a request, or of an answer, that is not complete. Returns NULL if there is nothing (or out of
 * memory), otherwise a message to be freed. */
struct wire_message *wire_monitor_rest(const struct wire_monitor *monitor, bool answer);

#endif
