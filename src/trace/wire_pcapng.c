/* SPDX-License-Identifier: MIT */
/* wire_pcapng.c: a capture file for Wireshark (draft-ietf-opsawg-pcapng), link type 250, RTAC serial: every packet begins with 12
 * bytes with time, direction, and the state of the control lines. What the messages mean is in packet comments. */
#include <string.h>

#include <rkm04/limits.h>

#include "wire/wire.h"
#include "wire_format.h"

/* Blocks. Numbers in them are little-endian. */
#define BLOCK_SECTION 0x0A0D0D0Au
#define BLOCK_INTERFACE 1u
#define BLOCK_PACKET 6u
#define SECTION_ORDER 0x1A2B3C4Du
#define LINKTYPE_RTAC_SERIAL 250u

enum option {
    OPTION_END = 0,
    OPTION_COMMENT = 1,
    OPTION_NAME = 2,    /* of the interface */
    OPTION_APPLICATION = 4, /* of the section */
    OPTION_FLAGS = 2,   /* of a packet */
    OPTION_SPEED = 8,
    OPTION_RESOLUTION = 9
};

/* Flags of a packet. */
#define FLAG_INBOUND 1u /* as the host sees it */
#define FLAG_OUTBOUND 2u
#define FLAG_SYMBOL_ERROR (UINT32_C(1) << 31)
#define FLAG_TOO_SHORT (UINT32_C(1) << 26)
#define FLAG_TOO_LONG (UINT32_C(1) << 25)
#define FLAG_WRONG_CHECK (UINT32_C(1) << 24)

/* The head of a packet. Numbers in it are big-endian. */
#define HEAD_SIZE 12u
enum serial_event {
    EVENT_STATUS = 0x00,
    EVENT_TRANSMITTED = 0x01, /* from the host */
    EVENT_RECEIVED = 0x02,    /* by the host */
    EVENT_FRAMING_ERROR = 0x07,
    EVENT_BREAK = 0x09
};

#define COMMENT_MAX 60000u /* characters; an option may have 65535 */

static void put_little(struct wire_text *out, uint64_t value, unsigned bytes)
{
    for (; bytes > 0; bytes--, value >>= 8)
        wire_text_put(out, (char)(value & 0xFFu));
}

static void put_big(struct wire_text *out, uint32_t value)
{
    for (unsigned shift = 32; shift > 0; shift -= 8)
        wire_text_put(out, (char)(value >> (shift - 8u) & 0xFFu));
}

static void put_padding(struct wire_text *out, size_t length)
{
    for (; length % 4u != 0; length++)
        wire_text_put(out, 0);
}

static void put_raw(struct wire_text *out, const void *bytes, size_t length)
{
    if (length == 0 || length > out->room - out->length)
        return; /* too long cannot be: WIRE_ENTRY_MAX is more than everything together */
    memcpy(out->text + out->length, bytes, length);
    out->length += length;
}

/* A block's length is at its beginning and at its end. Returns where it began, for end_block(). */
static size_t begin_block(struct wire_text *out, uint32_t type)
{
    size_t at = out->length;
    put_little(out, type, 4);
    put_little(out, 0, 4);
    return at;
}

static void end_block(struct wire_text *out, size_t at)
{
    size_t length = out->length + 4u - at;
    struct wire_text field = {.text = out->text + at + 4u, .room = 4};
    put_little(&field, length, 4);
    put_little(out, length, 4);
}

static void put_option(struct wire_text *out, enum option code, const void *value, size_t length)
{
    put_little(out, code, 2);
    put_little(out, length, 2);
    put_raw(out, value, length);
    put_padding(out, length);
}

static void put_option_string(struct wire_text *out, enum option code, const char *string)
{
    put_option(out, code, string, strlen(string));
}

static void put_comment(struct wire_text *out, const struct wire_text *comment)
{
    put_option(out, OPTION_COMMENT, comment->text, comment->length);
}

