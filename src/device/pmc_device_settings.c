/* SPDX-License-Identifier: MIT */
/* The settings of a PMC (AU8): on command lines, in scenarios, in recordings. */
#include <stdio.h>
#include <string.h>

#include "pmc_device.h"
#include "text/text.h"

_Static_assert(sizeof(struct pmc_own) <= DEVICE_SETTINGS_SIZE, "the settings of a PMC have to fit");

struct pmc_own pmc_own_of(const struct device_config *config)
{
    struct pmc_own own;
    memcpy(&own, config->own.byte, sizeof own);
    return own;
}

static void put_own(struct device_config *config, const struct pmc_own *own)
{
    memcpy(config->own.byte, own, sizeof *own);
}

struct pmc_config pmc_config_of(const struct device_config *config, unsigned axes)
{
    const struct pmc_own own = pmc_own_of(config);
    return (struct pmc_config){
        .face = own.is_modbus ? &pmc_modbus_face : &pmc_ascii_face,
        .axes = (uint8_t)axes,
        .address = config->node,
        .passes = own.passes,
        .refuse = own.refuse,
        .baud = own.baud > 0 ? own.baud : PMC_BAUD,
        .first_answer_late = own.late,
    };
}

/* ---- Options -------------------------------------------------------------------------------------------------------- */

/* One of two words: the first one is the default. */
static bool read_word(bool *is_second, const char *value, const char *first, const char *second, char error[DEVICE_ERROR_SIZE])
{
    *is_second = strcmp(value, second) == 0;
    if (!*is_second && strcmp(value, first) != 0)
        snprintf(error, DEVICE_ERROR_SIZE, "`%.40s' is wrong: expected %s or %s", value, first, second);
    return *is_second || strcmp(value, first) == 0;
}

static bool read_face(struct device_config *config, const char *value, char error[DEVICE_ERROR_SIZE])
{
    struct pmc_own own = pmc_own_of(config);
    bool is_right = read_word(&own.is_modbus, value, pmc_ascii_face.name, pmc_modbus_face.name, error);
    put_own(config, &own);
    return is_right;
}

static bool read_counts(struct device_config *config, const char *value, char error[DEVICE_ERROR_SIZE])
{
    struct pmc_own own = pmc_own_of(config);
    bool is_right = read_word(&own.passes, value, "jumps", "passes", error);
    put_own(config, &own);
    return is_right;
}

static bool read_abs(struct device_config *config, const char *value, char error[DEVICE_ERROR_SIZE])
{
    struct pmc_own own = pmc_own_of(config);
    bool is_right = read_word(&own.refuse, value, "warn", "refuse", error);
    put_own(config, &own);
    return is_right;
}

static bool read_baud(struct device_config *config, const char *value, char error[DEVICE_ERROR_SIZE])
{
    uint64_t number = 0;
    struct pmc_own own = pmc_own_of(config);
    own.baud = 0;
    for (const uint32_t *baud = pmc_bauds; *baud != 0 && number_read(value, 0, UINT32_MAX, &number); baud++)
        if (*baud == number)
            own.baud = *baud;
    put_own(config, &own);
    if (own.baud == 0)
        snprintf(error, DEVICE_ERROR_SIZE, "`%.40s' is wrong: expected 9600, 19200, 38400, 57600 or 115200", value);
    return own.baud != 0;
}

static bool read_late(struct device_config *config, const char *value, char error[DEVICE_ERROR_SIZE])
{
    uint64_t ms;
    struct pmc_own own = pmc_own_of(config);
    if (!number_read(value, 0, PMC_LATE_MAX, &ms)) {
        snprintf(error, DEVICE_ERROR_SIZE, "`%.40s' is wrong: expected ms from 0 to %u", value, PMC_LATE_MAX);
        return false;
    }
    own.late = (uint32_t)ms;
    put_own(config, &own);
    return true;
}

static bool take_file(struct device_config *config, enum pmc_file what, unsigned axes, const char *name, const char *text,
                      size_t length, FILE *errors)
{
    struct pmc_own own = pmc_own_of(config);
    *(what == PMC_FILE_PROGRAM ? &own.program : &own.parameters) = text;
    put_own(config, &own);
    return !pmc_file_is_wrong(what, axes, name, text, length, errors);
}

static bool read_program_1hs(struct device_config *config, const char *name, const char *text, size_t length, FILE *errors)
{
    return take_file(config, PMC_FILE_PROGRAM, 1, name, text, length, errors);
}

static bool read_program_2hs(struct device_config *config, const char *name, const char *text, size_t length, FILE *errors)
{
    return take_file(config, PMC_FILE_PROGRAM, 2, name, text, length, errors);
}

static bool read_parameters_1hs(struct device_config *config, const char *name, const char *text, size_t length, FILE *errors)
{
    return take_file(config, PMC_FILE_PARAMETERS, 1, name, text, length, errors);
}

static bool read_parameters_2hs(struct device_config *config, const char *name, const char *text, size_t length, FILE *errors)
{
    return take_file(config, PMC_FILE_PARAMETERS, 2, name, text, length, errors);
}

