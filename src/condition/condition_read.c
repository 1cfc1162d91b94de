/* SPDX-License-Identifier: MIT */
/* Conditions from JSON. */
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "condition_term.h"
#include "text/text.h"

#define TERMS_MAX 256 /* of a condition: each is checked after everything that happens */
#define DEPTH_MAX 8 /* of all and any inside one another */

struct reader {
    struct sim *sim;
    struct refusal *refusal;
    unsigned depth, terms;
    bool messages;
};

static const char *const relation_names[] = {
    [TERM_EQUAL] = "==", [TERM_UNEQUAL] = "!=",  [TERM_LESS] = "<",
    [TERM_LESS_EQUAL] = "<=", [TERM_GREATER] = ">", [TERM_GREATER_EQUAL] = ">=",
};
#define RELATIONS (sizeof relation_names / sizeof relation_names[0])

const char *term_relation_name(enum term_relation relation)
{
    return relation_names[relation];
}

bool term_relation_named(const char *name, enum term_relation *relation)
{
    for (size_t i = 0; i < RELATIONS; i++) {
        if (strcmp(name, relation_names[i]) == 0) {
            *relation = (enum term_relation)i;
            return true;
        }
    }
    return false;
}

void term_clear(struct term *term)
{
    for (size_t i = 0; i < term->subs; i++)
        term_clear(&term->sub[i]);
    free(term->sub);
    *term = (struct term){0};
}

/* ---- Building ------------------------------------------------------------------------------------------------------- */

/* Refuse, for readers that return bool. */
#define REFUSE(...) (refuse(r->refusal, REFUSED_PARAMS, __VA_ARGS__), false)

/* Put a copy of `term` after the others of `group`, which owns what hangs on it then. */
static bool add_term(struct reader *r, struct term *group, const struct term *term)
{
    if (r->terms++ == TERMS_MAX)
        return REFUSE("condition: expected at most %d conditions in all", TERMS_MAX);
    struct term *sub = realloc(group->sub, (group->subs + 1) * sizeof *sub);
    if (sub == NULL) {
        refuse(r->refusal, REFUSED_MEMORY, "out of memory");
        return false;
    }
    group->sub = sub;
    sub[group->subs++] = *term;
    return true;
}

static bool is_flag(const json_t *json, int64_t *value)
{
    if (json_is_boolean(json))
        *value = json_is_true(json);
    else if (json_is_integer(json) && (json_integer_value(json) == 0 || json_integer_value(json) == 1))
        *value = json_integer_value(json);
    else
        return false;
    return true;
}

/* ---- Numbers -------------------------------------------------------------------------------------------------------- */

static bool read_whole(const json_t *json, const struct term *term, int64_t *value)
{
    if (json_is_integer(json)) {
        *value = json_integer_value(json);
        return true;
    }
    size_t wrong;
    uint64_t ticks;
    if (term->kind != TERM_TIME || !json_is_string(json) ||
        time_value_read(json_string_value(json), json_string_length(json), &ticks, &wrong) != NULL)
        return false;
    *value = (int64_t)ticks;
    return true;
}

/* A number, or an object of relations with numbers: a term each. */
static bool read_number(struct reader *r, struct term *group, struct term term, const char *key, const json_t *json)
{
    const char *what = term.kind == TERM_TIME ? "a time from " TIME_VALUE_RANGE " as in \"2.5s\", or in us" : "a whole number";
    const char *name;
    json_t *bound;
    if (!json_is_object(json)) {
        if (!read_whole(json, &term, &term.value))
            return REFUSE("%s: expected %s, or {\">=\": …} with one of ==, !=, <, <=, >, >=", key, what);
        /* time that has been leapt over would never be again */
        term.relation = term.kind == TERM_TIME ? TERM_GREATER_EQUAL : TERM_EQUAL;
        return add_term(r, group, &term);
    }
    if (json_object_size(json) == 0)
        return REFUSE("%s: expected %s, found {}", key, what);
    json_object_foreach((json_t *)json, name, bound) {
        enum term_relation relation;
        if (!term_relation_named(name, &relation))
            return REFUSE("%s: expected one of ==, !=, <, <=, >, >=, found \"%.20s\"", key, name);
        if (!read_whole(bound, &term, &term.value))
            return REFUSE("%s: expected %s after \"%s\"", key, what, name);
        term.relation = (uint8_t)relation;
        if (!add_term(r, group, &term))
            return false;
    }
    return true;
}

