/* SPDX-License-Identifier: MIT */
/* The settings of a CNC872 (NU1): on command lines, in scenarios, in recordings. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cnc872_device.h"

_Static_assert(sizeof(struct cnc_own) <= DEVICE_SETTINGS_SIZE, "the settings of a CNC872 have to fit");

struct cnc_own cnc_own_of(const struct device_config *config)
{
    struct cnc_own own;
    memcpy(&own, config->own.byte, sizeof own);
    return own;
}

const struct cnc_text *cnc_needed_text(const struct cnc_own *own, enum cnc_text_kind kind)
{
    return kind == CNC_TEXT_NC        ? own->text[CNC_TEXT_CONFIG]
           : kind == CNC_TEXT_MACHINE ? own->text[CNC_TEXT_PLC]
                                      : NULL;
}

bool cnc_has_axes(const struct cnc_own *own, const char *name, FILE *errors)
{
    const struct cnc_machine_switches *machine = &own->text[CNC_TEXT_MACHINE]->machine;
    const struct cnc_text *config = own->text[CNC_TEXT_CONFIG];
    const unsigned axes = config ? config->config->axes : cnc_default_config()->axes;
    for (unsigned at = 0; at < machine->count; at++)
        if ((axes >> machine->list[at].axis & 1u) == 0) {
            if (errors)
                fprintf(errors, "%s: error: switch %u: the configuration has no axis %s\n", name, at + 1u,
                        cnc_axis_names[machine->list[at].axis]);
            return false;
        }
    return true;
}

static bool take_text(struct device_config *config, enum cnc_text_kind kind, const char *name, const char *text, size_t length,
                      FILE *errors)
{
    struct cnc_own own = cnc_own_of(config);
    own.text[kind] = cnc_text_read(kind, cnc_needed_text(&own, kind), name, text, length, errors);
    memcpy(config->own.byte, &own, sizeof own);
    return own.text[kind] && (kind != CNC_TEXT_MACHINE || cnc_has_axes(&own, name, errors));
}

static bool read_config(struct device_config *config, const char *name, const char *text, size_t length, FILE *errors)
{
    return take_text(config, CNC_TEXT_CONFIG, name, text, length, errors);
}

static bool read_plc(struct device_config *config, const char *name, const char *text, size_t length, FILE *errors)
{
    return take_text(config, CNC_TEXT_PLC, name, text, length, errors);
}

static bool read_nc(struct device_config *config, const char *name, const char *text, size_t length, FILE *errors)
{
    return take_text(config, CNC_TEXT_NC, name, text, length, errors);
}

static bool read_machine(struct device_config *config, const char *name, const char *text, size_t length, FILE *errors)
{
    return take_text(config, CNC_TEXT_MACHINE, name, text, length, errors);
}

/* In the order in which they are read: what others need comes first. */
const struct device_option cnc_options[] = {
    {.name = "config", .argument = "FILE", .flags = DEVICE_OPTION_SWITCH, .read_file = read_config,
     .help = "Machine of a CNC872, XML: axes, gears, M functions; without it X, Y, Z with defaults"},
    {.name = "plc", .argument = "FILE", .flags = DEVICE_OPTION_SWITCH, .file_mib = CNC_PLC_TEXT_MAX >> 20, .read_file = read_plc,
     .help = "PLC program of a CNC872"},
    {.name = "nc", .argument = "FILE", .flags = DEVICE_OPTION_SWITCH, .file_mib = DEVICE_FILE_MIB_MAX, .read_file = read_nc,
     .help = "NC program of a CNC872 that is loaded at the start"},
    {.name = "machine", .argument = "FILE", .flags = DEVICE_OPTION_SWITCH, .read_file = read_machine,
     .help = "Switches of the machine of a CNC872, YAML: bits that follow the positions of axes"},
    {.name = NULL}
};

/* ---- Recordings --------------------------------------------------------------------------------------------------------- */

const char *const cnc_setting_names[] = {"config", "plc", "nc", "machine", NULL};

static enum cnc_text_kind kind_named(const char *name)
{
    static const enum cnc_text_kind kinds[] = {CNC_TEXT_CONFIG, CNC_TEXT_PLC, CNC_TEXT_NC, CNC_TEXT_MACHINE};
    unsigned at = 0;
    while (cnc_setting_names[at] && strcmp(cnc_setting_names[at], name) != 0)
        at++;
    return cnc_setting_names[at] ? kinds[at] : CNC_TEXT_KINDS;
}

void cnc_put_settings(const struct device_config *config, json_t *object)
{
    const struct cnc_own own = cnc_own_of(config);
    for (const char *const *name = cnc_setting_names; *name; name++) {
        const struct cnc_text *text = own.text[kind_named(*name)];
        if (text)
            json_object_set_new(object, *name, json_stringn_nocheck(text->text, text->length));
    }
}

bool cnc_read_setting(struct device_config *config, const char *name, const json_t *value, char error[DEVICE_ERROR_SIZE])
{
    const struct device_option *option = device_option_named(&cnc872_device, name);
    return device_read_content(option, config, value, error);
}

const char *cnc_settings_difference(const struct device_config *a, const struct device_config *b)
{
    static const char *const names[] = {[CNC_TEXT_CONFIG] = "the configuration (--config)",
                                        [CNC_TEXT_NC] = "the NC program (--nc)",
                                        [CNC_TEXT_PLC] = "the PLC program (--plc)",
                                        [CNC_TEXT_MACHINE] = "the switches of the machine (--machine)"};
    const struct cnc_own here = cnc_own_of(a), there = cnc_own_of(b);
    for (unsigned kind = 0; kind < CNC_TEXT_KINDS; kind++)
        if (here.text[kind] != there.text[kind])
            return names[kind];
    return NULL;
}

bool cnc_check_text(const struct device_config *config, const char *name, const char *text, size_t length, FILE *out)
{
    const struct cnc_own own = cnc_own_of(config);
    return cnc_text_read(CNC_TEXT_NC, own.text[CNC_TEXT_CONFIG], name, text, length, out) == NULL;
}
