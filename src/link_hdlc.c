/* SPDX-License-Identifier: MIT */
/* link_hdlc.c: octet-stuffed frames like those of RFC 1662 (L1).
 *
 *     7E  DNode SNode message… FCS-low FCS-high  7E        7D x stands for x ^ 20, in everything between the flags
 *
 * Where the message ends is known only when the closing flag comes, so the receiver keeps the last two bytes back: the
 * buffer holds the message alone and may be exactly as long as that. */
#include <rkm04/link.h>

#include "crc16.h"

enum { FLAG = 0x7E, ESCAPE = 0x7D, FLIP = 0x20 };

/* What the next unstuffed byte is. Of the states between flags the number grows with the bytes seen. */
enum phase {
    HUNT,  /* nothing: passed over until a flag comes */
    DNODE, /* after a flag */
    SNODE,
    KEPT_NONE, /* nothing is kept back yet */
    KEPT_ONE,
    KEPT_TWO, /* the older of two bytes kept back goes to the buffer */
    PHASE_MASK = 0x0F,
    ESCAPED = 0x80 /* besides the phase: the byte before was an escape */
};

static void take(struct rkm04_receiver *r, uint8_t byte, uint8_t *buffer, size_t room)
{
    uint8_t kept = (uint8_t)(r->left >> 8);
    r->check = crc16_update(r->check, byte);
    switch (r->phase) {
    case DNODE:
        r->dnode = byte;
        r->phase = SNODE;
        return;
    case SNODE:
        r->snode = byte;
        r->phase = KEPT_NONE;
        return;
    case KEPT_NONE:
        r->phase = KEPT_ONE;
        break;
    case KEPT_ONE:
        r->phase = KEPT_TWO;
        break;
    default:
        if (r->length >= room) {
            r->too_long++;
            r->phase = HUNT;
            return;
        }
        buffer[r->length++] = kept;
        break;
    }
    r->left = (r->left << 8 | byte) & 0xFFFFu;
}

/* A flag ends what is before it. Returns true if that was a whole message. */
static bool finish(struct rkm04_receiver *r)
{
    if (r->phase == HUNT || r->phase == DNODE)
        return false;
    if (r->phase != KEPT_TWO || r->length == 0) { /* too short, or an escape came last: aborted */
        r->malformed++;
        return false;
    }
    if (r->check != CRC16_GOOD) {
        r->bad_check++;
        return false;
    }
    return true;
}

static bool hdlc_receive(struct rkm04_receiver *r, uint8_t byte, uint64_t now, uint8_t *buffer, size_t room)
{
    r->last = now;
    if (byte == FLAG) {
        bool whole = finish(r);
        r->phase = DNODE;
        return whole;
    }
    if (r->phase == HUNT)
        return false;
    if (r->phase == DNODE) {
        r->check = CRC16_START;
        r->length = 0;
        r->left = 0;
    }
    if ((r->phase & ESCAPED) != 0) {
        r->phase &= PHASE_MASK;
        take(r, byte ^ FLIP, buffer, room);
    } else if (byte == ESCAPE) {
        r->phase |= ESCAPED;
    } else {
        take(r, byte, buffer, room);
    }
    return false;
}

static size_t stuff(uint8_t byte, uint8_t *out)
{
    if (byte != FLAG && byte != ESCAPE) {
        out[0] = byte;
        return 1;
    }
    out[0] = ESCAPE;
    out[1] = byte ^ FLIP;
    return 2;
}

static size_t hdlc_put(struct rkm04_sender *sender, uint8_t byte, uint8_t *out)
{
    sender->check = crc16_update(sender->check, byte);
    return stuff(byte, out);
}

static size_t hdlc_begin(struct rkm04_sender *sender, uint8_t dnode, uint8_t snode, size_t length, bool answer, uint8_t *out)
{
    (void)length; /* the flags say where a frame ends */
    (void)answer; /* a frame always names both */
    sender->check = CRC16_START;
    size_t n = 0;
    out[n++] = FLAG;
    n += hdlc_put(sender, dnode, out + n);
    n += hdlc_put(sender, snode, out + n);
    return n;
}

static size_t hdlc_end(struct rkm04_sender *sender, uint8_t *out)
{
    uint16_t check = crc16_final(sender->check);
    size_t n = stuff((uint8_t)(check & 0xFFu), out);
    n += stuff((uint8_t)(check >> 8), out + n);
    out[n++] = FLAG;
    return n;
}

const struct rkm04_framing rkm04_hdlc = {
    .name = "hdlc",
    .receive = hdlc_receive,
    .begin = hdlc_begin,
    .put = hdlc_put,
    .end = hdlc_end,
    .answer_names_sender = true,
};
