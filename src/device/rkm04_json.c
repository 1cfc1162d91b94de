/* SPDX-License-Identifier: MIT */
/* The state of an RKM04 as JSON. */
#include <stdlib.h>
#include <string.h>

#include "rkm04_device.h"

#define TABLE_TEXT_MAX 1024u /* message 6: 34 points of two numbers of ten and five digits, and more */

static const char *const slot_names[] = {
    [RKM04_SLOT_EMPTY] = "empty",
    [RKM04_SLOT_LOADED] = "loaded",
    [RKM04_SLOT_UNTRUSTED] = "untrusted",
    [RKM04_SLOT_STORED] = "stored",
};

/* Place 1..700 of command `number`. */
static int place_of(uint64_t number)
{
    return (int)(number % RKM04_PROGRAM_MAX) + 1;
}

/* ---- Of a motor ----------------------------------------------------------------------------------------------------- */

/* The command at place 1..700, as text; JSON null for place 0. */
static json_t *command_json(const struct rkm04_motor *motor, unsigned place)
{
    char text[RKM04_COMMAND_TEXT_MAX];
    if (place == 0)
        return json_null();
    struct rkm04_command command = {.op = motor->program.op[place - 1], .argument = motor->program.argument[place - 1]};
    return json_stringn(text, rkm04_format(command, text));
}

static json_t *guard_json(unsigned input)
{
    return input > 0 ? json_integer((json_int_t)input) : json_null();
}

static json_t *guards_json(const struct rkm04_motor *motor)
{
    return json_pack("{s:o, s:o, s:o}", "m", guard_json(motor->guard_m), "n", guard_json(motor->guard_n), "x",
                     guard_json(motor->guard_x));
}

static json_t *functions_json(const struct rkm04_motor *motor)
{
    json_t *list = json_array();
    if (motor->keep)
        json_array_append_new(list, json_integer(40));
    for (unsigned bit = 0; bit < 8; bit++)
        if (motor->functions >> bit & 1u)
            json_array_append_new(list, json_integer(51 + (json_int_t)bit));
    return list;
}

static json_t *loops_json(const struct rkm04_motor *motor)
{
    json_t *list = json_array();
    for (unsigned i = 0; i < motor->loops; i++)
        json_array_append_new(list, json_pack("{s:i, s:i}", "start", place_of(motor->loop[i].start), "left",
                                              (int)motor->loop[i].left));
    return list;
}

static json_t *calls_json(const struct rkm04_motor *motor)
{
    json_t *list = json_array();
    for (unsigned i = 0; i < motor->calls; i++)
        json_array_append_new(list, json_integer(place_of(motor->call[i])));
    return list;
}

/* The break points, as message 6 gives them: asked of a copy, so that nothing that goes on in the unit is disturbed. */
static json_t *profile_json(const struct rkm04_unit *unit, unsigned motor)
{
    static const struct rkm04_port nobody;
    const uint8_t message[] = {6, (uint8_t)('0' + motor)};
    char text[TABLE_TEXT_MAX];
    struct rkm04_unit *copy = malloc(sizeof *copy);
    if (!copy)
        return NULL;
    *copy = *unit;
    copy->port = &nobody;
    copy->waiting = false; /* a request that waits for the end of the answer must not act on the copy before */
    while (rkm04_send(copy, (uint8_t *)text, sizeof text) > 0) {
    }
    size_t length = rkm04_exchange(copy, message, sizeof message, (uint8_t *)text, sizeof text - 1);
    free(copy);
    text[length < sizeof text ? length : sizeof text - 1] = '\0';
    json_t *points = json_array();
    const char *at = strchr(text, '[');
    for (at = at ? at + 1 : ""; *at == '('; at += *at == ',') {
        char *end;
        unsigned long step = strtoul(at + 1, &end, 10);
        unsigned long speed = *end == ';' ? strtoul(end + 1, &end, 10) : 0;
        json_array_append_new(points, json_pack("[I, I]", (json_int_t)step, (json_int_t)speed));
        at = *end == ')' ? end + 1 : "";
    }
    return points;
}

static json_t *parameters_json(const struct rkm04_motor *motor)
{
    return json_pack("{s:i, s:i, s:i, s:I, s:b, s:i}", "start_speed", (int)motor->start_speed, "speed", (int)motor->speed,
                     "acceleration", (int)motor->acceleration, "count", (json_int_t)motor->count, "forward",
                     (int)motor->forward, "segments", (int)motor->segments);
}

