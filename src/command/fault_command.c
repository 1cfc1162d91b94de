/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "fault_parameters.h"
#include "methods.h"
#include "text/text.h"

#define SURE 1000000u        /* millionths */
#define COUNT_MAX UINT32_MAX
#define EVERY_MIN 1000u /* us */

typedef bool read_function(const json_t *params, struct fault *fault, struct refusal *refusal);

static read_function read_no_members, read_mask, read_byte, read_delay, read_bytes, read_flash, read_power, read_input;

/* What a kind has of its own; its parameters' names are those of fault_parameters.c. */
static read_function *const readers[FAULT_KINDS] = {
    [FAULT_DROP] = read_no_members,      [FAULT_FLIP] = read_mask,           [FAULT_DUPLICATE] = read_no_members,
    [FAULT_INSERT] = read_byte,          [FAULT_ECHO] = read_no_members,     [FAULT_DELAY] = read_delay,
    [FAULT_NO_ANSWER] = read_no_members, [FAULT_WRONG_FCS] = read_no_members, [FAULT_CUT] = read_bytes,
    [FAULT_FLASH] = read_flash,          [FAULT_POWER] = read_power,         [FAULT_BREAK] = read_no_members,
    [FAULT_UNPLUGGED] = read_no_members, [FAULT_CABLE] = read_no_members,    [FAULT_INPUT] = read_input,
};

/* ---- Reading: one kind's own ---------------------------------------------------------------------------------------- */

static bool read_no_members(const json_t *params, struct fault *fault, struct refusal *refusal)
{
    (void)params, (void)fault, (void)refusal;
    return true;
}

/* A number of the kind's own. `missing` < 0: it must be given. */
static bool read_number(const json_t *params, const char *name, int64_t low, int64_t high, int64_t missing, struct fault *fault,
                        struct refusal *refusal)
{
    int64_t number;
    bool read = missing < 0 ? param_integer(params, name, low, high, &number, refusal)
                            : param_integer_or(params, name, low, high, missing, &number, refusal);
    if (read)
        fault->number = (uint32_t)number;
    return read;
}

static bool read_mask(const json_t *params, struct fault *fault, struct refusal *refusal)
{
    return read_number(params, "mask", 1, 255, 1, fault, refusal);
}

static bool read_byte(const json_t *params, struct fault *fault, struct refusal *refusal)
{
    return read_number(params, "byte", 0, 255, 0, fault, refusal);
}

static bool read_delay(const json_t *params, struct fault *fault, struct refusal *refusal)
{
    if (!param_time(params, "delay", DEVICE_NEVER, &fault->ticks, refusal))
        return false;
    if (fault->ticks <= SEGMENT_DELAY_MAX)
        return true;
    refuse(refusal, REFUSED_PARAMS, "delay: expected a time up to %llus",
           (unsigned long long)(SEGMENT_DELAY_MAX / US_PER_SECOND));
    return false;
}

static bool read_bytes(const json_t *params, struct fault *fault, struct refusal *refusal)
{
    return read_number(params, "bytes", 0, UINT16_MAX, -1, fault, refusal);
}

/* A truth value: true, false, 1, 0. `missing` < 0: it must be given. */
static bool read_boolean(const json_t *params, const char *name, int missing, bool *truth, struct refusal *refusal)
{
    const json_t *value = json_object_get(params, name);
    int64_t number = json_is_boolean(value) ? json_is_true(value) : json_is_integer(value) ? json_integer_value(value) : -1;
    if (!value && missing >= 0)
        number = missing;
    if (number != 0 && number != 1) {
        refuse(refusal, REFUSED_PARAMS, "%s: expected 1, 0, true or false", name);
        return false;
    }
    *truth = number != 0;
    return true;
}

static bool read_flash(const json_t *params, struct fault *fault, struct refusal *refusal)
{
    const char *name = "write";
    if (!read_boolean(params, "torn", 0, &fault->torn, refusal))
        return false;
    if (json_object_get(params, "operation") && !(name = param_string(params, "operation", refusal)))
        return false;
    for (size_t i = 0; fault_operation_names[i]; i++)
        if (strcmp(fault_operation_names[i], name) == 0)
            fault->operations = fault_operation_sets[i];
    if (fault->operations != 0)
        return true;
    refuse(refusal, REFUSED_PARAMS, "operation: expected \"write\" (an erase or a program), \"erase\", \"program\" or \"read\"");
    return false;
}

