/* SPDX-License-Identifier: MIT */
/* NC programs as text (NN1, NN2): a line is a block of words, a letter and a number each. */
#include <string.h>

#include "nc.h"

#define MM_MAX (CNC_POSITION_MAX_MM * INT64_C(1000000))
#define MILLION INT64_C(1000000)
#define BILLION INT64_C(1000000000)

/* What a word is. */
enum kind { KIND_AXIS, KIND_FEED, KIND_SPEED, KIND_LIMIT, KIND_OTHER, KIND_M, KIND_G, KIND_NUMBER };

struct row {
    char letter;
    bool has_index;  /* A4=, I0=, R0= */
    bool is_whole;
    uint8_t kind;    /* enum kind */
    uint8_t first;   /* KIND_OTHER: enum cnc_nc_word, of index 0; KIND_AXIS: the axis */
    int64_t low, high; /* in millionths */
    const char *expected;
};

static const char expected_position[] = "expected a position from -200000 to 200000 mm, up to six decimals";
static const char expected_rate[] = "expected a number above 0, up to 1000000, up to six decimals";

static const struct row rows[] = {
    {'X', false, false, KIND_AXIS, 0, -MM_MAX, MM_MAX, expected_position},
    {'Y', false, false, KIND_AXIS, 1, -MM_MAX, MM_MAX, expected_position},
    {'Z', false, false, KIND_AXIS, 2, -MM_MAX, MM_MAX, expected_position},
    {'A', true, false, KIND_AXIS, 0, -MM_MAX, MM_MAX, expected_position},
    {'F', false, false, KIND_FEED, 0, 1, MILLION * MILLION, expected_rate},
    {'S', false, false, KIND_SPEED, 0, 1, MILLION * MILLION, expected_rate},
    {'L', false, false, KIND_LIMIT, 0, 1, MILLION * MILLION, expected_rate},
    {'P', false, false, KIND_OTHER, CNC_NC_DELAY, 0, MILLION * MILLION, "expected seconds from 0 to 1000000, up to six decimals"},
    {'T', false, true, KIND_OTHER, CNC_NC_T, 0, 99999999 * MILLION, "expected a whole number from 0 to 99999999"},
    {'H', false, false, KIND_OTHER, CNC_NC_H, 0, MILLION * MILLION, "expected a number from 0 to 1000000, up to six decimals"},
    {'I', true, true, KIND_OTHER, CNC_NC_I0, -2147483648 * MILLION, 2147483647 * MILLION,
     "expected a whole number from -2147483648 to 2147483647"},
    {'R', true, false, KIND_OTHER, CNC_NC_R0, -BILLION * MILLION, BILLION * MILLION,
     "expected a number from -1000000000 to 1000000000, up to six decimals"},
    {'M', false, true, KIND_M, 0, 0, CNC_M_MAX * MILLION, "expected M0 to M100"},
    {'G', false, true, KIND_G, 0, 0, 999 * MILLION, "expected G0, G1, G4, G23, G24, G33 or G94 to G97"},
    {'N', false, true, KIND_NUMBER, 0, 0, BILLION * MILLION, "expected a number of a block"},
};
#define ROWS (sizeof rows / sizeof rows[0])

/* G functions: one of each group in a block. */
enum g_group { G_MOTION, G_DELAY, G_CONTINUOUS, G_FEED, G_SPEED, G_GROUPS };
static const struct {
    uint8_t number, group, value; /* value: enum cnc_motion, or whether the mode is on */
} functions[] = {
    {0, G_MOTION, CNC_MOTION_RAPID}, {1, G_MOTION, CNC_MOTION_FEED}, {33, G_MOTION, CNC_MOTION_THREAD}, {4, G_DELAY, 1},
    {23, G_CONTINUOUS, 1}, {24, G_CONTINUOUS, 0}, {94, G_FEED, 0}, {95, G_FEED, 1}, {96, G_SPEED, 1}, {97, G_SPEED, 0},
};
#define FUNCTIONS (sizeof functions / sizeof functions[0])

