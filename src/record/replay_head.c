/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "record_line.h"
#include "replay_state.h"
#include "text/text.h"

#define EMULATOR_MAX 255u           /* bytes of its name */
#define KEY_SIZE 64u                /* bytes of a key */
#define KEYS_MAX 64u                /* of a head */
#define PLANT_MAX (1u << 20)        /* bytes */

/* ---- Flash: memory, all bytes inverted, so that untouched memory costs nothing ------------------------------------- */

static uint8_t *flash_at(void *context, unsigned number, unsigned block, unsigned offset, unsigned length)
{
    const struct replay *replay = context;
    const unsigned blocks = replay->head.device->flash_blocks, size = replay->head.device->flash_block_size;
    if (block >= blocks || offset > size || length > size - offset)
        return NULL;
    return replay->head.flash + ((number - 1u) * blocks + block) * size + offset;
}

static int flash_read(void *context, unsigned number, unsigned block, unsigned offset, void *data, unsigned length)
{
    const uint8_t *from = flash_at(context, number, block, offset, length);
    uint8_t *to = data;
    for (unsigned i = 0; from && i < length; i++)
        to[i] = (uint8_t)~from[i];
    return from ? 0 : 1;
}

static int flash_erase(void *context, unsigned number, unsigned block)
{
    const struct replay *replay = context;
    uint8_t *at = flash_at(context, number, block, 0, replay->head.device->flash_block_size);
    if (at)
        memset(at, 0, replay->head.device->flash_block_size);
    return at ? 0 : 1;
}

static int flash_program(void *context, unsigned number, unsigned block, unsigned offset, const void *data, unsigned length)
{
    uint8_t *to = flash_at(context, number, block, offset, length);
    const uint8_t *from = data;
    for (unsigned i = 0; to && i < length; i++)
        to[i] = (uint8_t)~from[i];
    return to ? 0 : 1;
}

/* The lines with images after the head. The line after them is read again. */
static bool read_images(struct replay *replay, unsigned units)
{
    static const char *const keys[] = {"flash", "block", "hex", NULL};
    while (replay_next_line(replay)) {
        uint64_t number, block;
        size_t length;
        if (!json_object_get(replay->lines.json, "flash")) {
            replay_return_line(replay);
            return true;
        }
        if (!replay_keys(replay, keys) || !replay_number(replay, "flash", 1, units, DEVICE_NEVER, &number) ||
            !replay_number(replay, "block", 0, replay->head.device->flash_blocks - 1u, DEVICE_NEVER, &block))
            return false;
        const uint8_t *bytes = replay_bytes(replay, "hex", replay->head.device->flash_block_size, &length);
        if (!bytes || flash_program(replay, (unsigned)number, (unsigned)block, 0, bytes, (unsigned)length) != 0)
            return false;
    }
    return !replay->result.ended;
}

/* ---- Head ----------------------------------------------------------------------------------------------------------- */

static bool read_nodes(struct replay *replay, struct node_list *nodes)
{
    const json_t *list = json_object_get(replay->lines.json, "nodes"), *node;
    size_t i;
    bool ok = json_is_array(list) && json_array_size(list) >= 1 && json_array_size(list) <= NODE_LIST_MAX;
    nodes->count = ok ? (unsigned)json_array_size(list) : 0;
    json_array_foreach((json_t *)list, i, node) {
        ok = ok && json_is_integer(node) && json_integer_value(node) >= 1 &&
               json_integer_value(node) <= replay->head.device->addresses;
        if (ok)
            nodes->node[i] = (uint8_t)json_integer_value(node);
    }
    return ok || replay_wrong(replay, "nodes", "expected \"nodes\", a list of 1 to %u addresses from 1 to %u", NODE_LIST_MAX,
                              replay->head.device->addresses);
}

/* Recordings that name no device are of the first one, the RKM04. */
static bool read_device(struct replay *replay, struct sim_config *config)
{
    const char *name = json_object_get(replay->lines.json, "device") ? replay_string(replay, "device") : device_kind_at(0)->name;
    config->device = replay->head.device = name ? device_kind_named(name) : NULL;
    return replay->head.device || !name ||
           replay_wrong(replay, "device", "expected \"device\", one of those that rkm04 devices lists");
}

/* The device's own settings, NAME or NAME_hex. They stay as long as the replay. */
static bool read_own(struct replay *replay, struct device_config *config)
{
    char error[DEVICE_ERROR_SIZE], hex_name[KEY_SIZE];
    replay->head.settings = json_object();
    for (const char *const *name = replay->head.device->settings; *name; name++) {
        json_t *value = json_object_get(replay->lines.json, *name);
        char *text;
        snprintf(hex_name, sizeof hex_name, "%s_hex", *name);
        if (json_object_get(replay->lines.json, hex_name)) {
            if (!replay_text_of(replay, *name, RECORD_LINE_MAX, &text))
                return false;
            json_object_set_new_nocheck(replay->head.settings, *name, json_string_nocheck(text));
            free(text);
        } else if (value) {
            json_object_set(replay->head.settings, *name, value);
        }
        if (!replay->head.device->read_setting(config, *name, json_object_get(replay->head.settings, *name), error))
            return replay_wrong(replay, *name, "%s", error);
    }
    return true;
}

