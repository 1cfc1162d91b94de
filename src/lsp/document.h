/* SPDX-License-Identifier: MIT */
/* document.h: a text as the editor has it. Positions are those of the protocol: line and UTF-16 code unit, both from 0; lines end
 * with \n, \r\n or \r. */
#ifndef RKM04_LSP_DOCUMENT_H
#define RKM04_LSP_DOCUMENT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "analysis.h"

#define DOCUMENT_LENGTH_MAX (256u << 10) /* bytes; a full program of 700 commands has about 8 KiB */

struct document_position {
    size_t line, character;
};

struct document {
    char *uri;
    int64_t version;
    char *text; /* UTF-8; NULL: empty */
    size_t length, room;
    bool is_unknown;  /* too long, or an edit was not understood: until the editor sends the whole text */
    bool has_changed; /* since the diagnostics were last reported */
    bool is_stale;    /* its diagnostics are: the configuration beside it has changed */
    struct cnc_config *machine; /* what a configuration says, once it was checked without an error; NULL: not known */
    struct analysis analysis;
    struct document_position *marks; /* of every 256th byte; NULL: not known */
};

/* Replace the bytes from `begin` to `end` by others, UTF-8. A text that becomes too long is unknown. Returns false if out of
 * memory. */
bool document_replace(struct document *document, size_t begin, size_t end, const char *text, size_t length);

/* The text is unknown from now on. */
void document_forget(struct document *document);

/* The offset of a position: after the end of its line that end, after the last line the end of the text. */
size_t document_offset(const struct document *document, struct document_position position);

/* The position of an offset, at most the end of the text. */
struct document_position document_position(struct document *document, size_t offset);

/* The text as the tools for programs take it. */
struct program_source document_source(const struct document *document);

void document_free(struct document *document);

#endif
