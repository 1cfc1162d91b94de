/* SPDX-License-Identifier: MIT */
/* Operands: from their text to a place (NP4). */
#include "operand.h"

struct reader {
    const char *text;
    size_t length, at;
    const struct cnc_names *names;
    struct cnc_operand *operand;
    struct cnc_text_fault *fault;
};

/* A name of the operand: where it is and what is there. */
struct target {
    unsigned begin, size; /* bytes of the cell in memory, or first field */
    unsigned count;       /* elements */
    uint8_t type, fields; /* of an element */
    unsigned offset;      /* in bytes, of the part that is meant */
};

static bool refuse(struct reader *reader, const char *reason, size_t at, size_t length)
{
    *reader->fault = (struct cnc_text_fault){reason, at, length};
    return false;
}

/* ---- Types ----------------------------------------------------------------------------------------------------------- */

enum cnc_type cnc_find_type(const char *text, size_t length)
{
    for (unsigned type = CNC_BYTE; type <= CNC_REAL; type++)
        if (cnc_same_name(cnc_type_name[type], text, length))
            return (enum cnc_type)type;
    return CNC_TYPES;
}

int64_t cnc_type_least(enum cnc_type type)
{
    if (type == CNC_QWRD)
        return INT64_MIN;
    return type == CNC_DWRD ? INT32_MIN : 0;
}

int64_t cnc_type_greatest(enum cnc_type type)
{
    static const int64_t greatest[CNC_TYPES] = {1, UINT8_MAX, UINT16_MAX, INT32_MAX, INT64_MAX};

    return greatest[type];
}

int64_t cnc_cut_number(int64_t value, enum cnc_type type)
{
    if (type == CNC_BYTE)
        return (uint8_t)value;
    if (type == CNC_WORD)
        return (uint16_t)value;
    return type == CNC_DWRD ? (int32_t)(uint32_t)value : value;
}

/* ---- Words ----------------------------------------------------------------------------------------------------------- */

static void skip_blanks(struct reader *reader)
{
    while (reader->at < reader->length && (reader->text[reader->at] == ' ' || reader->text[reader->at] == '\t'))
        reader->at++;
}

static bool take(struct reader *reader, char letter)
{
    skip_blanks(reader);
    if (reader->at == reader->length || reader->text[reader->at] != letter)
        return false;
    reader->at++;
    return true;
}

/* The letters of the name or number that comes next. */
static size_t word_length(struct reader *reader)
{
    size_t letters = 0;

    skip_blanks(reader);
    while (reader->at + letters < reader->length && cnc_is_name_letter(reader->text[reader->at + letters]))
        letters++;
    return letters;
}

/* The number that comes next, at most `greatest`. */
static bool take_number(struct reader *reader, int64_t greatest, unsigned *value)
{
    size_t letters = word_length(reader);
    int64_t number;

    if (!cnc_parse_number(reader->text + reader->at, letters, &number))
        return refuse(reader, "expected a number", reader->at, letters);
    *value = (unsigned)(number < greatest ? number : greatest);
    reader->at += letters;
    return true;
}

/* ---- Parts ----------------------------------------------------------------------------------------------------------- */

/* CNST.value */
static bool read_constant(struct reader *reader)
{
    skip_blanks(reader);
    const char *text = reader->text + reader->at;
    size_t rest = reader->length - reader->at;
    size_t letters = cnc_quoted_length(text, rest, &reader->operand->value);

    if (letters == 0)
        letters = word_length(reader);
    reader->operand->kind = CNC_OPERAND_CONSTANT;
    reader->operand->type = CNC_QWRD;
    const struct cnc_symbol *symbol = reader->names ? cnc_find_symbol(reader->names, 0, text, letters) : NULL;
    if (symbol && symbol->kind == CNC_SYMBOL_CONSTANT)
        reader->operand->value = symbol->value;
    else if (!cnc_find_constant(text, letters, &reader->operand->value) &&
             !cnc_parse_number(text, letters, &reader->operand->value))
        return refuse(reader, "expected a number or a constant", reader->at, letters);
    reader->at += letters;
    return true;
}