/* Put `value` into the object, which is NULL if memory has been short. */
static void put(json_t *object, const char *name, json_t *value)
{
    if (!value || !object)
        json_decref(value);
    else
        json_object_set_new(object, name, value);
}

static void put_motor(json_t *object, const struct rkm04_unit *unit, unsigned number)
{
    const struct rkm04_motor *motor = &unit->motor[number - 1];
    struct rkm04_motor_state state;
    rkm04_motor_state(unit, number, &state);
    put(object, "true_position", json_null());
    put(object, "command", command_json(motor, state.index));
    put(object, "waits_for", rkm04_waits_json(unit, number));
    put(object, "lit", json_boolean(state.lit));
    put(object, "speed", json_integer(state.speed));
    put(object, "steps", json_integer(state.steps));
    put(object, "forward", json_boolean(state.forward));
    put(object, "stopping", json_boolean(state.stopping));
    put(object, "held",
        motor->state == RKM04_HELD ? json_string(rkm04_state_name((enum rkm04_state)motor->held)) : json_null());
    put(object, "guards", guards_json(motor));
    put(object, "profile", profile_json(unit, number));
    put(object, "parameters", parameters_json(motor));
    put(object, "functions", functions_json(motor));
    put(object, "loops", loops_json(motor));
    put(object, "calls", calls_json(motor));
    put(object, "memory", json_pack("{s:i, s:i}", "commands", (int)state.commands, "of", (int)RKM04_PROGRAM_MAX));
    put(object, "slot", json_string(slot_names[state.slot]));
}

/* ---- Of a unit ------------------------------------------------------------------------------------------------------ */

static json_t *counters_json(const struct rkm04_unit *unit)
{
    struct rkm04_counters counters = rkm04_counters(unit);
    return json_pack("{s:I, s:I, s:I, s:I}", "requests", (json_int_t)counters.requests, "answers",
                     (json_int_t)counters.answers, "others", (json_int_t)counters.others, "dropped",
                     (json_int_t)counters.dropped);
}

static json_t *motor_state_json(const struct rkm04_unit *unit, unsigned motor)
{
    struct rkm04_motor_state state;
    rkm04_motor_state(unit, motor, &state);
    const char *fault = state.fault == RKM04_FAULT_NONE ? NULL : rkm04_fault_name(state.fault);
    return json_pack("{s:i, s:I, s:s, s:i, s:s, s:s?}", "motor", (int)motor, "position", (json_int_t)state.position, "state",
                     rkm04_state_name(state.state), "index", (int)state.index, "led", rkm04_led_name(state.led), "fault",
                     fault);
}

json_t *rkm04_json_state(const struct rkm04_unit *unit, uint64_t tick)
{
    json_t *motors = json_array();
    for (unsigned motor = 1; motor <= RKM04_MOTORS; motor++) {
        if (motors != NULL && json_array_append_new(motors, motor_state_json(unit, motor)) != 0) {
            json_decref(motors);
            motors = NULL;
        }
    }
    if (motors == NULL)
        return NULL;
    return json_pack("{s:I, s:o, s:i, s:i, s:i}", "t_us", (json_int_t)tick, "motors", motors, "di",
                     (int)rkm04_inputs(unit), "do", (int)rkm04_outputs(unit), "var", (int)rkm04_variables(unit));
}

json_t *rkm04_json_describe(const struct rkm04_unit *unit, uint64_t tick)
{
    json_t *state = rkm04_json_state(unit, tick), *motors = json_object_get(state, "motors");
    for (unsigned motor = 1; motor <= RKM04_MOTORS; motor++)
        put_motor(json_array_get(motors, motor - 1), unit, motor);
    put(state, "node", json_integer(unit->config.node));
    put(state, "simulation", json_boolean(unit->simulation));
    put(state, "counters", counters_json(unit));
    return state;
}

/* ---- The program ---------------------------------------------------------------------------------------------------- */

json_t *rkm04_json_program(const struct rkm04_unit *unit, unsigned number)
{
    const struct rkm04_motor *motor = &unit->motor[number - 1];
    uint64_t written = motor->program.written, oldest = written > RKM04_PROGRAM_MAX ? written - RKM04_PROGRAM_MAX : 0;
    json_t *commands = json_array();
    for (uint64_t at = oldest; at < written; at++)
        json_array_append_new(commands, command_json(motor, (unsigned)place_of(at)));
    return json_pack("{s:i, s:o}", "first", place_of(oldest), "commands", commands);
}
