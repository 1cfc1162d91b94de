/* SPDX-License-Identifier: MIT */
/* fuzz_line_settings.c: two ends of a line with any settings, bytes at any times up to the end of virtual time (10^15 us). What
 * is received is never more than a caller has room for, in order, within the receiver's data bits, and not before it was sent;
 * ends that agree receive what was sent; a change of settings is reported once. */
#include "fuzz.h"
#include "line/line_settings.h"

#include <string.h>

#define BYTES_MAX 300u
#define END_OF_TIME UINT64_C(1000000000000000)

static struct line_settings choose(struct fuzz *fuzz)
{
    static const uint32_t usual[] = {19200, 9600, 38400, 115200, 300, 19201, 2000000, 4000000};
    uint8_t how = fuzz_byte(fuzz), form = fuzz_byte(fuzz);
    uint32_t baud = how & 8 ? fuzz_number(fuzz, 4) : usual[how & 7];
    return line_settings_of(baud, 4u + (form & 7u), "NEOMS"[(form >> 3 & 7u) % 5u], form >> 6);
}

static void check_news(struct line_settings settings)
{
    struct line_settings known = line_settings_unit;
    char news[LINE_SETTINGS_CHANGE_MAX], text[LINE_SETTINGS_TEXT_MAX];
    bool told = line_settings_changed(&known, settings, line_settings_unit, news);
    FUZZ_CHECK(told != line_settings_equal(settings, line_settings_unit), "told %d", told);
    FUZZ_CHECK(!told || strstr(news, line_settings_text(settings, text)), "%s without %s", news, text);
    FUZZ_CHECK(!line_settings_changed(&known, settings, line_settings_unit, news), "told twice");
    FUZZ_CHECK(!told || (line_settings_changed(&known, line_settings_unit, line_settings_unit, news) &&
                         strstr(news, "as the unit is")), "%s", news);
}

struct session {
    struct line_receiver receiver;
    uint64_t tick, last; /* of sending; of the last byte received */
};

static void check_received(struct session *session, const struct line_received *received, size_t count)
{
    FUZZ_CHECK(count <= LINE_RECEIVER_MAX, "%zu", count);
    for (size_t i = 0; i < count; i++) {
        FUZZ_CHECK(received[i].tick >= session->last, "%llu after %llu", (unsigned long long)received[i].tick,
                   (unsigned long long)session->last);
        FUZZ_CHECK(received[i].byte >> session->receiver.to.data_bits == 0, "%02x", received[i].byte);
        session->last = received[i].tick;
    }
}

static void send_byte(struct session *session, uint8_t byte, uint64_t gap)
{
    struct line_received received[LINE_RECEIVER_MAX];
    const struct line_settings *from = &session->receiver.from;
    session->tick = session->tick > END_OF_TIME - gap ? END_OF_TIME : session->tick + gap;
    size_t count = line_receiver_byte(&session->receiver, byte, session->tick, received);
    check_received(session, received, count);
    if (!line_settings_equal(*from, session->receiver.to) || from->baud == 0)
        return;
    FUZZ_CHECK(count == 1 && received[0].byte == (byte & (0xffu >> (8u - from->data_bits))), "%zu heard", count);
    FUZZ_CHECK(received[0].tick + 1u >= session->tick, "heard at %llu, sent at %llu", (unsigned long long)received[0].tick,
               (unsigned long long)session->tick);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct fuzz fuzz = {data, size};
    struct line_received received[LINE_RECEIVER_MAX];
    struct session session = {0};
    uint8_t mode = fuzz_byte(&fuzz);
    struct line_settings from = mode & 1 ? line_settings_unit : choose(&fuzz), to = mode & 2 ? line_settings_unit : choose(&fuzz);
    if (mode & 4)
        to = from;
    check_news(from);
    check_news(to);
    line_receiver_begin(&session.receiver, from, to, mode & 8);
    for (unsigned i = 0; i < BYTES_MAX && fuzz.left > 0; i++) {
        uint8_t byte = fuzz_byte(&fuzz), gap = fuzz_byte(&fuzz);
        if (gap == 255) {
            size_t count = line_receiver_silence(&session.receiver, received);
            FUZZ_CHECK(count <= 1, "%zu in silence", count);
            check_received(&session, received, count);
        }
        send_byte(&session, byte, gap == 254 ? END_OF_TIME / 3u : gap == 255 ? 100000 : (uint64_t)gap * gap);
    }
    check_received(&session, received, line_receiver_silence(&session.receiver, received));
    FUZZ_CHECK(line_receiver_silence(&session.receiver, received) == 0, "silence is not silent");
    return 0;
}
