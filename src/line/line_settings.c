/* SPDX-License-Identifier: MIT */
#include "line_settings.h"

#include <stdio.h>

const struct line_settings line_settings_unit = {19200, 8, 'N', 2};

/* ---- Settings ------------------------------------------------------------------------------------------------------- */

struct line_settings line_settings_of(uint32_t baud, unsigned data_bits, char parity, unsigned stop_bits)
{
    uint8_t stop_halves = stop_bits == 3 ? 3 : stop_bits == 2 ? 4 : 2;
    return (struct line_settings){baud, data_bits >= 5 && data_bits <= 8 ? (uint8_t)data_bits : 8, parity, stop_halves};
}

bool line_settings_equal(struct line_settings a, struct line_settings b)
{
    return a.baud == b.baud && a.data_bits == b.data_bits && a.parity == b.parity && a.stop_halves == b.stop_halves;
}

char *line_settings_text(struct line_settings settings, char text[LINE_SETTINGS_TEXT_MAX])
{
    const char *stop = settings.stop_halves == 2 ? "1" : settings.stop_halves == 3 ? "1.5" : "2";
    snprintf(text, LINE_SETTINGS_TEXT_MAX, "%u %u%c%s", (unsigned)settings.baud, settings.data_bits, settings.parity, stop);
    return text;
}

bool line_settings_changed(struct line_settings *known, struct line_settings now, struct line_settings unit,
                           char change[LINE_SETTINGS_CHANGE_MAX])
{
    char client[LINE_SETTINGS_TEXT_MAX], text[LINE_SETTINGS_TEXT_MAX];
    if (line_settings_equal(*known, now))
        return false;
    *known = now;
    line_settings_text(now, client);
    if (line_settings_equal(now, unit))
        snprintf(change, LINE_SETTINGS_CHANGE_MAX, "client is %s, as the unit is", client);
    else
        snprintf(change, LINE_SETTINGS_CHANGE_MAX, "client is %s, unit is %s", client,
                 line_settings_text(unit, text));
    return true;
}

/* ---- The receiver --------------------------------------------------------------------------------------------------- */

enum phase { AWAITS_IDLE, AWAITS_START, IN_CHARACTER };

#define TICKS_PER_SECOND 1000000u
#define LONG_IDLE (1000u * UINT64_C(1000000)) /* ticks: more than any character lasts */

_Static_assert(UINT64_MAX / TICKS_PER_SECOND / 2 / LINE_RECEIVER_BAUD_MAX >= LINE_RECEIVER_BAUD_MAX, "tick_of() would overflow");

static uint64_t units_per_second(const struct line_receiver *receiver)
{
    return UINT64_C(2) * receiver->from.baud * receiver->to.baud;
}

static uint64_t units_of(const struct line_receiver *receiver, uint64_t tick)
{
    uint64_t per_second = units_per_second(receiver);
    return tick / TICKS_PER_SECOND * per_second + tick % TICKS_PER_SECOND * per_second / TICKS_PER_SECOND;
}

static uint64_t tick_of(const struct line_receiver *receiver, uint64_t time)
{
    uint64_t per_second = units_per_second(receiver);
    return time / per_second * TICKS_PER_SECOND + time % per_second * TICKS_PER_SECOND / per_second;
}

static uint64_t half_bit_sent(const struct line_receiver *receiver)
{
    return receiver->to.baud;
}

static uint64_t half_bit_received(const struct line_receiver *receiver)
{
    return receiver->from.baud;
}

/* The sample in the stop bit ends the character. Returns the number of bytes received. */
static size_t end_character(struct line_receiver *receiver, bool level, struct line_received *received)
{
    receiver->phase = level ? AWAITS_START : AWAITS_IDLE;
    receiver->framing_errors += !level;
    if (!level && !receiver->keeps_bad)
        return 0;
    *received = (struct line_received){receiver->origin + tick_of(receiver, receiver->start), receiver->bits};
    return 1;
}