/* {"PO_STOP": 1, "B_POL[0]": {">=": 8000}}: cells of the device. */
static bool read_cells(struct reader *r, struct term *group, struct term term, const char *key, const json_t *json)
{
    const struct device_kind *device = sim_device(r->sim);
    char error[DEVICE_ERROR_SIZE];
    const char *name;
    json_t *value;
    if (device->find_cell == NULL)
        return REFUSE("%s: the device %s has no cells", key, device->name);
    if (!json_is_object(json) || json_object_size(json) == 0)
        return REFUSE("%s: expected cells, as in {\"PO_STOP\": 1}", key);
    json_object_foreach((json_t *)json, name, value) {
        if (strlen(name) >= TERM_CELL_SIZE)
            return REFUSE("%s: `%.60s…': there is no cell with so long a name", key, name);
        snprintf(term.cell_name, sizeof term.cell_name, "%s", name);
        term.cell = device->find_cell(sim_core(r->sim, term.unit), name, error);
        if (term.cell == 0)
            return REFUSE("%s: %s", key, error);
        if (!read_number(r, group, term, name, value))
            return false;
    }
    return true;
}

/* ---- Names ---------------------------------------------------------------------------------------------------------- */

static const char *name_of(const struct device_kind *device, enum term_kind kind, unsigned value)
{
    switch (kind) {
    case TERM_STATE:
        return device->state_name(value);
    case TERM_LED:
        return device->led_name(value);
    default:
        return device->fault_name(value);
    }
}

#define LIST_SIZE 320u

/* The names that are possible there: "idle, ready, …". */
static void list_names(const struct device_kind *device, enum term_kind kind, char list[LIST_SIZE])
{
    size_t length = 0;
    const char *name;
    list[0] = '\0';
    for (unsigned i = 0; length < LIST_SIZE && (name = name_of(device, kind, i)) != NULL; i++)
        length += (size_t)snprintf(list + length, LIST_SIZE - length, "%s%s", i > 0 ? ", " : "", name);
}

static bool read_one_name(struct reader *r, struct term *group, struct term term, const char *key, const json_t *json)
{
    const struct device_kind *device = sim_device(r->sim);
    const char *name, *wanted = json_string_value(json);
    char list[LIST_SIZE];
    if (term.kind == TERM_FAULT && json_is_null(json))
        wanted = device->fault_name(0);
    for (unsigned i = 0; wanted != NULL && (name = name_of(device, (enum term_kind)term.kind, i)) != NULL; i++) {
        if (strcmp(name, wanted) == 0) {
            term.value = i;
            return add_term(r, group, &term);
        }
    }
    list_names(device, (enum term_kind)term.kind, list);
    if (wanted == NULL)
        return REFUSE("%s: expected one of %s", key, list);
    return REFUSE("%s: expected one of %s, found \"%.40s\"%s", key, list, wanted, nearest_hint(wanted, list));
}

/* A name, or an object of the relations == and != with names: a term each. */
static bool read_name(struct reader *r, struct term *group, struct term term, const char *key, const json_t *json)
{
    const char *relation;
    json_t *name;
    if (!json_is_object(json) || json_object_size(json) == 0)
        return read_one_name(r, group, term, key, json);
    json_object_foreach((json_t *)json, relation, name) {
        bool equal = strcmp(relation, term_relation_name(TERM_EQUAL)) == 0;
        if (!equal && strcmp(relation, term_relation_name(TERM_UNEQUAL)) != 0)
            return REFUSE("%s: expected == or != before a name, found \"%.20s\"", key, relation);
        term.relation = equal ? TERM_EQUAL : TERM_UNEQUAL;
        if (!read_one_name(r, group, term, key, name))
            return false;
    }
    return true;
}

/* ---- Flags and bits ------------------------------------------------------------------------------------------------- */

static bool read_flag(struct reader *r, struct term *group, struct term term, const char *key, const json_t *json)
{
    if (!is_flag(json, &term.value))
        return REFUSE("%s: expected true or false", key);
    return add_term(r, group, &term);
}

/* Read "8", "08", "80". Returns 0 if it is no number low..high. */
static uint8_t read_bit_number(const char *text, unsigned low, unsigned high)
{
    unsigned number = 0;
    size_t length = strlen(text);
    if (length < 1 || length > 2 || strspn(text, "0123456789") != length)
        return 0;
    for (; *text != '\0'; text++)
        number = number * 10 + (unsigned)(*text - '0');
    return number >= low && number <= high ? (uint8_t)number : 0;
}

