/* SPDX-License-Identifier: MIT */
/* The settings of a CIB module: what people choose, and as recordings have them. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cib_device.h"
#include "text/text.h"

#define TIME_MAX 86400000u /* ms: a day */

/* As a config has them: nothing is the default. */
struct own {
    bool is_set;
    struct cib_settings settings;
};

_Static_assert(sizeof(struct own) <= DEVICE_SETTINGS_SIZE, "the settings have to fit");

const char *const cib_setting_names[] = {"setup", "firmware", "idle_off", "comm_timeout", "brake_error", "acc_unit", "silence",
                                         NULL};

struct cib_settings cib_settings_of(const struct device_config *config)
{
    struct own own;
    memcpy(&own, config->own.byte, sizeof own);
    return own.is_set ? own.settings : (struct cib_settings){.config = cib_default_config, .silence = CIB_SILENCE};
}

static void put_own(struct device_config *config, const struct cib_settings *settings)
{
    struct own own;
    memset(&own, 0, sizeof own); /* so that equal settings are equal bytes */
    own.is_set = true;
    own.settings = *settings;
    memcpy(config->own.byte, &own, sizeof own);
}

/* ---- Numbers ------------------------------------------------------------------------------------------------------------ */

/* Settings that are a number. */
enum number { IDLE_OFF, COMM_TIMEOUT, BRAKE_ERROR, ACC_UNIT, SILENCE };

static const struct number_row {
    const char *name; /* of recordings; in options `-` is written for `_` */
    int64_t low, high;
    const char *expected;
} numbers[] = {
    [IDLE_OFF] = {"idle_off", 0, TIME_MAX, "ms from 0 to 86400000"},
    [COMM_TIMEOUT] = {"comm_timeout", 0, TIME_MAX, "ms from 0 to 86400000"},
    [BRAKE_ERROR] = {"brake_error", -CIB_BRAKE_ERROR_MAX, CIB_BRAKE_ERROR_MAX, "pulses from -20 to 20"},
    [ACC_UNIT] = {"acc_unit", 1, 100, "1, 10 or 100"},
    [SILENCE] = {"silence", CIB_SILENCE, CIB_SILENCE_MAX, "us from 2344 to 100000"},
};

#define NUMBERS (sizeof numbers / sizeof numbers[0])

static int64_t number_of(const struct cib_settings *settings, enum number number)
{
    const struct cib_config *config = &settings->config;
    const int64_t values[] = {config->idle_off, config->comm_timeout, config->brake_error, config->acc_unit, settings->silence};
    return values[number];
}

static bool set_number(struct cib_settings *settings, enum number number, int64_t value)
{
    if (value < numbers[number].low || value > numbers[number].high ||
        (number == ACC_UNIT && value != 1 && value != 10 && value != 100))
        return false;
    if (number == IDLE_OFF)
        settings->config.idle_off = (uint32_t)value;
    else if (number == COMM_TIMEOUT)
        settings->config.comm_timeout = (uint32_t)value;
    else if (number == BRAKE_ERROR)
        settings->config.brake_error = (int8_t)value;
    else if (number == ACC_UNIT)
        settings->config.acc_unit = (uint8_t)value;
    else
        settings->silence = (uint32_t)value;
    return true;
}

static bool read_number(struct device_config *config, enum number number, const char *text, char error[DEVICE_ERROR_SIZE])
{
    int64_t value;
    struct cib_settings settings = cib_settings_of(config);
    if (number_read_signed(text, INT32_MIN, INT32_MAX, &value) && set_number(&settings, number, value)) {
        put_own(config, &settings);
        return true;
    }
    snprintf(error, DEVICE_ERROR_SIZE, "`%.40s' is wrong: expected %s", text, numbers[number].expected);
    return false;
}

/* ---- Options ------------------------------------------------------------------------------------------------------------ */

static bool read_idle_off(struct device_config *config, const char *value, char error[DEVICE_ERROR_SIZE])
{
    return read_number(config, IDLE_OFF, value, error);
}

static bool read_comm_timeout(struct device_config *config, const char *value, char error[DEVICE_ERROR_SIZE])
{
    return read_number(config, COMM_TIMEOUT, value, error);
}

static bool read_brake_error(struct device_config *config, const char *value, char error[DEVICE_ERROR_SIZE])
{
    return read_number(config, BRAKE_ERROR, value, error);
}

static bool read_acc_unit(struct device_config *config, const char *value, char error[DEVICE_ERROR_SIZE])
{
    return read_number(config, ACC_UNIT, value, error);
}

static bool read_silence(struct device_config *config, const char *value, char error[DEVICE_ERROR_SIZE])
{
    return read_number(config, SILENCE, value, error);
}

static const char *firmware_text(const struct cib_settings *settings)
{
    return settings->config.firmware == CIB_FIRMWARE_1_1 ? "1.1" : "1.2";
}

