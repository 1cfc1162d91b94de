/* SPDX-License-Identifier: MIT */
#include "time_value.h"

#include <stdbool.h>
#include <string.h>

static const struct {
    const char *name;
    unsigned places; /* digits after the point that a tick can show */
    const char *too_fine;
} units[] = {
    {"us", 0, "a whole number of us (the unit's clock ticks once a microsecond)"},
    {"ms", 3, "at most 3 digits after the point in ms (the unit's clock ticks once a microsecond)"},
    {"s", 6, "at most 6 digits after the point in s (the unit's clock ticks once a microsecond)"},
};

/* Digits from text[*at] on, not beyond `length`. Returns false if the number is above TIME_VALUE_MAX. */
static bool read_digits(const char *text, size_t length, size_t *at, uint64_t *number)
{
    *number = 0;
    while (*at < length && text[*at] >= '0' && text[*at] <= '9') {
        *number = *number * 10 + (uint64_t)(text[*at] - '0');
        if (*number > TIME_VALUE_MAX)
            return false;
        ++*at;
    }
    return true;
}

static bool scale(uint64_t *number, unsigned places)
{
    for (; places > 0; places--) {
        if (*number > TIME_VALUE_MAX / 10)
            return false;
        *number *= 10;
    }
    return true;
}

const char *time_value_read(const char *text, size_t length, uint64_t *ticks, size_t *wrong)
{
    static const char form[] = "a time with its unit, such as 250us, 1500ms or 2.5s";
    static const char too_late[] = "a time of at most 1000000000s";
    size_t at = 0, point;
    uint64_t whole, part = 0;

    *wrong = 0;
    if (!read_digits(text, length, &at, &whole))
        return too_late;
    *wrong = at;
    if (at == 0)
        return form;
    point = at;
    if (at < length && text[at] == '.') {
        at++;
        *wrong = at;
        if (!read_digits(text, length, &at, &part))
            return "fewer digits after the point";
        *wrong = at;
        if (at == point + 1)
            return form;
    }
    size_t digits = at > point ? at - point - 1 : 0;
    for (size_t i = 0; i < sizeof units / sizeof units[0]; i++) {
        if (strlen(units[i].name) != length - at || memcmp(units[i].name, text + at, length - at) != 0)
            continue;
        if (digits > units[i].places) {
            *wrong = units[i].places > 0 ? point + 1 + units[i].places : point;
            return units[i].too_fine;
        }
        *wrong = 0;
        if (!scale(&whole, units[i].places) || !scale(&part, units[i].places - (unsigned)digits) ||
            whole + part > TIME_VALUE_MAX)
            return too_late;
        *ticks = whole + part;
        return NULL;
    }
    return form;
}
