/* SPDX-License-Identifier: MIT */
/* CONFIG.xml (NJ1 to NJ3): elements, attributes, comments, the XML line; nothing else. */
#include <string.h>

#include "config.h"
#include "xml.h"

enum element { ELEMENT_NONE, ELEMENT_CHANNEL, ELEMENT_M_FUNCTIONS, ELEMENT_M_FUNCTION, ELEMENT_AXIS, ELEMENT_GEAR, ELEMENTS };
#define DEPTH 3u       /* elements inside one another */
#define ROWS_MAX 32u   /* attributes of an element */

/* What an element says, before it is in the configuration. */
struct channel {
    uint8_t is_parabolic, manual_by_man;
    uint16_t no_license;
};
struct m_function {
    uint32_t no, group;
    uint8_t break_cont, break_cont_end, change_pos;
};
struct gear {
    uint32_t no, min_speed, max_speed;
};
struct axis {
    struct cnc_axis_config axis;
    uint32_t linear[CNC_SETS]; /* 1/1000 mm/s^2 */
    uint8_t name, geometry, needs_reference, needs_reference_in_aut, is_rotary, searches_plus;
};
union reading {
    struct channel channel;
    struct m_function m_function;
    struct gear gear;
    struct axis axis;
};

/* How a value is written, and what lies in its place. */
enum kind {
    KIND_WHOLE,        /* uint32_t */
    KIND_MILLI,        /* up to three decimals -> uint32_t, thousandths */
    KIND_ACCELERATION, /* up to three decimals -> int64_t, u/T^2 */
    KIND_MM,           /* up to three decimals -> int64_t, u */
    KIND_UM,           /* up to three decimals -> int64_t, u, rounded down */
    KIND_BYTE,         /* uint8_t */
    KIND_AXIS,         /* uint8_t, index */
    KIND_MANUAL,       /* PI or MAN -> uint8_t, 0 or 1 */
    KIND_DIRECTION,    /* - or + -> uint8_t, 0 or 1 */
    KIND_LICENSES      /* names -> uint16_t */
};

struct row {
    uint8_t element; /* enum element */
    uint8_t kind;    /* enum kind */
    uint16_t place;  /* offset in the reading of the element */
    const char *name;
    const char *standard; /* NULL: none */
    int64_t low, high;    /* of a number, in thousandths if it may have decimals */
    const char *expected;
};

static const char expected_rate[] = "expected a number from 0.001 to 1000000, up to three decimals";
static const char expected_length[] = "expected mm from -200000 to 200000, up to three decimals";
static const char expected_um[] = "expected um from 0 to 1000000, up to three decimals";
static const char expected_speed[] = "expected rev/min from 0 to 1000000, up to three decimals";
static const char expected_flag[] = "expected 0 or 1";

#define AXIS(name, kind, field, standard, low, high, expected) \
    {ELEMENT_AXIS, kind, offsetof(struct axis, field), name, standard, low, high, expected}
#define RATE(name, kind, field, standard) AXIS(name, kind, field, standard, 1, 1000000000, expected_rate)
#define LENGTH(name, field, standard) AXIS(name, KIND_MM, axis.field, standard, -200000000, 200000000, expected_length)

