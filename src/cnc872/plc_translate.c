/* SPDX-License-Identifier: MIT */
/* Translates a PLC text: sections, mechanisms, variables, labels (NP3, NP8). */
#include <string.h>

#include "plc_translator.h"

static const struct cnc_word no_word = {"", 0};

/* ---- Errors ---------------------------------------------------------------------------------------------------------- */

static void wrong_at(struct translator *translator, unsigned line, unsigned column, const char *reason, struct cnc_word word)
{
    if (translator->is_second)
        cnc_text_fail_at(&translator->errors, line, column, reason, word.text, word.length);
}

void cnc_plc_wrong(struct translator *translator, const char *reason, struct cnc_word word)
{
    unsigned column = (unsigned)(word.text - translator->line.begin) + 1;

    wrong_at(translator, translator->line.number, column, reason, word);
}

/* ---- Names ----------------------------------------------------------------------------------------------------------- */

/* Takes memory or a bit for a new name; false: there is none left. */
static bool take_place(struct cnc_plc_program *program, struct cnc_symbol *symbol, enum cnc_symbol_kind kind, enum cnc_type type)
{
    symbol->kind = (uint8_t)kind;
    symbol->type = (uint8_t)type;
    if (kind == CNC_SYMBOL_BIT) {
        if (program->bits == CNC_OWN_BITS)
            return false;
        symbol->place = (uint16_t)(CNC_SYSTEM_BITS + program->bits++);
    } else if (kind == CNC_SYMBOL_VARIABLE) {
        if (program->memory + cnc_type_size[type] > CNC_OWN_MEMORY)
            return false;
        symbol->place = (uint16_t)(CNC_SYSTEM_MEMORY + program->memory);
        program->memory = (uint16_t)(program->memory + cnc_type_size[type]);
    }
    return true;
}

/* Has the language or the system a name like this? */
static bool is_taken(struct cnc_word name)
{
    static const char own[][5] = {"BLK", "CNST", "BX"};
    unsigned index;
    int64_t value;

    for (size_t i = 0; i < sizeof own / sizeof *own; i++)
        if (cnc_same_name(own[i], name.text, name.length))
            return true;
    return cnc_find_constant(name.text, name.length, &value) || cnc_find_type(name.text, name.length) != CNC_TYPES ||
           cnc_find_row(cnc_rows, cnc_row_count, name.text, name.length, &index);
}

/* The symbol of a name that the line declares: made in the first translation, found in the second. NULL: it is reported. */
static struct cnc_symbol *declare(struct translator *translator, unsigned scope, struct cnc_word name,
                                  enum cnc_symbol_kind kind, enum cnc_type type)
{
    struct cnc_plc_program *program = translator->program;
    unsigned line = translator->line.number;

    if (name.length == 0 || name.length > CNC_NAME_MAX || cnc_name_length(name.text, name.length) != name.length) {
        cnc_plc_wrong(translator, "expected a name of at most 31 letters, digits and _ ? @", name);
        return NULL;
    }
    const struct cnc_symbol *found = cnc_find_symbol(&program->names, scope, name.text, name.length);
    if (!translator->is_second) {
        struct cnc_symbol *symbol = found ? NULL : cnc_add_symbol(&program->names, scope, name.text, name.length);
        if (symbol && take_place(program, symbol, kind, type))
            symbol->line = line;
        return symbol;
    }
    bool is_room = found && found->line > 0;
    if (is_room && found->line == line && !(scope == 0 && is_taken(name)))
        return &program->names.symbols[found - program->names.symbols];
    cnc_plc_wrong(translator, !is_room              ? "there is no room for one more name"
                              : found->line == line ? "the system or the language has this name"
                                                    : "this name is there twice", name);
    return NULL;
}

static void declare_label(struct translator *translator)
{
    if (translator->section == CNC_NOWHERE) {
        cnc_plc_wrong(translator, "expected a section before the label", translator->line.label);
        return;
    }
    unsigned scope = cnc_plc_part_of(translator) + 1;
    struct cnc_symbol *symbol = declare(translator, scope, translator->line.label, CNC_SYMBOL_LABEL, CNC_BIT);
    if (symbol)
        symbol->value = translator->program->length;
}