static bool read_bits(struct reader *r, struct term *group, struct term term, const char *key, const json_t *json)
{
    bool variables = term.kind == TERM_VARIABLE;
    const struct device_kind *device = sim_device(r->sim);
    const bool names = !variables && (term.kind == TERM_OUTPUT ? device->output_names : device->input_names);
    unsigned low = variables ? device->first_variable : 1;
    unsigned count = variables ? device->variables : term.kind == TERM_OUTPUT ? device->outputs : device->inputs;
    unsigned high = low + count - 1;
    const char *name;
    char expected[DEVICE_ERROR_SIZE];
    json_t *level;
    if (count == 0)
        return REFUSE("%s: the device %s has none", key, device->name);
    if (!json_is_object(json) || json_object_size(json) == 0)
        return REFUSE("%s: expected numbers with levels, as in {\"%02u\": 1}", key, low);
    json_object_foreach((json_t *)json, name, level) {
        term.number = (uint8_t)(variables                  ? read_bit_number(name, low, high)
                                : term.kind == TERM_OUTPUT ? device_output_named(device, name)
                                                           : device_input_named(device, name));
        if (term.number == 0 && names)
            return REFUSE("%s: expected %s, found \"%.20s\"", key,
                          term.kind == TERM_OUTPUT ? device_output_names(device, expected) : device_input_names(device, expected),
                          name);
        if (term.number == 0)
            return REFUSE("%s: expected a number %02u to %02u, found \"%.20s\"", key, low, high, name);
        if (!is_flag(level, &term.value))
            return REFUSE("%s: expected 0 or 1 for %02u", key, term.number);
        if (!add_term(r, group, &term))
            return false;
    }
    return true;
}

/* ---- Messages ------------------------------------------------------------------------------------------------------- */

static bool read_from(struct reader *r, const json_t *json, int *from)
{
    char text[24];
    const char *name = json_string_value(json);
    if (json_is_integer(json)) {
        snprintf(text, sizeof text, "%lld", (long long)json_integer_value(json));
        name = text;
    }
    *from = name == NULL ? 0 : (int)sim_unit_named(r->sim, name);
    if (*from > 0)
        return true;
    if (name == NULL || (strcmp(name, "master") != 0 && strcmp(name, "unit") != 0))
        return REFUSE("message: from: expected \"master\", \"unit\" or the name of a unit");
    *from = name[0] == 'm' ? 0 : TERM_ANY_UNIT;
    return true;
}

static bool read_message(struct reader *r, struct term *group, struct term term, const char *key, const json_t *json)
{
    static const char *const known[] = {"number", "motor", "from", "dropped", NULL};
    const json_t *from = json_object_get(json, "from"), *dropped = json_object_get(json, "dropped");
    int64_t number, motor, flag = 0;
    if (!json_is_object(json))
        return REFUSE("%s: expected an object, as in {\"number\": 4, \"from\": \"unit\"}", key);
    if (!params_known(json, known, r->refusal) || !param_integer_or(json, "number", 0, 255, -1, &number, r->refusal) ||
        !param_integer_or(json, "motor", 0, (int)sim_device(r->sim)->axes, -1, &motor, r->refusal))
        return false;
    term.message = (struct term_message){.number = (int)number, .motor = motor < 0 ? -1 : '0' + (int)motor, .from = -1};
    if (from != NULL && !read_from(r, from, &term.message.from))
        return false;
    if (dropped != NULL && !is_flag(dropped, &flag))
        return REFUSE("message: dropped: expected true or false");
    term.message.dropped = flag != 0;
    if (term.message.dropped && (number >= 0 || motor >= 0))
        return REFUSE("message: a dropped message has no number and no motor");
    r->messages = true;
    return add_term(r, group, &term);
}

/* ---- The whole ------------------------------------------------------------------------------------------------------ */

static bool read_object(struct reader *r, struct term *group, const json_t *json);

static bool read_list(struct reader *r, struct term *group, struct term term, const char *key, const json_t *json)
{
    size_t index;
    json_t *item;
    if (!json_is_array(json) || json_array_size(json) == 0)
        return REFUSE("%s: expected a list of conditions", key);
    if (r->depth >= DEPTH_MAX)
        return REFUSE("%s: nested deeper than %d levels", key, DEPTH_MAX);
    r->depth++;
    term = (struct term){.kind = term.kind};
    json_array_foreach((json_t *)json, index, item) {
        struct term sub = {.kind = TERM_ALL};
        if (!read_object(r, &sub, item) || !add_term(r, &term, &sub)) {
            term_clear(&sub);
            term_clear(&term);
            return false;
        }
    }
    r->depth--;
    if (add_term(r, group, &term))
        return true;
    term_clear(&term);
    return false;
}

