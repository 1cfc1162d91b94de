/* SPDX-License-Identifier: MIT */
/* Steps and stimuli of a scenario. */
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "condition/condition.h"
#include "file/file.h"
#include "scenario_model.h"
#include "text/text.h"

#define SILENCE 1000000u /* ticks: how long `answer: none` listens */
#define EXTRAS_MAX 5

typedef bool step_reader(struct scenario_reader *reader, const struct config_node *node, struct scenario_step *step);

static step_reader read_set, read_program, read_message, read_bytes, read_condition, read_stays, read_advance, read_pulses,
    read_di, read_power, read_reset, read_fault, read_clear, read_call;

/* Each gets the node of the step, not of the value. */
static const struct {
    const char *key;
    step_reader *read;
    uint8_t action;
    bool stimulus; /* may be one, too */
    const char *extra[EXTRAS_MAX]; /* keys besides it, apart from at and label */
} actions[] = {
    {"set", read_set, ACTION_SET, false, {"unit", "motor", "flag", "within"}},
    {"program", read_program, ACTION_SET, false, {"unit", "motor", "flag", "within"}},
    {"message", read_message, ACTION_MESSAGE, false, {"unit", "answer", "within"}},
    {"bytes", read_bytes, ACTION_BYTES, false, {"answer", "within"}},
    {"di", read_di, ACTION_CALL, true, {"unit"}},
    {"wait", read_condition, ACTION_WAIT, false, {"unit", "within", "not_before"}},
    {"expect", read_condition, ACTION_EXPECT, true, {"unit"}},
    {"stays", read_stays, ACTION_STAYS, false, {"unit", "for"}},
    {"advance", read_advance, ACTION_ADVANCE, false, {NULL}},
    {"pulses", read_pulses, ACTION_PULSES, false, {"unit"}},
    {"power", read_power, ACTION_CALL, true, {"unit"}},
    {"reset", read_reset, ACTION_CALL, true, {"unit"}},
    {"fault", read_fault, ACTION_CALL, true, {NULL}},
    {"clear", read_clear, ACTION_CALL, true, {NULL}},
    {"call", read_call, ACTION_CALL, true, {"params", "result"}},
};
#define ACTIONS (sizeof actions / sizeof actions[0])

/* ---- Parts ---------------------------------------------------------------------------------------------------------- */

static bool no_memory(const struct config_node *node)
{
    return config_error(node, "out of memory");
}

static const char *read_text(const struct config_node *node, const char *what)
{
    if (config_type(node) == CONFIG_TEXT)
        return config_text(node);
    config_error(node, "expected %s, a text", what);
    return NULL;
}

/* `unit` beside a step. `all`: may it be all of them? */
static bool read_unit(struct scenario_reader *reader, const struct config_node *step, bool all, uint8_t *unit)
{
    struct refusal refusal;
    const struct config_node *node = config_get(step, "unit");
    json_t *params = json_object();
    *unit = 0;
    if (node != NULL && all && config_type(node) == CONFIG_TEXT && strcmp(config_text(node), "all") == 0) {
        json_decref(params);
        return true;
    }
    if (node != NULL)
        json_object_set_new(params, "unit", config_json(node));
    *unit = (uint8_t)param_unit(reader->sim, params, &refusal);
    json_decref(params);
    return *unit > 0 || config_error(node != NULL ? node : step, "%s", refusal.text);
}

static bool read_time(const struct config_node *step, const char *key, uint64_t missing, uint64_t *ticks)
{
    const struct config_node *node = config_get(step, key);
    *ticks = missing;
    return node == NULL || config_time(node, key, ticks);
}

static bool read_within(const struct scenario_reader *reader, const struct config_node *step, struct scenario_step *result)
{
    return read_time(step, "within", reader->scenario->timeout, &result->within);
}

json_t *scenario_condition(struct scenario_reader *reader, const struct config_node *node, unsigned unit, bool waits)
{
    struct refusal refusal;
    json_t *json = config_json(node);
    if (unit > 0 && json_is_object(json) && json_object_get(json, "unit") == NULL)
        json_object_set_new(json, "unit", json_string(reader->sim->unit[unit - 1].name));
    struct condition *condition = condition_read(reader->sim, json, &refusal);
    bool ok = condition != NULL && (waits || !condition->messages);
    if (condition == NULL)
        config_error(node, "%s", refusal.text);
    else if (!ok)
        config_error(node, "expected a state: for a message use wait or when");
    condition_free(condition);
    if (ok)
        return json;
    json_decref(json);
    return NULL;
}

/* ---- What is sent --------------------------------------------------------------------------------------------------- */

