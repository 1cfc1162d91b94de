/* SPDX-License-Identifier: MIT */
/* fuzz_parse.c: any bytes as a program text (section 5). Reading always gets on; what is read is valid; its canonical text,
 * with blanks, without, and with comments, is read as the same commands (P8). */
#include <string.h>

#include <rkm04/text.h>

#include "fuzz.h"

#define COMMANDS_MAX 4096

static struct rkm04_command commands[COMMANDS_MAX];
static char canonical[COMMANDS_MAX * (RKM04_COMMAND_TEXT_MAX + 8)];

/* The text of all commands with `between` after each is read as the same commands. */
static void check_canonical(size_t count, const char *between)
{
    struct rkm04_reader reader;
    struct rkm04_command command;
    size_t length = 0;
    for (size_t i = 0; i < count; i++) {
        length += rkm04_format(commands[i], canonical + length);
        memcpy(canonical + length, between, strlen(between));
        length += strlen(between);
    }
    rkm04_read_begin(&reader, canonical, length);
    for (size_t i = 0; i < count; i++) {
        FUZZ_CHECK(rkm04_read(&reader, &command) == RKM04_READ_COMMAND, "command %zu of %.*s", i, (int)length, canonical);
        FUZZ_CHECK(command.op == commands[i].op && command.argument == commands[i].argument, "command %zu of %.*s", i,
                   (int)length, canonical);
    }
    FUZZ_CHECK(rkm04_read(&reader, &command) == RKM04_READ_END, "more than %zu commands in %.*s", count, (int)length, canonical);
}

static void check_command(struct rkm04_command command)
{
    char text[RKM04_COMMAND_TEXT_MAX];
    struct rkm04_range ranges[RKM04_RANGES_MAX];
    enum rkm04_form form;
    size_t length;
    FUZZ_CHECK(rkm04_command_valid(command), "%c %u", command.op, (unsigned)command.argument);
    FUZZ_CHECK(rkm04_form_of(command.op, &form, ranges) >= 0, "%c has no form", command.op);
    length = rkm04_format(command, text);
    FUZZ_CHECK(length >= 1 && length <= sizeof text && (uint8_t)text[0] == command.op, "%.*s", (int)length, text);
}

/* Reads on after errors, too. */
static void read_all(const uint8_t *data, size_t size, size_t *count)
{
    struct rkm04_reader reader;
    *count = 0;
    rkm04_read_begin(&reader, data, size);
    for (;;) {
        size_t before = reader.at;
        struct rkm04_command command = {0, 0};
        enum rkm04_read found = rkm04_read(&reader, &command);
        FUZZ_CHECK(reader.at <= size, "at %zu of %zu", reader.at, size);
        if (found == RKM04_READ_END)
            return;
        FUZZ_CHECK(reader.at > before, "no way on at %zu", before);
        FUZZ_CHECK(reader.start >= before && reader.start < reader.at, "start %zu, at %zu", reader.start, reader.at);
        if (found == RKM04_READ_COMMAND) {
            check_command(command);
            if (*count < COMMANDS_MAX)
                commands[(*count)++] = command;
            continue;
        }
        FUZZ_CHECK(reader.wrong >= reader.start && reader.wrong <= size, "wrong at %zu", reader.wrong);
    }
}

/* A command out of the blue, as a damaged flash could hold: if it is valid, it has a text. */
static void check_stored(const uint8_t *data, size_t size)
{
    struct rkm04_command command = {0, 0};
    if (size < 5)
        return;
    command.op = data[0];
    memcpy(&command.argument, data + 1, 4);
    if (!rkm04_command_valid(command))
        return;
    commands[0] = command;
    check_command(command);
    check_canonical(1, " ");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    size_t count;
    read_all(data, size, &count);
    check_canonical(count, " ");
    check_canonical(count, "");
    check_canonical(count, " {a}\n");
    check_stored(data, size);
    return 0;
}