static bool read_seed(struct replay *replay, uint64_t *seed)
{
    const char *text = replay_string(replay, "seed");
    return text && (number_read(text, 0, UINT64_MAX, seed) ||
                    replay_wrong(replay, "seed", "expected \"seed\", a string with a number from 0 to 2^64 - 1"));
}

static bool read_settings(struct replay *replay, struct sim_config *config)
{
    uint64_t turnaround;
    bool ok = read_nodes(replay, &config->nodes) && read_own(replay, &config->unit) &&
                replay_flag(replay, "timed", true, &config->timed) &&
                replay_number(replay, "turnaround", 0, SEGMENT_TURNAROUND_MAX, 0, &turnaround) &&
                read_seed(replay, &config->seed) && replay_flag(replay, "outputs", false, &replay->head.outputs);
    if (!ok)
        return false;
    config->turnaround = (uint32_t)turnaround;
    return true;
}

static bool has_known_keys(struct replay *replay)
{
    const char *names[KEYS_MAX] = {"rkm04_record", "emulator", "program", "device", "nodes", "timed", "turnaround", "seed",
                                   "plant", "plant_hex", "outputs"};
    char hex[KEYS_MAX][KEY_SIZE];
    size_t count = 11;
    for (const char *const *name = replay->head.device->settings; *name && count < KEYS_MAX - 2u; name++) {
        snprintf(hex[count], KEY_SIZE, "%s_hex", *name);
        names[count + 1u] = *name;
        names[count] = hex[count];
        count += 2;
    }
    return replay_keys(replay, names);
}

/* Which emulator has made the recording. Older ones call it "program", which may be a setting of the device. */
static bool read_emulator(struct replay *replay)
{
    const char *name = "program";
    for (const char *const *own = replay->head.device->settings; *own; own++)
        if (strcmp(*own, name) == 0)
            name = "emulator";
    if (json_object_get(replay->lines.json, "emulator"))
        name = "emulator";
    return replay_text_of(replay, name, EMULATOR_MAX, &replay->head.emulator);
}

static bool read_head(struct replay *replay, struct sim_config *config, char **plant)
{
    uint64_t version;
    if (!replay_next_line(replay))
        return replay->result.ended || replay_wrong(replay, NULL, "expected a recording, which begins with {\"rkm04_record\":1,");
    if (!json_object_get(replay->lines.json, "rkm04_record"))
        return replay_wrong(replay, NULL, "expected a recording, which begins with {\"rkm04_record\":1,");
    if (!replay_number(replay, "rkm04_record", RECORD_VERSION, RECORD_VERSION, DEVICE_NEVER, &version) ||
        !read_device(replay, config) || !has_known_keys(replay) ||
        !read_emulator(replay) || !read_settings(replay, config))
        return false;
    return replay_text_of(replay, "plant", PLANT_MAX, plant);
}

static bool set_plant(struct replay *replay, const char *plant)
{
    char *messages = NULL;
    size_t size;
    FILE *errors = open_memstream(&messages, &size);
    bool ok = errors && sim_configure_plants(replay->head.sim, "plant", plant, strlen(plant), errors);
    if (errors)
        fclose(errors);
    if (!ok) {
        size_t length = messages ? strcspn(messages, "\n") : 0;
        replay_wrong(replay, NULL, "%.*s", (int)length, length > 0 ? messages : "the plant could not be set up");
    }
    free(messages);
    return ok;
}

static bool power_up(struct replay *replay, const struct sim_config *config, const char *plant)
{
    replay->head.sim = calloc(1, sizeof *replay->head.sim);
    if (!replay->head.sim || !sim_begin(replay->head.sim, config) || !snapshots_attach(replay->head.sim))
        return replay_no_memory(replay);
    return !plant || set_plant(replay, plant);
}

bool replay_begin(struct replay *replay)
{
    struct sim_config config = {
        .flash = {.read = flash_read, .erase = flash_erase, .program = flash_program, .context = replay},
    };
    char *plant = NULL;
    bool ok = read_head(replay, &config, &plant) && !replay->result.ended;
    if (ok) {
        const struct device_kind *kind = replay->head.device;
        replay->head.flash = calloc(config.nodes.count, kind->flash_blocks * kind->flash_block_size + 1u);
        ok = replay->head.flash ? read_images(replay, config.nodes.count) : replay_no_memory(replay);
    }
    ok = ok && power_up(replay, &config, plant);
    free(plant);
    return ok;
}

void replay_head_free(struct replay *replay)
{
    if (replay->head.sim)
        sim_end(replay->head.sim);
    free(replay->head.sim);
    free(replay->head.flash);
    json_decref(replay->head.settings);
    free(replay->head.emulator);
}
