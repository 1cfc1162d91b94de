/* SPDX-License-Identifier: MIT */
/* rkm04/link.h: framings, bytes on the line <-> addressed messages (specification section 4).
 *
 * A framing is one const record; the unit and a host use the same one. Adding a framing takes one file and one row in
 * rkm04_framings[]. Times are ticks of 1 us. */
#ifndef RKM04_LINK_H
#define RKM04_LINK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <rkm04/limits.h>

#ifdef __cplusplus
extern "C" {
#endif

#define RKM04_FRAME_EDGE_MAX 8 /* bytes that begin or end a frame, or stand for one byte of it, at most */

/* State of a receiver: plain data, zero-initialised. Who may read it: `dnode`, `snode`, `length` when a message is complete;
 * the counters at any time. */
struct rkm04_receiver {
    uint8_t phase;    /* of the framing's own machine */
    uint8_t dnode;    /* addressee */
    uint8_t snode;    /* sender, 0 where the framing has none */
    uint16_t check;   /* running check value */
    uint32_t length;  /* bytes of the message in the buffer */
    uint32_t left;    /* bytes still to come, for framings that know */
    uint64_t last;    /* tick of the last byte */
    uint32_t bad_check; /* frames dropped: wrong check sum */
    uint32_t malformed; /* frames dropped: aborted, too short, impossible header, silence inside */
    uint32_t too_long;  /* frames dropped: longer than the buffer */
};

/* State of a sender: plain data. */
struct rkm04_sender {
    uint16_t check;
};

struct rkm04_framing {
    const char *name; /* "hdlc", "plain" */

    /* Take one byte that arrived at tick `now`. The message gathers in buffer[0..room).
     * Returns true when a whole message with a correct check value is there: dnode, snode, length are set and stay, with the
     * buffer, until the next call. Anything wrong is dropped and counted, never reported. */
    bool (*receive)(struct rkm04_receiver *receiver, uint8_t byte, uint64_t now, uint8_t *buffer, size_t room);

    /* Begin a frame from `snode` to `dnode` that carries `length` bytes. Writes up to RKM04_FRAME_EDGE_MAX bytes to `out`.
     * Returns their number. `answer`: the frame is a unit's answer (plain puts the unit's own node at its head, L2). */
    size_t (*begin)(struct rkm04_sender *sender, uint8_t dnode, uint8_t snode, size_t length, bool answer, uint8_t *out);

    /* Encode one byte of the message. Returns the number of bytes written to `out` (1 or 2 for hdlc). */
    size_t (*put)(struct rkm04_sender *sender, uint8_t byte, uint8_t *out);

    /* End the frame. Returns the number of bytes written to `out`. */
    size_t (*end)(struct rkm04_sender *sender, uint8_t *out);

    bool answer_names_sender; /* true: answers carry DNode = asker, SNode = unit (hdlc); false: DNode = unit (plain) */
};

extern const struct rkm04_framing rkm04_hdlc;  /* L1, the default */
extern const struct rkm04_framing rkm04_plain; /* L2 */

/* All framings, for a choice at run time; the list ends with NULL. */
extern const struct rkm04_framing *const rkm04_framings[];

/* Find a framing by name. Returns NULL if there is none of that name. */
const struct rkm04_framing *rkm04_framing_named(const char *name);

#ifdef __cplusplus
}
#endif

#endif