static bool read_power(const json_t *params, struct fault *fault, struct refusal *refusal)
{
    if (!read_number(params, "operation", 1, COUNT_MAX, 1, fault, refusal))
        return false;
    fault->operations = FAULT_ERASE | FAULT_PROGRAM;
    fault->skip += fault->number - 1u;
    if (!fault->counted)
        fault->left = 1;
    fault->counted = true;
    return true;
}

static bool read_input(const json_t *params, struct fault *fault, struct refusal *refusal)
{
    return read_boolean(params, "level", -1, &fault->level, refusal);
}

/* ---- Reading: what several kinds have ------------------------------------------------------------------------------- */

static bool read_kind(const json_t *params, struct fault *fault, struct refusal *refusal)
{
    char list[200] = "";
    const char *name = json_string_value(json_object_get(params, "kind"));
    enum fault_kind kind = name ? fault_kind_named(name) : FAULT_KINDS;
    fault->kind = (uint8_t)kind;
    if (kind != FAULT_KINDS)
        return true;
    for (unsigned i = 0; i < FAULT_KINDS; i++) {
        strncat(list, i > 0 ? ", " : "", sizeof list - strlen(list) - 1u);
        strncat(list, fault_kind_name((enum fault_kind)i), sizeof list - strlen(list) - 1u);
    }
    refuse(refusal, REFUSED_PARAMS, "kind: expected one of %s%s", list, nearest_hint(name ? name : "", list));
    return false;
}

static bool check_names(const json_t *params, enum fault_kind kind, struct refusal *refusal)
{
    const char *names[16] = {"kind"};
    unsigned count = 1;
    for (const struct fault_parameter *common = fault_common_parameters; common->name; common++)
        names[count++] = common->name;
    for (const struct fault_parameter *own = fault_parameters(kind); own->name; own++)
        names[count++] = own->name;
    names[count] = NULL;
    return params_known(params, names, refusal);
}

static bool read_probability(const json_t *params, struct fault *fault, struct refusal *refusal)
{
    const json_t *value = json_object_get(params, "probability");
    double probability = json_number_value(value);
    fault->millionths = SURE;
    if (!value)
        return true;
    if (!json_is_number(value) || !(probability >= 1.0 / SURE && probability <= 1.0)) {
        refuse(refusal, REFUSED_PARAMS, "probability: expected a number from 0.000001 to 1");
        return false;
    }
    fault->millionths = (uint32_t)(probability * SURE + 0.5);
    return true;
}

static bool read_opportunities(const json_t *params, struct fault *fault, struct refusal *refusal)
{
    int64_t count, skip;
    if (!param_integer_or(params, "count", 1, COUNT_MAX, 0, &count, refusal) ||
        !param_integer_or(params, "skip", 0, INT32_MAX, 0, &skip, refusal) || !read_probability(params, fault, refusal))
        return false;
    fault->counted = count > 0;
    fault->left = (uint32_t)count;
    fault->skip = (uint64_t)skip;
    return true;
}

static bool read_window(const struct sim *sim, const json_t *params, struct fault *fault, struct refusal *refusal)
{
    uint64_t after, length = DEVICE_NEVER;
    if (!param_time(params, "after", 0, &after, refusal))
        return false;
    if (json_object_get(params, "for") && !param_time(params, "for", DEVICE_NEVER, &length, refusal))
        return false;
    if (length == 0) {
        refuse(refusal, REFUSED_PARAMS, "for: expected a time of at least 1us");
        return false;
    }
    fault->from = sim_now(sim) + after;
    fault->until = length == DEVICE_NEVER ? DEVICE_NEVER : fault->from + length;
    return true;
}

static bool read_interval(const json_t *params, struct fault *fault, struct refusal *refusal)
{
    if (!fault_takes(fault->kind, "duration"))
        return true;
    bool given = json_object_get(params, "duration") != NULL;
    fault->ticks = DEVICE_NEVER;
    if (given && !param_time(params, "duration", DEVICE_NEVER, &fault->ticks, refusal))
        return false;
    if (!param_time(params, "every", 0, &fault->every, refusal))
        return false;
    const char *wrong = NULL;
    if (given && fault->ticks == 0)
        wrong = "duration: expected a time of at least 1us";
    else if (fault->kind == FAULT_BREAK && !given && fault->until == DEVICE_NEVER)
        wrong = "duration: missing: how long the bus is held at 0, as in \"20ms\"";
    else if (fault->every > 0 && (!given || fault->ticks >= fault->every))
        wrong = "every: expected a duration, too, and a time longer than the duration";
    else if (json_object_get(params, "every") && fault->every < EVERY_MIN)
        wrong = "every: expected a time of at least 1ms";
    if (wrong)
        refuse(refusal, REFUSED_PARAMS, "%s", wrong);
    return !wrong;
}

