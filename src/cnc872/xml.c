/* SPDX-License-Identifier: MIT */
/* Characters of CONFIG.xml. */
#include "xml.h"

#include <string.h>

static bool is_word(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

bool cnc_xml_next_is(const struct cnc_xml *xml, const char *bytes)
{
    size_t size = strlen(bytes);
    return xml->length - xml->at >= size && memcmp(xml->text + xml->at, bytes, size) == 0;
}

bool cnc_xml_next_is_word(const struct cnc_xml *xml)
{
    return xml->at < xml->length && is_word(xml->text[xml->at]);
}

bool cnc_xml_next_is_space(const struct cnc_xml *xml)
{
    return xml->at < xml->length && cnc_xml_is_space(xml->text[xml->at]);
}

void cnc_xml_move_on(struct cnc_xml *xml, size_t count)
{
    for (; count > 0; count--)
        if (xml->text[xml->at++] == '\n') {
            xml->line++;
            xml->line_begin = xml->at;
        }
}

void cnc_xml_skip_space(struct cnc_xml *xml)
{
    while (cnc_xml_next_is_space(xml))
        cnc_xml_move_on(xml, 1);
}

bool cnc_xml_skip_to(struct cnc_xml *xml, const char *end)
{
    while (xml->at < xml->length && !cnc_xml_next_is(xml, end))
        cnc_xml_move_on(xml, 1);
    if (xml->at == xml->length)
        return false;
    cnc_xml_move_on(xml, strlen(end));
    return true;
}

struct cnc_piece cnc_xml_place(const struct cnc_xml *xml)
{
    return (struct cnc_piece){xml->text + xml->at, 0, xml->line, (uint32_t)(xml->at - xml->line_begin) + 1};
}

struct cnc_piece cnc_xml_read_word(struct cnc_xml *xml)
{
    struct cnc_piece piece = cnc_xml_place(xml);
    for (; cnc_xml_next_is_word(xml); xml->at++)
        piece.length++;
    return piece;
}

bool cnc_xml_read_quoted(struct cnc_xml *xml, struct cnc_piece *value)
{
    if (!cnc_xml_next_is(xml, "\"") && !cnc_xml_next_is(xml, "'"))
        return cnc_xml_fail_here(xml, "expected a value in quotes");
    const char quote = xml->text[xml->at];
    cnc_xml_move_on(xml, 1);
    *value = cnc_xml_place(xml);
    while (xml->at < xml->length && xml->text[xml->at] != quote) {
        if (cnc_xml_next_is(xml, "<") || cnc_xml_next_is(xml, "&"))
            return cnc_xml_fail_here(xml, "expected a value without < and &");
        cnc_xml_move_on(xml, 1);
        value->length++;
    }
    if (xml->at == xml->length)
        return cnc_xml_fail_here(xml, "expected a quote behind the value");
    cnc_xml_move_on(xml, 1);
    return true;
}

bool cnc_piece_is(const struct cnc_piece *piece, const char *text)
{
    return strlen(text) == piece->length && memcmp(piece->text, text, piece->length) == 0;
}

bool cnc_xml_fail(struct cnc_xml *xml, const struct cnc_piece *piece, const char *expected)
{
    cnc_text_fail(&xml->errors, piece->line, piece->column, expected, "", 0, "");
    return false;
}

bool cnc_xml_fail_here(struct cnc_xml *xml, const char *expected)
{
    struct cnc_piece here = cnc_xml_place(xml);
    return cnc_xml_fail(xml, &here, expected);
}
