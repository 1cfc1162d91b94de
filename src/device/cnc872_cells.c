/* SPDX-License-Identifier: MIT */
/* Cells of a CNC872 by name, as JSON (NL1, NL5): bits are 0 or 1, REAL a number with a point. */
#include <stdio.h>
#include <string.h>

#include "cnc872_device.h"

static const struct cnc_names *names_of(const struct cnc_device *device)
{
    return device->own.text[CNC_TEXT_PLC] ? &device->own.text[CNC_TEXT_PLC]->plc->names : NULL;
}

/* An operand that can be asked for. */
static bool read_operand(const struct cnc_device *device, const char *name, struct cnc_operand *operand,
                         struct device_refusal *refusal)
{
    struct cnc_text_fault fault;
    if (!cnc_parse_operand(name, strlen(name), names_of(device), operand, &fault))
        return CNC_REFUSE(refusal, false, "`%.60s': %s%s", name, fault.reason,
                          cnc_nearest_cell(names_of(device), name, &fault));
    if (operand->kind == CNC_OPERAND_CONSTANT || operand->block == CNC_BLOCK_BX)
        return CNC_REFUSE(refusal, false, "`%.60s': expected a cell, not a constant or a register", name);
    return true;
}

static int64_t number_at(const struct cnc *cnc, const struct cnc_operand *operand)
{
    switch (operand->kind) {
    case CNC_OPERAND_BIT:
        return cnc_bit(&cnc->cells, operand->place);
    case CNC_OPERAND_NUMBER:
        return cnc_read_number(&cnc->cells, operand->place, operand->type);
    case CNC_OPERAND_QUEUE:
        return cnc_cut_number(cnc_queue_number(cnc, operand->block, operand->place, operand->index), operand->type);
    default:
        return cnc_queue_number(cnc, operand->block, operand->place, operand->index);
    }
}

/* JSON has no infinite numbers, and none that are no numbers: null. */
json_t *cnc_real_json(double real)
{
    json_t *json = json_real(real);
    return json ? json : json_null();
}

json_t *cnc_cell_json(const struct cnc *cnc, const struct cnc_operand *operand)
{
    if (operand->kind == CNC_OPERAND_NUMBER && operand->type == CNC_REAL)
        return cnc_real_json(cnc_read_real(&cnc->cells, operand->place));
    if (operand->kind == CNC_OPERAND_QUEUE && operand->type == CNC_REAL)
        return cnc_real_json(cnc_queue_real(cnc, operand->block, operand->place, operand->index));
    return json_integer(number_at(cnc, operand));
}

json_t *cnc_get_cells(const struct cnc_device *device, const json_t *cells, struct device_refusal *refusal)
{
    size_t at;
    const json_t *cell;
    json_t *values = json_object();
    if (!json_is_array(cells)) {
        json_decref(values);
        return cnc_refuse(refusal, false, "expected a list of cells, as in [\"PO_STOP\", \"DIFCIT_X[0]\"]");
    }
    json_array_foreach((json_t *)cells, at, cell) {
        const char *name = json_string_value(cell);
        struct cnc_operand operand;
        if (!name || !read_operand(device, name, &operand, refusal)) {
            json_decref(values);
            return name ? NULL : cnc_refuse(refusal, false, "cells: expected names of cells");
        }
        json_object_set_new(values, name, cnc_cell_json(&device->cnc, &operand));
    }
    return values;
}

/* ---- Set ---------------------------------------------------------------------------------------------------------------- */

/* Does the value fit the cell? Then *number or *real is it. */
static bool read_value(const char *name, const struct cnc_operand *operand, const json_t *value, int64_t *number, double *real,
                       struct device_refusal *refusal)
{
    const enum cnc_type type = operand->kind == CNC_OPERAND_BIT ? CNC_BIT : (enum cnc_type)operand->type;
    *real = json_number_value(value);
    *number = json_is_boolean(value) ? json_is_true(value) : json_integer_value(value);
    if (type == CNC_REAL)
        return json_is_number(value) ? true : CNC_REFUSE(refusal, false, "`%.60s': expected a number", name);
    const int64_t least = type == CNC_BIT ? 0 : cnc_type_least(type), greatest = type == CNC_BIT ? 1 : cnc_type_greatest(type);
    if ((json_is_integer(value) || (type == CNC_BIT && json_is_boolean(value))) && *number >= least && *number <= greatest)
        return true;
    return CNC_REFUSE(refusal, false, "`%.60s': expected a whole number from %lld to %lld", name, (long long)least,
                      (long long)greatest);
}

static bool set_cell(struct cnc_device *device, const char *name, const json_t *value, bool is_trial,
                     struct device_refusal *refusal)
{
    struct cnc_operand operand;
    int64_t number;
    double real;
    struct cnc_cells *cells = &device->cnc.cells;
    if (!read_operand(device, name, &operand, refusal))
        return false;
    if (!operand.writable)
        return CNC_REFUSE(refusal, false, "%.60s may only be read", name);
    if (!read_value(name, &operand, value, &number, &real, refusal))
        return false;
    if (is_trial)
        return true;
    if (operand.kind == CNC_OPERAND_BIT)
        cnc_put_bit(cells, operand.place, number != 0);
    else if (operand.type == CNC_REAL)
        cnc_write_real(cells, operand.place, real);
    else
        cnc_write_number(cells, operand.place, operand.type, number);
    return true;
}