/* Which unit, and which way: bytes of the host cannot be those of one unit. Without a unit: all of them. */
static bool read_unit_and_direction(struct sim *sim, const json_t *params, struct fault *fault, struct refusal *refusal)
{
    if (fault_takes(fault->kind, "unit") && json_object_get(params, "unit") &&
        !(fault->unit = (uint8_t)param_unit(sim, params, refusal)))
        return false;
    if (!fault_takes(fault->kind, "direction"))
        return true;
    fault->direction = fault->unit > 0 ? FAULT_TO_HOST : FAULT_BOTH;
    if (!json_object_get(params, "direction"))
        return true;
    const char *way = json_string_value(json_object_get(params, "direction"));
    fault->direction = 0;
    for (uint8_t i = FAULT_TO_UNITS; way && i <= FAULT_BOTH; i++)
        if (strcmp(fault_direction_names[i - FAULT_TO_UNITS], way) == 0)
            fault->direction = i;
    if (fault->direction == 0)
        refuse(refusal, REFUSED_PARAMS, "direction: expected \"to_units\", \"to_master\" or \"both\"");
    else if (fault->unit > 0 && fault->direction != FAULT_TO_HOST)
        refuse(refusal, REFUSED_PARAMS,
               "direction: with unit expected \"to_master\": all units receive the same bytes of the host");
    else
        return true;
    return false;
}

/* ---- Methods -------------------------------------------------------------------------------------------------------- */

/* `input`: a number or a name. */
static bool read_input_number(const struct device_kind *device, const json_t *params, struct fault *fault,
                              struct refusal *refusal)
{
    char expected[DEVICE_ERROR_SIZE];
    const char *name = json_string_value(json_object_get(params, "input"));
    if (!name)
        return read_number(params, "input", 1, device->inputs, -1, fault, refusal);
    fault->number = device_input_named(device, name);
    if (fault->number == 0)
        refuse(refusal, REFUSED_PARAMS, "input: unknown input `%.40s': expected %s", name, device_input_names(device, expected));
    return fault->number > 0;
}

static bool has_check_value(const struct sim *sim)
{
    const struct device_kind *device = sim_device(sim);
    return device->receive && device->has_check_value(&sim->config.unit);
}

static json_t *command_fault_inject(struct sim *sim, const json_t *params, struct refusal *refusal)
{
    struct fault fault = {0};
    if (!read_kind(params, &fault, refusal))
        return NULL;
    const char *lacking = fault_lacks(fault.kind, sim_device(sim));
    if (lacking)
        return refuse(refusal, REFUSED_STATE, "%s: the device %s %s", fault_kind_name(fault.kind), sim_device(sim)->name,
                      lacking);
    if (!check_names(params, fault.kind, refusal) || !read_opportunities(params, &fault, refusal) ||
        !read_window(sim, params, &fault, refusal) || !read_interval(params, &fault, refusal) ||
        !read_unit_and_direction(sim, params, &fault, refusal) || !readers[fault.kind](params, &fault, refusal))
        return NULL;
    if (fault.kind == FAULT_INPUT && !read_input_number(sim_device(sim), params, &fault, refusal))
        return NULL;
    if (fault.kind == FAULT_WRONG_FCS && !has_check_value(sim))
        return refuse(refusal, REFUSED_STATE, "wrong_fcs: framing `%s' has no check value",
                      sim->monitor.framing->link->name);
    uint32_t id = faults_add(&sim->faults, &fault);
    if (id == 0)
        return refuse(refusal, REFUSED_STATE, "too many faults: %u can still act; clear some of them first", FAULTS_MAX);
    return json_pack("{s:I}", "id", (json_int_t)id);
}

static json_t *command_fault_clear(struct sim *sim, const json_t *params, struct refusal *refusal)
{
    static const char *const names[] = {"id", NULL};
    int64_t id;
    if (!params_known(params, names, refusal) || !param_integer_or(params, "id", 1, UINT32_MAX, 0, &id, refusal))
        return NULL;
    unsigned cleared = faults_remove(&sim->faults, (uint32_t)id);
    if (id != 0 && cleared == 0)
        return refuse(refusal, REFUSED_PARAMS, "id: there is no fault %lld: see fault.list", (long long)id);
    return json_pack("{s:i}", "cleared", (int)cleared);
}

