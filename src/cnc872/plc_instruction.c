/* SPDX-License-Identifier: MIT */
/* Translates instructions with their operands (NP2, NP4, NP8). */
#include "config.h"
#include "plc_translator.h"

/* What an instruction has behind its name. */
enum form {
    FORM_NOTHING,
    FORM_BIT,
    FORM_WRITTEN_BIT,
    FORM_FLAG, /* 0 or 1, bit */
    FORM_LABEL,
    FORM_TIME,   /* counter, time, label, code */
    FORM_NUMBER,
    FORM_WHOLE,  /* a number, not REAL */
    FORM_STORE,
    FORM_TYPE,
    FORM_SHIFT,  /* CNST.n,type */
    FORM_LICENCE,
    FORM_INDEX   /* BX,n */
};

static const struct instruction_row {
    char name[8];
    uint8_t code, form;
    bool waits; /* stands in mechanisms and in the modules of a block */
} rows[] = {
    {"LDR", CODE_LDR, FORM_BIT, false},
    {"LA", CODE_LA, FORM_BIT, false},
    {"LO", CODE_LO, FORM_BIT, false},
    {"LX", CODE_LX, FORM_BIT, false},
    {"WR", CODE_WR, FORM_WRITTEN_BIT, false},
    {"CA", CODE_CA, FORM_NOTHING, false},
    {"FL", CODE_FL, FORM_FLAG, false},
    {"FL1", CODE_FL1, FORM_FLAG, false},
    {"JUM", CODE_JUM, FORM_LABEL, false},
    {"JL0", CODE_JL0, FORM_LABEL, false},
    {"JL1", CODE_JL1, FORM_LABEL, false},
    {"EX", CODE_EX, FORM_NOTHING, true},
    {"EX0", CODE_EX0, FORM_NOTHING, true},
    {"EX1", CODE_EX1, FORM_NOTHING, true},
    {"TEX0", CODE_TEX0, FORM_TIME, true},
    {"LOD", CODE_LOD, FORM_NUMBER, false},
    {"STO", CODE_STO, FORM_STORE, false},
    {"AD", CODE_AD, FORM_NUMBER, false},
    {"SU", CODE_SU, FORM_NUMBER, false},
    {"ORB", CODE_ORB, FORM_WHOLE, false},
    {"ANDB", CODE_ANDB, FORM_WHOLE, false},
    {"XORB", CODE_XORB, FORM_WHOLE, false},
    {"MULB", CODE_MULB, FORM_NUMBER, false},
    {"DIVB", CODE_DIVB, FORM_NUMBER, false},
    {"EQ", CODE_EQ, FORM_NUMBER, false},
    {"LE", CODE_LE, FORM_NUMBER, false},
    {"LT", CODE_LT, FORM_NUMBER, false},
    {"GE", CODE_GE, FORM_NUMBER, false},
    {"GT", CODE_GT, FORM_NUMBER, false},
    {"ABS", CODE_ABS, FORM_TYPE, false},
    {"RR", CODE_RR, FORM_SHIFT, false},
    {"ESET", CODE_ESET, FORM_NOTHING, false},
    {"LDR_LIC", CODE_LICENCE, FORM_LICENCE, false},
    {"CLI", CODE_NOTHING, FORM_NOTHING, false},
    {"STI", CODE_NOTHING, FORM_NOTHING, false},
    {"MOV", CODE_BX, FORM_INDEX, false},
};

/* ---- Operands -------------------------------------------------------------------------------------------------------- */

static bool parse(struct translator *translator, struct cnc_word word, struct cnc_operand *operand)
{
    struct cnc_text_fault fault;

    if (cnc_parse_operand(word.text, word.length, &translator->program->names, operand, &fault))
        return true;
    cnc_plc_wrong(translator, fault.reason, (struct cnc_word){word.text + fault.at, fault.length});
    return false;
}

static void parse_bit(struct translator *translator, struct cnc_word word, bool is_written, struct cnc_operand *operand)
{
    if (!parse(translator, word, operand))
        return;
    if (operand->kind != CNC_OPERAND_BIT && operand->kind != CNC_OPERAND_QUEUE_BIT)
        cnc_plc_wrong(translator, "expected a bit; this is a number", word);
    else if (is_written && !operand->writable)
        cnc_plc_wrong(translator, "this bit may only be read", word);
}

