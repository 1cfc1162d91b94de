/* SPDX-License-Identifier: MIT */
/* The table of kinds of devices. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "device.h"

/* A row for each kind; the first one is meant where none is named. */
static const struct device_kind *const device_kinds[] = {&rkm04_device, &cib_device, &pmc_1hs_device, &pmc_2hs_device,
                                                          &cnc872_device};

#define KINDS (sizeof device_kinds / sizeof device_kinds[0])

/* Kinds of a program that is linked with more of them; ends with NULL. */
extern const struct device_kind *const device_kinds_added[];

const struct device_kind *device_kind_at(unsigned at)
{
    if (at < KINDS)
        return device_kinds[at];
    for (unsigned i = 0; device_kinds_added[i]; i++)
        if (i == at - KINDS)
            return device_kinds_added[i];
    return NULL;
}

const char *device_kind_names(char text[DEVICE_ERROR_SIZE])
{
    const struct device_kind *kind;
    size_t length = 0;
    text[0] = '\0';
    for (unsigned at = 0; (kind = device_kind_at(at)) && length < DEVICE_ERROR_SIZE; at++)
        length += (size_t)snprintf(text + length, DEVICE_ERROR_SIZE - length, at > 0 ? ", %s" : "%s", kind->name);
    return text;
}

const char *device_addresses(const struct device_kind *kind, char text[DEVICE_ERROR_SIZE])
{
    snprintf(text, DEVICE_ERROR_SIZE, "expected addresses from 1 to %u%s, as in 3 or 1,2,5-8, at most %u units", kind->addresses,
             kind->address_note ? kind->address_note : "", NODE_LIST_MAX);
    return text;
}

const struct device_kind *device_kind_named(const char *name)
{
    const struct device_kind *kind;
    for (unsigned at = 0; (kind = device_kind_at(at)); at++)
        if (strcmp(kind->name, name) == 0)
            return kind;
    return NULL;
}

static bool is_key(const char *key, const char *name)
{
    while (*key != '\0' && (*key == *name || (*key == '_' && *name == '-'))) {
        key++;
        name++;
    }
    return *key == '\0' && *name == '\0';
}

size_t device_option_file_max(const struct device_option *option)
{
    return (size_t)(option->file_mib > 0 ? option->file_mib : 1u) << 20;
}

const struct device_option *device_option_named(const struct device_kind *kind, const char *name)
{
    for (const struct device_option *option = kind->options; option && option->name; option++)
        if (strcmp(option->name, name) == 0)
            return option;
    return NULL;
}

const struct device_option *device_option_keyed(const struct device_kind *kind, const char *key)
{
    for (const struct device_option *option = kind->options; option && option->name; option++)
        if (is_key(key, option->name))
            return option;
    return NULL;
}

/* The first error among messages, warnings too, a line each. NULL: memory is short. */
static void keep_error(const char *lines, char error[DEVICE_ERROR_SIZE])
{
    const char *at = lines ? strstr(lines, ": error: ") : NULL;
    while (at && at > lines && at[-1] != '\n')
        at--;
    at = at ? at : lines ? lines : "out of memory";
    snprintf(error, DEVICE_ERROR_SIZE, "%.*s", (int)strcspn(at, "\n"), at);
}

bool device_read_content(const struct device_option *option, struct device_config *config, const json_t *value,
                         char error[DEVICE_ERROR_SIZE])
{
    const char *text = json_string_value(value);
    const size_t length = json_string_length(value);
    char *lines = NULL;
    size_t size = 0;
    if (!value)
        return true;
    if (!text || memchr(text, '\0', length)) {
        snprintf(error, DEVICE_ERROR_SIZE, "expected \"%s\", a text%s", option->name, text ? " without the character 0" : "");
        return false;
    }
    FILE *errors = open_memstream(&lines, &size);
    const bool is_right = errors && option->read_file(config, option->name, text, length, errors);
    if (errors)
        fclose(errors);
    if (!is_right)
        keep_error(lines, error);
    free(lines);
    return is_right;
}

/* ---- Framing -------------------------------------------------------------------------------------------------------- */

static bool receive_none(struct rkm04_receiver *receiver, uint8_t byte, uint64_t now, uint8_t *buffer, size_t room)
{
    (void)receiver;
    (void)byte;
    (void)now;
    (void)buffer;
    (void)room;
    return false;
}

static size_t begin_plain(struct rkm04_sender *sender, uint8_t dnode, uint8_t snode, size_t length, bool answer, uint8_t *out)
{
    (void)sender;
    (void)dnode;
    (void)snode;
    (void)length;
    (void)answer;
    (void)out;
    return 0;
}

static size_t put_plain(struct rkm04_sender *sender, uint8_t byte, uint8_t *out)
{
    (void)sender;
    out[0] = byte;
    return 1;
}

static size_t end_plain(struct rkm04_sender *sender, uint8_t *out)
{
    (void)sender;
    (void)out;
    return 0;
}

const struct device_framing *device_framing_of(const struct device_kind *kind, const struct device_config *config)
{
    static const struct rkm04_framing link = {
        .name = "none", .receive = receive_none, .begin = begin_plain, .put = put_plain, .end = end_plain};
    static const struct device_framing none = {.link = &link, .flag = -1, .escape = -1};
    return kind->receive ? kind->framing(config) : &none;
}

unsigned device_baud(const struct device_kind *kind, const struct device_config *config)
{
    return kind->baud ? kind->baud(config) : DEVICE_BAUD;
}

unsigned device_turnaround(const struct device_kind *kind)
{
    return kind->turnaround > 0 ? kind->turnaround : DEVICE_TURNAROUND;
}
