/* SPDX-License-Identifier: MIT */
#include "line_settings.h"

#include <asm/termbits.h> /* not <termios.h>: the kernel's own structure has speeds of any number */
#include <stdio.h>
#include <sys/ioctl.h>

#ifndef TCGETS2 /* where the first structure has them already */
#define TCGETS2 TCGETS
#define termios2 termios
#endif

const struct line_settings line_settings_unit = {19200, 8, 'N', 2};

/* ---- Settings ------------------------------------------------------------------------------------------------------- */

static uint8_t data_bits_of(tcflag_t flags)
{
    switch (flags & CSIZE) {
    case CS5:
        return 5;
    case CS6:
        return 6;
    case CS7:
        return 7;
    default:
        return 8;
    }
}

static char parity_of(tcflag_t flags)
{
    if (!(flags & PARENB))
        return 'N';
    if (flags & CMSPAR)
        return flags & PARODD ? 'M' : 'S';
    return flags & PARODD ? 'O' : 'E';
}

bool line_settings_read(int fd, struct line_settings *settings)
{
    struct termios2 terminal;
    if (ioctl(fd, TCGETS2, &terminal) != 0)
        return false;
    settings->baud = terminal.c_ospeed;
    settings->data_bits = data_bits_of(terminal.c_cflag);
    settings->parity = parity_of(terminal.c_cflag);
    settings->stop_halves = 2;
    if (terminal.c_cflag & CSTOPB)
        settings->stop_halves = settings->data_bits == 5 ? 3 : 4; /* so UARTs have it */
    return true;
}

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

bool line_settings_news(struct line_settings *known, struct line_settings now, char news[LINE_NEWS_MAX])
{
    char client[LINE_SETTINGS_TEXT_MAX], unit[LINE_SETTINGS_TEXT_MAX];
    if (line_settings_equal(*known, now))
        return false;
    *known = now;
    line_settings_text(now, client);
    if (line_settings_equal(now, line_settings_unit))
        snprintf(news, LINE_NEWS_MAX, "client is %s, as the unit is", client);
    else
        snprintf(news, LINE_NEWS_MAX, "client is %s, unit is %s", client, line_settings_text(line_settings_unit, unit));
    return true;
}

/* ---- The ear -------------------------------------------------------------------------------------------------------- */

enum phase { AWAITS_IDLE, AWAITS_START, IN_CHARACTER };

#define TICKS_PER_SECOND 1000000u
#define LONG_IDLE (1000u * UINT64_C(1000000)) /* ticks: more than any character lasts */

_Static_assert(UINT64_MAX / TICKS_PER_SECOND / 2 / LINE_EAR_BAUD_MAX >= LINE_EAR_BAUD_MAX, "tick_of() would overflow");

static uint64_t units_per_second(const struct line_ear *ear)
{
    return UINT64_C(2) * ear->from.baud * ear->to.baud;
}

static uint64_t units_of(const struct line_ear *ear, uint64_t tick)
{
    uint64_t per_second = units_per_second(ear);
    return tick / TICKS_PER_SECOND * per_second + tick % TICKS_PER_SECOND * per_second / TICKS_PER_SECOND;
}

static uint64_t tick_of(const struct line_ear *ear, uint64_t time)
{
    uint64_t per_second = units_per_second(ear);
    return time / per_second * TICKS_PER_SECOND + time % per_second * TICKS_PER_SECOND / per_second;
}

static uint64_t half_bit_sent(const struct line_ear *ear)
{
    return ear->to.baud;
}

static uint64_t half_bit_heard(const struct line_ear *ear)
{
    return ear->from.baud;
}

/* The sample in the stop bit ends the character. Returns the number of bytes heard. */
static size_t end_character(struct line_ear *ear, bool level, struct line_heard *heard)
{
    ear->phase = level ? AWAITS_START : AWAITS_IDLE;
    ear->framing_errors += !level;
    if (!level && !ear->keeps_bad)
        return 0;
    *heard = (struct line_heard){ear->origin + tick_of(ear, ear->start), ear->bits};
    return 1;
}