static void parse_number(struct translator *translator, struct cnc_word word, struct cnc_operand *operand)
{
    if (parse(translator, word, operand) && (operand->kind == CNC_OPERAND_BIT || operand->kind == CNC_OPERAND_QUEUE_BIT))
        cnc_plc_wrong(translator, "expected a number; this is a bit", word);
}

static void parse_whole(struct translator *translator, struct cnc_word word, struct cnc_operand *operand)
{
    parse_number(translator, word, operand);
    if (operand->type == CNC_REAL)
        cnc_plc_wrong(translator, "expected a whole number; this is REAL", word);
}

static void check_written(struct translator *translator, struct cnc_word word, const struct cnc_operand *operand)
{
    if (operand->kind == CNC_OPERAND_CONSTANT)
        cnc_plc_wrong(translator, "expected a cell; this is a constant", word);
    else if ((operand->kind == CNC_OPERAND_NUMBER || operand->kind == CNC_OPERAND_QUEUE) && !operand->writable)
        cnc_plc_wrong(translator, "this cell may only be read", word);
}

/* A number, or a cell with one. */
static void parse_value(struct translator *translator, struct cnc_word word, struct cnc_operand *operand)
{
    operand->kind = CNC_OPERAND_CONSTANT;
    operand->type = CNC_QWRD;
    if (!cnc_plc_value(translator, word, &operand->value))
        parse_whole(translator, word, operand);
}

static void find_label(struct translator *translator, struct cnc_word word, struct cnc_operand *operand)
{
    const struct cnc_symbol *symbol =
        cnc_find_symbol(&translator->program->names, cnc_plc_part_of(translator) + 1, word.text, word.length);

    if (symbol)
        operand->value = symbol->value;
    else
        cnc_plc_wrong(translator, "this section or mechanism has no label", word);
}

static void parse_type(struct translator *translator, struct cnc_word word, struct cnc_operand *operand)
{
    operand->type = (uint8_t)cnc_find_type(word.text, word.length);
    if (operand->type >= CNC_REAL)
        cnc_plc_wrong(translator, "expected BYTE, WORD, DWRD or QWRD", word);
}

/* ---- Forms with several words ---------------------------------------------------------------------------------------- */

static void translate_flag(struct translator *translator, const struct cnc_word *word, struct cnc_operand *operand)
{
    int64_t value = 0;

    if (!cnc_plc_value(translator, word[0], &value) || value > 1)
        cnc_plc_wrong(translator, "expected 0 or 1", word[0]);
    parse_bit(translator, word[1], true, operand);
    operand->value = value;
}

static void translate_time(struct translator *translator, const struct cnc_word *word, struct cnc_instruction *counter)
{
    parse_whole(translator, word[0], &counter->operand);
    check_written(translator, word[0], &counter->operand);
    if (!cnc_plc_value(translator, word[3], &counter->operand.value))
        cnc_plc_wrong(translator, "expected a number", word[3]);
    parse_value(translator, word[1], &cnc_plc_emit(translator, CODE_TIME)->operand);
    find_label(translator, word[2], &cnc_plc_emit(translator, CODE_JUM)->operand);
}

static void translate_shift(struct translator *translator, const struct cnc_word *word, struct cnc_operand *operand)
{
    struct cnc_operand places;

    if (parse(translator, word[0], &places)) {
        if (places.kind != CNC_OPERAND_CONSTANT || places.value > 63)
            cnc_plc_wrong(translator, "expected CNST. and a number up to 63", word[0]);
        operand->value = places.value;
    }
    parse_type(translator, word[1], operand);
}

static void translate_index(struct translator *translator, const struct cnc_word *word, struct cnc_operand *operand)
{
    if (!cnc_same_name("BX", word[0].text, word[0].length))
        cnc_plc_wrong(translator, "expected BX", word[0]);
    parse_value(translator, word[1], operand);
}

