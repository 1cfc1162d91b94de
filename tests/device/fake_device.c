/* SPDX-License-Identifier: MIT */
/* The fake device as a kind of device: all that the rooms around it know of it. */
#include "fake_device.h"

#include <stdio.h>
#include <string.h>

#include "fake.h"
#include "text/text.h"

#define FAKE_REFUSED 10 /* flags of a text that the unit refuses begin here */
#define FLASH (FAKE_FLASH_BLOCKS - 1u) /* the block that is used */

/* A unit: what struct device_unit is for this kind. */
struct fake_device {
    struct fake_unit core;
    const struct device_port *port; /* what the unit reports to */
    void *context;                  /* of the port */
};

static struct fake_device *device_of(struct device_unit *unit)
{
    return (struct fake_device *)unit;
}

static const struct fake_unit *core_of(const struct device_unit *unit)
{
    return &((const struct fake_device *)unit)->core;
}

/* What a config has of it: nothing is the default. */
struct fake_settings {
    int32_t rate;      /* steps/s at power-up; 0: 100, or that of the flash */
    bool silent;       /* messages end with a silence */
    const char *start; /* texts to execute at power-up, a line each; NULL: none */
};

_Static_assert(sizeof(struct fake_settings) <= DEVICE_SETTINGS_SIZE, "the settings have to fit");

static struct fake_settings settings_of(const struct device_config *config)
{
    struct fake_settings settings;
    memcpy(&settings, config->own.byte, sizeof settings);
    return settings;
}

static void put_own(struct device_config *config, const struct fake_settings *settings)
{
    memcpy(config->own.byte, settings, sizeof *settings);
}

/* ---- What the core reports ------------------------------------------------------------------------------------------ */

static void on_step(void *context, uint64_t tick, int32_t position, bool forward)
{
    const struct fake_device *device = context;
    if (device->port->steps)
        device->port->steps(device->context, 1, &tick, 1, position, forward);
}

static void on_direction(void *context, uint64_t tick, bool forward)
{
    const struct fake_device *device = context;
    if (device->port->direction)
        device->port->direction(device->context, tick, 1, forward);
}

static void report(const struct fake_device *device, uint64_t tick, enum device_event what, uint32_t value)
{
    if (device->port->event)
        device->port->event(device->context, tick, 1, what, value);
}

static void on_motion(void *context, uint64_t tick, bool moving)
{
    report(context, tick, DEVICE_EVENT_MOTION, moving);
    report(context, tick, DEVICE_EVENT_LED, moving ? DEVICE_LED_ON : DEVICE_LED_OFF);
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
    const struct fake_device *device = context;
    if (device->port->outputs)
        device->port->outputs(device->context, tick, on);
}

static bool on_load(void *context, uint8_t data[4])
{
    const struct fake_device *device = context;
    return device->port->flash_read && device->port->flash_read(device->context, FLASH, 0, data, 4) == 0;
}

static bool on_save(void *context, const uint8_t data[4])
{
    const struct fake_device *device = context;
    const struct device_port *port = device->port;
    return port->flash_erase && port->flash_program && port->flash_erase(device->context, FLASH) == 0 &&
           port->flash_program(device->context, FLASH, 0, data, 4) == 0;
}

static const struct fake_calls calls = {
    .step = on_step, .direction = on_direction, .motion = on_motion, .position = on_position,
    .limit = on_limit, .output = on_output, .load = on_load, .save = on_save,
};

/* ---- Power, time, bytes --------------------------------------------------------------------------------------------- */

/* Obey what the settings say, before the first us. */
static void start(struct fake_device *device, struct fake_settings settings)
{
    char text[FAKE_TEXT_MAX + 1];
    device->core.silent = settings.silent;
    if (settings.rate > 0)
        device->core.rate = (uint16_t)settings.rate;
    for (const char *at = settings.start; at && *at; at += strcspn(at, "\n"), at += *at == '\n') {
        snprintf(text, sizeof text, "%.*s", (int)strcspn(at, "\n"), at);
        fake_obey(&device->core, text);
    }
}

static void begin(struct device_unit *unit, const struct device_config *config, const struct device_port *port, void *context)
{
    struct fake_device *device = device_of(unit);
    device->port = port;
    device->context = context;
    fake_begin(&device->core, config->node, &calls, device);
    start(device, settings_of(config));
}

/* A copy reports to its own surroundings, not to those of the original. */
static void attach(struct device_unit *unit, const struct device_config *config, const struct device_port *port, void *context)
{
    struct fake_device *device = device_of(unit);
    (void)config;
    device->port = port;
    device->context = context;
    device->core.context = device;
}