static bool read_pattern(const struct config_node *node, const char *what, struct scenario_bytes *bytes)
{
    const char *text = read_text(node, what);
    const char *wrong = text != NULL ? scenario_bytes_read(bytes, text) : NULL;
    if (wrong != NULL)
        return config_error(node, "expected %s", wrong);
    return text != NULL;
}

/* What the host sends: at most `most` bytes. */
static bool read_sent(const struct scenario_reader *reader, const struct config_node *node, const char *what, unsigned most,
                      struct scenario_bytes *bytes)
{
    const struct device_kind *device = sim_device(reader->sim);
    if (!device->receive)
        return config_error(node, "the device %s has no bus: expected no %s", device->name, what);
    if (!read_pattern(node, what, bytes))
        return false;
    if (bytes->anys || bytes->rest)
        return config_error(node, "expected %s without .. and *, which stand for bytes of an answer", what);
    if (bytes->length > most)
        return config_error(node, "expected %s of up to %u bytes, found %zu", what, most, bytes->length);
    return true;
}

static bool read_answer(const struct config_node *step, enum scenario_answer missing, struct scenario_step *result)
{
    const struct config_node *node = config_get(step, "answer");
    const char *text = node != NULL && config_type(node) == CONFIG_TEXT ? config_text(node) : "";
    result->answer = (uint8_t)missing;
    if (strcmp(text, "none") == 0)
        result->answer = ANSWER_NONE;
    else if (strcmp(text, "any") == 0)
        result->answer = ANSWER_ANY;
    else if (node != NULL)
        result->answer = ANSWER_THIS;
    if (result->unit == 0 && result->action == ACTION_MESSAGE && node != NULL && result->answer != ANSWER_NONE)
        return config_error(node, "expected none: no unit answers a request to all units");
    if (result->answer == ANSWER_NONE && config_get(step, "within") == NULL)
        result->within = SILENCE;
    return result->answer != ANSWER_THIS || read_pattern(node, "answer", &result->wanted);
}

static bool read_message(struct scenario_reader *reader, const struct config_node *node, struct scenario_step *step)
{
    if (!read_unit(reader, node, true, &step->unit) || !read_within(reader, node, step))
        return false;
    return read_sent(reader, config_get(node, "message"), "message", sim_device(reader->sim)->request_max, &step->bytes) &&
           read_answer(node, step->unit == 0 ? ANSWER_UNASKED : ANSWER_ANY, step);
}

static bool read_bytes(struct scenario_reader *reader, const struct config_node *node, struct scenario_step *step)
{
    const struct config_node *bytes = config_get(node, "bytes");
    return read_within(reader, node, step) && read_sent(reader, bytes, "bytes", DEVICE_MESSAGE_MAX, &step->bytes) &&
           read_answer(node, ANSWER_UNASKED, step);
}

/* Keep the first of the errors in the program, for the report if the unit refuses it. `name`: of the file. */
static void find_program_error(const struct scenario_reader *reader, const char *name, size_t head, struct scenario_step *step)
{
    const struct device_kind *kind = sim_device(reader->sim);
    const char *program = (const char *)step->bytes.byte + head;
    char *text = NULL;
    size_t length;
    FILE *out = kind->check_text ? open_memstream(&text, &length) : NULL;
    if (out == NULL)
        return;
    bool is_wrong = kind->check_text(&reader->sim->config.unit, name, program, step->bytes.length - head, out);
    if (fclose(out) == 0 && is_wrong) {
        text[strcspn(text, "\n")] = '\0';
        step->wrong = text;
    } else {
        free(text);
    }
}

/* The message that carries a program text, from the file `name`, and what must be answered. */
static bool set_program(struct scenario_reader *reader, const struct config_node *node, struct scenario_step *step,
                        const char *name, const char *text, size_t length)
{
    const struct config_node *motor_node = config_get(node, "motor"), *flag_node = config_get(node, "flag");
    const struct device_kind *kind = sim_device(reader->sim);
    const struct device_program_message *carrier = kind->program_message;
    int64_t motor = 1, flag = 0;
    if (!carrier)
        return config_error(node, "the device %s has no programs that a message sets: expected message or call", kind->name);
    if (!read_unit(reader, node, true, &step->unit) || !read_within(reader, node, step) ||
        (motor_node != NULL && !config_integer(motor_node, "motor", 0, kind->axes, &motor)) ||
        (flag_node != NULL && !config_integer(flag_node, "flag", 0, carrier->flags, &flag)))
        return false;
    const unsigned head = carrier->head, most = kind->request_max - head;
    if (length > most)
        return config_error(node, "expected a program of up to %u bytes, as much as a message holds", most);
    step->bytes.byte = malloc(length + head);
    if (step->bytes.byte == NULL)
        return no_memory(node);
    carrier->begin(step->bytes.byte, (unsigned)motor);
    memcpy(step->bytes.byte + head, text, length);
    if (reader->files->map != NULL)
        length = reader->files->map((char *)step->bytes.byte + head, length);
    step->bytes.length = head + length;
    find_program_error(reader, name, head, step);
    step->flag = (uint8_t)flag;
    step->answer = step->unit == 0 ? ANSWER_UNASKED : ANSWER_THIS;
    return step->unit != 0 || flag_node == NULL ||
           config_error(flag_node, "expected none: no unit answers a request to all units");
}

