/* SPDX-License-Identifier: MIT */
#include "token.h"

#include <string.h>

#include "text/text.h"

void token_begin(struct token_reader *tokens, const char *text, size_t length)
{
    *tokens = (struct token_reader){.has_ahead = false};
    rkm04_read_begin(&tokens->reader, text, length);
}

static void read_ahead(struct token_reader *tokens)
{
    static const enum token_kind kinds[] = {
        [RKM04_READ_END] = TOKEN_END,
        [RKM04_READ_COMMAND] = TOKEN_COMMAND,
        [RKM04_READ_BAD_VALUE] = TOKEN_ERROR,
        [RKM04_READ_UNKNOWN] = TOKEN_ERROR,
    };
    struct token *ahead = &tokens->ahead;
    tokens->gap = tokens->reader.at;
    *ahead = (struct token){.kind = TOKEN_END};
    ahead->found = diagnose_read(&tokens->reader, &ahead->command);
    ahead->kind = kinds[ahead->found];
    ahead->offset = tokens->reader.start;
    ahead->length = tokens->reader.at - tokens->reader.start;
    tokens->has_ahead = true;
}

struct token token_next(struct token_reader *tokens)
{
    const char *text = (const char *)tokens->reader.text;
    size_t lines = 0;
    bool returns = false;
    if (!tokens->has_ahead)
        read_ahead(tokens);
    for (; tokens->gap < tokens->ahead.offset; tokens->gap++) {
        const size_t at = tokens->gap;
        if (text[at] == '\n' && lines++ == 0)
            returns = at > 0 && text[at - 1] == '\r';
        if (text[at] != '{')
            continue;
        const char *end = memchr(text + at, '}', tokens->ahead.offset - at);
        const size_t length = end == NULL ? tokens->ahead.offset - at : (size_t)(end - (text + at)) + 1;
        tokens->gap += length;
        return (struct token){
            .kind = TOKEN_COMMENT, .offset = at, .length = length, .lines = lines, .returns = returns};
    }
    tokens->has_ahead = tokens->ahead.kind == TOKEN_END;
    tokens->ahead.lines = lines;
    tokens->ahead.returns = returns;
    return tokens->ahead;
}
