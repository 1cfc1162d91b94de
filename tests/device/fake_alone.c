/* SPDX-License-Identifier: MIT */
/* fake_alone.c: a kind of device without a bus: the core of fake.h with names of inputs and outputs, reached by its methods. */
#include <stdio.h>
#include <string.h>

#include "fake.h"
#include "fake_device.h"

#define INPUTS 3u

struct fake_alone {
    struct fake_unit core;
    const struct device_port *port;
    void *context;
    bool has_stepped;
    int32_t level; /* a value without a meaning */
};

static struct fake_alone *alone_of(struct device_unit *unit)
{
    return (struct fake_alone *)unit;
}

static const struct fake_unit *core_of(const struct device_unit *unit)
{
    return &((const struct fake_alone *)unit)->core;
}

struct fake_unit *fake_alone_core(struct device_unit *unit)
{
    return unit ? &alone_of(unit)->core : NULL;
}

/* ---- What the core reports ------------------------------------------------------------------------------------------ */

/* Half steps: leads 1 to 4 in outputs 2 to 5. Nothing is driven before the first step. */
static uint32_t outputs_at(const struct fake_alone *alone, int32_t position)
{
    static const uint8_t rows[] = {9, 1, 3, 2, 6, 4, 12, 8};
    return alone->core.output | (alone->has_stepped ? (uint32_t)rows[position & 7] << 1 : 0);
}

static void on_step(void *context, uint64_t tick, int32_t position, bool forward)
{
    struct fake_alone *alone = context;
    alone->has_stepped = true;
    if (alone->port->steps)
        alone->port->steps(alone->context, 1, &tick, 1, position, forward);
    if (alone->port->outputs)
        alone->port->outputs(alone->context, tick, outputs_at(alone, position));
}

static bool coils(const struct device_unit *unit, unsigned axis, struct device_coils *driven)
{
    (void)unit;
    (void)axis;
    *driven = (struct device_coils){.output = {2, 3, 4, 5}, .eighths = 1, .rest = 9};
    return true;
}

static void on_direction(void *context, uint64_t tick, bool forward)
{
    const struct fake_alone *alone = context;
    if (alone->port->direction)
        alone->port->direction(alone->context, tick, 1, forward);
}

static void report(const struct fake_alone *alone, uint64_t tick, enum device_event what, uint32_t value)
{
    if (alone->port->event)
        alone->port->event(alone->context, tick, 1, what, value);
}

static void on_motion(void *context, uint64_t tick, bool moving)
{
    report(context, tick, DEVICE_EVENT_MOTION, moving);
}

static void on_position(void *context, uint64_t tick, int32_t position)
{
    report(context, tick, DEVICE_EVENT_POSITION, (uint32_t)position);
}

static void on_limit(void *context, uint64_t tick, bool hit)
{
    report(context, tick, DEVICE_EVENT_FAULT, hit);
}

static void on_output(void *context, uint64_t tick, bool on)
{
    const struct fake_alone *alone = context;
    uint32_t others = outputs_at(alone, alone->core.position) & ~1u;
    if (alone->port->outputs)
        alone->port->outputs(alone->context, tick, others | on);
}

static bool on_load(void *context, uint8_t data[4])
{
    (void)context;
    (void)data;
    return false;
}

static bool on_save(void *context, const uint8_t data[4])
{
    (void)context;
    (void)data;
    return false;
}

static const struct fake_calls calls = {
    .step = on_step, .direction = on_direction, .motion = on_motion, .position = on_position,
    .limit = on_limit, .output = on_output, .load = on_load, .save = on_save,
};

/* ---- Power and time ------------------------------------------------------------------------------------------------- */

static void begin(struct device_unit *unit, const struct device_config *config, const struct device_port *port, void *context)
{
    struct fake_alone *alone = alone_of(unit);
    alone->port = port;
    alone->context = context;
    alone->has_stepped = false;
    alone->level = 0;
    fake_begin(&alone->core, config->node, &calls, alone);
}

static void attach(struct device_unit *unit, const struct device_config *config, const struct device_port *port, void *context)
{
    struct fake_alone *alone = alone_of(unit);
    (void)config;
    alone->port = port;
    alone->context = context;
    alone->core.context = alone;
}

static uint64_t now(const struct device_unit *unit)
{
    return core_of(unit)->now / FAKE_TICKS_PER_US;
}

static void advance(struct device_unit *unit, uint64_t us)
{
    fake_advance(&alone_of(unit)->core, us * FAKE_TICKS_PER_US);
}

static uint64_t next_event(const struct device_unit *unit)
{
    uint64_t tick = core_of(unit)->due;
    return tick == FAKE_NEVER ? DEVICE_NEVER : tick / FAKE_TICKS_PER_US;
}

/* ---- State ---------------------------------------------------------------------------------------------------------- */

static void set_inputs(struct device_unit *unit, uint32_t mask)
{
    fake_set_inputs(&alone_of(unit)->core, mask);
}

static uint32_t inputs_of(const struct device_unit *unit)
{
    return core_of(unit)->inputs;
}

static uint32_t outputs_of(const struct device_unit *unit)
{
    return outputs_at((const struct fake_alone *)unit, core_of(unit)->position);
}

static uint32_t variables_of(const struct device_unit *unit)
{
    (void)unit;
    return 0;
}

static unsigned node(const struct device_unit *unit)
{
    return core_of(unit)->address;
}

static const char *state_name(unsigned state)
{
    static const char *const names[] = {"idle", "moving"};
    return state < 2 ? names[state] : NULL;
}