/* A line while it is read. */
struct line {
    bool has_words, has_number, failed;
    uint16_t axes, words;
    uint8_t rates;                      /* bits KIND_FEED, KIND_SPEED, KIND_LIMIT */
    uint8_t g;                          /* bits of enum g_group */
    uint8_t m[CNC_M_GROUPS + 1];
    uint32_t axis_column, delay_column; /* of the first axis word; of P or G04 */
    int64_t target[CNC_AXES], word[CNC_NC_WORDS], rate[KIND_LIMIT + 1];
};

struct reader {
    const char *text;
    size_t length, at, line_begin;
    uint32_t number; /* of the line */
    struct cnc_text_errors errors;
    const struct cnc_config *config;
    struct cnc_nc_program *program;
    struct cnc_nc_block modal; /* what is in force */
    uint8_t motion;            /* enum cnc_motion in force */
    struct line line;
};

static bool has_bit(unsigned bits, unsigned bit)
{
    return (bits >> bit & 1u) != 0;
}

static uint32_t column_here(const struct reader *reader)
{
    return (uint32_t)(reader->at - reader->line_begin) + 1;
}

/* The first error of a line is the only one. */
static bool fail_with(struct reader *reader, uint32_t column, const char *before, const char *piece, size_t length)
{
    cnc_text_fail(&reader->errors, reader->number, column, before, piece, length, "");
    reader->line.failed = true;
    return false;
}

static bool fail(struct reader *reader, uint32_t column, const char *expected)
{
    return fail_with(reader, column, expected, "", 0);
}

