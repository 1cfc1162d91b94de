/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "text/text.h"
#include "record_line.h"
#include "replay_inside.h"

#define TEXT_MAX 255u               /* bytes of a version text */
#define LATENCY_MAX 2000u           /* ms (C4) */
#define PLANT_MAX (1u << 20)        /* bytes */

/* ---- Flash: memory, all bytes inverted, so that what nobody touches costs nothing ------------------------------------- */

static uint8_t *flash_at(void *context, unsigned number, unsigned block, unsigned offset, unsigned length)
{
    const struct replay *replay = context;
    if (block >= RKM04_FLASH_BLOCKS || offset > RKM04_FLASH_BLOCK_SIZE || length > RKM04_FLASH_BLOCK_SIZE - offset)
        return NULL;
    return replay->flash + ((number - 1u) * RKM04_FLASH_BLOCKS + block) * RKM04_FLASH_BLOCK_SIZE + offset;
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
    uint8_t *at = flash_at(context, number, block, 0, RKM04_FLASH_BLOCK_SIZE);
    if (at)
        memset(at, 0, RKM04_FLASH_BLOCK_SIZE);
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

/* The lines with images behind the head. The line behind them is read again. */
static bool read_images(struct replay *replay, unsigned units)
{
    static const char *const keys[] = {"flash", "block", "hex", NULL};
    while (replay_next_line(replay)) {
        uint64_t number, block;
        size_t length;
        if (!json_object_get(replay->json, "flash")) {
            replay->again = true;
            return true;
        }
        if (!replay_keys(replay, keys) || !replay_number(replay, "flash", 1, units, RKM04_NEVER, &number) ||
            !replay_number(replay, "block", 0, RKM04_FLASH_BLOCKS - 1u, RKM04_NEVER, &block))
            return false;
        const uint8_t *bytes = replay_bytes(replay, "hex", RKM04_FLASH_BLOCK_SIZE, &length);
        if (!bytes || flash_program(replay, (unsigned)number, (unsigned)block, 0, bytes, (unsigned)length) != 0)
            return false;
    }
    return !replay->ended;
}

/* ---- Head ----------------------------------------------------------------------------------------------------------- */

static bool read_nodes(struct replay *replay, struct node_list *nodes)
{
    const json_t *list = json_object_get(replay->json, "nodes"), *node;
    size_t i;
    bool well = json_is_array(list) && json_array_size(list) >= 1 && json_array_size(list) <= NODE_LIST_MAX;
    nodes->count = well ? (unsigned)json_array_size(list) : 0;
    json_array_foreach((json_t *)list, i, node) {
        well = well && json_is_integer(node) && json_integer_value(node) >= 1 && json_integer_value(node) <= RKM04_NODE_MAX;
        if (well)
            nodes->node[i] = (uint8_t)json_integer_value(node);
    }
    return well || replay_wrong(replay, "nodes", "expected \"nodes\", a list of 1 to %u addresses from 1 to %d", NODE_LIST_MAX,
                                RKM04_NODE_MAX);
}

static bool read_framing(struct replay *replay, const struct rkm04_framing **framing)
{
    const char *name = replay_string(replay, "framing");
    *framing = name ? rkm04_framing_named(name) : NULL;
    if (name && !*framing)
        replay_wrong(replay, "framing", "expected \"framing\", hdlc or plain");
    return *framing != NULL;
}

static bool read_seed(struct replay *replay, uint64_t *seed)
{
    const char *text = replay_string(replay, "seed");
    return text && (number_read(text, 0, UINT64_MAX, seed) ||
                    replay_wrong(replay, "seed", "expected \"seed\", a string with a number from 0 to 2^64 - 1"));
}

/* Recordings without them were made under the defaults, but for speed_change_latency, the older name of speed-change. */
static bool read_readings(struct replay *replay, struct rkm04_readings *readings)
{
    char error[READINGS_ERROR_SIZE];
    uint64_t latency;
    const json_t *json = json_object_get(replay->json, "readings");
    if (!replay_number(replay, "speed_change_latency", 0, LATENCY_MAX, 0, &latency))
        return false;
    readings->speed_change = (uint16_t)latency;
    return !json || readings_read_json(readings, json, error) || replay_wrong(replay, "readings", "\"readings\": %s", error);
}

static bool read_settings(struct replay *replay, struct sim_config *config)
{
    uint64_t turnaround;
    bool well = read_nodes(replay, &config->nodes) && read_framing(replay, &config->unit.framing) &&
                replay_text_of(replay, "version_text", TEXT_MAX, &replay->version_text) &&
                read_readings(replay, &config->unit.readings) &&
                replay_flag(replay, "timed", true, &config->timed) &&
                replay_number(replay, "turnaround", 0, SEGMENT_TURNAROUND_MAX, 0, &turnaround) &&
                read_seed(replay, &config->seed) && replay_flag(replay, "outputs", false, &replay->outputs);
    if (!well)
        return false;
    config->unit.version_text = replay->version_text;
    config->turnaround = (uint32_t)turnaround;
    return true;
}

static bool read_head(struct replay *replay, struct sim_config *config, char **plant)
{
    static const char *const keys[] = {"rkm04_record", "program",  "nodes", "framing", "version_text", "version_text_hex",
                                       "speed_change_latency", "readings", "timed", "turnaround", "seed", "plant",
                                       "plant_hex", "outputs", NULL};
    uint64_t version;
    if (!replay_next_line(replay))
        return replay->ended || replay_wrong(replay, NULL, "expected a recording, which begins with {\"rkm04_record\":1,");
    if (!json_object_get(replay->json, "rkm04_record"))
        return replay_wrong(replay, NULL, "expected a recording, which begins with {\"rkm04_record\":1,");
    if (!replay_number(replay, "rkm04_record", RECORD_VERSION, RECORD_VERSION, RKM04_NEVER, &version) ||
        !replay_keys(replay, keys) || !replay_text_of(replay, "program", TEXT_MAX, &replay->program) ||
        !read_settings(replay, config))
        return false;
    return replay_text_of(replay, "plant", PLANT_MAX, plant);
}

static bool set_plant(struct replay *replay, const char *plant)
{
    char *messages = NULL;
    size_t size;
    FILE *errors = open_memstream(&messages, &size);
    bool well = errors && sim_configure_plants(replay->sim, "plant", plant, strlen(plant), errors);
    if (errors)
        fclose(errors);
    if (!well) {
        size_t length = messages ? strcspn(messages, "\n") : 0;
        replay_wrong(replay, NULL, "%.*s", (int)length, length > 0 ? messages : "the plant could not be set up");
    }
    free(messages);
    return well;
}

static bool power_up(struct replay *replay, const struct sim_config *config, const char *plant)
{
    replay->sim = calloc(1, sizeof *replay->sim);
    if (!replay->sim || !sim_begin(replay->sim, config) || !snapshots_attach(replay->sim))
        return replay_no_memory(replay);
    return !plant || set_plant(replay, plant);
}

bool replay_begin(struct replay *replay)
{
    struct sim_config config = {
        .flash = {.read = flash_read, .erase = flash_erase, .program = flash_program, .context = replay},
    };
    char *plant = NULL;
    bool well = read_head(replay, &config, &plant) && !replay->ended;
    if (well) {
        replay->flash = calloc(config.nodes.count, RKM04_FLASH_BLOCKS * RKM04_FLASH_BLOCK_SIZE);
        well = replay->flash ? read_images(replay, config.nodes.count) : replay_no_memory(replay);
    }
    well = well && power_up(replay, &config, plant);
    free(plant);
    return well;
}
