/* SPDX-License-Identifier: MIT */
/* The configuration of a CIB module (registers 101H-125H) as people write it: YAML in files and scenarios, JSON on the control
 * socket and in recordings. One table of entries for all of it. */
#include <stdio.h>
#include <string.h>

#include "cib_device.h"
#include "text/text.h"

#define WORDS 0x25u /* registers from CIB_FIRST on */
#define FIRST 0x101u

/* How an entry is written. */
enum style {
    USE,     /* do, pwm, drive */
    NUMBER,  /* a word */
    PERIOD,  /* two words, high word first, us */
    FLAG,    /* a word, 0 or 1: false or true */
    BIT_FLAG, /* bit `bit` of a word: false or true */
    BIT_LEVEL /* the same: 0 or 1 */
};

struct entry {
    const char *group, *name;
    uint16_t address;
    uint8_t style, bit;
};

#define OUTPUTS(group, at) \
    {group, "use", 0x101 + (at), USE, 0}, {group, "period", 0x104 + 2 * (at), PERIOD, 0}, {group, "bipolar", 0x10a, BIT_FLAG, at}
#define PULSE(n) {"pulse", "pwm" #n, 0x10b, BIT_LEVEL, (n) - 1}
#define DRIVE(group, at) \
    {group, "mode", at, NUMBER, 0}, {group, "start_speed", (at) + 1, NUMBER, 0}, {group, "speed_max", (at) + 2, NUMBER, 0}, \
        {group, "acceleration_max", (at) + 3, NUMBER, 0}, {group, "deceleration_max", (at) + 4, NUMBER, 0}, \
        {group, "ramps", (at) + 5, FLAG, 0}

static const struct entry entries[] = {
    OUTPUTS("do1-2", 0), OUTPUTS("do3-4", 1), OUTPUTS("do5-8", 2),
    PULSE(1), PULSE(2), PULSE(3), PULSE(4), PULSE(5), PULSE(6), PULSE(7), PULSE(8),
    DRIVE("drive_a", 0x110), DRIVE("drive_b", 0x120),
};

#define ENTRIES (sizeof entries / sizeof entries[0])

static const char *const group_names[] = {"do1-2", "do3-4", "do5-8", "pulse", "drive_a", "drive_b", NULL};
static const char *const use_names[] = {[CIB_USE_DO] = "do", [CIB_USE_PWM] = "pwm", [CIB_USE_DRIVE] = "drive"};

/* ---- As registers: word[address - FIRST] --------------------------------------------------------------------------------- */

static void put_drive(uint16_t *word, const struct cib_drive_setup *drive)
{
    const uint16_t values[] = {drive->mode, drive->start_speed, drive->speed_max,
                               drive->acceleration_max, drive->deceleration_max, drive->ramps};
    memcpy(word, values, sizeof values);
}

static struct cib_drive_setup drive_of(const uint16_t *word)
{
    return (struct cib_drive_setup){.mode = word[0],
                                    .start_speed = word[1],
                                    .speed_max = word[2],
                                    .acceleration_max = word[3],
                                    .deceleration_max = word[4],
                                    .ramps = word[5]};
}

static void words_of(const struct cib_setup *setup, uint16_t word[WORDS])
{
    memset(word, 0, WORDS * sizeof *word);
    for (unsigned i = 0; i < CIB_USES; i++) {
        word[i] = setup->use[i];
        word[0x104 - FIRST + 2 * i] = (uint16_t)(setup->period[i] >> 16);
        word[0x105 - FIRST + 2 * i] = (uint16_t)setup->period[i];
    }
    word[0x10a - FIRST] = setup->bipolar;
    word[0x10b - FIRST] = setup->active;
    put_drive(&word[0x110 - FIRST], &setup->drive[0]);
    put_drive(&word[0x120 - FIRST], &setup->drive[1]);
}

static struct cib_setup setup_of(const uint16_t word[WORDS])
{
    struct cib_setup setup = {.bipolar = word[0x10a - FIRST], .active = word[0x10b - FIRST]};
    for (unsigned i = 0; i < CIB_USES; i++) {
        setup.use[i] = word[i];
        setup.period[i] = (uint32_t)word[0x104 - FIRST + 2 * i] << 16 | word[0x105 - FIRST + 2 * i];
    }
    setup.drive[0] = drive_of(&word[0x110 - FIRST]);
    setup.drive[1] = drive_of(&word[0x120 - FIRST]);
    return setup;
}