/* The character here; 0 at the end of the line. */
static char peek(const struct reader *reader)
{
    return reader->at < reader->length && reader->text[reader->at] != '\n' ? reader->text[reader->at] : '\0';
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r';
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

static void skip_blank(struct reader *reader)
{
    while (reader->at < reader->length && is_blank(peek(reader)))
        reader->at++;
}

/* ---- Words --------------------------------------------------------------------------------------------------------- */

/* [+-]digits[.digits], in millionths. Returns false if it is something else, has more than six decimals, or a point where the
 * word takes whole numbers only. */
static bool read_number(struct reader *reader, bool is_whole, int64_t *value)
{
    bool negative = peek(reader) == '-', has_point = false, fits = true;
    unsigned digits = 0, decimals = 0;
    int64_t number = 0;
    reader->at += negative || peek(reader) == '+';
    for (; is_digit(peek(reader)) || (peek(reader) == '.' && !has_point); reader->at++) {
        if (peek(reader) == '.') {
            has_point = true;
            continue;
        }
        fits = fits && number < BILLION * MILLION;
        if (fits)
            number = number * 10 + (peek(reader) - '0');
        digits++;
        decimals += has_point;
    }
    for (unsigned i = decimals; i < 6 && fits; i++) {
        fits = number < BILLION * MILLION;
        number = fits ? number * 10 : number;
    }
    *value = negative ? -number : number;
    return digits > 0 && decimals <= 6 && fits && !(has_point && is_whole) && peek(reader) != '.';
}

/* The digits and = of A4=, I0=, R0=. Returns the index, or -1. */
static int read_index(struct reader *reader, const struct row *row)
{
    const char *begin = reader->text + reader->at;
    size_t length = 0;
    while (is_digit(peek(reader))) {
        reader->at++;
        length++;
    }
    skip_blank(reader);
    if (peek(reader) != '=')
        return -1;
    reader->at++;
    if (row->kind == KIND_AXIS)
        return cnc_find_axis(begin, length);
    return length == 1 && begin[0] < '0' + (int)CNC_NC_PARAMETERS ? begin[0] - '0' : -1;
}

static bool take_axis(struct reader *reader, uint32_t column, unsigned axis, int64_t value)
{
    struct line *line = &reader->line;
    if (!reader->config->axis[axis].is_configured)
        return fail_with(reader, column, "expected an axis of the configuration, which does not have ", cnc_axis_names[axis],
                         strlen(cnc_axis_names[axis]));
    if (has_bit(line->axes, axis))
        return fail(reader, column, "expected each axis once in a block");
    line->axis_column = line->axes == 0 ? column : line->axis_column;
    line->axes = (uint16_t)(line->axes | 1u << axis);
    line->target[axis] = value * 8192 / 125; /* millionths of a mm are 65.536 u each; cut towards 0 */
    return true;
}

static bool take_m(struct reader *reader, uint32_t column, unsigned m)
{
    uint8_t *place = &reader->line.m[reader->config->m[m].group];
    if (*place != CNC_NC_NO_M)
        return fail(reader, column, "expected one M function of each group in a block");
    *place = (uint8_t)m;
    return true;
}

static void put_mode(struct cnc_nc_block *modal, unsigned mode, bool is_on)
{
    modal->modes = (uint8_t)(is_on ? modal->modes | mode : modal->modes & ~mode);
}

static bool take_g(struct reader *reader, uint32_t column, unsigned g)
{
    struct line *line = &reader->line;
    unsigned which = 0;
    while (which < FUNCTIONS && functions[which].number != g)
        which++;
    if (which == FUNCTIONS)
        return fail(reader, column, "expected G0, G1, G4, G23, G24, G33 or G94 to G97: other functions are not emulated");
    const unsigned group = functions[which].group, value = functions[which].value;
    if (has_bit(line->g, group))
        return fail(reader, column, "expected one G function of a kind in a block");
    line->g = (uint8_t)(line->g | 1u << group);
    if (group == G_MOTION)
        reader->motion = (uint8_t)value;
    else if (group == G_CONTINUOUS)
        put_mode(&reader->modal, CNC_NC_CONTINUOUS, value);
    else if (group == G_FEED)
        put_mode(&reader->modal, CNC_NC_PER_REVOLUTION, value);
    else if (group == G_SPEED)
        put_mode(&reader->modal, CNC_NC_CONSTANT_CUT, value);
    else
        line->delay_column = column;
    return true;
}

static bool take_word(struct reader *reader, const struct row *row, uint32_t column, unsigned index, int64_t value)
{
    struct line *line = &reader->line;
    unsigned word = row->first + index;
    switch ((enum kind)row->kind) {
    case KIND_AXIS:
        return take_axis(reader, column, row->first + index, value);
    case KIND_M:
        return take_m(reader, column, (unsigned)(value / MILLION));
    case KIND_G:
        return take_g(reader, column, (unsigned)(value / MILLION));
    case KIND_NUMBER:
        if (line->has_number)
            return fail(reader, column, "expected N once in a block");
        line->has_number = true;
        return true;
    case KIND_OTHER:
        if (has_bit(line->words, word))
            return fail(reader, column, "expected each word once in a block");
        line->words = (uint16_t)(line->words | 1u << word);
        line->word[word] = row->is_whole ? value / MILLION : value;
        line->delay_column = word == CNC_NC_DELAY ? column : line->delay_column;
        return true;
    case KIND_FEED:
    case KIND_SPEED:
    case KIND_LIMIT:
        break;
    }
    if (has_bit(line->rates, row->kind))
        return fail(reader, column, "expected each word once in a block");
    line->rates = (uint8_t)(line->rates | 1u << row->kind);
    line->rate[row->kind] = value;
    return true;
}

static bool read_word(struct reader *reader)
{
    const uint32_t column = column_here(reader);
    const char found = peek(reader), letter = (char)(found >= 'a' && found <= 'z' ? found - 'a' + 'A' : found);
    unsigned which = 0;
    while (which < ROWS && rows[which].letter != letter)
        which++;
    if (which == ROWS)
        return fail_with(reader, column, "expected N, G, X, Y, Z, A4= to A16=, F, S, L, T, H, M, P, I0= to I4=, R0= to R4=, not ",
                         reader->text + reader->at, 1);
    const struct row *row = &rows[which];
    reader->at++;
    skip_blank(reader);
    int index = row->has_index ? read_index(reader, row) : 0;
    if (index < 0)
        return fail(reader, column, letter == 'A'   ? "expected A4= to A16="
                                    : letter == 'I' ? "expected I0= to I4="
                                                    : "expected R0= to R4=");
    skip_blank(reader);
    const uint32_t value_column = column_here(reader);
    int64_t value = 0;
    if (!read_number(reader, row->is_whole, &value) || value < row->low || value > row->high)
        return fail(reader, value_column, row->expected);
    reader->line.has_words = true;
    return take_word(reader, row, column, (unsigned)index, value);
}

/* ---- Blocks -------------------------------------------------------------------------------------------------------- */

static bool add_value(struct reader *reader, int64_t value)
{
    struct cnc_nc_program *program = reader->program;
    if (program->value_count == program->value_room)
        return false;
    program->values[program->value_count++] = value;
    return true;
}

/* The rates of a line come into force: each has its own value. */
static bool put_rates(struct reader *reader)
{
    struct cnc_nc_block *modal = &reader->modal;
    uint32_t *const place[] = {[KIND_FEED] = &modal->feed,
                               [KIND_SPEED] = (modal->modes & CNC_NC_CONSTANT_CUT) != 0 ? &modal->cutting_speed : &modal->speed,
                               [KIND_LIMIT] = &modal->speed_limit};
    for (unsigned kind = KIND_FEED; kind <= KIND_LIMIT; kind++) {
        if (!has_bit(reader->line.rates, kind))
            continue;
        *place[kind] = reader->program->value_count;
        if (!add_value(reader, reader->line.rate[kind]))
            return false;
    }
    return true;
}

static bool add_block(struct reader *reader)
{
    const struct line *line = &reader->line;
    struct cnc_nc_program *program = reader->program;
    struct cnc_nc_block block = reader->modal;
    block.line = reader->number;
    block.values = program->value_count;
    block.axes = line->axes;
    block.words = line->words;
    block.motion = line->axes != 0 ? reader->motion : (uint8_t)CNC_MOTION_NONE;
    block.has_speed = has_bit(line->rates, KIND_SPEED);
    memcpy(block.m, line->m, sizeof block.m);
    bool fits = program->block_count < program->block_room && program->block_count < CNC_NC_BLOCKS_MAX;
    for (unsigned axis = 0; axis < CNC_AXES; axis++)
        fits = fits && (!has_bit(line->axes, axis) || add_value(reader, line->target[axis]));
    for (unsigned word = 0; word < CNC_NC_WORDS; word++)
        fits = fits && (!has_bit(line->words, word) || add_value(reader, line->word[word]));
    if (!fits || !put_rates(reader))
        return fail(reader, 1, "expected at most 1000000 blocks");
    block.feed = reader->modal.feed;
    block.speed = reader->modal.speed;
    block.cutting_speed = reader->modal.cutting_speed;
    block.speed_limit = reader->modal.speed_limit;
    program->blocks[program->block_count++] = block;
    return true;
}

/* What concerns more than one word of a line. */
static bool check_line(struct reader *reader)
{
    const struct line *line = &reader->line;
    bool has_feed = has_bit(line->rates, KIND_FEED) || reader->modal.feed != CNC_NC_NONE;
    bool has_delay = has_bit(line->words, CNC_NC_DELAY);
    if (line->axes != 0 && reader->motion == CNC_MOTION_NONE)
        return fail(reader, line->axis_column, "expected G0, G1 or G33 before an axis");
    if (line->axes != 0 && reader->motion != CNC_MOTION_RAPID && !has_feed)
        return fail(reader, line->axis_column, "expected F before a motion with G1 or G33");
    if (has_delay != has_bit(line->g, G_DELAY))
        return fail(reader, line->delay_column, has_delay ? "expected G4 with P" : "expected P with G4");
    return true;
}

/* ( ... ) or ; to the end of the line. */
static bool skip_comment(struct reader *reader)
{
    const uint32_t column = column_here(reader);
    const char end = peek(reader) == '(' ? ')' : '\0';
    while (peek(reader) != end && peek(reader) != '\0')
        reader->at++;
    while (end == '\0' && reader->at < reader->length && reader->text[reader->at] != '\n')
        reader->at++; /* a byte 0 in the comment */
    if (end != '\0' && peek(reader) != end)
        return fail(reader, column, "expected ) behind a comment");
    reader->at += end != '\0';
    return true;
}

static void read_line(struct reader *reader)
{
    struct line *line = &reader->line;
    memset(line, 0, sizeof *line);
    memset(line->m, (int)CNC_NC_NO_M, sizeof line->m);
    reader->line_begin = reader->at;
    bool going_on = true;
    while (going_on) {
        skip_blank(reader);
        if (reader->at == reader->length || reader->text[reader->at] == '\n')
            break;
        const char c = reader->text[reader->at];
        going_on = c == '(' || c == ';' ? skip_comment(reader) : read_word(reader);
    }
    while (reader->at < reader->length && reader->text[reader->at] != '\n')
        reader->at++;
    if (going_on && line->has_words && check_line(reader))
        (void)add_block(reader);
}

void cnc_nc_measure(const char *text, size_t length, uint32_t *blocks, uint32_t *values)
{
    *blocks = 1;
    *values = 0;
    for (size_t i = 0; i < length; i++) {
        const char c = text[i];
        *blocks += c == '\n' && *blocks < CNC_NC_BLOCKS_MAX;
        *values += ((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z')) && *values < UINT32_MAX - 1;
    }
}

bool cnc_nc_read(const char *text, size_t length, const struct cnc_config *config, struct cnc_nc_program *program,
                 cnc_text_report *report, void *context)
{
    struct reader reader = {.text = text, .length = length, .config = config, .program = program,
                            .errors = {.report = report, .context = context}};
    reader.modal.feed = reader.modal.speed = reader.modal.cutting_speed = reader.modal.speed_limit = CNC_NC_NONE;
    program->block_count = program->value_count = 0;
    if (length >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0)
        reader.at = 3;
    while (reader.at < length && reader.errors.count < CNC_TEXT_ERRORS_MAX) {
        reader.number++;
        read_line(&reader);
        reader.at += reader.at < length; /* the end of the line */
    }
    if (reader.errors.count > 0)
        program->block_count = program->value_count = 0;
    return reader.errors.count == 0;
}

/* ---- What a block says --------------------------------------------------------------------------------------------- */

static unsigned count_bits(unsigned bits)
{
    unsigned count = 0;
    for (; bits != 0; bits &= bits - 1)
        count++;
    return count;
}

bool cnc_nc_target(const struct cnc_nc_program *program, const struct cnc_nc_block *block, unsigned axis, int64_t *target)
{
    if (!has_bit(block->axes, axis))
        return false;
    *target = program->values[block->values + count_bits(block->axes & ((1u << axis) - 1u))];
    return true;
}

int64_t cnc_nc_word(const struct cnc_nc_program *program, const struct cnc_nc_block *block, enum cnc_nc_word word)
{
    if (!has_bit(block->words, word))
        return 0;
    return program->values[block->values + count_bits(block->axes) + count_bits(block->words & ((1u << word) - 1u))];
}

int64_t cnc_nc_value(const struct cnc_nc_program *program, uint32_t index)
{
    return index == CNC_NC_NONE ? 0 : program->values[index];
}
