/* SPDX-License-Identifier: MIT */
/* Methods of a CIB module: what a host does by its registers, by name (docs/CIB.md). */
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "cib_device.h"

#define SEQ 0u
#define FIRST_OF_A 0x10u
#define FIRST_OF_B 0x20u
#define APPLY 0x100u

static json_t *refuse(struct device_refusal *refusal, const char *format, ...) __attribute__((format(printf, 2, 3)));

static json_t *refuse(struct device_refusal *refusal, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    vsnprintf(refusal->text, DEVICE_ERROR_SIZE, format, list);
    va_end(list);
    return NULL;
}

static struct cib_unit *core_of(struct device_unit *unit)
{
    return &cib_device_of(unit)->unit;
}

/* ---- Parameters --------------------------------------------------------------------------------------------------------- */

static bool read_number(const json_t *params, const char *name, int64_t low, int64_t high, int64_t *value,
                        struct device_refusal *refusal)
{
    const json_t *given = json_object_get(params, name);
    *value = json_integer_value(given);
    if (json_is_integer(given) && *value >= low && *value <= high)
        return true;
    refuse(refusal, "%s: expected a number from %lld to %lld", name, (long long)low, (long long)high);
    return false;
}

static bool read_number_or(const json_t *params, const char *name, int64_t low, int64_t high, int64_t *value,
                           struct device_refusal *refusal)
{
    *value = 0;
    return !json_object_get(params, name) || read_number(params, name, low, high, value, refusal);
}

/* "A" or "B". */
static bool read_drive(const json_t *params, unsigned *drive, struct device_refusal *refusal)
{
    const char *name = json_string_value(json_object_get(params, "drive"));
    *drive = name && (strcmp(name, "B") == 0 || strcmp(name, "b") == 0);
    if (name && (*drive == 1 || strcmp(name, "A") == 0 || strcmp(name, "a") == 0))
        return true;
    refuse(refusal, "drive: expected \"A\" or \"B\"");
    return false;
}

/* ---- Drives ------------------------------------------------------------------------------------------------------------- */

static json_t *status_json(const struct cib_unit *unit, unsigned drive)
{
    static const char *const names[] = {"move", "dir", "invel", "trg", "err", "ramp"};
    struct cib_drive_state state;
    cib_drive_state(unit, drive, &state);
    json_t *json = json_pack("{s:s, s:i, s:i, s:i, s:s, s:i, s:i, s:i}", "drive", drive == 0 ? "A" : "B", "ack", (int)state.ack,
                             "mcstat", (int)state.status, "mcerr", (int)state.error, "error",
                             cib_error_name(state.error), "position", (int)state.position, "speed", (int)state.speed, "row",
                             (int)state.row);
    for (unsigned bit = 0; bit < sizeof names / sizeof names[0]; bit++)
        json_object_set_new(json, names[bit], json_boolean((unsigned)state.status >> bit & 1u));
    return json;
}

static json_t *call_status(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    unsigned drive;
    if (json_object_get(params, "drive"))
        return read_drive(params, &drive, refusal) ? status_json(core_of(unit), drive) : NULL;
    return json_pack("{s:[o, o]}", "drives", status_json(core_of(unit), 0), status_json(core_of(unit), 1));
}

/* As a host does: the whole zone in one message, with the next SEQ. */
static json_t *call_command(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    int64_t number, p1, p2;
    unsigned drive;
    if (!read_drive(params, &drive, refusal) || !read_number(params, "command", 0, UINT16_MAX, &number, refusal) ||
        !read_number_or(params, "p1", INT32_MIN, INT32_MAX, &p1, refusal) ||
        !read_number_or(params, "p2", 0, UINT16_MAX, &p2, refusal))
        return NULL;
    uint16_t first = drive == 0 ? FIRST_OF_A : FIRST_OF_B, ack = cib_read(core_of(unit), CIB_INPUT_ZONE, first);
    const uint16_t zone[] = {(uint16_t)(ack + 1u), (uint16_t)number, (uint16_t)((uint64_t)p1 >> 16 & 0xffffu),
                             (uint16_t)((uint64_t)p1 & 0xffffu), (uint16_t)p2};
    cib_note_request(core_of(unit));
    (void)cib_write(core_of(unit), first, zone, sizeof zone / sizeof zone[0]);
    return status_json(core_of(unit), drive);
}