static bool read_set(struct scenario_reader *reader, const struct config_node *node, struct scenario_step *step)
{
    const char *text = read_text(config_get(node, "set"), "program");
    return text != NULL && set_program(reader, node, step, "TEXT", text, strlen(text));
}

static bool read_program(struct scenario_reader *reader, const struct config_node *node, struct scenario_step *step)
{
    const struct config_node *file = config_get(node, "program");
    char *path = NULL;
    size_t length;
    char *text = scenario_file(reader, file, &path, &length);
    bool ok = text != NULL && set_program(reader, node, step, path, text, length);
    free(path);
    free(text);
    return ok;
}

/* ---- What is expected ----------------------------------------------------------------------------------------------- */

static bool read_condition(struct scenario_reader *reader, const struct config_node *node, struct scenario_step *step)
{
    const struct config_node *condition = config_get(node, step->action == ACTION_WAIT ? "wait" : "expect");
    if (config_get(node, "unit") != NULL && !read_unit(reader, node, false, &step->unit))
        return false;
    if (!read_within(reader, node, step) || !read_time(node, "not_before", 0, &step->not_before))
        return false;
    if (step->not_before > step->within)
        return config_error(config_get(node, "not_before"), "expected a time before within");
    step->json = scenario_condition(reader, condition, step->unit, step->action == ACTION_WAIT);
    return step->json != NULL;
}

static bool read_stays(struct scenario_reader *reader, const struct config_node *node, struct scenario_step *step)
{
    if (config_get(node, "for") == NULL)
        return config_error(node, "expected for, the time, beside stays");
    if (config_get(node, "unit") != NULL && !read_unit(reader, node, false, &step->unit))
        return false;
    if (!read_time(node, "for", 0, &step->time))
        return false;
    step->json = scenario_condition(reader, config_get(node, "stays"), step->unit, false);
    return step->json != NULL;
}

static bool read_advance(struct scenario_reader *reader, const struct config_node *node, struct scenario_step *step)
{
    (void)reader;
    return config_time(config_get(node, "advance"), "advance", &step->time);
}

/* A number, or a map of relations with numbers. */
static bool read_bounds(const struct config_node *map, const char *key, struct scenario_bounds *bounds)
{
    const struct config_node *node = config_get(map, key);
    if (node == NULL)
        return true;
    if (config_type(node) != CONFIG_MAP) {
        bounds->count = 1;
        bounds->bound[0].relation = TERM_EQUAL;
        return config_integer(node, key, 0, INT64_MAX, &bounds->bound[0].value);
    }
    for (size_t i = 0; i < config_count(node); i++) {
        enum term_relation relation;
        if (!term_relation_named(config_key(node, i), &relation) || bounds->count == BOUNDS_MAX)
            return config_error(config_at(node, i), "expected one of ==, !=, <, <=, >, >=, found \"%.20s\"", config_key(node, i));
        bounds->bound[bounds->count].relation = (uint8_t)relation;
        if (!config_integer(config_at(node, i), key, 0, INT64_MAX, &bounds->bound[bounds->count++].value))
            return false;
    }
    return true;
}

