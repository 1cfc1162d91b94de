/* SPDX-License-Identifier: MIT */
#include "document.h"

#include <stdlib.h>
#include <string.h>

#define MARK_EVERY 256u

static void forget_results(struct document *document)
{
    analysis_clear(&document->analysis);
    free(document->marks);
    free(document->machine);
    document->marks = NULL;
    document->machine = NULL;
    document->has_changed = true;
}

bool document_replace(struct document *document, size_t begin, size_t end, const char *text, size_t length)
{
    const size_t rest = document->length - end, whole = begin + length + rest;
    if (length > DOCUMENT_LENGTH_MAX || whole > DOCUMENT_LENGTH_MAX) {
        document_forget(document);
        return true;
    }
    if (whole > document->room) {
        char *grown = realloc(document->text, 2 * whole);
        if (grown == NULL)
            return false;
        document->text = grown;
        document->room = 2 * whole;
    }
    if (rest > 0)
        memmove(document->text + begin + length, document->text + end, rest);
    if (length > 0)
        memcpy(document->text + begin, text, length);
    document->length = whole;
    forget_results(document);
    return true;
}

void document_forget(struct document *document)
{
    forget_results(document);
    free(document->text);
    document->text = NULL;
    document->length = document->room = 0;
    document->is_unknown = true;
}

/* UTF-16 units of the character that begins with this byte; 0: it goes on with it. */
static size_t units_of(char byte)
{
    const unsigned char value = (unsigned char)byte;
    return (value & 0xC0) == 0x80 ? 0 : value >= 0xF0 ? 2 : 1;
}

static bool ends_line(const struct document *document, size_t at)
{
    const char byte = document->text[at];
    return byte == '\n' || (byte == '\r' && (at + 1 == document->length || document->text[at + 1] != '\n'));
}

/* From the byte at `at` to the next one. */
static void step(const struct document *document, size_t at, struct document_position *position)
{
    if (ends_line(document, at)) {
        position->line++;
        position->character = 0;
    } else if (document->text[at] != '\r') {
        position->character += units_of(document->text[at]);
    }
}

size_t document_offset(const struct document *document, struct document_position position)
{
    size_t at = 0, units = 0;
    for (; at < document->length && position.line > 0; at++)
        position.line -= ends_line(document, at);
    if (position.line > 0)
        return document->length;
    while (at < document->length && document->text[at] != '\n' && document->text[at] != '\r') {
        units += units_of(document->text[at]);
        if (units > position.character)
            break;
        for (at++; at < document->length && units_of(document->text[at]) == 0;)
            at++;
    }
    return at;
}

/* Note the position of every 256th byte. */
static void set_marks(struct document *document)
{
    struct document_position position = {0, 0};
    document->marks = malloc((document->length / MARK_EVERY + 1) * sizeof *document->marks);
    for (size_t at = 0; document->marks != NULL && at <= document->length; at++) {
        if (at % MARK_EVERY == 0)
            document->marks[at / MARK_EVERY] = position;
        if (at < document->length)
            step(document, at, &position);
    }
}

struct document_position document_position(struct document *document, size_t offset)
{
    struct document_position position = {0, 0};
    size_t at = 0;
    if (document->marks == NULL)
        set_marks(document);
    if (document->marks != NULL) {
        position = document->marks[offset / MARK_EVERY];
        at = offset / MARK_EVERY * MARK_EVERY;
    }
    for (; at < offset; at++)
        step(document, at, &position);
    return position;
}

struct program_source document_source(const struct document *document)
{
    return (struct program_source){document->uri, document->text != NULL ? document->text : "", document->length, 1};
}

void document_free(struct document *document)
{
    analysis_clear(&document->analysis);
    free(document->marks);
    free(document->machine);
    free(document->text);
    free(document->uri);
    free(document);
}