static const struct row rows[] = {
    {ELEMENT_CHANNEL, KIND_BYTE, offsetof(struct channel, is_parabolic), "AccelerationType", "0", 0, 1, expected_flag},
    {ELEMENT_CHANNEL, KIND_MANUAL, offsetof(struct channel, manual_by_man), "ManualEnable", "PI", 0, 0, "expected PI or MAN"},
    {ELEMENT_CHANNEL, KIND_LICENSES, offsetof(struct channel, no_license), "NoLicense", "", 0, 0,
     "expected HwKeyConnected or FeaturePlc0 to FeaturePlc9, spaces between them"},
    {ELEMENT_M_FUNCTION, KIND_WHOLE, offsetof(struct m_function, no), "No", NULL, 0, CNC_M_MAX,
     "expected a number from 0 to 100"},
    {ELEMENT_M_FUNCTION, KIND_WHOLE, offsetof(struct m_function, group), "GroupNo", "14", 1, CNC_M_GROUPS,
     "expected a number from 1 to 14"},
    {ELEMENT_M_FUNCTION, KIND_BYTE, offsetof(struct m_function, break_cont), "BreakCont", "0", 0, 1, expected_flag},
    {ELEMENT_M_FUNCTION, KIND_BYTE, offsetof(struct m_function, break_cont_end), "BreakContEnd", "0", 0, 1, expected_flag},
    {ELEMENT_M_FUNCTION, KIND_BYTE, offsetof(struct m_function, change_pos), "ChangePos", "0", 0, 1, expected_flag},
    {ELEMENT_GEAR, KIND_WHOLE, offsetof(struct gear, no), "No", NULL, 1, CNC_GEARS, "expected a number from 1 to 32"},
    {ELEMENT_GEAR, KIND_MILLI, offsetof(struct gear, min_speed), "MinSpeed", "0", 0, 1000000000, expected_speed},
    {ELEMENT_GEAR, KIND_MILLI, offsetof(struct gear, max_speed), "MaxSpeed", NULL, 1, 1000000000, expected_rate},
    AXIS("Name", KIND_AXIS, name, NULL, 0, 0, "expected X, Y, Z, or a number from 4 to 16"),
    RATE("Feed", KIND_MILLI, axis.feed, "2000"),
    RATE("FeedRT", KIND_MILLI, axis.feed_rapid, "12000"),
    RATE("FeedSlow", KIND_MILLI, axis.feed_slow, "300"),
    RATE("FeedRef", KIND_MILLI, axis.feed_reference, "300"),
    RATE("Acceleration", KIND_ACCELERATION, axis.acceleration[CNC_SET_NORMAL], "500"),
    RATE("AccelerationRT", KIND_ACCELERATION, axis.acceleration[CNC_SET_RAPID], "1000"),
    RATE("AccelerationEmergency", KIND_ACCELERATION, axis.acceleration[CNC_SET_EMERGENCY], "2000"),
    RATE("LinearAccel", KIND_MILLI, linear[CNC_SET_NORMAL], "500"),
    RATE("LinearAccelRT", KIND_MILLI, linear[CNC_SET_RAPID], "1000"),
    RATE("LinearAccelEmergency", KIND_MILLI, linear[CNC_SET_EMERGENCY], "2000"),
    RATE("ParabAccel", KIND_MILLI, axis.parabolic[CNC_SET_NORMAL], "10"),
    RATE("ParabAccelRT", KIND_MILLI, axis.parabolic[CNC_SET_RAPID], "20"),
    RATE("ParabAccelEmergency", KIND_MILLI, axis.parabolic[CNC_SET_EMERGENCY], "40"),
    AXIS("MaxDifference", KIND_UM, axis.max_difference, "5", 0, 1000000000, expected_um),
    AXIS("MaxLag", KIND_WHOLE, axis.max_lag, "0", 0, 1000000, "expected um from 0 to 1000000, whole"),
    AXIS("Lag", KIND_WHOLE, axis.lag, "1", 1, 1000000, "expected T from 1 to 1000000, whole"),
    AXIS("NeedRef", KIND_BYTE, needs_reference, "0", 0, 1, expected_flag),
    AXIS("AutNeedRef", KIND_BYTE, needs_reference_in_aut, "0", 0, 1, expected_flag),
    AXIS("RefMethod", KIND_BYTE, axis.reference_method, "0", 0, 2, "expected 0, 1 or 2"),
    AXIS("RefDir", KIND_DIRECTION, searches_plus, "-", 0, 0, "expected + or -"),
    LENGTH("MachineNullPoint", null_point, "0"),
    LENGTH("SlsMinus", sls_minus, NULL),
    LENGTH("SlsPlus", sls_plus, NULL),
    LENGTH("LengthCorrection", length_correction, "0"),
    LENGTH("Offset1", offset1, "0"),
    LENGTH("Offset2", offset2, "0"),
    AXIS("Geo", KIND_BYTE, geometry, NULL, 0, 2, "expected 0, 1 or 2"),
    AXIS("Rotary", KIND_BYTE, is_rotary, "0", 0, 1, expected_flag),
};
#define ROWS (sizeof rows / sizeof rows[0])