/* Take the sample that is due. Returns the number of bytes received. */
static size_t take_sample(struct line_receiver *receiver, bool level, struct line_received *received)
{
    unsigned bit = receiver->bit++;
    unsigned last = receiver->to.data_bits + (receiver->to.parity != 'N' ? 1u : 0u); /* before the stop bit */
    receiver->sample += 2 * half_bit_received(receiver);
    if (bit == 0 && level)
        receiver->phase = AWAITS_START; /* too short for a start bit */
    else if (1 <= bit && bit <= receiver->to.data_bits)
        receiver->bits |= (uint8_t)(level << (bit - 1));
    else if (bit > last)
        return end_character(receiver, level, received);
    return 0;
}

/* The line stays at `level` until `until`. Within a level at most one character can end. Returns the number of bytes received. */
static size_t track_level(struct line_receiver *receiver, bool level, uint64_t until, struct line_received *received)
{
    size_t count = 0;
    if (receiver->phase == AWAITS_IDLE && level)
        receiver->phase = AWAITS_START;
    if (receiver->phase == AWAITS_START && !level) {
        receiver->phase = IN_CHARACTER;
        receiver->bit = receiver->bits = 0;
        receiver->start = receiver->time;
        receiver->sample = receiver->time + half_bit_received(receiver);
    }
    while (receiver->phase == IN_CHARACTER && receiver->sample < until)
        count += take_sample(receiver, level, received);
    receiver->time = until;
    return count;
}

static bool parity_bit(struct line_settings settings, uint8_t byte)
{
    bool odd = false; /* number of ones in the byte */
    for (unsigned bit = 0; bit < settings.data_bits; bit++)
        odd ^= byte >> bit & 1;
    return settings.parity == 'M' || (settings.parity == 'E' && odd) || (settings.parity == 'O' && !odd);
}

void line_receiver_begin(struct line_receiver *receiver, struct line_settings from, struct line_settings to, bool keeps_bad)
{
    *receiver = (struct line_receiver){.from = from, .to = to, .keeps_bad = keeps_bad, .phase = AWAITS_START};
    if (receiver->from.baud > LINE_RECEIVER_BAUD_MAX)
        receiver->from.baud = LINE_RECEIVER_BAUD_MAX;
    if (receiver->to.baud > LINE_RECEIVER_BAUD_MAX)
        receiver->to.baud = LINE_RECEIVER_BAUD_MAX;
}

size_t line_receiver_byte(struct line_receiver *receiver, uint8_t byte, uint64_t tick,
                          struct line_received received[LINE_RECEIVER_MAX])
{
    const uint64_t half = half_bit_sent(receiver);
    size_t count = 0;
    if (units_per_second(receiver) == 0)
        return 0;
    uint64_t drawn = tick_of(receiver, receiver->time), gone = tick > receiver->origin ? tick - receiver->origin : 0;
    uint64_t set_out = units_of(receiver, gone < drawn + LONG_IDLE ? gone : drawn + LONG_IDLE);
    if (receiver->phase != AWAITS_START && set_out > receiver->time)
        count += track_level(receiver, true, set_out, received);
    if (receiver->phase == AWAITS_START && set_out >= receiver->time) { /* times stay small */
        receiver->origin = tick;
        receiver->time = 0;
    }
    count += track_level(receiver, false, receiver->time + 2 * half, received + count);
    for (unsigned bit = 0; bit < receiver->from.data_bits; bit++)
        count += track_level(receiver, byte >> bit & 1, receiver->time + 2 * half, received + count);
    if (receiver->from.parity != 'N')
        count += track_level(receiver, parity_bit(receiver->from, byte), receiver->time + 2 * half, received + count);
    return count + track_level(receiver, true, receiver->time + receiver->from.stop_halves * half, received + count);
}

size_t line_receiver_silence(struct line_receiver *receiver, struct line_received received[LINE_RECEIVER_MAX])
{
    uint64_t time = receiver->time;
    size_t count = 0;
    while (receiver->phase != AWAITS_START)
        count += track_level(receiver, true, receiver->time + 2 * half_bit_received(receiver), received);
    receiver->time = time;
    return count;
}
