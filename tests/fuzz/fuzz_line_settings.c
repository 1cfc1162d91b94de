/* SPDX-License-Identifier: MIT */
/* fuzz_line_settings.c: two ends of a line with any settings, bytes at any times up to the end of virtual time (10^15 us). What
 * is heard is never more than a caller has room for, in order, within the receiver's data bits, and not before it was sent;
 * ends that agree hear what was sent; a change of settings is told once. */
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
    char news[LINE_NEWS_MAX], text[LINE_SETTINGS_TEXT_MAX];
    bool told = line_settings_news(&known, settings, news);
    FUZZ_CHECK(told != line_settings_equal(settings, line_settings_unit), "told %d", told);
    FUZZ_CHECK(!told || strstr(news, line_settings_text(settings, text)), "%s without %s", news, text);
    FUZZ_CHECK(!line_settings_news(&known, settings, news), "told twice");
    FUZZ_CHECK(!told || (line_settings_news(&known, line_settings_unit, news) && strstr(news, "as the unit is")), "%s", news);
}

struct session {
    struct line_ear ear;
    uint64_t tick, last; /* of sending; of the last byte heard */
};

static void check_heard(struct session *session, const struct line_heard *heard, size_t count)
{
    FUZZ_CHECK(count <= LINE_EAR_MAX, "%zu", count);
    for (size_t i = 0; i < count; i++) {
        FUZZ_CHECK(heard[i].tick >= session->last, "%llu after %llu", (unsigned long long)heard[i].tick,
                   (unsigned long long)session->last);
        FUZZ_CHECK(heard[i].byte >> session->ear.to.data_bits == 0, "%02x", heard[i].byte);
        session->last = heard[i].tick;
    }
}

static void send_byte(struct session *session, uint8_t byte, uint64_t gap)
{
    struct line_heard heard[LINE_EAR_MAX];
    const struct line_settings *from = &session->ear.from;
    session->tick = session->tick > END_OF_TIME - gap ? END_OF_TIME : session->tick + gap;
    size_t count = line_ear_byte(&session->ear, byte, session->tick, heard);
    check_heard(session, heard, count);
    if (!line_settings_equal(*from, session->ear.to) || from->baud == 0)
        return;
    FUZZ_CHECK(count == 1 && heard[0].byte == (byte & (0xffu >> (8u - from->data_bits))), "%zu heard", count);
    FUZZ_CHECK(heard[0].tick + 1u >= session->tick, "heard at %llu, sent at %llu", (unsigned long long)heard[0].tick,
               (unsigned long long)session->tick);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct fuzz fuzz = {data, size};
    struct line_heard heard[LINE_EAR_MAX];
    struct session session = {0};
    uint8_t mode = fuzz_byte(&fuzz);
    struct line_settings from = mode & 1 ? line_settings_unit : choose(&fuzz), to = mode & 2 ? line_settings_unit : choose(&fuzz);
    if (mode & 4)
        to = from;
    check_news(from);
    check_news(to);
    line_ear_begin(&session.ear, from, to, mode & 8);
    for (unsigned i = 0; i < BYTES_MAX && fuzz.left > 0; i++) {
        uint8_t byte = fuzz_byte(&fuzz), gap = fuzz_byte(&fuzz);
        if (gap == 255) {
            size_t count = line_ear_silence(&session.ear, heard);
            FUZZ_CHECK(count <= 1, "%zu in silence", count);
            check_heard(&session, heard, count);
        }
        send_byte(&session, byte, gap == 254 ? END_OF_TIME / 3u : gap == 255 ? 100000 : (uint64_t)gap * gap);
    }
    check_heard(&session, heard, line_ear_silence(&session.ear, heard));
    FUZZ_CHECK(line_ear_silence(&session.ear, heard) == 0, "silence is not silent");
    return 0;
}
