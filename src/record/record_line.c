/* SPDX-License-Identifier: MIT */
#include "record_line.h"

#include <inttypes.h>
#include <string.h>

#include "text/text.h"

void record_hex(FILE *out, const uint8_t *bytes, size_t length)
{
    static const char digits[] = "0123456789abcdef";
    for (size_t i = 0; i < length; i++) {
        putc_unlocked(digits[bytes[i] >> 4], out);
        putc_unlocked(digits[bytes[i] & 15u], out);
    }
}

/* ---- Head ----------------------------------------------------------------------------------------------------------- */

/* A text as "name", or as "name_hex" if it is not UTF-8. */
static bool put_string(json_t *head, const char *name, const char *text)
{
    json_t *string = json_string(text);
    if (string)
        return json_object_set_new(head, name, string) == 0;
    char *hex = NULL, hex_name[40];
    size_t size;
    FILE *stream = open_memstream(&hex, &size);
    if (!stream)
        return false;
    record_hex(stream, (const uint8_t *)text, strlen(text));
    snprintf(hex_name, sizeof hex_name, "%s_hex", name);
    bool ok = fclose(stream) == 0 && json_object_set_new(head, hex_name, json_string(hex)) == 0;
    free(hex);
    return ok;
}

static bool put_member(json_t *head, const char *name, json_t *value)
{
    return json_object_set_new(head, name, value) == 0;
}

/* The device's own settings. */
static bool put_device(json_t *head, const struct device_kind *kind, const struct device_config *config)
{
    const char *name;
    json_t *settings = json_object(), *value;
    bool ok = settings != NULL;
    if (ok)
        kind->put_settings(config, settings);
    json_object_foreach(settings, name, value)
        ok = ok && (json_is_string(value) ? put_string(head, name, json_string_value(value))
                                              : json_object_set(head, name, value) == 0);
    json_decref(settings);
    return ok;
}

static bool put_settings(json_t *head, const struct sim *sim, bool outputs)
{
    const struct device_kind *kind = sim_device(sim);
    const struct sim_config *config = &sim->config;
    json_t *nodes = json_array();
    char seed[24];
    snprintf(seed, sizeof seed, "%" PRIu64, config->seed);
    for (unsigned at = 0; at < config->nodes.count; at++)
        if (json_array_append_new(nodes, json_integer(config->nodes.node[at])) != 0)
            return json_decref(nodes), false;
    return put_member(head, "rkm04_record", json_integer(RECORD_VERSION)) &&
           put_member(head, "emulator", json_string("rkm04 " RKM04_VERSION)) &&
           (kind == device_kind_at(0) || put_member(head, "device", json_string(kind->name))) &&
           put_member(head, "nodes", nodes) &&
           put_device(head, kind, &config->unit) &&
           put_member(head, "timed", json_boolean(config->timed)) &&
           put_member(head, "turnaround", json_integer(config->turnaround)) &&
           put_member(head, "seed", json_string(seed)) && (!sim->plant_text || put_string(head, "plant", sim->plant_text)) &&
           put_member(head, "outputs", json_boolean(outputs));
}

/* Blocks that are not erased, without the erased bytes at their ends. */
static bool write_flash(FILE *out, struct sim *sim, unsigned number)
{
    struct sim_unit *unit = &sim->unit[number - 1u];
    const struct sim_flash *flash = &sim->config.flash;
    const unsigned size = sim_device(sim)->flash_block_size;
    uint8_t data[DEVICE_FLASH_BLOCK_MAX];
    if (!flash->read && !unit->memory)
        return true;
    for (unsigned block = 0; block < sim_device(sim)->flash_blocks; block++) {
        size_t length = size;
        if (flash->read && flash->read(flash->context, number, block, 0, data, size) != 0)
            return false;
        for (unsigned i = 0; !flash->read && i < size; i++)
            data[i] = (uint8_t)~unit->memory[block * size + i];
        while (length > 0 && data[length - 1u] == 0xFF)
            length--;
        if (length == 0)
            continue;
        fprintf(out, "{\"flash\":%u,\"block\":%u,\"hex\":\"", number, block);
        record_hex(out, data, length);
        fputs("\"}\n", out);
    }
    return true;
}

bool record_line_head(FILE *out, struct sim *sim, bool outputs)
{
    json_t *head = json_object();
    bool ok = put_settings(head, sim, outputs) && json_dumpf(head, out, JSON_COMPACT) == 0;
    json_decref(head);
    putc('\n', out);
    for (unsigned number = 1; ok && number <= sim_units(sim); number++)
        ok = write_flash(out, sim, number);
    return ok;
}

/* ---- What comes in -------------------------------------------------------------------------------------------------- */

static void begin(FILE *out, uint64_t now)
{
    fprintf(out, "{\"t\":%" PRIu64, now);
}

void record_line_bytes(FILE *out, uint64_t now, uint64_t tick, const uint8_t *bytes, size_t length)
{
    begin(out, now);
    if (tick > now)
        fprintf(out, ",\"at\":%" PRIu64, tick);
    fputs(",\"in\":\"", out);
    record_hex(out, bytes, length);
    fputs("\"}\n", out);
}

void record_line_purge(FILE *out, uint64_t now)
{
    begin(out, now);
    fputs(",\"purge\":true}\n", out);
}

void record_line_break(FILE *out, uint64_t now, bool on)
{
    begin(out, now);
    fprintf(out, ",\"break\":%s}\n", on ? "true" : "false");
}

void record_line_timed(FILE *out, uint64_t now, bool timed)
{
    begin(out, now);
    fprintf(out, ",\"timed\":%s}\n", timed ? "true" : "false");
}

bool record_line_command(FILE *out, uint64_t now, const char *method, const json_t *params)
{
    begin(out, now);
    fprintf(out, ",\"command\":\"%s\",\"params\":", method);
    bool ok = params ? json_dumpf(params, out, JSON_COMPACT) == 0 : fputs("{}", out) >= 0;
    fputs("}\n", out);
    return ok;
}