/* Names of elements; MFuncs is what the table of 8.3.5 prints for MFunc. */
static const struct {
    const char *name;
    uint8_t element, parents; /* bits of enum element */
    const char *inside; /* what may stand in it */
} elements[] = {
    {"ChannelConfig", ELEMENT_CHANNEL, 1u << ELEMENT_NONE, "expected Axis, Gear, MFunctions or </ChannelConfig>"},
    {"MFunctions", ELEMENT_M_FUNCTIONS, 1u << ELEMENT_NONE | 1u << ELEMENT_CHANNEL, "expected MFunc or </MFunctions>"},
    {"MFunc", ELEMENT_M_FUNCTION, 1u << ELEMENT_M_FUNCTIONS, "expected </MFunc>"},
    {"MFuncs", ELEMENT_M_FUNCTION, 1u << ELEMENT_M_FUNCTIONS, "expected </MFuncs>"},
    {"Axis", ELEMENT_AXIS, 1u << ELEMENT_CHANNEL, "expected </Axis>"},
    {"Gear", ELEMENT_GEAR, 1u << ELEMENT_CHANNEL, "expected </Gear>"},
};
#define ELEMENT_NAMES (sizeof elements / sizeof elements[0])

struct reader {
    struct cnc_xml xml;
    struct cnc_config *config;
    unsigned open[DEPTH], depth; /* indices of elements */
    bool has_root;
    union reading reading;
    struct cnc_piece element;        /* name of the present one */
    struct cnc_piece given[ROWS];    /* values of its attributes; text NULL: not given */
    uint8_t geometry_given;      /* bits */
    bool m_given[CNC_M_MAX + 1];
};

/* ---- Values -------------------------------------------------------------------------------------------------------- */

/* -?digits[.digits], up to `decimals` of them. Returns false if it is something else or not within low to high. */
static bool read_number(const struct cnc_piece *piece, unsigned decimals, int64_t low, int64_t high, int64_t *value)
{
    const char *at = piece->text, *end = at + piece->length;
    bool negative = at < end && *at == '-', has_point = false;
    unsigned digits = 0, behind = 0;
    int64_t number = 0;
    for (at += negative; at < end; at++) {
        if (*at == '.' && !has_point && digits > 0 && decimals > 0) {
            has_point = true;
            continue;
        }
        if (*at < '0' || *at > '9' || number > 100000000000 || (has_point && behind == decimals))
            return false;
        number = number * 10 + (*at - '0');
        digits++;
        behind += has_point;
    }
    if (digits == 0 || (has_point && behind == 0))
        return false;
    for (; behind < decimals; behind++)
        number *= 10;
    *value = negative ? -number : number;
    return *value >= low && *value <= high;
}

static bool read_licenses(const struct cnc_piece *piece, uint16_t *licenses)
{
    const char *at = piece->text, *end = at + piece->length;
    *licenses = 0;
    while (at < end) {
        const char *begin = at;
        while (at < end && !cnc_xml_is_space(*at))
            at++;
        int license = at > begin ? cnc_find_license(begin, (size_t)(at - begin)) : 0;
        if (license < 0)
            return false;
        if (at > begin)
            *licenses = (uint16_t)(*licenses | 1u << license);
        at += at < end;
    }
    return true;
}

