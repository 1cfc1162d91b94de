/* SPDX-License-Identifier: MIT */
#include "code.h"

#include <stdlib.h>
#include <string.h>

#include "token.h"

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

static bool add_command(struct code *code, size_t source, const struct token *token)
{
    struct code_command *grown = grow(code->commands, code->count, &code->command_room, sizeof *grown);
    if (grown == NULL)
        return false;
    code->commands = grown;
    grown[code->count++] = (struct code_command){.command = token->command,
                                                 .source = (uint32_t)source,
                                                 .offset = (uint32_t)token->offset,
                                                 .length = (uint32_t)token->length};
    if (token->command.op == '\\') {
        code->first = code->count;
        code->has_reset = true;
    }
    return true;
}

static bool add_comment(struct code *code, size_t source, const struct token *token, bool after)
{
    struct code_comment *grown = grow(code->comments, code->comment_count, &code->comment_room, sizeof *grown);
    if (grown == NULL)
        return false;
    code->comments = grown;
    grown[code->comment_count++] =
        (struct code_comment){(uint32_t)source, (uint32_t)token->offset, (uint32_t)token->length, after};
    return true;
}

static bool is_request(struct rkm04_command command)
{
    return command.op == 'K' || (command.op == 'C' && command.argument == 75);
}

bool code_read(struct code *code, size_t source, const char *text, code_notice *notice, void *context)
{
    struct token_reader tokens;
    bool after = false; /* a command precedes in the line */
    token_begin(&tokens, text, code->sources[source].length);
    for (;;) {
        const struct token token = token_next(&tokens);
        const char *at = text + token.offset;
        after = after && token.lines == 0;
        if (token.kind == TOKEN_END)
            return true;
        if (token.kind == TOKEN_COMMENT) {
            if (!add_comment(code, source, &token, after))
                return false;
            after = after && memchr(at, '\n', token.length) == NULL;
            continue;
        }
        after = true;
        if (token.kind == TOKEN_COMMAND && !is_request(token.command)) {
            if (!add_command(code, source, &token))
                return false;
        } else if (notice != NULL) {
            notice(context, source, &tokens.reader, token.found, token.command);
        }
    }
}

struct diagnostic code_place(const struct code *code, size_t command, size_t last)
{
    const struct code_command *from = &code->commands[command], *to = &code->commands[last];
    while (to->source != from->source)
        to--;
    return (struct diagnostic){.source = from->source,
                               .offset = from->offset,
                               .length = to->offset + to->length - from->offset,
                               .severity = DIAGNOSTIC_WARNING};
}