bool cnc_plc_value(const struct translator *translator, struct cnc_word word, int64_t *value)
{
    const struct cnc_symbol *symbol = cnc_find_symbol(&translator->program->names, 0, word.text, word.length);

    if (symbol && symbol->kind == CNC_SYMBOL_CONSTANT) {
        *value = symbol->value;
        return true;
    }
    return cnc_find_constant(word.text, word.length, value) || cnc_parse_number(word.text, word.length, value);
}

/* NAME DB|DW|DD|DQ|BIT|EQU value */
static void declare_data(struct translator *translator)
{
    static const struct {
        char name[4];
        enum cnc_symbol_kind kind;
        enum cnc_type type;
        int64_t greatest;
        const char *expected;
    } kinds[] = {{"DB", CNC_SYMBOL_VARIABLE, CNC_BYTE, UINT8_MAX, "expected one number from 0 to 255"},
                 {"DW", CNC_SYMBOL_VARIABLE, CNC_WORD, UINT16_MAX, "expected one number from 0 to 65535"},
                 {"DD", CNC_SYMBOL_VARIABLE, CNC_DWRD, UINT32_MAX, "expected one number from 0 to 4294967295"},
                 {"DQ", CNC_SYMBOL_VARIABLE, CNC_QWRD, INT64_MAX, "expected one number from 0 on"},
                 {"BIT", CNC_SYMBOL_BIT, CNC_BIT, 1, "expected 0 or 1"},
                 {"EQU", CNC_SYMBOL_CONSTANT, CNC_QWRD, INT64_MAX, "expected one number from 0 on"}};
    const struct cnc_plc_line *line = &translator->line;
    struct cnc_word rest = line->arguments > 0 ? line->argument[0] : (struct cnc_word){line->name.text + line->name.length, 0};
    size_t kind = 0, letters = 0;
    int64_t value;

    while (letters < rest.length && cnc_is_name_letter(rest.text[letters]))
        letters++;
    while (kind < sizeof kinds / sizeof *kinds && !cnc_same_name(kinds[kind].name, rest.text, letters))
        kind++;
    if (line->label.length > 0 || kind == sizeof kinds / sizeof *kinds) {
        const struct cnc_word word = {rest.text, letters};
        const bool is_name = line->label.length == 0 && letters > 0;
        cnc_plc_wrong(translator, "expected NAME DB, DW, DD, DQ, BIT or EQU and a value", is_name ? word : line->name);
        return;
    }
    struct cnc_symbol *symbol = declare(translator, 0, line->name, kinds[kind].kind, kinds[kind].type);
    while (letters < rest.length && (rest.text[letters] == ' ' || rest.text[letters] == '\t'))
        letters++;
    rest = (struct cnc_word){rest.text + letters, rest.length - letters};
    if (line->arguments != 1 || !cnc_plc_value(translator, rest, &value) || value > kinds[kind].greatest)
        cnc_plc_wrong(translator, kinds[kind].expected, rest);
    else if (symbol)
        symbol->value = value;
}

/* ---- Sections -------------------------------------------------------------------------------------------------------- */

unsigned cnc_plc_part_of(const struct translator *translator)
{
    return (unsigned)(translator->mechanism != CNC_NOWHERE ? CNC_PLC_SECTIONS + translator->mechanism : translator->section);
}

struct cnc_instruction *cnc_plc_emit(struct translator *translator, enum cnc_plc_code code)
{
    struct cnc_plc_program *program = translator->program;
    struct cnc_instruction *instruction = &translator->spare;

    if (program->length < CNC_PLC_CODE_MAX)
        instruction = &program->code[program->length++];
    else if (!translator->is_full)
        cnc_plc_wrong(translator, "the program has more than 65535 instructions", translator->line.name);
    translator->is_full = instruction == &translator->spare;
    *instruction = (struct cnc_instruction){.line = translator->line.number, .code = (uint8_t)code};
    return instruction;
}

static void begin_section(struct translator *translator, enum cnc_plc_section section)
{
    struct cnc_plc_part *part = &translator->program->parts[section];

    if (translator->section != CNC_NOWHERE)
        cnc_plc_wrong(translator, "a section is open; expected its end before", translator->line.name);
    else if (part->is_there)
        cnc_plc_wrong(translator, "this section is there twice", translator->line.name);
    translator->section = (int)section;
    translator->section_line = translator->line.number;
    translator->mechanism = CNC_NOWHERE;
    *part = (struct cnc_plc_part){.begin = (uint16_t)translator->program->length, .is_there = true};
}