/* n].: a number or BX */
static bool read_block(struct reader *reader)
{
    unsigned block = CNC_BLOCK_BX;
    size_t letters = word_length(reader);

    if (cnc_same_name("BX", reader->text + reader->at, letters))
        reader->at += letters;
    else if (!take_number(reader, CNC_BLOCK_BX - 1, &block)) /* no queue is as long */
        return refuse(reader, "expected a number or BX", reader->at, letters);
    reader->operand->block = (uint8_t)block;
    if (!take(reader, ']') || !take(reader, '.'))
        return refuse(reader, "expected `].' and a field of the block", reader->at, 0);
    return true;
}

static void set_bit(struct reader *reader, unsigned place, bool writable)
{
    reader->operand->kind = CNC_OPERAND_BIT;
    reader->operand->type = CNC_BIT;
    reader->operand->place = (uint16_t)place;
    reader->operand->writable = writable;
}

/* A name that the PLC program has of its own. */
static bool find_own(struct reader *reader, const struct cnc_symbol *symbol, size_t letters, struct target *target)
{
    if (symbol->kind == CNC_SYMBOL_CONSTANT)
        return refuse(reader, "a constant is written CNST.name", reader->at, letters);
    if (symbol->kind == CNC_SYMBOL_BIT)
        set_bit(reader, symbol->place, true);
    reader->operand->writable = true;
    *target = (struct target){symbol->place, cnc_type_size[symbol->type], 1, symbol->type, CNC_FIELDS_NONE, 0};
    return true;
}

/* The cell, field of the queue or variable whose name comes next. */
static bool read_name(struct reader *reader, bool in_queue, struct target *target)
{
    size_t letters = word_length(reader);
    const char *text = reader->text + reader->at;
    unsigned index;
    const struct cnc_symbol *symbol = !in_queue && reader->names ? cnc_find_symbol(reader->names, 0, text, letters) : NULL;

    if (letters == 0)
        return refuse(reader, "expected a name", reader->at, 0);
    if (symbol) {
        if (!find_own(reader, symbol, letters, target))
            return false;
    } else {
        const struct cnc_row *row = in_queue ? cnc_find_row(cnc_queue_rows, CNC_QUEUE_FIELDS, text, letters, &index)
                                             : cnc_find_row(cnc_rows, cnc_row_count, text, letters, &index);
        if (!row)
            return refuse(reader, in_queue                          ? "a block has no field"
                                  : text[0] >= '0' && text[0] <= '9' ? "expected a cell, or a number as CNST.5"
                                                                     : "there is no cell", reader->at, letters);
        unsigned size = (unsigned)row->count * cnc_type_size[row->type];
        *target = (struct target){row->place, size, row->count, row->type, row->fields, 0};
        reader->operand->writable = row->writable;
        if (row->type == CNC_BIT) {
            set_bit(reader, in_queue ? row->place : row->place + index, row->writable);
            reader->operand->index = (uint8_t)index;
        }
    }
    reader->at += letters;
    return true;
}

/* [i], .field and +offset behind a name of a number; *type: that of the element or field. */
static bool read_part(struct reader *reader, bool in_queue, struct target *target, uint8_t *type)
{
    size_t begin = reader->at;
    unsigned value;
    bool has_element = take(reader, '[');

    *type = target->type;
    if (has_element) {
        if (!take_number(reader, UINT16_MAX, &value) || !take(reader, ']'))
            return refuse(reader, "expected a number and `]'", reader->at, 0);
        if (value >= target->count || target->type == CNC_STRUCTURE)
            return refuse(reader, "there is no such element", begin, reader->at - begin);
        target->offset = value * (in_queue ? 1u : cnc_type_size[target->type]);
    } else if (in_queue && target->count > 1) {
        return refuse(reader, "expected the number of an element, `[0]'", reader->at, 0);
    }
    if (in_queue)
        return true;
    if (!has_element && take(reader, '.')) {
        size_t letters = word_length(reader);
        const struct cnc_field *field = cnc_fields;
        while (field < cnc_fields + cnc_field_count &&
               (field->fields != target->fields || !cnc_same_name(field->name, reader->text + reader->at, letters)))
            field++;
        if (field == cnc_fields + cnc_field_count)
            return refuse(reader, "the cell has no field", reader->at, letters);
        target->offset = field->offset;
        *type = field->type;
        reader->at += letters;
    }
    if (take(reader, '+')) {
        if (!take_number(reader, UINT16_MAX, &value))
            return false;
        target->offset += value;
    }
    return true;
}