static const char *fault_name(unsigned fault)
{
    static const char *const names[] = {"none", "limit"};
    return fault < 2 ? names[fault] : NULL;
}

static const char *led_name(unsigned led)
{
    return led == DEVICE_LED_OFF ? "off" : NULL;
}

static void axis(const struct device_unit *unit, unsigned number, struct device_axis *state)
{
    const struct fake_unit *core = core_of(unit);
    bool moving = core->due != FAKE_NEVER;
    (void)number;
    *state = (struct device_axis){
        .position = core->position, .steps = moving ? core->done : 0, .speed = moving ? core->rate : 0, .state = moving,
        .fault = core->limit, .idle = !moving, .running = moving, .moving = moving, .forward = core->forward,
    };
}

static bool is_stuck(const struct device_unit *unit, unsigned number, char text[DEVICE_ERROR_SIZE])
{
    (void)number;
    if (core_of(unit)->limit)
        snprintf(text, DEVICE_ERROR_SIZE, "the limit switch has ended the motion");
    return core_of(unit)->limit;
}

static bool is_endless(const struct device_unit *unit, unsigned number, char text[DEVICE_ERROR_SIZE])
{
    (void)unit;
    (void)number;
    (void)text;
    return false;
}

static json_t *state(const struct device_unit *unit, uint64_t t_us)
{
    const struct fake_unit *core = core_of(unit);
    json_t *motor = json_pack("{s:i, s:i, s:s, s:i, s:s, s:s?}", "motor", 1, "position", (int)core->position, "state",
                              state_name(core->due != FAKE_NEVER), "index", 0, "led", "off", "fault",
                              core->limit ? fault_name(1) : NULL);
    return json_pack("{s:I, s:[o], s:i, s:i, s:i}", "t_us", (json_int_t)t_us, "motors", motor, "di", (int)core->inputs, "do",
                     (int)outputs_of(unit), "var", 0);
}

static json_t *describe(const struct device_unit *unit, uint64_t t_us)
{
    json_t *all = state(unit, t_us);
    json_object_set_new(json_array_get(json_object_get(all, "motors"), 0), "true_position", json_null());
    json_object_set_new(all, "node", json_integer(core_of(unit)->address));
    return all;
}

/* ---- Methods and settings ------------------------------------------------------------------------------------------- */

/* `alone.obey {text}`: a request as fake.h has it, without the bus. */
static json_t *call_obey(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    const char *text = json_string_value(json_object_get(params, "text"));
    if (text && strlen(text) <= FAKE_TEXT_MAX)
        return json_pack("{s:s}", "answer", fake_obey(&alone_of(unit)->core, text));
    snprintf(refusal->text, DEVICE_ERROR_SIZE, "text: expected a request of at most %u bytes", FAKE_TEXT_MAX);
    return NULL;
}

/* alone.level {level}: sets the value. */
static json_t *call_level(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    struct fake_alone *alone = alone_of(unit);
    (void)refusal;
    alone->level = (int32_t)json_integer_value(json_object_get(params, "level"));
    if (alone->port->event)
        alone->port->event(alone->context, alone->core.now, 1, DEVICE_EVENT_VALUE, (uint32_t)alone->level);
    return json_object();
}

static const struct device_method methods[] = {
    {"alone.level", call_level, true, NULL},
    {"alone.obey", call_obey, true, NULL},
    {NULL, NULL, false, NULL},
};

static void put_settings(const struct device_config *config, json_t *object)
{
    (void)config;
    (void)object;
}

static bool read_setting(struct device_config *config, const char *name, const json_t *value, char error[DEVICE_ERROR_SIZE])
{
    (void)config;
    (void)name;
    (void)value;
    (void)error;
    return true;
}

static const char *unlike(const struct device_config *a, const struct device_config *b)
{
    (void)a;
    (void)b;
    return NULL;
}

static int32_t value(const struct device_unit *unit, unsigned number)
{
    (void)number;
    return ((const struct fake_alone *)unit)->level;
}

static const char *const value_names[] = {"level"};
static const char *const input_names[INPUTS] = {"lmt+", "near", "DI3"};
static const char *const output_names[] = {"lamp", "a1", "b1", "a2", "b2"};
static const char *const no_settings[] = {NULL};

const struct device_kind fake_alone_device = {
    .name = "alone",
    .description = "one axis with coils, without a bus (example)",
    .size = sizeof(struct fake_alone),
    .axes = 1,
    .inputs = INPUTS,
    .outputs = 5,
    .input_names = input_names,
    .output_names = output_names,
    .values = 1,
    .value_names = value_names,
    .value = value,
    .addresses = 1,
    .ticks_per_us = FAKE_TICKS_PER_US,
    .slot = 1,
    .pulse = FAKE_PULSE,
    .begin = begin,
    .attach = attach,
    .now = now,
    .advance = advance,
    .next_event = next_event,
    .next_report = next_event,
    .coils = coils,
    .set_inputs = set_inputs,
    .inputs_of = inputs_of,
    .outputs_of = outputs_of,
    .variables_of = variables_of,
    .node = node,
    .axis = axis,
    .is_stuck = is_stuck,
    .is_endless = is_endless,
    .state_name = state_name,
    .fault_name = fault_name,
    .led_name = led_name,
    .state = state,
    .describe = describe,
    .methods = methods,
    .services = fake_services,
    .settings = no_settings,
    .put_settings = put_settings,
    .read_setting = read_setting,
    .unlike = unlike,
};
