/* SPDX-License-Identifier: MIT */
#include "readings.h"

#include <stddef.h>
#include <string.h>

#include "time_value.h"

#define FOUND_MAX 40 /* characters of what was found that a message repeats */

struct reading {
    const char *name;
    const char *value[2];                     /* the default first; NULL: a time */
    uint16_t most;                            /* ms, of a time */
    uint8_t size;                             /* bytes of the member */
    uint8_t member;                           /* where it is in struct rkm04_readings */
    uint16_t tried[READINGS_TRIED_MAX];       /* values of a time under which tests are run */
    const char *clause, *about;               /* what the other value does */
};

#define MEMBER(name) .member = offsetof(struct rkm04_readings, name), .size = sizeof((struct rkm04_readings *)0)->name

/* Times are tried at one slot, which shows whether a result depends on the exact slot, at one or two values that a real unit
 * probably has, and at the most that there is. */
static const struct reading table[READINGS] = {
    {"label", {"wait", "fault"}, MEMBER(label), .clause = "C7", .about = "a jump or call to a label not in memory is a fault"},
    {"fault-exit", {"reset", "new"}, MEMBER(fault_exit), .clause = "C3, E1",
     .about = "commands stored after a fault are executed, and the fault ends when they begin"},
    {"hold-exit", {"new", "latch"}, MEMBER(hold_exit), .clause = "C3",
     .about = "after K only C75 or \\ resumes: commands stored meanwhile wait after the rest"},
    {"x-after", {"armed", "once"}, MEMBER(x_after), .clause = "C6", .about = "X acts only once"},
    {"guard-start", {"none", "step"}, MEMBER(guard_start), .clause = "C5",
     .about = "a motion starts even if its M or N is true, and is stopped in the next slot"},
    {"v-alone", {"blanks", "first"}, MEMBER(v_alone), .clause = "C3, C4",
     .about = "V, K and C75 are stand-alone only as the whole text, from its first byte on"},
    {"y-eleventh", {"run", "y"}, MEMBER(y_eleventh), .clause = "E1", .about = "the eleventh Y is itself the error, in its slot"},
    {"reset-t41", {"keep", "clear"}, MEMBER(reset_t41), .clause = "C1", .about = "\\ of any motor also switches T41 off"},
    {"negative-position", {"yes", "no"}, MEMBER(negative_position), .clause = "section 5", .about = "=-n is a bad value"},
    {"speed-change", .most = 2000, MEMBER(speed_change), .tried = {1, 500, 2000}, .clause = "C4",
     .about = "the time from a command that changes the speed to the change"},
    {"planning", .most = 2000, MEMBER(planning), .tried = {1, 10, 100, 2000}, .clause = "R1",
     .about = "from the slot of a motion command to the slot in which the motion starts"},
    {"input-filter", .most = 100, MEMBER(input_filter), .tried = {1, 10, 100}, .clause = "U2",
     .about = "an input counts when it has been constant for this time"},
    {"store-time", .most = 1000, MEMBER(store_time), .tried = {1, 100, 1000}, .clause = "P6",
     .about = "Store Flash is answered after this time; no motor executes a command meanwhile"},
};

/* ---- Values --------------------------------------------------------------------------------------------------------- */

const char *readings_name(unsigned at)
{
    return table[at].name;
}

static bool is_time(const struct reading *reading)
{
    return reading->value[0] == NULL;
}

const char *readings_value_name(unsigned at, unsigned value, char text[16])
{
    if (!is_time(&table[at]))
        return table[at].value[value != 0];
    snprintf(text, 16, "%ums", value);
    return text;
}

unsigned readings_get(const struct rkm04_readings *readings, unsigned at)
{
    const uint8_t *member = (const uint8_t *)readings + table[at].member;
    uint16_t time;
    if (table[at].size == 1)
        return *member;
    memcpy(&time, member, sizeof time);
    return time;
}

void readings_put(struct rkm04_readings *readings, unsigned at, unsigned value)
{
    uint8_t *member = (uint8_t *)readings + table[at].member;
    uint16_t time = (uint16_t)value;
    if (table[at].size == 1)
        *member = (uint8_t)value;
    else
        memcpy(member, &time, sizeof time);
}

unsigned readings_tried(unsigned at, unsigned values[READINGS_TRIED_MAX])
{
    unsigned count = 0;
    values[0] = 1;
    if (!is_time(&table[at]))
        return 1;
    for (; count < READINGS_TRIED_MAX && table[at].tried[count] > 0; count++)
        values[count] = table[at].tried[count];
    return count;
}