static void end_section(struct translator *translator, enum cnc_plc_section section)
{
    if (translator->section != (int)section || translator->mechanism != CNC_NOWHERE) {
        cnc_plc_wrong(translator, translator->mechanism == CNC_NOWHERE ? "this section is not open" : "expected MECH_END before",
                      translator->line.name);
        return;
    }
    translator->program->parts[section].end = (uint16_t)translator->program->length;
    cnc_plc_emit(translator, CODE_END);
    translator->section = CNC_NOWHERE;
}

static void begin_mechanism(struct translator *translator, struct cnc_word name)
{
    struct cnc_plc_program *program = translator->program;

    if (translator->section != CNC_PLC_MAIN || translator->mechanism != CNC_NOWHERE) {
        cnc_plc_wrong(translator, "a mechanism stands in MODULE_MAIN, not inside another one", translator->line.name);
        return;
    }
    if (program->mechanisms == CNC_PLC_MECHANISMS_MAX) {
        cnc_plc_wrong(translator, "there are more than 250 mechanisms", translator->line.name);
        return;
    }
    struct cnc_symbol *symbol = declare(translator, 0, name, CNC_SYMBOL_BIT, CNC_BIT);
    if (symbol)
        symbol->is_mechanism = true;
    struct cnc_instruction *instruction = cnc_plc_emit(translator, CODE_MECHANISM);
    instruction->operand.place = symbol ? symbol->place : 0;
    instruction->operand.value = program->mechanisms;
    translator->mechanism = program->mechanisms++;
    translator->mechanism_line = translator->line.number;
    unsigned part = cnc_plc_part_of(translator);
    program->parts[part] = (struct cnc_plc_part){.begin = (uint16_t)program->length, .is_there = true};
}

static void end_mechanism(struct translator *translator, struct cnc_word name)
{
    struct cnc_plc_program *program = translator->program;

    if (translator->mechanism == CNC_NOWHERE) {
        cnc_plc_wrong(translator, "no mechanism is open", translator->line.name);
        return;
    }
    struct cnc_plc_part *part = &program->parts[cnc_plc_part_of(translator)];
    const struct cnc_symbol *symbol = cnc_find_symbol(&program->names, 0, name.text, name.length);
    if (!symbol || symbol->line != translator->mechanism_line)
        cnc_plc_wrong(translator, "expected the name of the mechanism that is open", name);
    part->end = (uint16_t)program->length;
    struct cnc_instruction *instruction = cnc_plc_emit(translator, CODE_END_MECHANISM);
    instruction->operand.value = translator->mechanism;
    instruction->operand.place = symbol ? symbol->place : 0;
    translator->mechanism = CNC_NOWHERE;
}

/* ---- Lines ----------------------------------------------------------------------------------------------------------- */

enum mark { MARK_BEGIN, MARK_END, MARK_MECH_BEGIN, MARK_MECH_END, MARK_PROC_BEGIN, MARK_PROC_END, MARK_DATA, MARK_STOP };

static const struct {
    char name[22];
    enum mark mark;
    enum cnc_plc_section section;
    bool is_named;
} marks[] = {
    {"MODULE_INIT", MARK_BEGIN, CNC_PLC_INIT, false},
    {"MODULE_INIT_END", MARK_END, CNC_PLC_INIT, false},
    {"MODULE_MAIN", MARK_BEGIN, CNC_PLC_MAIN, false},
    {"MODULE_MAIN_END", MARK_END, CNC_PLC_MAIN, false},
    {"MODULE_BLOCK_INIT", MARK_BEGIN, CNC_PLC_BLOCK_INIT, false},
    {"MODULE_BLOCK_INIT_END", MARK_END, CNC_PLC_BLOCK_INIT, false},
    {"MODULE_BLOCK_DONE", MARK_BEGIN, CNC_PLC_BLOCK_DONE, false},
    {"MODULE_BLOCK_DONE_END", MARK_END, CNC_PLC_BLOCK_DONE, false},
    {"PROC_BEGIN", MARK_PROC_BEGIN, CNC_PLC_EVENT, true},
    {"PROC_END", MARK_PROC_END, CNC_PLC_EVENT, true},
    {"MECH_BEGIN", MARK_MECH_BEGIN, CNC_PLC_MAIN, true},
    {"MECH_END", MARK_MECH_END, CNC_PLC_MAIN, true},
    {"DATA", MARK_DATA, CNC_PLC_INIT, false},
    {"STOP", MARK_STOP, CNC_PLC_INIT, false},
};