static void pcapng_head(struct wire_text *out, const struct sim *sim)
{
    static const uint8_t microseconds = 6;
    size_t at = begin_block(out, BLOCK_SECTION);
    put_little(out, SECTION_ORDER, 4);
    put_little(out, 1, 2); /* version 1.0 */
    put_little(out, 0, 2);
    put_little(out, UINT64_MAX, 8); /* length of the section: not said */
    put_option_string(out, OPTION_APPLICATION, "rkm04 " RKM04_VERSION);
    put_little(out, OPTION_END, 4);
    end_block(out, at);

    at = begin_block(out, BLOCK_INTERFACE);
    put_little(out, LINKTYPE_RTAC_SERIAL, 2);
    put_little(out, 0, 2);
    put_little(out, 0, 4); /* packets of any length */
    put_option_string(out, OPTION_NAME, "rs485");
    put_little(out, OPTION_SPEED, 2);
    put_little(out, 8, 2);
    put_little(out, sim->segment.config.timed ? sim->segment.config.baud : 0, 8);
    put_option(out, OPTION_RESOLUTION, &microseconds, 1);
    put_little(out, OPTION_END, 4);
    end_block(out, at);
}

struct packet {
    uint64_t time;
    enum serial_event event;
    uint32_t flags;
    const uint8_t *bytes;
    size_t length, whole; /* what is there, and what there was */
};

static void put_packet(struct wire_text *out, const struct packet *packet, const struct wire_text *comment)
{
    size_t at = begin_block(out, BLOCK_PACKET);
    put_little(out, 0, 4); /* interface */
    put_little(out, packet->time >> 32, 4);
    put_little(out, packet->time & UINT32_MAX, 4);
    put_little(out, HEAD_SIZE + packet->length, 4);
    put_little(out, HEAD_SIZE + packet->whole, 4);
    put_big(out, (uint32_t)(packet->time / US_PER_SECOND));
    put_big(out, (uint32_t)(packet->time % US_PER_SECOND));
    wire_text_put(out, (char)packet->event);
    put_little(out, 0, 3); /* control lines: RS485 has none; footer */
    put_raw(out, packet->bytes, packet->length);
    put_padding(out, packet->length);
    put_comment(out, comment);
    put_little(out, OPTION_FLAGS, 2);
    put_little(out, 4, 2);
    put_little(out, packet->flags, 4);
    put_little(out, OPTION_END, 4);
    end_block(out, at);
}

static uint32_t error_flag(enum wire_fate fate)
{
    switch (fate) {
    case WIRE_WRONG_CHECK:
        return FLAG_WRONG_CHECK;
    case WIRE_TOO_SHORT:
        return FLAG_TOO_SHORT;
    case WIRE_TOO_LONG:
        return FLAG_TOO_LONG;
    case WIRE_FRAMING_ERROR:
    case WIRE_BREAK:
        return FLAG_SYMBOL_ERROR;
    default:
        return 0;
    }
}

static void pcapng_message(struct wire_text *out, const struct sim *sim, const struct wire_message *message)
{
    char buffer[COMMENT_MAX];
    struct wire_text comment = {.text = buffer, .room = sizeof buffer};
    struct packet packet = {
        .time = message->start,
        .event = message->answer ? EVENT_RECEIVED : EVENT_TRANSMITTED,
        .flags = (message->answer ? FLAG_INBOUND : FLAG_OUTBOUND) | error_flag(message->fate),
        .bytes = message->raw,
        .length = message->raw_length,
        .whole = message->raw_total,
    };
    if (message->fate == WIRE_FRAMING_ERROR)
        packet.event = EVENT_FRAMING_ERROR;
    if (message->fate == WIRE_BREAK)
        packet.event = EVENT_BREAK;
    const struct wire_names names = sim_wire_names(sim);
    wire_words_direction(&comment, &names, message);
    wire_text_string(&comment, ": ");
    wire_words_story(&comment, &names, message);
    put_packet(out, &packet, &comment);
}

static void pcapng_news(struct wire_text *out, const struct sim *sim, const struct watch_event *event)
{
    char buffer[1024];
    struct wire_text comment = {.text = buffer, .room = sizeof buffer};
    struct packet packet = {.time = event->tick, .event = EVENT_STATUS};
    wire_news_words(&comment, sim, event);
    put_packet(out, &packet, &comment);
}

const struct wire_format wire_pcapng = {
    .suffix = ".pcapng",
    .kind = {.name = "a pcapng file", .begins = {"\n\r\r\n"}},
    .head = pcapng_head,
    .message = pcapng_message,
    .news = pcapng_news,
};