bool cnc_set_cells(struct cnc_device *device, const json_t *cells, struct device_refusal *refusal)
{
    const char *name;
    const json_t *value;
    if (!json_is_object(cells))
        return CNC_REFUSE(refusal, false, "expected cells and their values, as in {\"FEED_OVR\": 1}");
    for (unsigned pass = 0; pass < 2; pass++)
        json_object_foreach((json_t *)cells, name, value)
            if (!set_cell(device, name, value, pass == 0, refusal))
                return false;
    return true;
}

/* ---- Conditions (NL2) --------------------------------------------------------------------------------------------------- */

_Static_assert(CNC_TYPES <= 16 && CNC_OPERAND_CONSTANT < 16 && CNC_TEXTS_MAX <= 4096,
               "a cell fits a number: text and its mark, kind, type, block, index, place");
#define CODE_IS_CELL (UINT64_C(1) << 48) /* so that it is not 0 */
#define CODE_IS_OWN (UINT64_C(1) << 49)  /* of the PLC program whose text has the number behind: */
#define CODE_TEXT 50u

/* Bytes, or bits, of a name of a PLC program; 0: it has none. */
static unsigned extent_of(const struct cnc_symbol *symbol, bool is_bit)
{
    if (symbol->kind == CNC_SYMBOL_BIT)
        return is_bit;
    return symbol->kind == CNC_SYMBOL_VARIABLE && !is_bit ? cnc_type_size[symbol->type] : 0;
}

/* The name of a PLC program that an operand is in; NULL: it is none of its own. */
static const struct cnc_symbol *symbol_at(const struct cnc_names *names, const struct cnc_operand *operand)
{
    const bool is_bit = operand->kind == CNC_OPERAND_BIT;
    if (!is_bit && operand->kind != CNC_OPERAND_NUMBER)
        return NULL;
    for (unsigned at = 0; names != NULL && at < names->count; at++) {
        const struct cnc_symbol *symbol = &names->symbols[at];
        const unsigned extent = extent_of(symbol, is_bit);
        if (operand->place >= symbol->place && operand->place < symbol->place + extent)
            return symbol;
    }
    return NULL;
}

/* A cell as a number that is not 0. One of a PLC program has its text with it: another may be loaded later. */
static uint64_t code_of(const struct cnc_device *device, const struct cnc_operand *operand)
{
    const bool is_own = symbol_at(names_of(device), operand) != NULL;
    return (uint64_t)operand->kind << 40 | (uint64_t)operand->type << 36 | (uint64_t)operand->index << 28 |
           (uint64_t)operand->block << 20 | operand->place | CODE_IS_CELL |
           (is_own ? CODE_IS_OWN | (uint64_t)device->own.text[CNC_TEXT_PLC]->number << CODE_TEXT : 0);
}

/* An operand of another PLC program that was loaded once, in the present one: what has its name and type there. False: nothing
 * has. */
static bool find_again(const struct cnc_device *device, unsigned text, struct cnc_operand *operand)
{
    const struct cnc_names *names = names_of(device);
    const struct cnc_symbol *old = symbol_at(&cnc_text_numbered(text)->plc->names, operand);
    const struct cnc_symbol *now = names && old ? cnc_find_symbol(names, 0, old->name, strlen(old->name)) : NULL;
    if (!now || now->kind != old->kind || now->type != old->type)
        return false;
    operand->place = (uint16_t)(now->place + (operand->place - old->place));
    return true;
}

uint64_t cnc_find_cell_code(const struct device_unit *unit, const char *name, char error[DEVICE_ERROR_SIZE])
{
    struct device_refusal refusal;
    struct cnc_operand operand;
    if (!read_operand(cnc_in(unit), name, &operand, &refusal)) {
        snprintf(error, DEVICE_ERROR_SIZE, "%s", refusal.text);
        return 0;
    }
    if ((operand.kind == CNC_OPERAND_NUMBER || operand.kind == CNC_OPERAND_QUEUE) && operand.type == CNC_REAL) {
        snprintf(error, DEVICE_ERROR_SIZE, "`%.60s': expected a bit or a cell of whole numbers", name);
        return 0;
    }
    return code_of(cnc_in(unit), &operand);
}

int64_t cnc_cell_value(const struct device_unit *unit, uint64_t found)
{
    const struct cnc_device *device = cnc_in(unit);
    const struct cnc_text *plc = device->own.text[CNC_TEXT_PLC];
    const unsigned text = (unsigned)(found >> CODE_TEXT) % CNC_TEXTS_MAX;
    struct cnc_operand operand = {.kind = found >> 40 & 15, .type = found >> 36 & 15, .index = (uint8_t)(found >> 28),
                                  .block = (uint8_t)(found >> 20), .place = (uint16_t)found};
    if ((found & CODE_IS_OWN) != 0 && (!plc || plc->number != text) && !find_again(device, text, &operand))
        return 0;
    return number_at(&device->cnc, &operand);
}