struct cib_setup cib_setup_read(const struct cib_unit *unit, enum cib_zone zone)
{
    uint16_t word[WORDS];
    for (unsigned i = 0; i < WORDS; i++)
        word[i] = cib_read(unit, zone, (uint16_t)(FIRST + i));
    return setup_of(word);
}

void cib_setup_write(struct cib_unit *unit, const struct cib_setup *setup)
{
    uint16_t word[WORDS];
    words_of(setup, word);
    for (unsigned i = 0; i < WORDS; i++)
        if (cib_has_register(CIB_OUTPUT_ZONE, (uint16_t)(FIRST + i)))
            (void)cib_write(unit, (uint16_t)(FIRST + i), &word[i], 1);
}

/* ---- Entries ------------------------------------------------------------------------------------------------------------ */

static int64_t value_of(const struct entry *entry, const uint16_t word[WORDS])
{
    const uint16_t *at = word + entry->address - FIRST;
    if (entry->style == PERIOD)
        return (int64_t)((uint32_t)at[0] << 16 | at[1]);
    return entry->style == BIT_FLAG || entry->style == BIT_LEVEL ? at[0] >> entry->bit & 1 : at[0];
}

static void put_value(const struct entry *entry, uint16_t word[WORDS], int64_t value)
{
    uint16_t *at = word + entry->address - FIRST;
    if (entry->style == PERIOD) {
        at[0] = (uint16_t)(value >> 16);
        at[1] = (uint16_t)(value & 0xffff);
    } else if (entry->style == BIT_FLAG || entry->style == BIT_LEVEL) {
        at[0] = (uint16_t)((at[0] & ~(1u << entry->bit)) | (unsigned)value << entry->bit);
    } else {
        at[0] = (uint16_t)value;
    }
}

static int64_t highest(const struct entry *entry)
{
    return entry->style == PERIOD ? UINT32_MAX : entry->style == NUMBER ? UINT16_MAX : 1;
}

static const struct entry *find(const char *group, const char *name)
{
    for (size_t i = 0; i < ENTRIES; i++)
        if (strcmp(entries[i].group, group) == 0 && strcmp(entries[i].name, name) == 0)
            return &entries[i];
    return NULL;
}

static int use_named(const char *name)
{
    for (int use = 0; name && use < (int)(sizeof use_names / sizeof use_names[0]); use++)
        if (strcmp(use_names[use], name) == 0)
            return use;
    return -1;
}

const char *cib_setup_name(uint16_t address, char name[DEVICE_COMMAND_SIZE])
{
    for (size_t i = 0; i < ENTRIES; i++) {
        if (entries[i].address != address)
            continue;
        bool is_whole = entries[i].style == BIT_LEVEL || entries[i].style == BIT_FLAG; /* the register is about several */
        snprintf(name, DEVICE_COMMAND_SIZE, "%s%s%s", is_whole ? "" : entries[i].group, is_whole ? "" : ".",
                 entries[i].style == BIT_LEVEL ? "pulse" : entries[i].name);
        return name;
    }
    return NULL;
}

bool cib_setup_check(const struct cib_setup *setup, uint16_t firmware, char error[DEVICE_ERROR_SIZE])
{
    char name[DEVICE_COMMAND_SIZE];
    uint16_t wrong = cib_check_setup(setup, firmware);
    if (wrong != 0)
        snprintf(error, DEVICE_ERROR_SIZE, "%s: the module refuses it (register %XH)", cib_setup_name(wrong, name), wrong + 0u);
    return wrong == 0;
}

/* ---- JSON --------------------------------------------------------------------------------------------------------------- */

static json_t *entry_json(const struct entry *entry, int64_t value)
{
    if (entry->style == USE && value < (int64_t)(sizeof use_names / sizeof use_names[0]))
        return json_string(use_names[value]);
    if (entry->style == BIT_FLAG || (entry->style == FLAG && value <= 1))
        return json_boolean(value != 0);
    return json_integer(value);
}