static bool read_choice(const struct cnc_piece *piece, const char *zero, const char *one, uint8_t *value)
{
    *value = cnc_piece_is(piece, one);
    return *value == 1 || cnc_piece_is(piece, zero);
}

static bool read_axis_name(const struct cnc_piece *piece, uint8_t *value)
{
    int axis = cnc_find_axis(piece->text, piece->length);
    *value = (uint8_t)(axis < 0 ? 0 : axis);
    return axis >= 0;
}

/* Put the value of a row into its place. */
static bool put_value(union reading *reading, const struct row *row, const struct cnc_piece *piece)
{
    void *where = (char *)reading + row->place;
    int64_t number = 0;
    switch ((enum kind)row->kind) {
    case KIND_AXIS:
        return read_axis_name(piece, where);
    case KIND_MANUAL:
        return read_choice(piece, "PI", "MAN", where);
    case KIND_DIRECTION:
        return read_choice(piece, "-", "+", where);
    case KIND_LICENSES:
        return read_licenses(piece, where);
    case KIND_BYTE:
        if (!read_number(piece, 0, row->low, row->high, &number))
            return false;
        *(uint8_t *)where = (uint8_t)number;
        return true;
    case KIND_WHOLE:
    case KIND_MILLI:
        if (!read_number(piece, row->kind == KIND_MILLI ? 3 : 0, row->low, row->high, &number))
            return false;
        *(uint32_t *)where = (uint32_t)number;
        return true;
    case KIND_ACCELERATION:
    case KIND_MM:
    case KIND_UM:
        break;
    }
    if (!read_number(piece, 3, row->low, row->high, &number))
        return false;
    *(int64_t *)where = row->kind == KIND_ACCELERATION ? cnc_acceleration_of(number)
                        : row->kind == KIND_MM         ? number * CNC_U_PER_UM
                                                       : number * CNC_U_PER_UM / 1000;
    return true;
}

/* The defaults of an element. */
static void put_standards(union reading *reading, enum element element)
{
    memset(reading, 0, sizeof *reading);
    for (unsigned i = 0; i < ROWS; i++)
        if (rows[i].element == element && rows[i].standard != NULL)
            (void)put_value(reading, &rows[i], &(struct cnc_piece){rows[i].standard, strlen(rows[i].standard), 0, 0});
}

/* The value of an attribute of the present element, which has one of this name; NULL: it is not given. */
static const struct cnc_piece *given(const struct reader *reader, const char *name)
{
    unsigned i = 0;
    while (rows[i].element != elements[reader->open[reader->depth - 1]].element || strcmp(rows[i].name, name) != 0)
        i++;
    return reader->given[i].text != NULL ? &reader->given[i] : NULL;
}

/* ---- What elements say --------------------------------------------------------------------------------------------- */

static void put_axis(struct cnc_config *config, const struct axis *read)
{
    struct cnc_axis_config *axis = &config->axis[read->name];
    *axis = read->axis;
    axis->is_configured = true;
    axis->needs_reference = read->needs_reference != 0 || read->needs_reference_in_aut != 0;
    axis->is_rotary = read->is_rotary != 0;
    axis->searches_plus = read->searches_plus != 0;
    for (unsigned set = 0; set < CNC_SETS; set++) {
        uint64_t n = (2 * (uint64_t)read->linear[set] + axis->parabolic[set]) / (2 * (uint64_t)axis->parabolic[set]);
        axis->smoothing[set] = (uint16_t)(n < 1 ? 1 : n > 1000 ? 1000 : n);
        axis->linear[set] = cnc_acceleration_of(read->linear[set]);
    }
    config->axes = (uint16_t)(config->axes | 1u << read->name);
}