static uint64_t now(const struct device_unit *unit)
{
    return core_of(unit)->now / FAKE_TICKS_PER_US;
}

static void advance(struct device_unit *unit, uint64_t us)
{
    fake_advance(&device_of(unit)->core, us * FAKE_TICKS_PER_US);
}

static uint64_t next_event(const struct device_unit *unit)
{
    uint64_t tick = core_of(unit)->due;
    return tick == FAKE_NEVER ? DEVICE_NEVER : tick / FAKE_TICKS_PER_US;
}

static uint64_t next_report(const struct device_unit *unit)
{
    const struct fake_device *device = (const struct fake_device *)unit;
    uint64_t tick = fake_end(&device->core);
    if (device->port->steps)
        return next_event(unit);
    return tick == FAKE_NEVER ? DEVICE_NEVER : tick / FAKE_TICKS_PER_US;
}

/* Fast motions have shorter pulses. */
static unsigned pulse_ticks(const struct device_unit *unit, unsigned number)
{
    (void)number;
    return core_of(unit)->rate > FAKE_FAST ? FAKE_TICKS_PER_US : FAKE_PULSE * FAKE_TICKS_PER_US;
}

static size_t receive(struct device_unit *unit, const uint8_t *bytes, size_t length)
{
    return fake_receive(&device_of(unit)->core, bytes, length);
}

static size_t send(struct device_unit *unit, uint8_t *bytes, size_t room)
{
    return fake_send(&device_of(unit)->core, bytes, room);
}

static uint64_t silence_end(const struct device_unit *unit)
{
    uint64_t tick = core_of(unit)->silence;
    return tick == FAKE_NEVER ? DEVICE_NEVER : tick / FAKE_TICKS_PER_US;
}

static bool has_answer(const struct device_unit *unit)
{
    return core_of(unit)->answer_length > 0;
}

static uint64_t answer_wait(const struct device_unit *unit)
{
    (void)unit;
    return 0;
}

static struct device_counters counters_of(const struct device_unit *unit)
{
    const struct fake_unit *core = core_of(unit);
    return (struct device_counters){
        .requests = core->requests, .others = core->frames - core->requests, .answers = core->answers};
}

/* A text without address and CR. Returns the answer, NULL: it is too long. */
static const char *obey(struct device_unit *unit, const void *bytes, size_t length)
{
    char text[FAKE_TEXT_MAX + 1];
    if (length > FAKE_TEXT_MAX)
        return NULL;
    memcpy(text, bytes, length);
    text[length] = '\0';
    return fake_obey(&device_of(unit)->core, text);
}

static size_t exchange(struct device_unit *unit, const uint8_t *message, size_t length, uint8_t *answer, size_t room)
{
    const char *text = obey(unit, message, length);
    size_t answer_length = text ? strlen(text) : 0;
    if (text)
        memcpy(answer, text, answer_length < room ? answer_length : room);
    return answer_length;
}

/* ---- Messages -------------------------------------------------------------------------------------------------------- */

static const struct device_framing *framing(const struct device_config *config)
{
    return settings_of(config).silent ? &fake_sums : &fake_lines;
}

static void put_words(struct wire_text *out, const uint8_t *message, size_t length, bool is_answer)
{
    if (!is_answer)
        wire_text_string(out, "request ");
    wire_text_bytes(out, message, length);
}

static void put_refusal(struct wire_text *out, const uint8_t *message, size_t length)
{
    if (length == 2 && message[0] == 'E')
        wire_text_string(out, message[1] == '3' ? "the limit switch is on" : "the request is wrong");
}

static const struct device_words words = {.message = put_words, .refusal = put_refusal};

static bool has_check_value(const struct device_config *config)
{
    (void)config;
    return false;
}

/* ---- State ---------------------------------------------------------------------------------------------------------- */

static void set_inputs(struct device_unit *unit, uint32_t mask)
{
    fake_set_inputs(&device_of(unit)->core, mask);
}

static uint32_t inputs_of(const struct device_unit *unit)
{
    return core_of(unit)->inputs;
}

static uint32_t outputs_of(const struct device_unit *unit)
{
    return core_of(unit)->output;
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
    static const char *const names[] = {"off", "on"};
    return led < 2 ? names[led] : NULL;
}

static void axis(const struct device_unit *unit, unsigned number, struct device_axis *state)
{
    const struct fake_unit *core = core_of(unit);
    bool moving = core->due != FAKE_NEVER;
    (void)number; /* there is one */
    *state = (struct device_axis){
        .position = core->position,
        .steps = moving ? core->done : 0,
        .speed = moving ? core->rate : 0,
        .state = moving,
        .fault = core->limit,
        .led = moving ? DEVICE_LED_ON : DEVICE_LED_OFF,
        .lit = moving,
        .idle = !moving,
        .running = moving,
        .moving = moving,
        .forward = core->forward,
    };
}

