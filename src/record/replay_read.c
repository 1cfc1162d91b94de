/* SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "record_line.h"
#include "replay_state.h"
#include "text/text.h"

/* ---- What is wrong -------------------------------------------------------------------------------------------------- */

static size_t skip_string(const char *text, size_t length, size_t at)
{
    for (at++; at < length && text[at] != '"'; at++)
        at += text[at] == '\\';
    return at;
}

/* The column of the value of a key of the outermost object. */
static size_t column_of(const struct replay *replay, const char *key)
{
    const char *text = replay->lines.line;
    size_t wanted = strlen(key), depth = 0;
    for (size_t at = 0; at < replay->lines.length; at++) {
        if (text[at] == '{' || text[at] == '[')
            depth++;
        else if (text[at] == '}' || text[at] == ']')
            depth--;
        if (text[at] != '"')
            continue;
        size_t end = skip_string(text, replay->lines.length, at);
        size_t colon = end + 1u;
        while (colon < replay->lines.length && (text[colon] == ' ' || text[colon] == '\t'))
            colon++;
        if (depth == 1 && end - at - 1u == wanted && memcmp(text + at + 1, key, wanted) == 0 && colon < replay->lines.length &&
            text[colon] == ':')
            return colon + 2u;
        at = end;
    }
    return 1;
}

static void finish_wrong(struct replay *replay, size_t column, const char *format, va_list list)
{
    uint64_t line = replay->lines.count > 0 ? replay->lines.count : 1u;
    replay_finish_wrong(&replay->result, replay->lines.name, line, column, format, list);
}

bool replay_no_memory(struct replay *replay)
{
    return replay_finish_no_memory(&replay->result);
}

bool replay_wrong(struct replay *replay, const char *key, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    finish_wrong(replay, key ? column_of(replay, key) : 1u, format, list);
    va_end(list);
    return false;
}

static bool wrong_at(struct replay *replay, size_t column, const char *format, ...) __attribute__((format(printf, 3, 4)));

static bool wrong_at(struct replay *replay, size_t column, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    finish_wrong(replay, column, format, list);
    va_end(list);
    return false;
}

/* ---- Lines ---------------------------------------------------------------------------------------------------------- */

static bool make_room(struct replay *replay)
{
    if (replay->lines.length < replay->lines.room)
        return true;
    size_t room = 2 * replay->lines.room + 256u;
    char *line = realloc(replay->lines.line, room);
    if (!line)
        return replay_no_memory(replay);
    replay->lines.line = line;
    replay->lines.room = room;
    return true;
}

/* Read a line without its end. Returns false at the end of the file, which may be in the middle of a line, or if it is wrong. */
static bool read_line(struct replay *replay)
{
    int c;
    replay->lines.length = 0;
    replay->lines.count++;
    while ((c = getc_unlocked(replay->lines.in)) != EOF && c != '\n') {
        if (replay->lines.length == RECORD_LINE_MAX)
            return wrong_at(replay, RECORD_LINE_MAX, "expected a line of at most %u bytes", RECORD_LINE_MAX);
        if (!make_room(replay))
            return false;
        replay->lines.line[replay->lines.length++] = (char)c;
    }
    if (c == '\n')
        return true;
    if (ferror(replay->lines.in))
        return wrong_at(replay, replay->lines.length + 1u, "cannot continue reading");
    if (replay->lines.length > 0)
        replay_set_note(&replay->result, "line %" PRIu64 ", the last one, is incomplete: the lines before it were "
                     "replayed",
                 replay->lines.count);
    replay->lines.count--;
    return false;
}

void replay_lines_begin(struct replay *replay, const char *name, FILE *in)
{
    replay->lines.name = name;
    replay->lines.in = in;
}

void replay_lines_free(struct replay *replay)
{
    free(replay->lines.line);
    free(replay->lines.hex);
    free(replay->lines.embedded);
    json_decref(replay->lines.json);
}

void replay_return_line(struct replay *replay)
{
    replay->lines.again = true;
}

bool replay_next_line(struct replay *replay)
{
    json_error_t error;
    if (replay->lines.again) {
        replay->lines.again = false;
        return true;
    }
    json_decref(replay->lines.json);
    replay->lines.json = NULL;
    if (!read_line(replay))
        return false;
    replay->lines.json = json_loadb(replay->lines.length > 0 ? replay->lines.line : "", replay->lines.length,
                                    JSON_REJECT_DUPLICATES, &error);
    if (replay->lines.count == 1 && (replay->lines.length == 0 || replay->lines.line[0] != '{'))
        return wrong_at(replay, 1, "expected a recording, which begins with {\"rkm04_record\":1,: `rkm04 serve --record FILE' "
                                   "makes one");
    if (!replay->lines.json)
        return wrong_at(replay, error.position > 0 ? (size_t)error.position : 1u, "expected a JSON object: %s", error.text);
    if (!json_is_object(replay->lines.json))
        return wrong_at(replay, 1, "expected a JSON object, as in {\"t\":0,\"in\":\"7e\"}");
    return true;
}

