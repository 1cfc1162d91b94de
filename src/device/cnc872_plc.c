/* SPDX-License-Identifier: MIT */
/* The PLC program of a CNC872 as its author sees it while it runs: where it waits, how long its calls are, its text with the
 * present values of the cells that it names. */
#include <stdlib.h>
#include <string.h>

#include "cnc872_device.h"

#define LINES 100 /* of an answer if nothing else is said */
#define LINES_MAX 500

static const char *const section_names[CNC_PLC_SECTIONS] = {
    "MODULE_INIT", "MODULE_MAIN", "MODULE_BLOCK_INIT", "MODULE_BLOCK_DONE", "_ON_EVENT"};

static const char *mechanism_name(const struct cnc_plc_program *plc, const struct cnc_operand *bit)
{
    for (unsigned at = 0; at < plc->names.count; at++)
        if (plc->names.symbols[at].is_mechanism && plc->names.symbols[at].place == bit->place)
            return plc->names.symbols[at].name;
    return "?";
}

static const char *part_name(const struct cnc_plc_program *plc, unsigned part)
{
    if (part < CNC_PLC_SECTIONS)
        return section_names[part];
    return mechanism_name(plc, &plc->code[plc->parts[part].end].operand);
}

/* Sections and mechanisms that wait: [{name, line}]. */
static json_t *waits_json(const struct cnc_plc *plc, const struct cnc_plc_program *program)
{
    json_t *waits = json_array();
    for (unsigned part = 0; part < (unsigned)CNC_PLC_SECTIONS + program->mechanisms; part++)
        if (plc->waits[part] != 0 && !plc->is_halted)
            json_array_append_new(waits, json_pack("{s:s, s:I}", "name", part_name(program, part), "line",
                                                   (json_int_t)program->code[plc->waits[part] - 1u].line));
    return waits;
}

/* Instructions of the calls: {section: {last, most}}. */
static json_t *calls_json(const struct cnc_plc *plc, const struct cnc_plc_program *program)
{
    json_t *calls = json_object();
    for (unsigned part = 0; part < CNC_PLC_SECTIONS; part++)
        if (program->parts[part].is_there)
            json_object_set_new(calls, section_names[part], json_pack("{s:I, s:I}", "last", (json_int_t)plc->done[part], "most",
                                                                      (json_int_t)plc->most[part]));
    return calls;
}

/* ---- Listing ------------------------------------------------------------------------------------------------------------ */

/* A line of the text; what is not UTF-8 of it as `?`. */
static json_t *line_json(const char *text, size_t length, json_int_t number)
{
    json_t *line = json_stringn(text, length);
    if (!line) {
        char *plain = strndup(text, length);
        for (size_t at = 0; plain && at < length; at++)
            plain[at] = (unsigned char)plain[at] < 0x80 && plain[at] != '\0' ? plain[at] : '?';
        line = plain ? json_string(plain) : NULL;
        free(plain);
    }
    return json_pack("{s:I, s:o}", "line", number, "text", line ? line : json_null());
}

/* Lines `first` to `end` - 1. Returns how many the whole text has. */
static json_int_t list_lines(const struct cnc_text *text, json_int_t first, json_int_t end, json_t *listing)
{
    json_int_t number = 0;
    for (const char *at = text->text, *stop = at + text->length; at < stop;) {
        const char *newline = memchr(at, '\n', (size_t)(stop - at)), *line_end = newline ? newline : stop;
        const size_t length = (size_t)(line_end - at) - (line_end > at && line_end[-1] == '\r');
        if (++number >= first && number < end)
            json_array_append_new(listing, line_json(at, length, number));
        at = line_end + 1;
    }
    return number;
}

/* The value of a cell, beside the line that names it; of the first one of a line. */
static void add_value(json_t *listing, json_int_t first, json_int_t line, const struct cnc *cnc, struct cnc_operand operand)
{
    json_t *object = line < first ? NULL : json_array_get(listing, (size_t)(line - first));
    if (operand.block == CNC_BLOCK_BX)
        operand.block = cnc->plc.bx < CNC_BLOCK_BX ? (uint8_t)cnc->plc.bx : CNC_BLOCK_BX - 1u;
    if (object && !json_object_get(object, "value"))
        json_object_set_new(object, "value", cnc_cell_json(cnc, &operand));
}

static json_t *listing_json(const struct cnc_device *device, json_int_t first, json_int_t count, json_int_t *lines)
{
    const struct cnc_text *text = device->own.text[CNC_TEXT_PLC];
    json_t *listing = json_array();
    *lines = list_lines(text, first, first + count, listing);
    for (uint32_t at = 0; at < text->plc->length; at++) {
        const struct cnc_operand *cell = cnc_plc_cell(&text->plc->code[at]);
        if (cell)
            add_value(listing, first, text->plc->code[at].line, &device->cnc, *cell);
    }
    for (unsigned at = 0; at < text->plc->names.count; at++) {
        const struct cnc_symbol *symbol = &text->plc->names.symbols[at];
        const bool is_bit = symbol->kind == CNC_SYMBOL_BIT;
        if (is_bit || symbol->kind == CNC_SYMBOL_VARIABLE)
            add_value(listing, first, symbol->line, &device->cnc,
                      (struct cnc_operand){.kind = is_bit ? CNC_OPERAND_BIT : CNC_OPERAND_NUMBER, .type = symbol->type,
                                           .place = symbol->place});
    }
    return listing;
}

json_t *cnc_show_plc(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    const struct cnc_device *device = cnc_of(unit);
    const struct cnc_text *text = device->own.text[CNC_TEXT_PLC];
    const struct cnc_plc *plc = &device->cnc.plc;
    const json_t *first_given = json_object_get(params, "first"), *lines_given = json_object_get(params, "lines");
    int64_t first = 1, count = LINES;
    json_int_t lines = 0;
    if ((first_given && !cnc_read_number_param("first", first_given, 1, CNC_PLC_TEXT_MAX, &first, refusal)) ||
        (lines_given && !cnc_read_number_param("lines", lines_given, 0, LINES_MAX, &count, refusal)))
        return NULL;
    if (!text)
        return cnc_refuse(refusal, true, "no PLC program is loaded");
    json_t *listing = listing_json(device, first, count, &lines);
    return json_pack("{s:I, s:I, s:o, s:o, s:o, s:i, s:I, s:o, s:i, s:o}", "t", (json_int_t)device->cnc.turn, "lines", lines,
                     "halted", plc->is_halted ? json_integer((json_int_t)text->plc->code[plc->halted_at].line) : json_null(),
                     "waits", waits_json(plc, text->plc), "calls", calls_json(plc, text->plc), "rlo", (int)plc->rlo, "dr",
                     (json_int_t)plc->dr, "dr_real", cnc_real_json(plc->real), "bx", (int)plc->bx, "listing", listing);
}