static void translate_licence(struct translator *translator, struct cnc_word word, struct cnc_operand *operand)
{
    int licence = cnc_find_license(word.text, word.length);

    if (licence < 0)
        cnc_plc_wrong(translator, "there is no licence", word);
    operand->value = licence;
}

/* ---- Instructions ---------------------------------------------------------------------------------------------------- */

static void translate_form(struct translator *translator, enum form form, struct cnc_instruction *instruction)
{
    const struct cnc_word *word = translator->line.argument;
    struct cnc_operand *operand = &instruction->operand;

    switch (form) {
    case FORM_NOTHING: break;
    case FORM_BIT: parse_bit(translator, word[0], false, operand); break;
    case FORM_WRITTEN_BIT: parse_bit(translator, word[0], true, operand); break;
    case FORM_FLAG: translate_flag(translator, word, operand); break;
    case FORM_LABEL: find_label(translator, word[0], operand); break;
    case FORM_TIME: translate_time(translator, word, instruction); break;
    case FORM_NUMBER: parse_number(translator, word[0], operand); break;
    case FORM_WHOLE: parse_whole(translator, word[0], operand); break;
    case FORM_STORE:
        parse_number(translator, word[0], operand);
        check_written(translator, word[0], operand);
        break;
    case FORM_TYPE: parse_type(translator, word[0], operand); break;
    case FORM_SHIFT: translate_shift(translator, word, operand); break;
    case FORM_LICENCE: translate_licence(translator, word[0], operand); break;
    case FORM_INDEX: translate_index(translator, word, operand); break;
    }
}

static bool may_wait(const struct translator *translator)
{
    return translator->mechanism != CNC_NOWHERE || translator->section == CNC_PLC_BLOCK_INIT ||
           translator->section == CNC_PLC_BLOCK_DONE;
}

/* SPI_AX_x: the axis, -1 if the name is another one. */
static int spindle_axis(struct cnc_word name)
{
    if (name.length <= 7 || !cnc_same_name("SPI_AX_", name.text, 7))
        return -1;
    return cnc_find_axis(name.text + 7, name.length - 7);
}

void cnc_translate_instruction(struct translator *translator)
{
    static const uint8_t words[] = {[FORM_NOTHING] = 0, [FORM_BIT] = 1,   [FORM_WRITTEN_BIT] = 1, [FORM_FLAG] = 2,
                                    [FORM_LABEL] = 1,   [FORM_TIME] = 4,  [FORM_NUMBER] = 1,      [FORM_WHOLE] = 1,
                                    [FORM_STORE] = 1,   [FORM_TYPE] = 1,  [FORM_SHIFT] = 2,       [FORM_LICENCE] = 1,
                                    [FORM_INDEX] = 2};
    static const char *const expected[] = {"expected nothing behind", "expected one operand of", "expected two operands of", "",
                                           "expected counter, time, label and code behind"};
    const struct cnc_plc_line *line = &translator->line;
    const struct instruction_row *row = rows;
    const struct instruction_row spindle = {"SPI_AX_", CODE_SPINDLE_AXIS, FORM_NOTHING, false};
    int axis = spindle_axis(line->name);

    while (row < rows + sizeof rows / sizeof *rows && !cnc_same_name(row->name, line->name.text, line->name.length))
        row++;
    if (axis >= 0)
        row = &spindle;
    if (row == rows + sizeof rows / sizeof *rows) {
        cnc_plc_wrong(translator, "unknown instruction", line->name);
        return;
    }
    if (translator->section == CNC_NOWHERE)
        cnc_plc_wrong(translator, "expected a section before the instruction", line->name);
    else if (row->waits && !may_wait(translator))
        cnc_plc_wrong(translator, "only mechanisms, MODULE_BLOCK_INIT and MODULE_BLOCK_DONE have", line->name);
    else if (line->arguments != words[row->form])
        cnc_plc_wrong(translator, expected[words[row->form]], line->name);
    else {
        struct cnc_instruction *instruction = cnc_plc_emit(translator, (enum cnc_plc_code)row->code);
        if (axis >= 0)
            instruction->operand.value = axis;
        translate_form(translator, (enum form)row->form, instruction);
    }
}
