/* SPDX-License-Identifier: MIT */
/* What people may choose of an RKM04: framing, version text, readings. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rkm04_device.h"
#include "text/text.h"

#define LATENCY_MAX 2000u /* ms (C4) */

/* Read into the readings of a config, and note which have been chosen. */
typedef bool reader(struct rkm04_own *own, const void *from, char error[DEVICE_ERROR_SIZE]);

static bool change(struct device_config *config, reader *read, const void *from, char error[DEVICE_ERROR_SIZE])
{
    struct rkm04_own own;
    memcpy(&own, config->own.byte, sizeof own);
    bool is_right = read(&own, from, error);
    memcpy(config->own.byte, &own, sizeof own);
    return is_right;
}

/* ---- On a command line ------------------------------------------------------------------------------------------------ */

static bool take_framing(struct rkm04_own *own, const void *from, char error[DEVICE_ERROR_SIZE])
{
    int length = snprintf(error, DEVICE_ERROR_SIZE, "`%.40s' is unknown: expected ", (const char *)from);
    own->config.framing = rkm04_framing_named(from);
    for (size_t i = 0; rkm04_framings[i]; i++)
        length += snprintf(error + length, DEVICE_ERROR_SIZE - (size_t)length, "%s%s",
                           i == 0 ? "" : rkm04_framings[i + 1] ? ", " : " or ", rkm04_framings[i]->name);
    return own->config.framing;
}

static bool read_framing(struct device_config *config, const char *value, char error[DEVICE_ERROR_SIZE])
{
    return change(config, take_framing, value, error);
}

static bool take_version_text(struct rkm04_own *own, const void *from, char error[DEVICE_ERROR_SIZE])
{
    own->config.version_text = from;
    snprintf(error, DEVICE_ERROR_SIZE, "%zu characters: expected at most %u", strlen(from), RKM04_VERSION_TEXT_MAX);
    return strlen(from) <= RKM04_VERSION_TEXT_MAX;
}

static bool read_version_text(struct device_config *config, const char *value, char error[DEVICE_ERROR_SIZE])
{
    return change(config, take_version_text, value, error);
}

static bool take_readings(struct rkm04_own *own, const void *from, char error[DEVICE_ERROR_SIZE])
{
    return readings_read(&own->config.readings, &own->chosen, from, error);
}

static bool read_readings(struct device_config *config, const char *value, char error[DEVICE_ERROR_SIZE])
{
    return change(config, take_readings, value, error);
}

/* The older name of the reading speed-change. */
static bool read_latency(struct device_config *config, const char *value, char error[DEVICE_ERROR_SIZE])
{
    char *pair = NULL;
    bool is_right = false;
    if (strchr(value, ','))
        snprintf(error, DEVICE_ERROR_SIZE, "expected whole ms from 0 to %u", LATENCY_MAX);
    else if (asprintf(&pair, "speed-change=%s", value) < 0)
        snprintf(error, DEVICE_ERROR_SIZE, "out of memory");
    else
        is_right = change(config, take_readings, pair, error);
    free(pair);
    return is_right;
}

/* ---- In a scenario ------------------------------------------------------------------------------------------------------ */

static bool read_text_node(const char *key, const struct config_node *node)
{
    return config_type(node) == CONFIG_TEXT || config_error(node, "expected %s, a text", key);
}

static bool read_framing_node(struct device_config *config, const char *key, const struct config_node *node)
{
    char error[DEVICE_ERROR_SIZE];
    if (!read_text_node(key, node))
        return false;
    return read_framing(config, config_text(node), error) ||
           config_error(node, "expected framing, hdlc or plain, found \"%.20s\"", config_text(node));
}

static bool read_version_node(struct device_config *config, const char *key, const struct config_node *node)
{
    char error[DEVICE_ERROR_SIZE];
    return read_text_node(key, node) &&
           (read_version_text(config, config_text(node), error) ||
            config_error(node, "expected version_text of up to %u bytes", RKM04_VERSION_TEXT_MAX));
}

