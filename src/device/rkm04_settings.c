/* SPDX-License-Identifier: MIT */
/* The settings of an RKM04: framing, version text, readings. */
#include <stdio.h>
#include <string.h>

#include "rkm04_device.h"
#include "text/text.h"

#define LATENCY_MAX 2000u     /* ms (C4) */

_Static_assert(sizeof(struct rkm04_own) <= DEVICE_SETTINGS_SIZE, "the settings of an RKM04 have to fit");

const char *const rkm04_setting_names[] = {"framing", "version_text", "speed_change_latency", "readings", NULL};

struct rkm04_config rkm04_settings(const struct device_config *config)
{
    struct rkm04_config settings;
    memcpy(&settings, config->own.byte, sizeof settings);
    settings.node = config->node;
    return settings;
}

void rkm04_settings_put(struct device_config *config, const struct rkm04_config *settings)
{
    memcpy(config->own.byte, settings, sizeof *settings);
}

struct device_config rkm04_device_config(const struct rkm04_config *settings)
{
    struct device_config config = {.node = settings->node};
    rkm04_settings_put(&config, settings);
    return config;
}

static const struct rkm04_framing *framing_of(const struct rkm04_config *settings)
{
    return settings->framing ? settings->framing : &rkm04_hdlc;
}

static const char *version_text_of(const struct rkm04_config *settings)
{
    return settings->version_text ? settings->version_text : RKM04_VERSION_TEXT;
}

void rkm04_put_settings(const struct device_config *config, json_t *object)
{
    const struct rkm04_config settings = rkm04_settings(config);
    json_object_set_new(object, "framing", json_string(framing_of(&settings)->name));
    json_object_set_new_nocheck(object, "version_text", json_string_nocheck(version_text_of(&settings)));
    json_object_set_new(object, "readings", readings_json(&settings.readings));
}

static bool read_framing(struct rkm04_config *settings, const json_t *value, char error[DEVICE_ERROR_SIZE])
{
    const char *name = json_string_value(value);
    settings->framing = name ? rkm04_framing_named(name) : NULL;
    if (!settings->framing)
        snprintf(error, DEVICE_ERROR_SIZE, "expected \"framing\", hdlc or plain");
    return settings->framing != NULL;
}

static bool read_version_text(struct rkm04_config *settings, const json_t *value, char error[DEVICE_ERROR_SIZE])
{
    settings->version_text = json_string_value(value);
    if (value && (!settings->version_text || json_string_length(value) > RKM04_VERSION_TEXT_MAX)) {
        snprintf(error, DEVICE_ERROR_SIZE, "expected \"version_text\", at most %u bytes", RKM04_VERSION_TEXT_MAX);
        return false;
    }
    return true;
}

/* The older name of the reading speed-change. */
static bool read_latency(struct rkm04_config *settings, const json_t *value, char error[DEVICE_ERROR_SIZE])
{
    json_int_t latency = json_integer_value(value);
    if (!value)
        return true;
    if (!json_is_integer(value) || latency < 0 || latency > LATENCY_MAX) {
        snprintf(error, DEVICE_ERROR_SIZE, "expected \"speed_change_latency\", a number from 0 to %u", LATENCY_MAX);
        return false;
    }
    settings->readings.speed_change = (uint16_t)latency;
    return true;
}

bool rkm04_read_setting(struct device_config *config, const char *name, const json_t *value, char error[DEVICE_ERROR_SIZE])
{
    struct rkm04_config settings = rkm04_settings(config);
    bool is_right = true;
    char text[READINGS_ERROR_SIZE];
    if (strcmp(name, "framing") == 0)
        is_right = read_framing(&settings, value, error);
    else if (strcmp(name, "version_text") == 0)
        is_right = read_version_text(&settings, value, error);
    else if (strcmp(name, "speed_change_latency") == 0)
        is_right = read_latency(&settings, value, error);
    else if (strcmp(name, "readings") == 0 && value && !(is_right = readings_read_json(&settings.readings, value, text)))
        snprintf(error, DEVICE_ERROR_SIZE, "\"readings\": %.200s", text);
    rkm04_settings_put(config, &settings);
    return is_right;
}

#define FLAG 0x7e
#define ESCAPE 0x7d
#define SILENCE 100000u /* us: both framings (L2) */

const struct device_framing *rkm04_settings_framing(const struct device_config *config)
{
    static const struct device_framing hdlc = {.link = &rkm04_hdlc, .flag = FLAG, .escape = ESCAPE, .silence = SILENCE};
    static const struct device_framing plain = {
        .link = &rkm04_plain, .flag = -1, .escape = -1, .silence = SILENCE, .no_address = "no frame, no address above 16"};
    const struct rkm04_config settings = rkm04_settings(config);
    return framing_of(&settings) == &rkm04_plain ? &plain : &hdlc;
}

const char *rkm04_settings_difference(const struct device_config *a, const struct device_config *b)
{
    const struct rkm04_config here = rkm04_settings(a), there = rkm04_settings(b);
    if (framing_of(&here) != framing_of(&there))
        return "the framing";
    if (!readings_same(&here.readings, &there.readings))
        return "one of the readings (--readings)";
    if (strcmp(version_text_of(&here), version_text_of(&there)) != 0)
        return "the version text";
    return NULL;
}
