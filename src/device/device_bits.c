/* SPDX-License-Identifier: MIT */
/* device_bits.c: inputs and outputs by number and by name. */
#include <stdio.h>
#include <string.h>

#include "device.h"

static unsigned find_number(const char *text, unsigned count)
{
    unsigned number = 0;
    size_t length = strlen(text);
    if (length < 1 || length > 2 || strspn(text, "0123456789") != length)
        return 0;
    for (; *text != '\0'; text++)
        number = number * 10 + (unsigned)(*text - '0');
    return number <= count ? number : 0;
}

static unsigned find_bit(const char *const *names, unsigned count, const char *name)
{
    for (unsigned at = 0; names && at < count; at++)
        if (strcmp(names[at], name) == 0)
            return at + 1u;
    return find_number(name, count);
}

static const char *list_bits(const char *const *names, unsigned count, char text[DEVICE_ERROR_SIZE])
{
    size_t length = (size_t)snprintf(text, DEVICE_ERROR_SIZE, count > 0 ? "1 to %u" : "(the device has none)", count);
    for (unsigned at = 0; names && at < count && length < DEVICE_ERROR_SIZE; at++)
        length += (size_t)snprintf(text + length, DEVICE_ERROR_SIZE - length, at > 0 ? ", %s" : " or %s", names[at]);
    return text;
}

unsigned device_input_named(const struct device_kind *kind, const char *name)
{
    return find_bit(kind->input_names, kind->inputs, name);
}

unsigned device_output_named(const struct device_kind *kind, const char *name)
{
    return find_bit(kind->output_names, kind->outputs, name);
}

const char *device_input_names(const struct device_kind *kind, char text[DEVICE_ERROR_SIZE])
{
    return list_bits(kind->input_names, kind->inputs, text);
}

const char *device_output_names(const struct device_kind *kind, char text[DEVICE_ERROR_SIZE])
{
    return list_bits(kind->output_names, kind->outputs, text);
}
