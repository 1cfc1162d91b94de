/* SPDX-License-Identifier: MIT */
/* token.h: a program text as commands, comments and errors in their order. Commands are read by the core's reader; the comments
 * are what is between them. */
#ifndef RKM04_PROGRAM_TOOLS_TOKEN_H
#define RKM04_PROGRAM_TOOLS_TOKEN_H

#include <stdbool.h>
#include <stddef.h>

#include <rkm04/text.h>

enum token_kind { TOKEN_END, TOKEN_COMMAND, TOKEN_COMMENT, TOKEN_ERROR };

struct token {
    enum token_kind kind;
    struct rkm04_command command; /* TOKEN_COMMAND */
    enum rkm04_read found;        /* TOKEN_ERROR; the reader of the token_reader has the rest */
    size_t offset, length;        /* a comment with its braces */
    size_t lines;                 /* newlines between the token before and this one */
    bool returns;                 /* the first of them follows a carriage return */
};

struct token_reader {
    struct rkm04_reader reader;
    struct token ahead; /* read already: what follows the comments at `gap` */
    size_t gap;         /* where the text between the last token and `ahead` begins */
    bool has_ahead;
};

/* `text`: mapped in place (program_text_map_in_place()). */
void token_begin(struct token_reader *tokens, const char *text, size_t length);

/* The next token; always TOKEN_END after the last one. */
struct token token_next(struct token_reader *tokens);

#endif