json_t *cib_setup_json(const struct cib_setup *setup)
{
    uint16_t word[WORDS];
    json_t *object = json_object();
    words_of(setup, word);
    for (const char *const *group = group_names; *group; group++) {
        json_t *part = json_object();
        for (size_t i = 0; i < ENTRIES; i++)
            if (strcmp(entries[i].group, *group) == 0)
                json_object_set_new(part, entries[i].name, entry_json(&entries[i], value_of(&entries[i], word)));
        json_object_set_new(object, *group, part);
    }
    return object;
}

/* Anything that registers can hold, so that a host can propose what APPLY refuses. */
static bool read_entry(const struct entry *entry, const json_t *json, int64_t *value)
{
    int use = use_named(json_string_value(json));
    if (json_is_boolean(json) && (entry->style == FLAG || entry->style == BIT_FLAG))
        *value = json_is_true(json);
    else if (entry->style == USE && use >= 0)
        *value = use;
    else if (json_is_integer(json) && json_integer_value(json) >= 0 &&
             json_integer_value(json) <= (entry->style == USE || entry->style == FLAG ? UINT16_MAX : highest(entry)))
        *value = json_integer_value(json);
    else
        return false;
    return true;
}

bool cib_setup_read_json(struct cib_setup *setup, const json_t *object, char error[DEVICE_ERROR_SIZE])
{
    uint16_t word[WORDS];
    const char *group, *name;
    json_t *part, *json;
    int64_t value;
    words_of(setup, word);
    if (!json_is_object(object)) {
        snprintf(error, DEVICE_ERROR_SIZE, "expected a configuration, as in {\"do5-8\": {\"use\": \"do\"}}");
        return false;
    }
    json_object_foreach((json_t *)object, group, part) {
        json_object_foreach(part, name, json) {
            const struct entry *entry = find(group, name);
            if (!entry || !read_entry(entry, json, &value)) {
                snprintf(error, DEVICE_ERROR_SIZE, "%.40s.%.40s: %s", group, name, entry ? "wrong value" : "unknown entry");
                return false;
            }
            put_value(entry, word, value);
        }
        if (!json_is_object(part)) {
            snprintf(error, DEVICE_ERROR_SIZE, "%.40s: expected an object", group);
            return false;
        }
    }
    *setup = setup_of(word);
    return true;
}

/* ---- YAML --------------------------------------------------------------------------------------------------------------- */

static bool read_use(const struct config_node *node, int64_t *value)
{
    int use = config_type(node) == CONFIG_TEXT ? use_named(config_text(node)) : -1;
    *value = use;
    return use >= 0 || config_error(node, "expected what the outputs are used for: do, pwm or drive");
}

static bool read_group(const struct config_node *group, const char *name, uint16_t word[WORDS])
{
    const char *names[10];
    size_t count = 0;
    for (size_t i = 0; i < ENTRIES; i++)
        if (strcmp(entries[i].group, name) == 0)
            names[count++] = entries[i].name;
    names[count] = NULL;
    if (config_type(group) != CONFIG_MAP)
        return config_error(group, "expected a map, as in {%s: ...}", names[0]);
    bool is_right = config_keys(group, names);
    for (size_t i = 0; is_right && i < config_count(group); i++) {
        const struct entry *entry = find(name, config_key(group, i));
        const struct config_node *node = config_at(group, i);
        int64_t value = 0;
        bool flag = false;
        if (entry->style == USE)
            is_right = read_use(node, &value);
        else if (entry->style == FLAG || entry->style == BIT_FLAG)
            is_right = config_flag(node, entry->name, &flag);
        else
            is_right = config_integer(node, entry->name, 0, highest(entry), &value);
        put_value(entry, word, entry->style == FLAG || entry->style == BIT_FLAG ? flag : value);
    }
    return is_right;
}

bool cib_setup_read_node(struct cib_setup *setup, const struct config_node *node)
{
    uint16_t word[WORDS];
    words_of(setup, word);
    if (config_type(node) != CONFIG_MAP)
        return config_error(node, "expected a configuration, as in {do5-8: {use: do}}");
    if (!config_keys(node, group_names))
        return false;
    for (size_t i = 0; i < config_count(node); i++)
        if (!read_group(config_at(node, i), config_key(node, i), word))
            return false;
    *setup = setup_of(word);
    return true;
}
