/* SPDX-License-Identifier: MIT */
#include "code.h"

#include <stdlib.h>
#include <string.h>

#include "text/text.h"

void code_begin(struct code *code, const struct program_source *sources, size_t count)
{
    *code = (struct code){.sources = sources, .source_count = count};
}

void code_free(struct code *code)
{
    free(code->commands);
    free(code->comments);
    *code = (struct code){0};
}

/* Room for one more element. Returns the array, or NULL: out of memory. */
static void *grow(void *array, size_t count, size_t *room, size_t size)
{
    if (count < *room)
        return array;
    size_t more = *room == 0 ? 64 : 2 * *room;
    void *grown = realloc(array, more * size);
    if (grown != NULL)
        *room = more;
    return grown;
}

static bool add_command(struct code *code, size_t source, const struct rkm04_reader *reader, struct rkm04_command command)
{
    struct code_command *grown = grow(code->commands, code->count, &code->command_room, sizeof *grown);
    if (grown == NULL)
        return false;
    code->commands = grown;
    grown[code->count++] = (struct code_command){.command = command,
                                                 .source = (uint32_t)source,
                                                 .offset = (uint32_t)reader->start,
                                                 .length = (uint32_t)(reader->at - reader->start)};
    if (command.op == '\\') {
        code->first = code->count;
        code->has_reset = true;
    }
    return true;
}

/* The comments between two commands, where the reader has found nothing else but blanks. `after`: a command precedes. */
static bool add_comments(struct code *code, size_t source, const char *text, size_t from, size_t to, bool after)
{
    for (size_t at = from; at < to; at++) {
        if (text[at] == '\n')
            after = false;
        if (text[at] != '{')
            continue;
        const char *end = memchr(text + at, '}', to - at);
        struct code_comment *grown = grow(code->comments, code->comment_count, &code->comment_room, sizeof *grown);
        if (grown == NULL)
            return false;
        code->comments = grown;
        size_t length = end == NULL ? to - at : (size_t)(end - (text + at)) + 1;
        grown[code->comment_count++] = (struct code_comment){(uint32_t)source, (uint32_t)at, (uint32_t)length, after};
        if (memchr(text + at, '\n', length) != NULL)
            after = false;
        at += length - 1;
    }
    return true;
}

static bool is_request(struct rkm04_command command)
{
    return command.op == 'K' || (command.op == 'C' && command.argument == 75);
}

bool code_read(struct code *code, size_t source, const char *text, code_notice *notice, void *context)
{
    struct rkm04_reader reader;
    rkm04_read_begin(&reader, text, code->sources[source].length);
    for (;;) {
        struct rkm04_command command = {0};
        const size_t before = reader.at;
        const enum rkm04_read found = diagnose_read(&reader, &command);
        if (!add_comments(code, source, text, before, reader.start, before > 0))
            return false;
        if (found == RKM04_READ_END)
            return true;
        if (found == RKM04_READ_COMMAND && !is_request(command)) {
            if (!add_command(code, source, &reader, command))
                return false;
        } else if (notice != NULL) {
            notice(context, source, &reader, found, command);
        }
    }
}

struct diagnostic code_place(const struct code *code, size_t command, size_t last)
{
    const struct code_command *from = &code->commands[command], *to = &code->commands[last];
    return (struct diagnostic){.source = from->source,
                               .offset = from->offset,
                               .length = to->offset + to->length - from->offset,
                               .severity = DIAGNOSTIC_WARNING};
}