/* ---- Outputs ------------------------------------------------------------------------------------------------------------ */

static json_t *outputs_json(const struct cib_unit *unit)
{
    json_t *duties = json_array();
    for (uint16_t output = 1; output <= CIB_OUTPUTS; output++)
        json_array_append_new(duties, json_integer(cib_read(unit, CIB_OUTPUT_ZONE, output)));
    return json_pack("{s:i, s:i, s:i, s:o}", "do", (int)cib_read(unit, CIB_OUTPUT_ZONE, 0), "on", (int)(cib_driven(unit) & 0xffu),
                     "minus", (int)(cib_driven(unit) >> 8), "pwm", duties);
}

/* Register bits of DO: {"outputs": {"6": 1}}; nothing: only show. */
static json_t *call_do(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    const char *name;
    json_t *value, *outputs = json_object_get(params, "outputs");
    unsigned mask = 0, bits = 0;
    json_object_foreach(outputs, name, value) {
        unsigned number = (unsigned)(name[0] - '0');
        if (name[0] < '1' || name[0] > '8' || name[1] != '\0' || !json_is_integer(value) || json_integer_value(value) < 0 ||
            json_integer_value(value) > 1)
            return refuse(refusal, "outputs: expected numbers from 1 to 8 with levels 0 or 1, as in {\"6\": 1}");
        mask |= 1u << (number - 1u);
        bits |= (unsigned)json_integer_value(value) << (number - 1u);
    }
    if (mask != 0) {
        cib_note_request(core_of(unit));
        cib_write_coils(core_of(unit), (uint8_t)mask, (uint8_t)bits);
    }
    return outputs_json(core_of(unit));
}

static json_t *call_pwm(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    int64_t output, duty;
    if (!read_number(params, "output", 1, CIB_OUTPUTS, &output, refusal) ||
        !read_number(params, "duty", 0, CIB_DUTY_MAX, &duty, refusal))
        return NULL;
    uint16_t word = (uint16_t)duty;
    cib_note_request(core_of(unit));
    (void)cib_write(core_of(unit), (uint16_t)output, &word, 1);
    return outputs_json(core_of(unit));
}

/* ---- Configuration ------------------------------------------------------------------------------------------------------ */

static json_t *configuration(const struct cib_unit *unit)
{
    const struct cib_setup proposal = cib_setup_read(unit, CIB_OUTPUT_ZONE), counts = cib_setup_read(unit, CIB_INPUT_ZONE);
    char name[DEVICE_COMMAND_SIZE];
    uint16_t result = cib_read(unit, CIB_INPUT_ZONE, APPLY);
    return json_pack("{s:o, s:o, s:i, s:s?}", "proposal", cib_setup_json(&proposal), "counts", cib_setup_json(&counts), "result",
                     (int)result, "wrong", result != 0 ? cib_setup_name(result, name) : NULL);
}

static json_t *call_config(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    (void)params;
    (void)refusal;
    return configuration(core_of(unit));
}

static json_t *call_config_put(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    struct cib_setup setup = cib_setup_read(core_of(unit), CIB_OUTPUT_ZONE);
    if (!cib_setup_read_json(&setup, json_object_get(params, "setup"), refusal->text))
        return NULL;
    cib_note_request(core_of(unit));
    cib_setup_write(core_of(unit), &setup);
    return configuration(core_of(unit));
}

static json_t *call_apply(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    const uint16_t yes = 1;
    (void)params;
    (void)refusal;
    cib_note_request(core_of(unit));
    (void)cib_write(core_of(unit), APPLY, &yes, 1);
    return configuration(core_of(unit));
}

#define NAMES(...) (const char *const[]){__VA_ARGS__, NULL}
#define NO_NAMES (const char *const[]){NULL}

const struct device_method cib_methods[] = {
    {"cib.status", call_status, false, NAMES("drive")},
    {"cib.command", call_command, true, NAMES("drive", "command", "p1", "p2")},
    {"cib.do", call_do, true, NAMES("outputs")},
    {"cib.pwm", call_pwm, true, NAMES("output", "duty")},
    {"cib.config", call_config, false, NO_NAMES},
    {"cib.config.put", call_config_put, true, NAMES("setup")},
    {"cib.apply", call_apply, true, NO_NAMES},
    {NULL, NULL, false, NULL},
};