static bool take_axis(struct reader *reader)
{
    struct axis *axis = &reader->reading.axis;
    const struct cnc_piece *name = given(reader, "Name"), *geometry = given(reader, "Geo");
    if (name == NULL)
        return cnc_xml_fail(&reader->xml, &reader->element, "expected Name");
    if (reader->config->axis[axis->name].is_configured)
        return cnc_xml_fail(&reader->xml, name, "expected each axis once");
    axis->axis.has_sls_minus = given(reader, "SlsMinus") != NULL;
    axis->axis.has_sls_plus = given(reader, "SlsPlus") != NULL;
    if (axis->axis.has_sls_minus && axis->axis.has_sls_plus && axis->axis.sls_minus >= axis->axis.sls_plus)
        return cnc_xml_fail(&reader->xml, given(reader, "SlsPlus"), "expected SlsPlus above SlsMinus");
    if (geometry != NULL && ((unsigned)reader->geometry_given >> axis->geometry & 1u) != 0)
        return cnc_xml_fail(&reader->xml, geometry, "expected each Geo once");
    if (geometry != NULL) {
        reader->geometry_given = (uint8_t)(reader->geometry_given | 1u << axis->geometry);
        reader->config->geometry[axis->geometry] = axis->name;
    }
    put_axis(reader->config, axis);
    return true;
}

static bool take_gear(struct reader *reader)
{
    const struct gear *gear = &reader->reading.gear;
    const struct cnc_piece *no = given(reader, "No"), *max = given(reader, "MaxSpeed");
    if (no == NULL || max == NULL)
        return cnc_xml_fail(&reader->xml, &reader->element, no == NULL ? "expected No" : "expected MaxSpeed");
    if (reader->config->gear[gear->no].is_configured)
        return cnc_xml_fail(&reader->xml, no, "expected each gear once");
    if (gear->min_speed > gear->max_speed)
        return cnc_xml_fail(&reader->xml, max, "expected MaxSpeed not below MinSpeed");
    reader->config->gear[gear->no] = (struct cnc_gear){true, gear->min_speed, gear->max_speed};
    return true;
}

static bool take_m_function(struct reader *reader)
{
    const struct m_function *m = &reader->reading.m_function;
    const struct cnc_piece *no = given(reader, "No"), *group = given(reader, "GroupNo");
    if (no == NULL)
        return cnc_xml_fail(&reader->xml, &reader->element, "expected No");
    if (reader->m_given[m->no])
        return cnc_xml_fail(&reader->xml, no, "expected each M function once");
    reader->m_given[m->no] = true;
    struct cnc_m_function *place = &reader->config->m[m->no];
    unsigned fixed = cnc_fixed_group(m->no);
    if (fixed != 0 && group != NULL && m->group != fixed) {
        const char digit = (char)('0' + fixed); /* fixed groups are 1 to 9 */
        cnc_text_fail(&reader->xml.errors, group->line, group->column, "expected GroupNo ", &digit, 1, ", which is fixed");
        return false;
    }
    place->group = fixed != 0 ? (uint8_t)fixed : (uint8_t)m->group;
    place->attributes = (uint8_t)((m->break_cont ? CNC_M_BREAK_CONT : 0) | (m->break_cont_end ? CNC_M_BREAK_CONT_END : 0) |
                                  (m->change_pos ? CNC_M_CHANGE_POS : 0));
    return true;
}

static void take_element(struct reader *reader, enum element element)
{
    const struct channel *channel = &reader->reading.channel;
    switch (element) {
    case ELEMENT_CHANNEL:
        reader->config->is_parabolic = channel->is_parabolic != 0;
        reader->config->manual_by_man = channel->manual_by_man != 0;
        reader->config->no_license = channel->no_license;
        break;
    case ELEMENT_AXIS:
        (void)take_axis(reader);
        break;
    case ELEMENT_GEAR:
        (void)take_gear(reader);
        break;
    case ELEMENT_M_FUNCTION:
        (void)take_m_function(reader);
        break;
    case ELEMENT_NONE:
    case ELEMENT_M_FUNCTIONS:
    case ELEMENTS:
        break;
    }
}