/* ---- Whole operands -------------------------------------------------------------------------------------------------- */

/* The type that is written, or that of the cell; it has to lie inside the cell. */
static bool choose_type(struct reader *reader, enum cnc_type written, uint8_t type, const struct target *target, size_t begin)
{
    if (written != CNC_TYPES)
        type = (uint8_t)written;
    if (type == CNC_STRUCTURE)
        return refuse(reader, "expected a field, or a type before the structure", begin, reader->at - begin);
    reader->operand->type = type;
    if (target->offset + cnc_type_size[type] > target->size)
        return refuse(reader, "this lies outside of the cell", begin, reader->at - begin);
    reader->operand->kind = CNC_OPERAND_NUMBER;
    reader->operand->place = (uint16_t)(target->begin + target->offset);
    return true;
}

/* Fields of a block are values, not memory: reals are read as REAL, whole numbers with a width. */
static bool choose_queue_type(struct reader *reader, enum cnc_type written, uint8_t type, const struct target *target,
                              size_t begin)
{
    if (written != CNC_TYPES && (written == CNC_REAL) != (type == CNC_REAL))
        return refuse(reader, type == CNC_REAL ? "expected REAL before it" : "this is not REAL", begin, reader->at - begin);
    reader->operand->type = written == CNC_TYPES ? type : (uint8_t)written;
    reader->operand->kind = CNC_OPERAND_QUEUE;
    reader->operand->place = (uint16_t)target->begin;
    reader->operand->index = (uint8_t)target->offset;
    return true;
}

/* name, element, field and offset, with or without parentheses. */
static bool read_rest(struct reader *reader, bool in_queue, enum cnc_type written)
{
    bool is_in_parentheses = !in_queue && take(reader, '(');
    struct target target;
    uint8_t type;

    skip_blanks(reader);
    size_t begin = reader->at;
    if (!read_name(reader, in_queue, &target))
        return false;
    if (target.type == CNC_BIT) {
        if (written != CNC_TYPES)
            return refuse(reader, "expected a number; this is a bit", begin, reader->at - begin);
        if (in_queue)
            reader->operand->kind = CNC_OPERAND_QUEUE_BIT;
    } else if (!read_part(reader, in_queue, &target, &type) ||
               !(in_queue ? choose_queue_type : choose_type)(reader, written, type, &target, begin)) {
        return false;
    }
    return !is_in_parentheses || take(reader, ')') || refuse(reader, "expected `)'", reader->at, 0);
}

static bool read_operand(struct reader *reader)
{
    size_t letters = word_length(reader);
    size_t end = reader->at + letters;
    const char *text = reader->text + reader->at;
    bool in_queue = cnc_same_name("BLK", text, letters) && end < reader->length && reader->text[end] == '[';
    enum cnc_type written = CNC_TYPES;

    if (cnc_same_name("CNST", text, letters)) {
        reader->at = end;
        return take(reader, '.') ? read_constant(reader) : refuse(reader, "expected CNST.value", reader->at, 0);
    }
    if (in_queue) {
        reader->at = end + 1;
        if (!read_block(reader))
            return false;
        letters = word_length(reader);
        text = reader->text + reader->at;
        end = reader->at + letters;
    }
    if (cnc_find_type(text, letters) != CNC_TYPES) {
        written = cnc_find_type(text, letters);
        reader->at = end;
        if (!take(reader, '.'))
            return refuse(reader, "expected `.' and a name behind the type", reader->at, 0);
    }
    return read_rest(reader, in_queue, written);
}

bool cnc_parse_operand(const char *text, size_t length, const struct cnc_names *names, struct cnc_operand *operand,
                       struct cnc_text_fault *fault)
{
    struct reader reader = {text, length, 0, names, operand, fault};

    *operand = (struct cnc_operand){.block = 0};
    bool is_read = read_operand(&reader);
    skip_blanks(&reader);
    if (is_read && reader.at < length)
        is_read = refuse(&reader, "expected the end of the operand", reader.at, length - reader.at);
    if (!is_read)
        *operand = (struct cnc_operand){.block = 0};
    return is_read;
}