static bool read_firmware(struct device_config *config, const char *value, char error[DEVICE_ERROR_SIZE])
{
    struct cib_settings settings = cib_settings_of(config);
    bool is_old = strcmp(value, "1.1") == 0;
    if (!is_old && strcmp(value, "1.2") != 0) {
        snprintf(error, DEVICE_ERROR_SIZE, "`%.40s' is unknown: expected 1.1 or 1.2", value);
        return false;
    }
    settings.config.firmware = is_old ? CIB_FIRMWARE_1_1 : CIB_FIRMWARE_1_2;
    if (!cib_setup_check(&settings.config.setup, settings.config.firmware, error))
        return false;
    put_own(config, &settings);
    return true;
}

static bool read_setup_node(struct device_config *config, const char *key, const struct config_node *node)
{
    char error[DEVICE_ERROR_SIZE];
    struct cib_settings settings = cib_settings_of(config);
    (void)key;
    if (!cib_setup_read_node(&settings.config.setup, node))
        return false;
    if (!cib_setup_check(&settings.config.setup, settings.config.firmware, error))
        return config_error(node, "expected a configuration that the module takes: %s", error);
    put_own(config, &settings);
    return true;
}

static bool read_setup_file(struct device_config *config, const char *name, const char *text, size_t length, FILE *errors)
{
    struct config_tree *tree = config_read(name, text, length, errors);
    bool is_right = tree && read_setup_node(config, "setup", config_root(tree));
    if (tree)
        config_free(tree);
    return is_right;
}

const struct device_option cib_options[] = {
    {.name = "firmware",
     .argument = "VERSION",
     .help = "Of the module, 1.2 (default) or 1.1, which has PWM on DO1 and DO2 alone",
     .read = read_firmware},
    {.name = "setup",
     .argument = "FILE",
     .help = "What the outputs are used for, and the drives' limits, at power-up (docs/CIB.md); default two drives, mode 20",
     .read_file = read_setup_file,
     .read_node = read_setup_node},
    {.name = "comm-timeout",
     .argument = "MS",
     .help = "Time without a request after which both drives stop; default 0, never",
     .read = read_comm_timeout},
    {.name = "idle-off",
     .argument = "MS",
     .help = "Time at rest after which a drive's outputs are switched off; default 0, never",
     .read = read_idle_off},
    {.name = "brake-error",
     .argument = "PULSES",
     .help = "How wrong the module computes its braking distance, -20 to 20; default 0",
     .read = read_brake_error},
    {.name = "acc-unit",
     .argument = "N",
     .help = "Pulses/s2 that an acceleration of 1 means: 1 (default), 10 or 100",
     .read = read_acc_unit},
    {.name = "silence",
     .argument = "US",
     .help = "Time without a byte that ends a frame, 2344 (default) to 100000 us",
     .flags = DEVICE_OPTION_BUS,
     .read = read_silence},
    {.name = NULL},
};

/* ---- Recordings --------------------------------------------------------------------------------------------------------- */

void cib_put_settings(const struct device_config *config, json_t *object)
{
    const struct cib_settings settings = cib_settings_of(config);
    json_object_set_new(object, "firmware", json_string(firmware_text(&settings)));
    json_object_set_new(object, "setup", cib_setup_json(&settings.config.setup));
    for (unsigned number = 0; number < NUMBERS; number++)
        json_object_set_new(object, numbers[number].name, json_integer(number_of(&settings, (enum number)number)));
}

static bool read_setup(struct device_config *config, const json_t *value, char error[DEVICE_ERROR_SIZE])
{
    struct cib_settings settings = cib_settings_of(config);
    if (!cib_setup_read_json(&settings.config.setup, value, error) ||
        !cib_setup_check(&settings.config.setup, CIB_FIRMWARE_1_2, error))
        return false;
    put_own(config, &settings);
    return true;
}

bool cib_read_setting(struct device_config *config, const char *name, const json_t *value, char error[DEVICE_ERROR_SIZE])
{
    struct cib_settings settings = cib_settings_of(config);
    if (!value)
        return true;
    if (strcmp(name, "setup") == 0)
        return read_setup(config, value, error);
    if (strcmp(name, "firmware") == 0)
        return read_firmware(config, json_is_string(value) ? json_string_value(value) : "", error);
    for (unsigned number = 0; number < NUMBERS; number++) {
        if (strcmp(name, numbers[number].name) != 0)
            continue;
        if (json_is_integer(value) && set_number(&settings, (enum number)number, json_integer_value(value))) {
            put_own(config, &settings);
            return true;
        }
        snprintf(error, DEVICE_ERROR_SIZE, "\"%s\": expected %s", name, numbers[number].expected);
    }
    return false;
}

const char *cib_settings_difference(const struct device_config *a, const struct device_config *b)
{
    const struct cib_settings here = cib_settings_of(a), there = cib_settings_of(b);
    if (here.config.firmware != there.config.firmware)
        return "the firmware";
    for (unsigned number = 0; number < NUMBERS; number++)
        if (number_of(&here, (enum number)number) != number_of(&there, (enum number)number))
            return numbers[number].name;
    return NULL; /* the configuration at power-up is over */
}