/* ---- Structure ----------------------------------------------------------------------------------------------------- */

static const struct row *find_row(enum element element, const struct cnc_piece *name)
{
    for (unsigned i = 0; i < ROWS; i++)
        if (rows[i].element == element && cnc_piece_is(name, rows[i].name))
            return &rows[i];
    return NULL;
}

/* NAME = "VALUE". Returns false if reading cannot go on. */
static bool read_attribute(struct reader *reader, enum element element)
{
    struct cnc_piece name = cnc_xml_read_word(&reader->xml), value;
    cnc_xml_skip_space(&reader->xml);
    if (!cnc_xml_next_is(&reader->xml, "="))
        return cnc_xml_fail_here(&reader->xml, "expected = behind the name of an attribute");
    cnc_xml_move_on(&reader->xml, 1);
    cnc_xml_skip_space(&reader->xml);
    if (!cnc_xml_read_quoted(&reader->xml, &value))
        return false;
    const struct row *row = find_row(element, &name);
    if (row == NULL)
        cnc_text_fail(&reader->xml.errors, name.line, name.column, "expected an attribute of ", reader->element.text,
                      reader->element.length, "");
    else if (reader->given[row - rows].text != NULL)
        cnc_xml_fail(&reader->xml, &name, "expected each attribute once");
    else if (!put_value(&reader->reading, row, &value))
        cnc_xml_fail(&reader->xml, &value, row->expected);
    if (row != NULL)
        reader->given[row - rows] = value;
    return true;
}

/* The attributes of an element, and its end > or />. Returns false if reading cannot go on. */
static bool read_attributes(struct reader *reader, enum element element, bool *is_closed)
{
    for (;;) {
        bool has_space = cnc_xml_next_is_space(&reader->xml);
        cnc_xml_skip_space(&reader->xml);
        *is_closed = cnc_xml_next_is(&reader->xml, "/>");
        if (*is_closed || cnc_xml_next_is(&reader->xml, ">")) {
            cnc_xml_move_on(&reader->xml, *is_closed ? 2 : 1);
            return true;
        }
        if (!has_space || !cnc_xml_next_is_word(&reader->xml))
            return cnc_xml_fail_here(&reader->xml, "expected an attribute, > or />");
        if (!read_attribute(reader, element))
            return false;
    }
}

static enum element present_element(const struct reader *reader)
{
    return reader->depth == 0 ? ELEMENT_NONE : (enum element)elements[reader->open[reader->depth - 1]].element;
}

static const char *expected_inside(const struct reader *reader)
{
    if (reader->depth > 0)
        return elements[reader->open[reader->depth - 1]].inside;
    return reader->has_root ? "expected the end of the file" : "expected ChannelConfig or MFunctions";
}

/* <NAME ...: an element begins. Returns false if reading cannot go on. */
static bool read_element(struct reader *reader)
{
    struct cnc_piece begin = cnc_xml_place(&reader->xml);
    unsigned which = 0;
    cnc_xml_move_on(&reader->xml, 1);
    reader->element = cnc_xml_read_word(&reader->xml);
    while (which < ELEMENT_NAMES && !cnc_piece_is(&reader->element, elements[which].name))
        which++;
    if (which == ELEMENT_NAMES || ((unsigned)elements[which].parents >> present_element(reader) & 1u) == 0 ||
        (reader->depth == 0 && reader->has_root))
        return cnc_xml_fail(&reader->xml, &begin, expected_inside(reader));
    bool is_closed = false;
    enum element element = (enum element)elements[which].element;
    reader->has_root = true;
    reader->open[reader->depth++] = which;
    memset(reader->given, 0, sizeof reader->given);
    put_standards(&reader->reading, element);
    uint32_t errors = reader->xml.errors.count;
    if (!read_attributes(reader, element, &is_closed))
        return false;
    if (reader->xml.errors.count == errors)
        take_element(reader, element);
    reader->depth -= is_closed;
    return true;
}

