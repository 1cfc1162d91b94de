/* SPDX-License-Identifier: MIT */
/* fuzz_link.c: both framings: any bytes at any times (L1, L2). What is received comes out of a frame made of it again; a frame
 * that was damaged on the way is dropped or well formed. First byte: 1 plain, 2 times are in the input, 4 a frame is made of
 * the input, 8 a small buffer. */
#include <string.h>

#include <rkm04/link.h>

#include "fuzz.h"

#define FRAME_MAX 20000
#define ROOM 9216

static uint8_t encoded[FRAME_MAX], again[FRAME_MAX], buffer[ROOM], second[ROOM];

static size_t encode(const struct rkm04_framing *framing, uint8_t to, uint8_t from, const uint8_t *message, size_t length,
                     uint8_t *frame)
{
    struct rkm04_sender sender = {0};
    size_t part, n = framing->begin(&sender, to, from, length, false, frame);
    FUZZ_CHECK(n <= RKM04_FRAME_EDGE_MAX, "%zu", n);
    for (size_t i = 0; i < length; i++) {
        part = framing->put(&sender, message[i], frame + n);
        FUZZ_CHECK(part >= 1 && part <= RKM04_FRAME_EDGE_MAX, "%zu", part);
        n += part;
    }
    part = framing->end(&sender, frame + n);
    FUZZ_CHECK(part <= RKM04_FRAME_EDGE_MAX, "%zu", part);
    return n + part;
}

/* A message that was received is received again from a frame made of it. */
static void check_again(const struct rkm04_framing *framing, const struct rkm04_receiver *got, const uint8_t *message)
{
    struct rkm04_receiver receiver = {0};
    size_t messages = 0, n = encode(framing, got->dnode, got->snode, message, got->length, again);
    for (size_t i = 0; i < n; i++)
        messages += framing->receive(&receiver, again[i], i, second, sizeof second);
    FUZZ_CHECK(messages == 1, "%zu messages from the frame of one", messages);
    FUZZ_CHECK(receiver.length == got->length && receiver.dnode == got->dnode && receiver.snode == got->snode,
               "%u bytes for %u from %u", (unsigned)receiver.length, receiver.dnode, receiver.snode);
    FUZZ_CHECK(memcmp(second, message, got->length) == 0, "other bytes");
    FUZZ_CHECK(receiver.bad_check + receiver.malformed + receiver.too_long == 0, "counted as damaged");
}

/* Make a frame of the input, damage it as the input says, and put it after what is fed. Returns its length. */
static size_t make_frame(const struct rkm04_framing *framing, struct fuzz *fuzz)
{
    uint8_t to = fuzz_byte(fuzz) & 31, from = fuzz_byte(fuzz), damages = fuzz_byte(fuzz) & 3;
    uint32_t damage = fuzz_number(fuzz, 3);
    size_t length, n;
    const uint8_t *message = fuzz_take(fuzz, 4096, &length);
    if (length == 0)
        return 0;
    n = encode(framing, to, from, message, length, encoded);
    for (; damages > 0; damages--, damage = damage * 1664525u + 1013904223u)
        encoded[(damage >> 8) % n] ^= (uint8_t)(1u << (damage & 7));
    return n;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct fuzz fuzz = {data, size};
    uint8_t mode = fuzz_byte(&fuzz);
    const struct rkm04_framing *framing = mode & 1 ? &rkm04_plain : &rkm04_hdlc;
    struct rkm04_receiver receiver = {0};
    size_t room = mode & 8 ? 64 : sizeof buffer, length, messages = 0;
    const uint8_t *bytes = encoded;
    uint64_t now = 0;
    if (mode & 4)
        length = make_frame(framing, &fuzz);
    else
        bytes = fuzz_take(&fuzz, FRAME_MAX, &length);
    for (size_t i = 0; i < length; i++) {
        if (mode & 2 && i % 8 == 7)
            now += (uint64_t)bytes[i] * 1000;
        now += 521;
        if (!framing->receive(&receiver, bytes[i], now, buffer, room))
            continue;
        messages++;
        FUZZ_CHECK(receiver.length <= room, "%u bytes in a buffer of %zu", (unsigned)receiver.length, room);
        check_again(framing, &receiver, buffer);
    }
    FUZZ_CHECK(messages + receiver.bad_check + receiver.malformed + receiver.too_long <= length, "more frames than bytes");
    return 0;
}
