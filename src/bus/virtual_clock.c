/* SPDX-License-Identifier: MIT */
#include "virtual_clock.h"

#include <string.h>

#include "device/device.h"

#define REAL 1000u        /* thousandths */
#define FASTEST 10000000u /* thousandths */
#define NS_PER_TICK 1000u

/* "N" or "N.nnn" in thousandths; 0 if it is no such number or too large. */
static uint32_t read_thousandths(const char *text)
{
    uint32_t value = 0;
    int places = -1; /* after the point; -1: before it */
    for (; *text; text++) {
        if (*text == '.' && places < 0) {
            places = 0;
            if (!text[1])
                return 0;
            continue;
        }
        if (*text < '0' || *text > '9' || places == 3 || value > FASTEST)
            return 0;
        value = value * 10 + (uint32_t)(*text - '0');
        places += places >= 0;
    }
    for (int i = places < 0 ? 0 : places; i < 3 && value <= FASTEST; i++)
        value *= 10;
    return value <= FASTEST ? value : 0;
}

bool virtual_clock_read(struct virtual_clock *clock, const char *text)
{
    *clock = (struct virtual_clock){.thousandths = REAL};
    if (strcmp(text, "real") == 0)
        return true;
    if (strcmp(text, "max") == 0) {
        clock->runs_ahead = true;
        return true;
    }
    if (strcmp(text, "stepped") == 0) {
        clock->stands = true;
        return true;
    }
    if (text[0] != 'x' || text[1] == '.')
        return false;
    clock->thousandths = read_thousandths(text + 1);
    return clock->thousandths != 0;
}

void virtual_clock_start(struct virtual_clock *clock, uint64_t now, uint64_t tick)
{
    clock->start = now;
    clock->leapt = tick;
}

/* Both ways divide first and multiply the rest apart: no overflow within 50 years at the highest speed. */
uint64_t virtual_clock_tick(const struct virtual_clock *clock, uint64_t now)
{
    const uint64_t unit = (uint64_t)NS_PER_TICK * REAL;
    uint64_t passed = clock->stands ? 0 : now - clock->start;
    return passed / unit * clock->thousandths + passed % unit * clock->thousandths / unit + clock->leapt;
}

uint64_t virtual_clock_when(const struct virtual_clock *clock, uint64_t tick)
{
    const uint64_t unit = (uint64_t)NS_PER_TICK * REAL;
    if (tick <= clock->leapt)
        return clock->start;
    if (clock->stands)
        return DEVICE_NEVER;
    uint64_t ticks = tick - clock->leapt;
    uint64_t rest = ticks % clock->thousandths * unit;
    return clock->start + ticks / clock->thousandths * unit + (rest + clock->thousandths - 1) / clock->thousandths;
}

void virtual_clock_leap(struct virtual_clock *clock, uint64_t now, uint64_t tick)
{
    clock->leapt += tick - virtual_clock_tick(clock, now);
}

void virtual_clock_skip(struct virtual_clock *clock, uint64_t nanoseconds)
{
    clock->start += nanoseconds;
}