static bool read_pulses(struct scenario_reader *reader, const struct config_node *node, struct scenario_step *step)
{
    static const char *const known[] = {"motor", "count", "forward", "back", "since", NULL};
    const struct config_node *map = config_get(node, "pulses");
    struct scenario_pulses *pulses = &step->pulses;
    int64_t motor;
    const unsigned axes = sim_device(reader->sim)->axes;
    if (sim_device(reader->sim)->has_no_steps)
        return config_error(map, "the axes of a %s make no steps: expected no pulses", sim_device(reader->sim)->name);
    if (config_type(map) != CONFIG_MAP)
        return config_error(map, "expected a map, as in {motor: 1, count: 5000}");
    const struct config_node *since = config_get(map, "since"), *motor_node = config_get(map, "motor");
    if (!config_keys(map, known) || !read_unit(reader, node, false, &step->unit))
        return false;
    if (motor_node == NULL)
        return config_error(map, "expected motor, 1 to %u", axes);
    if (!config_integer(motor_node, "motor", 1, axes, &motor) || !read_bounds(map, "count", &pulses->count) ||
        !read_bounds(map, "forward", &pulses->forward) || !read_bounds(map, "back", &pulses->back))
        return false;
    if (pulses->count.count + pulses->forward.count + pulses->back.count == 0)
        return config_error(map, "expected count, forward or back");
    const char *text = since != NULL ? read_text(since, "since") : "start";
    if (text == NULL)
        return false;
    if (strcmp(text, "start") != 0 && strcmp(text, "last") != 0)
        return config_error(since, "expected start or last");
    pulses->motor = (uint8_t)motor;
    pulses->since_last = strcmp(text, "last") == 0;
    reader->scenario->count_pulses = true;
    return true;
}

/* ---- What is done from outside -------------------------------------------------------------------------------------- */

/* What a scenario will restore is not to be overwritten by the report or a recording of the same run. */
static bool spare_file(const struct config_node *node, const json_t *params)
{
    const char *file = json_string_value(json_object_get(params, "file"));
    return file == NULL || output_file_spare(file) || no_memory(node);
}

/* Do a command on the line of which nothing is seen; of one that takes time what it begins and ends with. */
static json_t *try_command(struct sim *sim, const char *method, const json_t *params, struct refusal *refusal)
{
    struct exchange exchange;
    if (!exchange_is_named(sim, method))
        return sim_command(sim, method, params, refusal);
    json_t *result = exchange_begin(&exchange, sim, params, refusal) ? exchange_answer(&exchange, sim, refusal) : NULL;
    exchange_drop(&exchange);
    return result;
}

/* Try a command out. Takes `params` over. */
static bool set_command(struct scenario_reader *reader, const struct config_node *node, struct scenario_step *step,
                        const char *method, json_t *params)
{
    struct refusal refusal = {0};
    step->method = method;
    step->json = params;
    if (params == NULL)
        return no_memory(node);
    if (strcmp(method, "snapshot") == 0 || strcmp(method, "restore") == 0)
        return spare_file(node, params); /* files may be concerned: when the scenario runs */
    json_t *result = try_command(reader->sim, method, params, &refusal);
    bool wrong = result == NULL && (refusal.code == REFUSED_PARAMS || refusal.code == REFUSED_METHOD);
    json_decref(result);
    return !wrong || config_error(node, "%s", refusal.text);
}

/* Parameters with the unit in them. */
static json_t *params_of(struct scenario_reader *reader, const struct config_node *node)
{
    uint8_t unit;
    if (!read_unit(reader, node, false, &unit))
        return NULL;
    return json_pack("{s:s}", "unit", reader->sim->unit[unit - 1].name);
}

static bool read_di(struct scenario_reader *reader, const struct config_node *node, struct scenario_step *step)
{
    json_t *params = params_of(reader, node);
    if (params == NULL)
        return false;
    json_object_set_new(params, "di", config_json(config_get(node, "di")));
    return set_command(reader, config_get(node, "di"), step, "di.set", params);
}

static bool read_power(struct scenario_reader *reader, const struct config_node *node, struct scenario_step *step)
{
    bool on;
    json_t *params = config_flag(config_get(node, "power"), "power", &on) ? params_of(reader, node) : NULL;
    if (params == NULL)
        return false;
    json_object_set_new(params, "on", json_boolean(on));
    return set_command(reader, node, step, "power", params);
}

static bool read_reset(struct scenario_reader *reader, const struct config_node *node, struct scenario_step *step)
{
    bool on;
    if (!config_flag(config_get(node, "reset"), "reset", &on))
        return false;
    if (!on)
        return config_error(config_get(node, "reset"), "expected true");
    json_t *params = params_of(reader, node);
    return params != NULL && set_command(reader, node, step, "reset", params);
}

/* The one parameter that is no whole number: 0.25 is a text in a configuration file. */
static void make_probability(json_t *params)
{
    const char *text = json_string_value(json_object_get(params, "probability"));
    char *end;
    if (text == NULL || text[0] == '\0' || strspn(text, "0123456789.") != strlen(text))
        return;
    double value = strtod(text, &end);
    if (*end == '\0')
        json_object_set_new(params, "probability", json_real(value));
}

