/* SPDX-License-Identifier: MIT */
#include "texts.h"

#include <check.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const struct limits numbers[NUMBER_ROWS] = {
    {'@', 1, 1, 80},       {'A', 1, 1, 60000},      {'B', 1, 1, 16000000}, {'C', 2, 1, 8},   {'C', 2, 40, 58},
    {'C', 2, 75, 75},      {'C', 2, 80, 95},        {'C', 2, 100, 100},    {'F', 1, 1, 16000000},
    {'G', 1, 1, 2000000000}, {'J', 1, 1, 80},       {'L', 1, 1, 255},      {'M', 2, 1, 8},   {'N', 2, 1, 8},
    {'O', 2, 1, 8},        {'O', 2, 80, 95},        {'S', 1, 1, 2000},     {'T', 2, 1, 8},   {'T', 2, 40, 58},
    {'T', 2, 80, 95},      {'V', 1, 1, 16000},      {'W', 1, 1, 16000000}, {'X', 2, 1, 8},   {'Z', 2, 1, 8},
    {'Z', 2, 80, 95},      {')', 2, 1, 8},          {'(', 2, 1, 8},        {'\'', 1, 1, 80},
    {'=', 1, -2000000000, 2000000000},
};

bool legal(char op, int64_t value)
{
    for (size_t i = 0; i < NUMBER_ROWS; i++)
        if (numbers[i].op == op && numbers[i].low <= value && value <= numbers[i].high)
            return true;
    return false;
}

bool legal_argument(uint8_t op, uint32_t argument)
{
    if (op != 0 && strchr(PLAIN_COMMANDS, op))
        return argument == 0;
    if (op == 'G' && (argument == RKM04_G_FORWARD || argument == RKM04_G_BACK))
        return true;
    return legal((char)op, op == '=' && argument > INT32_MAX ? (int64_t)argument - (INT64_C(1) << 32) : argument);
}

#define TEXT_ROOM 200000

struct rkm04_reader begin_text(const void *text, size_t length)
{
    static uint8_t *room;
    if (room == NULL)
        room = malloc(TEXT_ROOM);
    if (room == NULL || length > TEXT_ROOM)
        ck_abort_msg("no room for a text of %zu bytes", length);
    uint8_t *copy = room + TEXT_ROOM - length;
    memcpy(copy, text, length);
    struct rkm04_reader reader;
    rkm04_read_begin(&reader, length == 0 ? NULL : copy, length);
    return reader;
}

bool is_command(const void *text, size_t length, char op, uint32_t argument)
{
    struct rkm04_reader reader = begin_text(text, length);
    struct rkm04_command command = UNTOUCHED;
    return rkm04_read(&reader, &command) == RKM04_READ_COMMAND && command.op == (uint8_t)op && command.argument == argument &&
           rkm04_read(&reader, &command) == RKM04_READ_END && reader.at == length;
}

bool is_error(const char *text, enum rkm04_read what, size_t start, size_t wrong)
{
    struct rkm04_reader reader = begin_text(text, strlen(text));
    struct rkm04_command command = UNTOUCHED;
    return rkm04_read(&reader, &command) == what && reader.start == start && reader.wrong == wrong && reader.at > start &&
           reader.at <= reader.length && command.op == UNTOUCHED.op && command.argument == UNTOUCHED.argument;
}

void expect_command(const char *text, char op, uint32_t argument)
{
    if (!is_command(text, strlen(text), op, argument))
        ck_abort_msg("\"%s\" is not the command %c %" PRIu32 " but: %s", text, op, argument, reading_of(text));
}

void expect_error(const char *text, enum rkm04_read what, size_t start, size_t wrong)
{
    if (!is_error(text, what, start, wrong))
        ck_abort_msg("\"%s\" is not error %d of the command at %zu seen at %zu but: %s", text, what, start, wrong,
                     reading_of(text));
}

const char *reading_of(const char *text)
{
    static char line[1000];
    struct rkm04_reader reader = begin_text(text, strlen(text));
    struct rkm04_command command;
    enum rkm04_read got;
    size_t at = 0;
    line[0] = 0;
    while ((got = rkm04_read(&reader, &command)) != RKM04_READ_END && at < sizeof line - 60) {
        char item[50], canonical[RKM04_COMMAND_TEXT_MAX];
        if (got == RKM04_READ_COMMAND)
            snprintf(item, sizeof item, "%.*s", (int)rkm04_format(command, canonical), canonical);
        else if (got == RKM04_READ_UNKNOWN)
            snprintf(item, sizeof item, "?%zu", reader.start);
        else
            snprintf(item, sizeof item, "!%zu:%zu", reader.start, reader.wrong);
        at += (size_t)snprintf(line + at, sizeof line - at, at == 0 ? "%s" : " %s", item);
    }
    return line;
}
