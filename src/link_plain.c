/* SPDX-License-Identifier: MIT */
/* link_plain.c: the manual's own "length, data" notation with the node before it, for use by hand or over TCP (L2).
 *
 *     DNode, length high byte, length low byte, message…
 *
 * No flags, no check sum: a receiver that has lost its place finds it again after 100 ms of silence. */
#include <rkm04/link.h>

#define PLAIN_LENGTH_MAX 9216u   /* of the framing, however small the buffer is */
#define PLAIN_SILENCE_TICKS (RKM04_TICKS_PER_SECOND / 10)

/* What the next byte is. */
enum phase { DNODE, LENGTH_HIGH, LENGTH_LOW, BODY, SKIP /* body of a frame longer than the buffer */ };

static void take_length(struct rkm04_receiver *r, uint8_t low, size_t room)
{
    r->left = r->left << 8 | low;
    r->length = 0;
    if (r->left == 0 || r->left > PLAIN_LENGTH_MAX) {
        r->malformed++;
        r->phase = DNODE;
    } else if (r->left > room) {
        r->too_long++;
        r->phase = SKIP;
    } else {
        r->phase = BODY;
    }
}

static void notice_silence(struct rkm04_receiver *r, uint64_t now)
{
    if (r->phase == DNODE || now - r->last < PLAIN_SILENCE_TICKS)
        return;
    if (r->phase != SKIP) /* that one is counted already */
        r->malformed++;
    r->phase = DNODE;
}

static bool plain_receive(struct rkm04_receiver *r, uint8_t byte, uint64_t now, uint8_t *buffer, size_t room)
{
    notice_silence(r, now);
    r->last = now;
    switch (r->phase) {
    case DNODE:
        if (byte > RKM04_NODE_MAX) {
            r->malformed++;
            return false;
        }
        r->dnode = byte;
        r->snode = 0;
        r->phase = LENGTH_HIGH;
        return false;
    case LENGTH_HIGH:
        r->left = byte;
        r->phase = LENGTH_LOW;
        return false;
    case LENGTH_LOW:
        take_length(r, byte, room);
        return false;
    case BODY:
        buffer[r->length++] = byte;
        break;
    default:
        break;
    }
    if (--r->left > 0)
        return false;
    bool whole = r->phase == BODY;
    r->phase = DNODE;
    return whole;
}

static size_t plain_begin(struct rkm04_sender *sender, uint8_t dnode, uint8_t snode, size_t length, bool answer, uint8_t *out)
{
    sender->check = 0;
    out[0] = answer ? snode : dnode;
    out[1] = (uint8_t)(length >> 8 & 0xFFu);
    out[2] = (uint8_t)(length & 0xFFu);
    return 3;
}

static size_t plain_put(struct rkm04_sender *sender, uint8_t byte, uint8_t *out)
{
    (void)sender;
    out[0] = byte;
    return 1;
}

static size_t plain_end(struct rkm04_sender *sender, uint8_t *out)
{
    (void)sender;
    (void)out;
    return 0;
}

const struct rkm04_framing rkm04_plain = {
    .name = "plain",
    .receive = plain_receive,
    .begin = plain_begin,
    .put = plain_put,
    .end = plain_end,
    .answer_names_sender = false,
};