/* clang-format off */
#define OPTIONS(axes)                                                                                                           \
    {.name = "face", .argument = "NAME", .flags = DEVICE_OPTION_BUS, .read = read_face,                                         \
     .help = "What the unit speaks on its line: ascii (default), lines of text; modbus, Modbus RTU"},                           \
    {.name = "baud", .argument = "RATE", .flags = DEVICE_OPTION_BUS, .read = read_baud,                                         \
     .help = "Speed of the line as the unit has it: 9600 (default), 19200, 38400, 57600, 115200; Modbus ends a frame by it"},   \
    {.name = "first-answer-late", .argument = "MS", .flags = DEVICE_OPTION_BUS, .read = read_late,                              \
     .help = "By how many ms the first answer after power-up is late, as a real unit's was by more than 2000; default 0"},      \
    {.name = "program", .argument = "FILE", .read_file = read_program_##axes,                                                   \
     .help = "Program that the unit has stored at the start, a register a line"},                                               \
    {.name = "parameters", .argument = "FILE", .read_file = read_parameters_##axes,                                             \
     .help = "Parameters that the unit has stored at the start, sections with KEY = VALUE"},                                    \
    {.name = "rep-counts", .argument = "WHAT", .read = read_counts,                                                             \
     .help = "What n of REP n counts: jumps (default), back to REP, n + 1 passes in all; passes, n in all"},                    \
    {.name = "abs-needs-home", .argument = "HOW", .read = read_abs,                                                             \
     .help = "ABS before a home search: warn (default), it moves, and a warning is set; refuse, error pgm"},                    \
    {.name = NULL}
/* clang-format on */

const struct device_option pmc_1hs_options[] = {OPTIONS(1hs)};
const struct device_option pmc_2hs_options[] = {OPTIONS(2hs)};

/* ---- Recordings ----------------------------------------------------------------------------------------------------- */

const char *const pmc_setting_names[] = {"face", "baud", "first_answer_late", "rep_counts", "abs_needs_home", "program",
                                         "parameters", NULL};

void pmc_put_settings(const struct device_config *config, json_t *object)
{
    const struct pmc_own own = pmc_own_of(config);
    json_object_set_new(object, "face", json_string(own.is_modbus ? "modbus" : "ascii"));
    json_object_set_new(object, "baud", json_integer(own.baud > 0 ? own.baud : PMC_BAUD));
    json_object_set_new(object, "first_answer_late", json_integer(own.late));
    json_object_set_new(object, "rep_counts", json_string(own.passes ? "passes" : "jumps"));
    json_object_set_new(object, "abs_needs_home", json_string(own.refuse ? "refuse" : "warn"));
    if (own.program)
        json_object_set_new(object, "program", json_string_nocheck(own.program));
    if (own.parameters)
        json_object_set_new(object, "parameters", json_string_nocheck(own.parameters));
}

static bool read_setting(const struct device_kind *kind, struct device_config *config, const char *name, const json_t *value,
                         char error[DEVICE_ERROR_SIZE])
{
    static const struct {
        const char *name;
        bool (*read)(struct device_config *config, const char *value, char error[DEVICE_ERROR_SIZE]);
    } readers[] = {{"face", read_face}, {"baud", read_baud}, {"first_answer_late", read_late}, {"rep_counts", read_counts},
                   {"abs_needs_home", read_abs}};
    char number[32];
    const char *text = json_string_value(value);
    const struct device_option *option = device_option_keyed(kind, name);
    if (!value)
        return true;
    if (option->read_file)
        return device_read_content(option, config, value, error);
    if (json_is_integer(value)) {
        snprintf(number, sizeof number, "%lld", (long long)json_integer_value(value));
        text = number;
    }
    for (size_t i = 0; text && i < sizeof readers / sizeof *readers; i++)
        if (strcmp(readers[i].name, name) == 0)
            return readers[i].read(config, text, error);
    snprintf(error, DEVICE_ERROR_SIZE, "expected \"%s\", a text or a number", name);
    return false;
}

bool pmc_read_setting_1hs(struct device_config *config, const char *name, const json_t *value, char error[DEVICE_ERROR_SIZE])
{
    return read_setting(&pmc_1hs_device, config, name, value, error);
}

bool pmc_read_setting_2hs(struct device_config *config, const char *name, const json_t *value, char error[DEVICE_ERROR_SIZE])
{
    return read_setting(&pmc_2hs_device, config, name, value, error);
}

const char *pmc_settings_difference(const struct device_config *a, const struct device_config *b)
{
    const struct pmc_own here = pmc_own_of(a), there = pmc_own_of(b);
    if (here.is_modbus != there.is_modbus)
        return "the face (--device-option face)";
    if ((here.baud > 0 ? here.baud : PMC_BAUD) != (there.baud > 0 ? there.baud : PMC_BAUD))
        return "the baud rate (--device-option baud)";
    if (here.passes != there.passes)
        return "what REP counts (--device-option rep-counts)";
    return here.refuse != there.refuse ? "what ABS needs (--device-option abs-needs-home)" : NULL;
}
