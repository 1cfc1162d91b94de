/* SPDX-License-Identifier: MIT */
/* Loading texts into a CNC872 that runs: an NC program, a PLC program, switches of the machine (cnc.load). Everything is read
 * first, then looked at, then taken. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cnc872_device.h"

/* What can be loaded, in the order in which it is read: what others need comes first. */
static const struct {
    const char *key, *name_key, *name; /* of the text, of its name in messages; the name if there is none */
    enum cnc_text_kind kind;
} loadable[] = {
    {"plc", "plc_name", "plc", CNC_TEXT_PLC},
    {"text", "name", "nc", CNC_TEXT_NC},
    {"machine", "machine_name", "machine", CNC_TEXT_MACHINE},
};
#define LOADABLE (sizeof loadable / sizeof loadable[0])

bool cnc_load_program(struct cnc_device *device, const struct cnc_text *program, struct device_refusal *refusal)
{
    const enum cnc_result result = cnc_load(&device->cnc, program->program);
    if (result != CNC_OK)
        return CNC_REFUSE(refusal, true, "%s", cnc_result_text(result));
    device->own.text[CNC_TEXT_NC] = device->loaded[CNC_TEXT_NC] = program;
    return true;
}

/* ---- Read --------------------------------------------------------------------------------------------------------------- */

/* Read a text. False: it is wrong, and the refusal has the first thing that is. */
static bool read_text(struct cnc_own *own, enum cnc_text_kind kind, const char *name, const char *text, size_t length,
                      struct device_refusal *refusal)
{
    char *lines = NULL;
    size_t size = 0;
    FILE *errors = open_memstream(&lines, &size);
    own->text[kind] = errors ? cnc_text_read(kind, cnc_needed_text(own, kind), name, text, length, errors) : NULL;
    const bool is_right = own->text[kind] && (kind != CNC_TEXT_MACHINE || cnc_has_axes(own, name, errors));
    if (errors)
        fclose(errors);
    if (!is_right)
        cnc_refuse(refusal, false, "%.*s", lines ? (int)strcspn(lines, "\n") : 13, lines ? lines : "out of memory");
    free(lines);
    return is_right;
}

/* The switches that it has, with the bits of another PLC program. */
static bool read_switches_again(struct cnc_own *own, struct device_refusal *refusal)
{
    const struct cnc_text *machine = own->text[CNC_TEXT_MACHINE];
    return !machine || read_text(own, CNC_TEXT_MACHINE, "machine", machine->text, machine->length, refusal);
}

static bool read_texts(struct cnc_own *own, const json_t *params, struct device_refusal *refusal)
{
    bool is_any = false;
    if (json_object_get(params, "config"))
        return CNC_REFUSE(refusal, false, "config: the configuration of a machine that runs stays: end the emulator and start it "
                                          "with --config");
    for (size_t at = 0; at < LOADABLE; at++) {
        const json_t *text = json_object_get(params, loadable[at].key), *name = json_object_get(params, loadable[at].name_key);
        if ((text && !json_is_string(text)) || (name && !json_is_string(name)))
            return CNC_REFUSE(refusal, false, "%s: expected a text", text && !json_is_string(text) ? loadable[at].key
                                                                                                  : loadable[at].name_key);
        if (text && !read_text(own, loadable[at].kind, name ? json_string_value(name) : loadable[at].name,
                               json_string_value(text), json_string_length(text), refusal))
            return false;
        is_any = is_any || text;
    }
    if (!is_any)
        return CNC_REFUSE(refusal, false, "text: expected an NC program, or plc, a PLC program, or machine, switches");
    return !json_object_get(params, "plc") || json_object_get(params, "machine") || read_switches_again(own, refusal);
}

/* ---- Take --------------------------------------------------------------------------------------------------------------- */

/* Another PLC program or other switches: power-up of the system, which keeps its positions and the backup memory. */
static bool restart(struct cnc_device *device, const struct cnc_own *own, struct device_refusal *refusal)
{
    uint8_t backup[CNC_BACKUP_SIZE];
    memcpy(backup, cnc_backup(&device->cnc), sizeof backup);
    const struct cnc_setup setup = cnc_setup_of(device, own, backup);
    const enum cnc_result result = cnc_restart(&device->cnc, &setup);
    if (result != CNC_OK)
        return CNC_REFUSE(refusal, true, "%s", cnc_result_text(result));
    for (size_t at = 0; at < LOADABLE; at++)
        if (own->text[loadable[at].kind] != device->own.text[loadable[at].kind])
            device->loaded[loadable[at].kind] = own->text[loadable[at].kind];
    device->own = *own;
    device->loads++;
    cnc_note(device, "restarted with another PLC program or other switches");
    return true;
}

json_t *cnc_load_texts(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    struct cnc_device *device = cnc_of(unit);
    struct cnc_own own = device->own;
    if (!read_texts(&own, params, refusal))
        return NULL;
    const bool is_restart = json_object_get(params, "plc") || json_object_get(params, "machine");
    if (is_restart ? !restart(device, &own, refusal) : !cnc_load_program(device, own.text[CNC_TEXT_NC], refusal))
        return NULL;
    device->is_quiet = false;
    const struct cnc_text *program = own.text[CNC_TEXT_NC], *plc = own.text[CNC_TEXT_PLC];
    json_t *result = json_pack("{s:I}", "blocks", (json_int_t)(program ? program->program->block_count : 0));
    if (is_restart)
        json_object_set_new(result, "instructions", json_integer(plc ? (json_int_t)plc->plc->length : 0));
    return result;
}