typedef bool key_reader(struct reader *r, struct term *group, struct term term, const char *key, const json_t *json);

enum needs { NEEDS_NOTHING, NEEDS_UNIT, NEEDS_MOTOR };

static const struct {
    const char *key;
    uint8_t kind, needs;
    key_reader *read;
} keys[] = {
    {"t", TERM_TIME, NEEDS_NOTHING, read_number},
    {"position", TERM_POSITION, NEEDS_MOTOR, read_number},
    {"true_position", TERM_TRUE_POSITION, NEEDS_MOTOR, read_number},
    {"steps", TERM_STEPS, NEEDS_MOTOR, read_number},
    {"index", TERM_INDEX, NEEDS_MOTOR, read_number},
    {"commands", TERM_COMMANDS, NEEDS_MOTOR, read_number},
    {"state", TERM_STATE, NEEDS_MOTOR, read_name},
    {"led", TERM_LED, NEEDS_MOTOR, read_name},
    {"fault", TERM_FAULT, NEEDS_MOTOR, read_name},
    {"idle", TERM_IDLE, NEEDS_UNIT, read_flag},
    {"di", TERM_INPUT, NEEDS_UNIT, read_bits},
    {"do", TERM_OUTPUT, NEEDS_UNIT, read_bits},
    {"var", TERM_VARIABLE, NEEDS_UNIT, read_bits},
    {"powered", TERM_POWERED, NEEDS_UNIT, read_flag},
    {"cell", TERM_CELL, NEEDS_UNIT, read_cells},
    {"message", TERM_MESSAGE, NEEDS_NOTHING, read_message},
    {"all", TERM_ALL, NEEDS_NOTHING, read_list},
    {"any", TERM_ANY, NEEDS_NOTHING, read_list},
};
#define KEYS (sizeof keys / sizeof keys[0])
#define KEY_NAMES \
    "t, position, true_position, steps, index, commands, state, led, fault, idle, di, do, var, powered, cell, message, all or any"

static bool read_key(struct reader *r, struct term *group, const json_t *object, const char *key, const json_t *json)
{
    size_t i = 0;
    int64_t motor = 0;
    struct term term = {0};
    while (i < KEYS && strcmp(key, keys[i].key) != 0)
        i++;
    if (i == KEYS)
        return REFUSE("unknown condition \"%.40s\": expected " KEY_NAMES ", with unit and motor%s", key,
                      nearest_hint(key, KEY_NAMES ", unit, motor"));
    term.kind = keys[i].kind;
    if (keys[i].needs != NEEDS_NOTHING) {
        term.unit = (uint8_t)param_unit(r->sim, object, r->refusal);
        if (term.unit == 0)
            return false;
    }
    if (keys[i].needs == NEEDS_MOTOR && !param_integer(object, "motor", 1, (int)sim_device(r->sim)->axes, &motor, r->refusal))
        return false;
    if (term.kind == TERM_IDLE && !param_integer_or(object, "motor", 1, (int)sim_device(r->sim)->axes, 0, &motor, r->refusal))
        return false;
    term.motor = (uint8_t)motor;
    return keys[i].read(r, group, term, key, json);
}

static bool read_object(struct reader *r, struct term *group, const json_t *json)
{
    const char *key;
    json_t *value;
    if (!json_is_object(json))
        return REFUSE("condition: expected an object, as in {\"motor\": 1, \"position\": 5000}");
    json_object_foreach((json_t *)json, key, value) {
        if (strcmp(key, "unit") != 0 && strcmp(key, "motor") != 0 && !read_key(r, group, json, key, value))
            return false;
    }
    if (group->subs == 0)
        return REFUSE("condition: nothing to wait for: expected a condition, as in {\"motor\": 1, \"position\": 5000}");
    return true;
}

struct condition *condition_read(struct sim *sim, const json_t *json, struct refusal *refusal)
{
    struct reader reader = {.sim = sim, .refusal = refusal};
    struct condition *condition = calloc(1, sizeof *condition);
    if (condition == NULL) {
        refuse(refusal, REFUSED_MEMORY, "out of memory");
        return NULL;
    }
    condition->sim = sim;
    condition->root.kind = TERM_ALL;
    if (!read_object(&reader, &condition->root, json)) {
        condition_free(condition);
        return NULL;
    }
    condition->messages = reader.messages;
    return condition;
}