static bool take_map(struct rkm04_own *own, const void *from, char error[DEVICE_ERROR_SIZE])
{
    (void)error; /* reported at their nodes */
    return readings_read_map(&own->config.readings, &own->chosen, from);
}

static bool read_readings_node(struct device_config *config, const char *key, const struct config_node *node)
{
    (void)key;
    return change(config, take_map, node, NULL);
}

static bool read_latency_node(struct device_config *config, const char *key, const struct config_node *node)
{
    uint64_t us;
    char text[32], error[DEVICE_ERROR_SIZE];
    if (!config_time(node, key, &us))
        return false;
    if (us > LATENCY_MAX * 1000u)
        return config_error(node, "expected %s of at most %u us", key, LATENCY_MAX * 1000u);
    if (us % 1000 != 0)
        return config_error(node, "expected %s in whole ms", key);
    snprintf(text, sizeof text, "%u", (unsigned)(us / 1000));
    return read_latency(config, text, error) || config_error(node, "%s", error);
}

const struct device_option rkm04_options[] = {
    {.name = "framing",
     .argument = "NAME",
     .help = "hdlc (default) or plain",
     .flags = DEVICE_OPTION_SWITCH | DEVICE_OPTION_BUS,
     .read = read_framing,
     .read_node = read_framing_node},
    {.name = "version-text",
     .argument = "TEXT",
     .help = "What the units answer to Version, up to 255 characters; default " RKM04_VERSION_TEXT,
     .flags = DEVICE_OPTION_SWITCH,
     .read = read_version_text,
     .read_node = read_version_node},
    {.name = "readings",
     .argument = "NAME=VALUE,...",
     .help = READINGS_OPTION_HELP,
     .flags = DEVICE_OPTION_SWITCH,
     .read = read_readings,
     .read_node = read_readings_node,
     .list = readings_list},
    {.name = "speed-change-latency",
     .argument = "MS",
     .help = "The same as --readings speed-change=MS",
     .flags = DEVICE_OPTION_SWITCH,
     .read = read_latency,
     .read_node = read_latency_node},
    {.name = NULL},
};

/* ---- Readings --------------------------------------------------------------------------------------------------------- */

_Static_assert(READINGS <= DEVICE_READINGS_MAX && READINGS_TRIED_MAX <= DEVICE_TRIED_MAX &&
                   READINGS_TEXT_SIZE <= DEVICE_TEXT_SIZE && READINGS_ERROR_SIZE <= DEVICE_ERROR_SIZE,
               "the readings of an RKM04 have to fit");

static struct rkm04_own own_of(const struct device_config *config)
{
    struct rkm04_own own;
    memcpy(&own, config->own.byte, sizeof own);
    return own;
}

static void put_reading(struct device_config *config, unsigned at, unsigned value)
{
    struct rkm04_config settings = rkm04_settings(config);
    readings_put(&settings.readings, at, value);
    rkm04_settings_put(config, &settings);
}

static bool is_chosen(const struct device_config *config, unsigned at)
{
    return own_of(config).chosen >> at & 1u;
}

static void take_others(struct device_config *config, const struct device_config *from)
{
    const struct rkm04_config other = rkm04_settings(from);
    for (unsigned at = 0; at < READINGS; at++)
        if (!is_chosen(config, at))
            put_reading(config, at, readings_get(&other.readings, at));
}

static const char *write_text(const struct device_config *config, char text[DEVICE_TEXT_SIZE])
{
    const struct rkm04_config settings = rkm04_settings(config);
    return readings_text(&settings.readings, text);
}

static json_t *make_json(const struct device_config *config)
{
    const struct rkm04_config settings = rkm04_settings(config);
    return readings_json(&settings.readings);
}

const struct device_readings rkm04_device_readings = {
    .count = READINGS,
    .name = readings_name,
    .tried = readings_tried,
    .put = put_reading,
    .is_chosen = is_chosen,
    .take_others = take_others,
    .text = write_text,
    .json = make_json,
};