/* The requests of a text, a line each, up to the first that is refused. */
static int set_text(struct device_unit *unit, unsigned number, const char *text, size_t length, char error[DEVICE_ERROR_SIZE])
{
    (void)number;
    for (size_t at = 0, end; at < length; at = end + 1) {
        for (end = at; end < length && text[end] != '\n';)
            end++;
        const char *answer = end > at ? obey(unit, text + at, end - at) : "OK";
        if (answer && answer[0] != 'E')
            continue;
        snprintf(error, DEVICE_ERROR_SIZE, "the unit answers %s", answer ? answer : "nothing: the text is too long");
        return FAKE_REFUSED + (answer ? answer[1] - '0' : 0);
    }
    return 0;
}

static bool check_text(const struct device_config *config, const char *name, const char *text, size_t length, FILE *out)
{
    bool is_wrong = false;
    size_t line = 1, column = 0;
    (void)config;
    for (size_t at = 0; at < length; at++) {
        column = text[at] == '\n' ? 0 : column + 1;
        line += text[at] == '\n';
        if (column == FAKE_TEXT_MAX + 1 && out)
            fprintf(out, "%s:%zu:%zu: error: expected a request of at most %u bytes\n", name, line, column, FAKE_TEXT_MAX);
        is_wrong = is_wrong || column > FAKE_TEXT_MAX;
    }
    return is_wrong;
}

static bool is_stuck(const struct device_unit *unit, unsigned number, char text[DEVICE_ERROR_SIZE])
{
    (void)number;
    if (core_of(unit)->limit)
        snprintf(text, DEVICE_ERROR_SIZE, "the limit switch has ended the motion");
    return core_of(unit)->limit;
}

/* Every motion has an end. */
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
    bool moving = core->due != FAKE_NEVER;
    json_t *motor = json_pack("{s:i, s:i, s:s, s:i, s:s, s:s?}", "motor", 1, "position", (int)core->position, "state",
                              state_name(moving), "index", 0, "led", led_name(moving), "fault",
                              core->limit ? fault_name(1) : NULL);
    return json_pack("{s:I, s:[o], s:i, s:i, s:i}", "t_us", (json_int_t)t_us, "motors", motor, "di", (int)core->inputs, "do",
                     (int)core->output, "var", 0);
}

static json_t *describe(const struct device_unit *unit, uint64_t t_us)
{
    json_t *all = state(unit, t_us);
    json_object_set_new(json_array_get(json_object_get(all, "motors"), 0), "true_position", json_null());
    json_object_set_new(all, "node", json_integer(core_of(unit)->address));
    json_object_set_new(all, "rate", json_integer(core_of(unit)->rate));
    return all;
}

/* ---- Settings ------------------------------------------------------------------------------------------------------- */

static bool read_rate(struct device_config *config, const char *value, char error[DEVICE_ERROR_SIZE])
{
    uint64_t rate;
    struct fake_settings own = settings_of(config);
    if (!number_read(value, 1, FAKE_RATE_MAX, &rate)) {
        snprintf(error, DEVICE_ERROR_SIZE, "`%.40s' is wrong: expected steps/s from 1 to %u", value, FAKE_RATE_MAX);
        return false;
    }
    own.rate = (int32_t)rate;
    put_own(config, &own);
    return true;
}

static bool read_framing(struct device_config *config, const char *value, char error[DEVICE_ERROR_SIZE])
{
    struct fake_settings own = settings_of(config);
    own.silent = strcmp(value, "sums") == 0;
    put_own(config, &own);
    if (!own.silent && strcmp(value, "lines") != 0)
        snprintf(error, DEVICE_ERROR_SIZE, "`%.40s' is wrong: expected lines or sums", value);
    return own.silent || strcmp(value, "lines") == 0;
}

static bool read_start(struct device_config *config, const char *name, const char *text, size_t length, FILE *errors)
{
    struct fake_settings own = settings_of(config);
    own.start = text;
    put_own(config, &own);
    return !check_text(config, name, text, length, errors);
}

static const struct device_option options[] = {
    {.name = "rate",
     .argument = "N",
     .help = "Steps/s at power-up, 1 to 10000; default 100, or that of the flash",
     .read = read_rate},
    {.name = "start-file",
     .argument = "FILE",
     .help = "Requests that are obeyed at power-up, a line each",
     .read_file = read_start},
    {.name = "end",
     .argument = "WHAT",
     .help = "What ends a message: lines (default), CR; sums, a silence of 2 ms after a sum of the bytes",
     .flags = DEVICE_OPTION_BUS,
     .read = read_framing},
    {.name = NULL},
};

