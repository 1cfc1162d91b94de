/* SPDX-License-Identifier: MIT */
/* xml.h: the characters of CONFIG.xml. */
#ifndef CNC872_XML_H
#define CNC872_XML_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "text_error.h"

/* A piece of the text and its place. */
struct cnc_piece {
    const char *text;
    size_t length;
    uint32_t line, column;
};

/* A text and where reading is. */
struct cnc_xml {
    const char *text;
    size_t length, at, line_begin;
    uint32_t line; /* from 1 */
    struct cnc_text_errors errors;
};

static inline bool cnc_xml_is_space(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

/* Do these bytes come next? */
bool cnc_xml_next_is(const struct cnc_xml *xml, const char *bytes);

/* Does the first character of a name come next; a space? */
bool cnc_xml_next_is_word(const struct cnc_xml *xml);
bool cnc_xml_next_is_space(const struct cnc_xml *xml);

/* Go on by `count` bytes; behind spaces; behind the bytes `end`: false if they are not there, at the end of the text then. */
void cnc_xml_move_on(struct cnc_xml *xml, size_t count);
void cnc_xml_skip_space(struct cnc_xml *xml);
bool cnc_xml_skip_to(struct cnc_xml *xml, const char *end);

/* The empty piece at this place. */
struct cnc_piece cnc_xml_place(const struct cnc_xml *xml);

/* Take a name: letters, digits, underscores. */
struct cnc_piece cnc_xml_read_word(struct cnc_xml *xml);

/* Take a value in quotes, without them. Returns false, with an error, if there is none. */
bool cnc_xml_read_quoted(struct cnc_xml *xml, struct cnc_piece *value);

bool cnc_piece_is(const struct cnc_piece *piece, const char *text);

/* Report an error at a piece, or here. Returns false. */
bool cnc_xml_fail(struct cnc_xml *xml, const struct cnc_piece *piece, const char *expected);
bool cnc_xml_fail_here(struct cnc_xml *xml, const char *expected);

#endif