bool readings_same(const struct rkm04_readings *left, const struct rkm04_readings *right)
{
    for (unsigned at = 0; at < READINGS; at++)
        if (readings_get(left, at) != readings_get(right, at))
            return false;
    return true;
}

/* ---- Errors --------------------------------------------------------------------------------------------------------- */

/* How many characters are to be changed, added or removed to make one name of the other. */
static unsigned distance(const char *name, const char *text, size_t length)
{
    unsigned row[FOUND_MAX + 1];
    if (length > FOUND_MAX)
        return FOUND_MAX;
    for (unsigned i = 0; i <= length; i++)
        row[i] = i;
    for (unsigned line = 1; name[line - 1] != '\0'; line++) {
        unsigned before = row[0];
        row[0] = line;
        for (size_t i = 1; i <= length; i++) {
            unsigned changed = before + (name[line - 1] != text[i - 1]);
            before = row[i];
            row[i] = row[i] < row[i - 1] ? row[i] + 1 : row[i - 1] + 1;
            row[i] = row[i] < changed ? row[i] : changed;
        }
    }
    return row[length];
}

static bool unknown_name(const char *name, size_t length, char error[READINGS_ERROR_SIZE])
{
    unsigned nearest = 0, least = FOUND_MAX;
    int shown = length < FOUND_MAX ? (int)length : FOUND_MAX;
    for (unsigned at = 0; at < READINGS; at++) {
        unsigned far = distance(table[at].name, name, length);
        if (far < least) {
            least = far;
            nearest = at;
        }
    }
    int end = snprintf(error, READINGS_ERROR_SIZE, "unknown reading `%.*s'; ", shown, name);
    if (least < FOUND_MAX && least <= 1 + length / 3) {
        snprintf(error + end, READINGS_ERROR_SIZE - (size_t)end, "did you mean `%s'?", table[nearest].name);
        return false;
    }
    for (unsigned at = 0; at < READINGS; at++)
        end += snprintf(error + end, READINGS_ERROR_SIZE - (size_t)end, "%s%s", at > 0 ? ", " : "readings are: ", table[at].name);
    return false;
}

static bool wrong_value(const struct reading *reading, const char *value, size_t length, char error[READINGS_ERROR_SIZE])
{
    int shown = length < FOUND_MAX ? (int)length : FOUND_MAX;
    if (is_time(reading))
        snprintf(error, READINGS_ERROR_SIZE, "%s: expected whole ms from 0 to %u, as in 5 or 5ms, found `%.*s'", reading->name,
                 reading->most, shown, value);
    else
        snprintf(error, READINGS_ERROR_SIZE, "%s: expected %s or %s, found `%.*s'", reading->name, reading->value[0],
                 reading->value[1], shown, value);
    return false;
}

/* ---- Reading -------------------------------------------------------------------------------------------------------- */

static bool is_word(const char *word, const char *text, size_t length)
{
    return strlen(word) == length && memcmp(word, text, length) == 0;
}

/* The reading of that name; READINGS: there is none. */
static unsigned find(const char *name, size_t length)
{
    unsigned at = 0;
    while (at < READINGS && !is_word(table[at].name, name, length))
        at++;
    return at;
}

/* Whole ms, with a unit or without. */
static bool read_time(const char *text, size_t length, unsigned most, unsigned *value)
{
    uint64_t ticks = 0;
    size_t wrong, digits = 0;
    while (digits < length && text[digits] >= '0' && text[digits] <= '9' && ticks <= most * 1000u) {
        ticks = ticks * 10 + (uint64_t)(text[digits] - '0') * 1000;
        digits++;
    }
    bool plain = digits > 0 && digits == length;
    if (!plain && time_value_read(text, length, &ticks, &wrong) != NULL)
        return false;
    *value = ticks <= most * 1000u ? (unsigned)(ticks / 1000) : 0;
    return ticks <= most * 1000u && ticks % 1000 == 0;
}

static bool read_value(struct rkm04_readings *readings, unsigned at, const char *text, size_t length)
{
    const struct reading *reading = &table[at];
    unsigned value = 0;
    bool known = is_time(reading) ? read_time(text, length, reading->most, &value)
                                  : is_word(reading->value[0], text, length) || is_word(reading->value[1], text, length);
    if (!known)
        return false;
    if (!is_time(reading))
        value = is_word(reading->value[1], text, length) ? 1 : 0;
    readings_put(readings, at, value);
    return true;
}