/* </NAME>. Returns false if reading cannot go on. */
static bool read_end(struct reader *reader)
{
    struct cnc_piece begin = cnc_xml_place(&reader->xml);
    cnc_xml_move_on(&reader->xml, 2);
    struct cnc_piece name = cnc_xml_read_word(&reader->xml);
    cnc_xml_skip_space(&reader->xml);
    if (reader->depth == 0 || !cnc_piece_is(&name, elements[reader->open[reader->depth - 1]].name) ||
        !cnc_xml_next_is(&reader->xml, ">"))
        return cnc_xml_fail(&reader->xml, &begin, expected_inside(reader));
    cnc_xml_move_on(&reader->xml, 1);
    reader->depth--;
    return true;
}

/* Returns false at the end of the text and if reading cannot go on. */
static bool read_next(struct reader *reader)
{
    cnc_xml_skip_space(&reader->xml);
    if (reader->xml.at == reader->xml.length) {
        if (reader->depth > 0) {
            const char *name = elements[reader->open[reader->depth - 1]].name;
            struct cnc_piece here = cnc_xml_place(&reader->xml);
            cnc_text_fail(&reader->xml.errors, here.line, here.column, "expected </", name, strlen(name), ">");
        } else if (!reader->has_root) {
            cnc_xml_fail_here(&reader->xml, expected_inside(reader));
        }
        return false;
    }
    if (cnc_xml_next_is(&reader->xml, "<!--"))
        return cnc_xml_skip_to(&reader->xml, "-->") || cnc_xml_fail_here(&reader->xml, "expected --> behind a comment");
    if (cnc_xml_next_is(&reader->xml, "<?xml"))
        return cnc_xml_skip_to(&reader->xml, "?>") || cnc_xml_fail_here(&reader->xml, "expected ?> behind the XML line");
    if (cnc_xml_next_is(&reader->xml, "</"))
        return read_end(reader);
    if (cnc_xml_next_is(&reader->xml, "<"))
        return read_element(reader);
    return cnc_xml_fail_here(&reader->xml, expected_inside(reader));
}

/* ---- All of it ----------------------------------------------------------------------------------------------------- */

static void begin_config(struct cnc_config *config)
{
    memset(config, 0, sizeof *config);
    for (unsigned m = 0; m <= CNC_M_MAX; m++)
        config->m[m].group = (uint8_t)(cnc_fixed_group(m) != 0 ? cnc_fixed_group(m) : CNC_M_GROUPS);
    for (unsigned i = 0; i < 3; i++)
        config->geometry[i] = (uint8_t)i;
}

/* What a text leaves out. */
static void complete_config(struct cnc_config *config)
{
    bool has_gear = false;
    for (unsigned gear = 1; gear <= CNC_GEARS; gear++)
        has_gear = has_gear || config->gear[gear].is_configured;
    if (!has_gear)
        config->gear[1] = (struct cnc_gear){true, 0, 4000000};
    union reading reading;
    put_standards(&reading, ELEMENT_AXIS);
    for (bool has_axis = config->axes != 0; !has_axis && reading.axis.name < 3; reading.axis.name++)
        put_axis(config, &reading.axis);
}

void cnc_config_clear(struct cnc_config *config)
{
    begin_config(config);
    complete_config(config);
}

bool cnc_config_read(const char *text, size_t length, struct cnc_config *config, cnc_text_report *report, void *context)
{
    struct reader reader = {.config = config, .xml = {.text = text, .length = length, .line = 1,
                                                      .errors = {.report = report, .context = context}}};
    begin_config(config);
    if (cnc_xml_next_is(&reader.xml, "\xEF\xBB\xBF"))
        reader.xml.at = reader.xml.line_begin = 3;
    while (read_next(&reader))
        ;
    complete_config(config);
    return reader.xml.errors.count == 0;
}