/* ---- fault.list: what faults there are, and how often each has acted ---------------------------------------------------- */

static void put_member(json_t *object, const char *name, json_t *value)
{
    json_object_set_new(object, name, value); /* short of memory: it is missing */
}

static void put_time(json_t *object, const char *name, uint64_t ticks)
{
    put_member(object, name, ticks == DEVICE_NEVER ? json_null() : json_integer((json_int_t)ticks));
}

static const char *fault_state(const struct fault *fault, uint64_t now)
{
    if (fault->active || fault->victim != 0)
        return "active";
    if (fault_is_spent(fault, now))
        return "spent";
    return fault->from > now ? "waiting" : "armed";
}

static const char *fault_operation_name(const struct fault *fault)
{
    unsigned i = 0;
    while (fault_operation_names[i + 1u] && fault_operation_sets[i] != fault->operations)
        i++;
    return fault_operation_names[i];
}

/* What the kind has of its own. */
static void put_kind_members(json_t *object, const struct fault *fault)
{
    switch (fault->kind) {
    case FAULT_FLIP:
        put_member(object, "mask", json_integer(fault->number));
        break;
    case FAULT_INSERT:
        put_member(object, "byte", json_integer(fault->number));
        break;
    case FAULT_DELAY:
        put_time(object, "delay_us", fault->ticks);
        break;
    case FAULT_CUT:
        put_member(object, "bytes", json_integer(fault->number));
        break;
    case FAULT_FLASH:
        put_member(object, "operation", json_string(fault_operation_name(fault)));
        put_member(object, "torn", json_boolean(fault->torn));
        break;
    case FAULT_POWER:
        put_member(object, "operation", json_integer(fault->number));
        break;
    case FAULT_INPUT:
        put_member(object, "input", json_integer(fault->number));
        put_member(object, "level", json_integer(fault->level));
        break;
    default:
        break;
    }
}

static json_t *fault_json(const struct sim *sim, const struct fault *fault)
{
    json_t *object = json_object();
    put_member(object, "id", json_integer((json_int_t)fault->id));
    put_member(object, "kind", json_string(fault_kind_name((enum fault_kind)fault->kind)));
    put_member(object, "state", json_string(fault_state(fault, sim_now(sim))));
    put_member(object, "acted", json_integer((json_int_t)fault->acted));
    put_member(object, "left", fault->counted ? json_integer((json_int_t)fault->left) : json_null());
    put_member(object, "skip", json_integer((json_int_t)fault->skip));
    put_member(object, "probability", json_real(fault->millionths / 1e6));
    put_time(object, "from_us", fault->from);
    put_time(object, "until_us", fault->until);
    put_member(object, "unit", fault->unit > 0 ? json_string(sim->unit[fault->unit - 1u].name) : json_null());
    if (fault->direction != 0)
        put_member(object, "direction", json_string(fault_direction_names[fault->direction - FAULT_TO_UNITS]));
    if (fault->kind >= FAULT_POWER)
        put_time(object, "duration_us", fault->ticks);
    if (fault->kind >= FAULT_BREAK)
        put_time(object, "every_us", fault->every > 0 ? fault->every : DEVICE_NEVER);
    put_kind_members(object, fault);
    return object;
}

static json_t *command_fault_list(struct sim *sim, const json_t *params, struct refusal *refusal)
{
    static const char *const names[] = {NULL};
    if (!params_known(params, names, refusal))
        return NULL;
    json_t *list = json_array();
    for (unsigned i = 0; i < sim->faults.count; i++)
        json_array_append_new(list, fault_json(sim, &sim->faults.fault[i]));
    return json_pack("{s:o}", "faults", list);
}

static json_t *command_fault_kinds(struct sim *sim, const json_t *params, struct refusal *refusal)
{
    static const char *const names[] = {NULL};
    return params_known(params, names, refusal) ? fault_kinds_json(sim_device(sim)) : NULL;
}

const struct command_method fault_methods[] = {
    {"fault.inject", command_fault_inject, true},
    {"fault.clear", command_fault_clear, true},
    {"fault.list", command_fault_list, false},
    {"fault.kinds", command_fault_kinds, false},
    {NULL, NULL, false},
};
