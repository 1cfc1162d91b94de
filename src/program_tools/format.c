/* SPDX-License-Identifier: MIT */
#include "format.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "source_texts.h"
#include "token.h"

#define INDENT 4u
#define LINE_MAX_COLUMNS 80u /* a line that would be longer is continued in the next one */
#define DEPTH_MAX 8u         /* levels of indentation shown */

struct layout {
    const struct program_source *source;
    const char *text;           /* mapped in place */
    FILE *out;
    const char *end_of_line;
    bool called[RKM04_LABELS + 1];
    size_t body_end;            /* offset of the last `.` of the subroutine; 0: not in one */
    unsigned depth;             /* of loops and blocks */
    size_t column;              /* 0: nothing is in the line */
    bool ended;                 /* the line takes no further command */
    bool any;                   /* something has been written */
};

/* ---- What the text has ------------------------------------------------------------------------------------------------ */

/* Note which labels are called, and how lines end. Returns false if there is an error. */
static bool survey(struct layout *layout)
{
    struct token_reader tokens;
    struct token token;
    token_begin(&tokens, layout->text, layout->source->length);
    do {
        token = token_next(&tokens);
        if (token.kind == TOKEN_ERROR)
            return false;
        if (token.kind == TOKEN_COMMAND && token.command.op == '\'')
            layout->called[token.command.argument] = true;
        if (token.lines > 0 && layout->end_of_line == NULL)
            layout->end_of_line = token.returns ? "\r\n" : "\n";
    } while (token.kind != TOKEN_END);
    if (layout->end_of_line == NULL)
        layout->end_of_line = "\n";
    return true;
}

/* Offset of the last `.` before the next subroutine; 0: there is none. */
static size_t find_body_end(const struct layout *layout, struct token_reader tokens)
{
    size_t end = 0;
    for (struct token token = token_next(&tokens); token.kind != TOKEN_END; token = token_next(&tokens)) {
        if (token.kind != TOKEN_COMMAND)
            continue;
        if (token.command.op == '@' && layout->called[token.command.argument])
            break;
        if (token.command.op == '.')
            end = token.offset;
    }
    return end;
}

/* ---- Lines ---------------------------------------------------------------------------------------------------------- */

static void end_line(struct layout *layout, size_t lines)
{
    if (!layout->any)
        return;
    fputs(layout->end_of_line, layout->out);
    if (lines > 1)
        fputs(layout->end_of_line, layout->out);
    layout->column = 0;
    layout->ended = false;
}

static void write_item(struct layout *layout, const char *text, size_t length, bool at_margin)
{
    if (layout->column > 0) {
        fputc(' ', layout->out);
        layout->column++;
    } else if (!at_margin) {
        const unsigned depth = (layout->depth < DEPTH_MAX ? layout->depth : DEPTH_MAX) + (layout->body_end > 0);
        layout->column = INDENT * depth;
        fprintf(layout->out, "%*s", (int)layout->column, "");
    }
    fwrite(text, 1, length, layout->out);
    layout->column += length;
    layout->any = true;
}

static void write_comment(struct layout *layout, const struct token *token)
{
    const char *text = layout->source->text + token->offset;
    if (token->lines > 0)
        end_line(layout, token->lines);
    write_item(layout, text, token->length, false);
    if (memchr(text, '\n', token->length) != NULL)
        layout->ended = true;
}

/* ---- Commands ------------------------------------------------------------------------------------------------------- */

static bool is_one_of(uint8_t op, const char *list)
{
    return strchr(list, op) != NULL;
}

static void write_command(struct layout *layout, const struct token *token, const struct token_reader *tokens)
{
    char text[RKM04_COMMAND_TEXT_MAX];
    const uint8_t op = token->command.op;
    const size_t length = rkm04_format(token->command, text);
    if (layout->column > 0 && (token->lines > 0 || layout->ended || is_one_of(op, "\\@LE.[]") ||
                               layout->column + 1 + length > LINE_MAX_COLUMNS))
        end_line(layout, token->lines);
    if (is_one_of(op, "E]") && layout->depth > 0)
        layout->depth--;
    if (op == '@' && layout->called[token->command.argument]) {
        layout->depth = 0;
        layout->body_end = find_body_end(layout, *tokens);
    }
    write_item(layout, text, length, op == '@');
    layout->ended = is_one_of(op, "@RGH)(WOZJI'.YLE[]");
    if (is_one_of(op, "L["))
        layout->depth++;
    if (op == '.' && token->offset == layout->body_end) {
        layout->body_end = 0;
        layout->depth = 0;
    }
}

static void write_all(struct layout *layout)
{
    struct token_reader tokens;
    token_begin(&tokens, layout->text, layout->source->length);
    for (struct token token = token_next(&tokens); token.kind != TOKEN_END; token = token_next(&tokens)) {
        if (token.kind == TOKEN_COMMENT)
            write_comment(layout, &token);
        else
            write_command(layout, &token, &tokens);
    }
    end_line(layout, 1);
}

/* ---- The text --------------------------------------------------------------------------------------------------------- */

/* Has the result the same commands? */
static bool is_same(const char *before, size_t before_length, const char *after, size_t after_length)
{
    struct rkm04_reader left, right;
    enum rkm04_read found;
    rkm04_read_begin(&left, before, before_length);
    rkm04_read_begin(&right, after, after_length);
    do {
        struct rkm04_command a = {0}, b = {0};
        found = rkm04_read(&left, &a);
        if (rkm04_read(&right, &b) != found || a.op != b.op || a.argument != b.argument)
            return false;
    } while (found == RKM04_READ_COMMAND);
    return found == RKM04_READ_END;
}

static enum format_result lay_out(struct layout *layout, char **out, size_t *length)
{
    if (!survey(layout))
        return FORMAT_ERRORS;
    layout->out = open_memstream(out, length);
    if (layout->out == NULL)
        return FORMAT_NO_MEMORY;
    write_all(layout);
    if (fclose(layout->out) != 0 || *out == NULL)
        return FORMAT_NO_MEMORY;
    return is_same(layout->text, layout->source->length, *out, *length) ? FORMAT_DONE : FORMAT_ERRORS;
}

enum format_result format_program(const struct program_source *source, char **out, size_t *length)
{
    char **texts = source_texts_map(source, 1);
    *out = NULL;
    *length = 0;
    if (texts == NULL)
        return FORMAT_NO_MEMORY;
    struct layout layout = {.source = source, .text = texts[0]};
    enum format_result result = lay_out(&layout, out, length);
    source_texts_free(texts, 1);
    if (result != FORMAT_DONE) {
        free(*out);
        *out = NULL;
    }
    return result;
}