/* As recordings have them. */
static const char *const settings[] = {"rate", "start", "end", NULL};

static void put_settings(const struct device_config *config, json_t *object)
{
    const struct fake_settings own = settings_of(config);
    json_object_set_new(object, "rate", json_integer(own.rate));
    if (own.start)
        json_object_set_new(object, "start", json_string(own.start));
    if (own.silent)
        json_object_set_new(object, "end", json_string("sums"));
}

static bool read_setting(struct device_config *config, const char *name, const json_t *value, char error[DEVICE_ERROR_SIZE])
{
    struct fake_settings own = settings_of(config);
    bool is_rate = strcmp(name, "rate") == 0;
    if (strcmp(name, "end") == 0)
        return !value || read_framing(config, json_is_string(value) ? json_string_value(value) : "", error);
    if (is_rate && value)
        own.rate = (int32_t)json_integer_value(value);
    if (!is_rate && value)
        own.start = json_string_value(value);
    if (own.rate < 0 || own.rate > (int32_t)FAKE_RATE_MAX || (value && is_rate != json_is_integer(value))) {
        snprintf(error, DEVICE_ERROR_SIZE, "expected \"rate\", a number up to %u, and \"start\", a text", FAKE_RATE_MAX);
        return false;
    }
    put_own(config, &own);
    return true;
}

/* ---- Methods of its own --------------------------------------------------------------------------------------------- */

/* fake.rate: another rate from the next step on, while it moves, too. */
static json_t *call_rate(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    struct fake_unit *core = &device_of(unit)->core;
    const json_t *rate = json_object_get(params, "rate");
    if (!json_is_integer(rate) || json_integer_value(rate) < 1 || json_integer_value(rate) > FAKE_RATE_MAX) {
        snprintf(refusal->text, DEVICE_ERROR_SIZE, "rate: expected steps/s from 1 to %u", FAKE_RATE_MAX);
        return NULL;
    }
    if (core->limit) {
        refusal->is_state = true;
        snprintf(refusal->text, DEVICE_ERROR_SIZE, "the limit switch has ended the motion: expected STOP first");
        return NULL;
    }
    core->rate = (uint16_t)json_integer_value(rate);
    return json_pack("{s:i}", "rate", (int)core->rate);
}

static const struct device_method methods[] = {
    {"fake.rate", call_rate, true, NULL},
    {NULL, NULL, false, NULL},
};

static const char *unlike(const struct device_config *a, const struct device_config *b)
{
    const struct fake_settings here = settings_of(a), there = settings_of(b);
    if (here.silent != there.silent)
        return "the end of messages";
    return here.rate != there.rate ? "the rate" : NULL; /* what it does at power-up is over */
}

const struct device_kind fake_device = {
    .name = "fake",
    .description = "one axis at constant speed, twenty inputs, one output (example)",
    .size = sizeof(struct fake_device),
    .axes = 1,
    .inputs = FAKE_INPUTS,
    .outputs = 1,
    .addresses = FAKE_ADDRESSES,
    .ticks_per_us = FAKE_TICKS_PER_US,
    .slot = 1,
    .pulse = FAKE_PULSE,
    .is_program_whole = true,
    .flash_blocks = FAKE_FLASH_BLOCKS,
    .flash_block_size = FAKE_FLASH_SIZE,
    .request_max = FAKE_TEXT_MAX,
    .answer_max = FAKE_TEXT_MAX,
    .begin = begin,
    .attach = attach,
    .now = now,
    .advance = advance,
    .next_event = next_event,
    .next_report = next_report,
    .pulse_ticks = pulse_ticks,
    .receive = receive,
    .send = send,
    .silence_end = silence_end,
    .has_answer = has_answer,
    .answer_wait = answer_wait,
    .counters = counters_of,
    .exchange = exchange,
    .framing = framing,
    .words = &words,
    .has_check_value = has_check_value,
    .set_inputs = set_inputs,
    .inputs_of = inputs_of,
    .outputs_of = outputs_of,
    .variables_of = variables_of,
    .node = node,
    .axis = axis,
    .set_text = set_text,
    .check_text = check_text,
    .is_stuck = is_stuck,
    .is_endless = is_endless,
    .state_name = state_name,
    .fault_name = fault_name,
    .led_name = led_name,
    .state = state,
    .describe = describe,
    .options = options,
    .methods = methods,
    .settings = settings,
    .put_settings = put_settings,
    .read_setting = read_setting,
    .unlike = unlike,
};