/* Take the sample that is due. Returns the number of bytes heard. */
static size_t sample(struct line_ear *ear, bool level, struct line_heard *heard)
{
    unsigned bit = ear->bit++, last = ear->to.data_bits + (ear->to.parity != 'N' ? 1u : 0u); /* last: before the stop bit */
    ear->sample += 2 * half_bit_heard(ear);
    if (bit == 0 && level)
        ear->phase = AWAITS_START; /* too short for a start bit */
    else if (1 <= bit && bit <= ear->to.data_bits)
        ear->bits |= (uint8_t)(level << (bit - 1));
    else if (bit > last)
        return end_character(ear, level, heard);
    return 0;
}

/* The line stays at `level` until `until`. Within a level at most one character can end. Returns the number of bytes heard. */
static size_t listen(struct line_ear *ear, bool level, uint64_t until, struct line_heard *heard)
{
    size_t count = 0;
    if (ear->phase == AWAITS_IDLE && level)
        ear->phase = AWAITS_START;
    if (ear->phase == AWAITS_START && !level) {
        ear->phase = IN_CHARACTER;
        ear->bit = ear->bits = 0;
        ear->start = ear->time;
        ear->sample = ear->time + half_bit_heard(ear);
    }
    while (ear->phase == IN_CHARACTER && ear->sample < until)
        count += sample(ear, level, heard);
    ear->time = until;
    return count;
}

static bool parity_bit(struct line_settings settings, uint8_t byte)
{
    bool odd = false; /* number of ones in the byte */
    for (unsigned bit = 0; bit < settings.data_bits; bit++)
        odd ^= byte >> bit & 1;
    return settings.parity == 'M' || (settings.parity == 'E' && odd) || (settings.parity == 'O' && !odd);
}

void line_ear_begin(struct line_ear *ear, struct line_settings from, struct line_settings to, bool keeps_bad)
{
    *ear = (struct line_ear){.from = from, .to = to, .keeps_bad = keeps_bad, .phase = AWAITS_START};
    if (ear->from.baud > LINE_EAR_BAUD_MAX)
        ear->from.baud = LINE_EAR_BAUD_MAX;
    if (ear->to.baud > LINE_EAR_BAUD_MAX)
        ear->to.baud = LINE_EAR_BAUD_MAX;
}

size_t line_ear_byte(struct line_ear *ear, uint8_t byte, uint64_t tick, struct line_heard heard[LINE_EAR_MAX])
{
    const uint64_t half = half_bit_sent(ear);
    size_t count = 0;
    if (units_per_second(ear) == 0)
        return 0;
    uint64_t drawn = tick_of(ear, ear->time), gone = tick > ear->origin ? tick - ear->origin : 0;
    uint64_t set_out = units_of(ear, gone < drawn + LONG_IDLE ? gone : drawn + LONG_IDLE);
    if (ear->phase != AWAITS_START && set_out > ear->time)
        count += listen(ear, true, set_out, heard);
    if (ear->phase == AWAITS_START && set_out >= ear->time) { /* times stay small */
        ear->origin = tick;
        ear->time = 0;
    }
    count += listen(ear, false, ear->time + 2 * half, heard + count);
    for (unsigned bit = 0; bit < ear->from.data_bits; bit++)
        count += listen(ear, byte >> bit & 1, ear->time + 2 * half, heard + count);
    if (ear->from.parity != 'N')
        count += listen(ear, parity_bit(ear->from, byte), ear->time + 2 * half, heard + count);
    return count + listen(ear, true, ear->time + ear->from.stop_halves * half, heard + count);
}

size_t line_ear_silence(struct line_ear *ear, struct line_heard heard[LINE_EAR_MAX])
{
    uint64_t time = ear->time;
    size_t count = 0;
    while (ear->phase != AWAITS_START)
        count += listen(ear, true, ear->time + 2 * half_bit_heard(ear), heard);
    ear->time = time;
    return count;
}