/* Append the present line to a text. Returns false if there is no room (replay->result.ended). */
static bool append_line(struct replay *replay, char **text, size_t *length, size_t *room)
{
    size_t more = replay->lines.length + 1u;
    if (more > RECORD_EMBEDDED_MAX - *length)
        return wrong_at(replay, 1, "expected an embedded file of at most %u bytes", RECORD_EMBEDDED_MAX);
    if (more > *room - *length) {
        char *grown = realloc(*text, 2 * *room + more);
        if (!grown)
            return replay_no_memory(replay);
        *text = grown;
        *room = 2 * *room + more;
    }
    memcpy(*text + *length, replay->lines.line, replay->lines.length);
    *length += more;
    (*text)[*length - 1u] = '\n';
    return true;
}

bool replay_read_embedded(struct replay *replay, uint64_t lines)
{
    size_t length = 0, room = 0;
    char *text = NULL;
    for (uint64_t i = 0; i < lines; i++) {
        if (read_line(replay) && append_line(replay, &text, &length, &room))
            continue;
        if (!replay->result.ended)
            replay_set_note(&replay->result, "the embedded file at the end is incomplete: the lines before it were "
                 "replayed");
        free(text);
        return false;
    }
    free(replay->lines.embedded);
    replay->lines.embedded = text;
    replay->lines.embedded_length = length;
    return true;
}

void replay_drop_embedded(struct replay *replay)
{
    free(replay->lines.embedded);
    replay->lines.embedded = NULL;
}

/* ---- Values --------------------------------------------------------------------------------------------------------- */

bool replay_number(struct replay *replay, const char *key, uint64_t low, uint64_t high, uint64_t missing, uint64_t *value)
{
    const json_t *given = json_object_get(replay->lines.json, key);
    if (!given && missing != DEVICE_NEVER) {
        *value = missing;
        return true;
    }
    if (json_is_integer(given) && json_integer_value(given) >= 0) {
        *value = (uint64_t)json_integer_value(given);
        if (*value >= low && *value <= high)
            return true;
    }
    if (low == high)
        return replay_wrong(replay, key, "expected \"%s\": %" PRIu64, key, low);
    return replay_wrong(replay, key, "expected \"%s\", a whole number from %" PRIu64 " to %" PRIu64, key, low, high);
}

bool replay_flag(struct replay *replay, const char *key, bool missing, bool *value)
{
    const json_t *given = json_object_get(replay->lines.json, key);
    *value = given ? json_is_true(given) : missing;
    return !given || json_is_boolean(given) || replay_wrong(replay, key, "expected \"%s\", true or false", key);
}

const char *replay_string(struct replay *replay, const char *key)
{
    const char *text = json_string_value(json_object_get(replay->lines.json, key));
    if (!text)
        replay_wrong(replay, key, "expected \"%s\", a string", key);
    return text;
}

static int digit(char c)
{
    return c <= '9' ? c - '0' : c - 'a' + 10;
}

const uint8_t *replay_bytes(struct replay *replay, const char *key, size_t most, size_t *length)
{
    const json_t *value = json_object_get(replay->lines.json, key);
    const char *text = json_string_value(value);
    size_t count = json_string_length(value);
    if (!text || count == 0 || count % 2 != 0 || count / 2 > most || text[strspn(text, "0123456789abcdef")] != '\0') {
        replay_wrong(replay, key, "expected \"%s\", 1 to %zu bytes of two hexadecimal digits 0-9a-f", key, most);
        return NULL;
    }
    uint8_t *bytes = realloc(replay->lines.hex, count / 2);
    if (!bytes) {
        replay_no_memory(replay);
        return NULL;
    }
    replay->lines.hex = bytes;
    for (size_t i = 0; i < count / 2; i++)
        bytes[i] = (uint8_t)(digit(text[2 * i]) << 4 | digit(text[2 * i + 1]));
    *length = count / 2;
    return bytes;
}

bool replay_text_of(struct replay *replay, const char *name, size_t most, char **text)
{
    char hex_name[40];
    size_t length;
    snprintf(hex_name, sizeof hex_name, "%s_hex", name);
    *text = NULL;
    if (json_object_get(replay->lines.json, hex_name)) {
        const uint8_t *bytes = replay_bytes(replay, hex_name, most, &length);
        if (!bytes)
            return false;
        *text = strndup((const char *)bytes, length);
    } else if (json_object_get(replay->lines.json, name)) {
        const char *given = replay_string(replay, name);
        if (!given)
            return false;
        if (strlen(given) > most)
            return replay_wrong(replay, name, "expected \"%s\", a string of at most %zu bytes", name, most);
        *text = strdup(given);
    } else {
        return true;
    }
    return *text || replay_no_memory(replay);
}

bool replay_keys(struct replay *replay, const char *const *names)
{
    const char *key;
    json_t *value;
    char list[300] = "";
    for (size_t i = 0; names[i]; i++)
        snprintf(list + strlen(list), sizeof list - strlen(list), i > 0 ? ", %s" : "%s", names[i]);
    json_object_foreach(replay->lines.json, key, value) {
        size_t i = 0;
        while (names[i] && strcmp(names[i], key) != 0)
            i++;
        if (!names[i])
            return replay_wrong(replay, key, "unexpected \"%.60s\" in this line: expected %s", key, list);
    }
    return true;
}