static bool read_fault(struct scenario_reader *reader, const struct config_node *node, struct scenario_step *step)
{
    const struct config_node *fault = config_get(node, "fault");
    json_t *params = config_json(fault);
    make_probability(params);
    return set_command(reader, fault, step, "fault.inject", params);
}

static bool read_clear(struct scenario_reader *reader, const struct config_node *node, struct scenario_step *step)
{
    const struct config_node *clear = config_get(node, "clear");
    bool all = config_type(clear) == CONFIG_TEXT && strcmp(config_text(clear), "all") == 0;
    return set_command(reader, clear, step, "fault.clear", all ? json_object() : config_json(clear));
}

static bool read_call(struct scenario_reader *reader, const struct config_node *node, struct scenario_step *step)
{
    const char *method = read_text(config_get(node, "call"), "call, a method");
    const struct config_node *params = config_get(node, "params"), *result = config_get(node, "result");
    if (method == NULL)
        return false;
    if (result != NULL && config_type(result) != CONFIG_MAP)
        return config_error(result, "expected a map, members of the result with their values");
    step->result = result != NULL ? config_json(result) : NULL;
    return set_command(reader, config_get(node, "call"), step, method, params != NULL ? config_json(params) : json_object());
}

/* ---- The whole ------------------------------------------------------------------------------------------------------ */

static void list_actions(char list[200], bool stimulus)
{
    size_t length = 0;
    list[0] = '\0';
    for (size_t i = 0; i < ACTIONS; i++) {
        if (!stimulus || actions[i].stimulus)
            length += (size_t)snprintf(list + length, 200 - length, "%s%s", length > 0 ? ", " : "", actions[i].key);
    }
}

/* Which action is in a step; ACTIONS: none, reported. */
static size_t find_action(const struct config_node *node, bool stimulus)
{
    char list[200];
    size_t i = 0;
    list_actions(list, stimulus);
    if (config_type(node) != CONFIG_MAP) {
        config_error(node, "expected a map with one of %s", list);
        return ACTIONS;
    }
    while (i < ACTIONS && (config_get(node, actions[i].key) == NULL || (stimulus && !actions[i].stimulus)))
        i++;
    if (i == ACTIONS)
        config_error(node, "expected one of %s%s", list, config_count(node) > 0 ? nearest_hint(config_key(node, 0), list) : "");
    return i;
}

static bool read_entry(struct scenario_reader *reader, const struct config_node *node, struct scenario_step *step, bool stimulus)
{
    const char *known[EXTRAS_MAX + 6] = {NULL, "at", "label", stimulus ? "when" : NULL, "after"};
    size_t action = find_action(node, stimulus), count = stimulus ? 5 : 3;
    *step = (struct scenario_step){.node = node};
    if (action == ACTIONS)
        return false;
    known[0] = actions[action].key;
    for (size_t i = 0; i < EXTRAS_MAX && actions[action].extra[i] != NULL; i++)
        known[count++] = actions[action].extra[i];
    known[count] = NULL;
    if (!config_keys(node, known) || !read_time(node, "at", DEVICE_NEVER, &step->at))
        return false;
    if (config_get(node, "label") != NULL) {
        step->label = read_text(config_get(node, "label"), "label");
        if (step->label == NULL)
            return false;
    }
    step->action = actions[action].action;
    return actions[action].read(reader, node, step);
}

bool scenario_step_read(struct scenario_reader *reader, const struct config_node *node, struct scenario_step *step)
{
    return read_entry(reader, node, step, false);
}

bool scenario_stimulus_read(struct scenario_reader *reader, const struct config_node *node, struct scenario_stimulus *stimulus)
{
    if (!read_entry(reader, node, &stimulus->step, true))
        return false;
    if (stimulus->step.action == ACTION_CALL && exchange_is_named(reader->sim, stimulus->step.method))
        return config_error(config_get(node, "call"), "expected a method that takes no time, found %s, which is for steps",
                            stimulus->step.method);
    const struct config_node *when = config_get(node, "when");
    if ((when == NULL) == (stimulus->step.at == DEVICE_NEVER))
        return config_error(node, "expected either at or when");
    if (!read_time(node, "after", 0, &stimulus->after))
        return false;
    stimulus->when = when != NULL ? scenario_condition(reader, when, 0, true) : NULL;
    return when == NULL || stimulus->when != NULL;
}

void scenario_step_free(struct scenario_step *step)
{
    scenario_bytes_free(&step->bytes);
    scenario_bytes_free(&step->wanted);
    json_decref(step->json);
    json_decref(step->result);
    step->json = step->result = NULL;
    free(step->wrong);
    step->wrong = NULL;
}