/* One NAME=VALUE of `length` bytes. */
static bool read_one(struct rkm04_readings *readings, readings_set *named, const char *text, size_t length, char *error)
{
    const char *equals = memchr(text, '=', length);
    if (equals == NULL) {
        const char *quote = length > 0 ? "`" : "nothing", *end = length > 0 ? "'" : "";
        int shown = length < FOUND_MAX ? (int)length : FOUND_MAX;
        snprintf(error, READINGS_ERROR_SIZE, "expected NAME=VALUE, found %s%.*s%s", quote, shown, text, end);
        return false;
    }
    size_t name = (size_t)(equals - text), rest = length - name - 1;
    unsigned at = find(text, name);
    if (at == READINGS)
        return unknown_name(text, name, error);
    if (*named >> at & 1u) {
        snprintf(error, READINGS_ERROR_SIZE, "%s is given twice", table[at].name);
        return false;
    }
    *named = *named | 1u << at;
    return read_value(readings, at, equals + 1, rest) || wrong_value(&table[at], equals + 1, rest, error);
}

bool readings_read(struct rkm04_readings *readings, readings_set *named, const char *text, char error[READINGS_ERROR_SIZE])
{
    struct rkm04_readings read = *readings;
    readings_set names = *named;
    for (;;) {
        size_t length = strcspn(text, ",");
        if (!read_one(&read, &names, text, length, error))
            return false;
        if (text[length] == '\0')
            break;
        text += length + 1;
    }
    *readings = read;
    *named = names;
    return true;
}

bool readings_read_json(struct rkm04_readings *readings, const json_t *json, char error[READINGS_ERROR_SIZE])
{
    struct rkm04_readings read = *readings;
    const char *name;
    const json_t *value;
    if (!json_is_object(json)) {
        snprintf(error, READINGS_ERROR_SIZE, "expected an object, as in {\"hold-exit\":\"latch\"}");
        return false;
    }
    json_object_foreach((json_t *)json, name, value) {
        char number[24] = "";
        unsigned at = find(name, strlen(name));
        if (json_is_integer(value))
            snprintf(number, sizeof number, "%" JSON_INTEGER_FORMAT, json_integer_value(value));
        const char *text = json_is_string(value) ? json_string_value(value) : number;
        if (at == READINGS)
            return unknown_name(name, strlen(name), error);
        if (!read_value(&read, at, text, strlen(text)))
            return wrong_value(&table[at], text, strlen(text), error);
    }
    *readings = read;
    return true;
}

bool readings_read_map(struct rkm04_readings *readings, readings_set *named, const struct config_node *map)
{
    bool ok = true;
    char error[READINGS_ERROR_SIZE];
    if (config_type(map) != CONFIG_MAP)
        return config_error(map, "expected readings, a map as in {hold-exit: latch}");
    for (size_t i = 0; i < config_count(map); i++) {
        const struct config_node *value = config_at(map, i);
        const char *name = config_key(map, i), *text = config_type(value) == CONFIG_TEXT ? config_text(value) : "";
        unsigned at = find(name, strlen(name));
        if (at == READINGS) {
            unknown_name(name, strlen(name), error);
            ok = config_key_error(map, i, "%s", error);
        } else if (!read_value(readings, at, text, strlen(text))) {
            wrong_value(&table[at], text, strlen(text), error);
            ok = config_error(value, "%s", error);
        } else {
            *named = *named | 1u << at;
        }
    }
    return ok;
}

/* ---- Writing -------------------------------------------------------------------------------------------------------- */

const char *readings_text(const struct rkm04_readings *readings, char text[READINGS_TEXT_SIZE])
{
    size_t end = 0;
    char value[16];
    text[0] = '\0';
    for (unsigned at = 0; at < READINGS; at++)
        if (readings_get(readings, at) != 0)
            end += (size_t)snprintf(text + end, READINGS_TEXT_SIZE - end, "%s%s=%s", end > 0 ? "," : "", table[at].name,
                                    readings_value_name(at, readings_get(readings, at), value));
    return text;
}

json_t *readings_json(const struct rkm04_readings *readings)
{
    json_t *json = json_object();
    for (unsigned at = 0; json != NULL && at < READINGS; at++) {
        unsigned value = readings_get(readings, at);
        json_t *item = is_time(&table[at]) ? json_integer((json_int_t)value) : json_string(table[at].value[value != 0]);
        if (value == 0) {
            json_decref(item);
        } else if (json_object_set_new(json, table[at].name, item) != 0) {
            json_decref(json);
            return NULL;
        }
    }
    return json;
}

void readings_list(FILE *out)
{
    for (unsigned at = 0; at < READINGS; at++) {
        char values[32];
        if (is_time(&table[at]))
            snprintf(values, sizeof values, "0 to %u ms", table[at].most);
        else
            snprintf(values, sizeof values, "%s, %s", table[at].value[0], table[at].value[1]);
        fprintf(out, "%-18s %-14s %s: %s\n", table[at].name, values, table[at].clause, table[at].about);
    }
}