static void follow_mark(struct translator *translator, size_t i)
{
    const struct cnc_word *own = &translator->line.name;
    struct cnc_word name = {own->text + own->length, 0};

    if (translator->line.arguments > 0)
        name = translator->line.argument[0];
    if (translator->line.arguments != (marks[i].is_named ? 1 : 0))
        cnc_plc_wrong(translator, marks[i].is_named ? "expected a name behind" : "expected nothing behind", *own);
    else if (marks[i].section == CNC_PLC_EVENT && !cnc_same_name("_ON_EVENT", name.text, name.length))
        cnc_plc_wrong(translator, "expected _ON_EVENT; there is no procedure", name);
    if (marks[i].mark == MARK_BEGIN || marks[i].mark == MARK_PROC_BEGIN)
        begin_section(translator, marks[i].section);
    else if (marks[i].mark == MARK_END || marks[i].mark == MARK_PROC_END)
        end_section(translator, marks[i].section);
    else if (marks[i].mark == MARK_MECH_BEGIN)
        begin_mechanism(translator, name);
    else if (marks[i].mark == MARK_MECH_END)
        end_mechanism(translator, name);
    else if (marks[i].mark == MARK_STOP)
        translator->has_stopped = true;
    else if (translator->section != CNC_NOWHERE)
        cnc_plc_wrong(translator, "a section is open; expected its end before", *own);
    else {
        translator->in_data = true;
        translator->data_line = translator->line.number;
    }
}

static void translate_line(struct translator *translator)
{
    const struct cnc_plc_line *line = &translator->line;
    size_t i = 0;

    if (line->name.length == 0 && line->label.length == 0 && line->arguments == 0)
        return;
    if (translator->has_stopped) {
        cnc_plc_wrong(translator, "expected nothing behind STOP", line->name);
        return;
    }
    while (i < sizeof marks / sizeof *marks && !cnc_same_name(marks[i].name, line->name.text, line->name.length))
        i++;
    bool is_mark = i < sizeof marks / sizeof *marks;
    if (translator->in_data) {
        bool is_section = is_mark && marks[i].mark != MARK_DATA && marks[i].mark != MARK_STOP;
        if (is_section)
            cnc_plc_wrong(translator, "expected DATA_END before", line->name);
        translator->in_data = !is_section && !cnc_same_name("DATA_END", line->name.text, line->name.length);
        if (translator->in_data)
            declare_data(translator);
        if (!is_section)
            return;
    }
    if (line->label.length > 0)
        declare_label(translator);
    if (is_mark)
        follow_mark(translator, i);
    else if (line->name.length > 0 || line->arguments > 0)
        cnc_translate_instruction(translator);
}

static void translate_text(struct translator *translator, const char *text, size_t length)
{
    translator->section = translator->mechanism = CNC_NOWHERE;
    translator->in_data = translator->has_stopped = translator->is_full = false;
    translator->line.number = 0;
    translator->program->length = translator->program->mechanisms = 0;
    memset(translator->program->parts, 0, sizeof translator->program->parts);
    while (length > 0) {
        cnc_read_plc_line(&text, &length, &translator->line);
        translate_line(translator);
    }
    if (translator->in_data)
        wrong_at(translator, translator->data_line, 1, "expected DATA_END to close DATA", no_word);
    if (translator->mechanism != CNC_NOWHERE)
        wrong_at(translator, translator->mechanism_line, 1, "expected MECH_END to close the mechanism", no_word);
    else if (translator->section != CNC_NOWHERE)
        wrong_at(translator, translator->section_line, 1, "expected the end of the section that begins here", no_word);
}

bool cnc_translate_plc(const char *text, size_t length, struct cnc_plc_program *program, cnc_text_report *report, void *context)
{
    struct translator translator = {.program = program, .errors = {report, context, 0}};

    cnc_clear_names(&program->names);
    program->memory = program->bits = 0;
    if (length > CNC_PLC_TEXT_MAX) {
        cnc_text_fail(&translator.errors, 1, 1, "the text has more than 16777216 bytes", "", 0, "");
        return false;
    }
    translate_text(&translator, text, length);
    translator.is_second = true;
    translate_text(&translator, text, length);
    return translator.errors.count == 0;
}
