/* SPDX-License-Identifier: MIT */
/* fake_framing.c: the bytes of the fake device's messages. */
#include <string.h>

#include "fake.h"
#include "fake_device.h"

/* ---- Messages that end with CR ---------------------------------------------------------------------------------------- */

static bool receive_byte(struct rkm04_receiver *receiver, uint8_t byte, uint64_t us, uint8_t *buffer, size_t room)
{
    receiver->last = us;
    if (receiver->phase == 0) { /* a message begins */
        receiver->length = 0;
        receiver->dnode = 0;
    }
    receiver->phase = byte != '\r';
    if (byte >= 0x80) {
        receiver->length = 0;
        receiver->dnode = byte & 0x7f;
    } else if (byte == '\r') {
        return receiver->length > 0;
    } else if (receiver->length < room) {
        buffer[receiver->length++] = byte;
    }
    return false;
}

static size_t begin_frame(struct rkm04_sender *sender, uint8_t to, uint8_t from, size_t length, bool answer, uint8_t *out)
{
    (void)sender;
    (void)from;
    (void)length;
    out[0] = 0x80 | to;
    return answer ? 0 : 1;
}

static size_t put_byte(struct rkm04_sender *sender, uint8_t byte, uint8_t *out)
{
    (void)sender;
    out[0] = byte;
    return 1;
}

static size_t end_frame(struct rkm04_sender *sender, uint8_t *out)
{
    return put_byte(sender, '\r', out);
}

static const struct rkm04_framing line_link = {
    .name = "lines", .receive = receive_byte, .begin = begin_frame, .put = put_byte, .end = end_frame};

const struct device_framing fake_lines = {.link = &line_link, .flag = -1, .escape = -1};

/* ---- Messages that end with a silence ------------------------------------------------------------------------ */

static bool gather_byte(struct rkm04_receiver *receiver, uint8_t byte, uint64_t us, uint8_t *buffer, size_t room)
{
    receiver->last = us;
    if (receiver->length < room)
        buffer[receiver->length++] = byte;
    else
        receiver->too_long++;
    return false;
}

/* A request is address, text, sum; an answer is text, sum. */
static bool end_gathered(struct rkm04_receiver *receiver, uint8_t *buffer, bool answer)
{
    uint32_t length = receiver->length, head = answer ? 0 : 1;
    uint8_t sum = 0;
    for (uint32_t i = 0; i + 1u < length; i++)
        sum = (uint8_t)(sum + buffer[i]);
    bool is_short = length < head + 1u, is_good = !is_short && sum == buffer[length - 1u] && receiver->too_long == 0;
    receiver->malformed += is_short;
    receiver->bad_check += !is_short && !is_good;
    if (!is_good)
        return false;
    receiver->dnode = answer ? 0 : buffer[0] & 0x7f;
    receiver->length = length - 1u - head;
    memmove(buffer, buffer + head, receiver->length);
    return true;
}

static size_t begin_sum(struct rkm04_sender *sender, uint8_t to, uint8_t from, size_t length, bool answer, uint8_t *out)
{
    size_t head = begin_frame(sender, to, from, length, answer, out);
    sender->check = head > 0 ? out[0] : 0;
    return head;
}

static size_t put_summed(struct rkm04_sender *sender, uint8_t byte, uint8_t *out)
{
    sender->check = (uint8_t)(sender->check + byte);
    return put_byte(sender, byte, out);
}

static size_t end_sum(struct rkm04_sender *sender, uint8_t *out)
{
    return put_byte(sender, (uint8_t)sender->check, out);
}

static const struct rkm04_framing sum_link = {
    .name = "sums", .receive = gather_byte, .begin = begin_sum, .put = put_summed, .end = end_sum};

const struct device_framing fake_sums = {
    .link = &sum_link, .flag = -1, .escape = -1, .silence = FAKE_SILENCE, .end = end_gathered};
