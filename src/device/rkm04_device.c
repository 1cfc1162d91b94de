/* SPDX-License-Identifier: MIT */
/* The RKM04 as a kind of device. */
#include "rkm04_device.h"

#include <stdio.h>

#include "motion_plan.h"
#include "rkm04_repeat.h"
#include "text/text.h"

#define DESCRIPTION "unit for four stepper motors on RS485 (SofCon RKM04)"
#define ANSWER_MAX DEVICE_MESSAGE_MAX /* the longest that a framing can have */

_Static_assert(RKM04_COMMAND_TEXT_MAX <= DEVICE_COMMAND_SIZE, "a command fits");
_Static_assert((int)DEVICE_SLOT_LOADED == (int)RKM04_SLOT_LOADED && (int)DEVICE_SLOT_UNTRUSTED == (int)RKM04_SLOT_UNTRUSTED &&
                   (int)DEVICE_SLOT_STORED == (int)RKM04_SLOT_STORED,
               "slots have the same numbers here and there");
_Static_assert((int)DEVICE_EVENT_MOTION == (int)RKM04_EVENT_MOTION && (int)DEVICE_EVENT_COMMAND == (int)RKM04_EVENT_COMMAND &&
                   (int)DEVICE_EVENT_LED == (int)RKM04_EVENT_LED &&
                   (int)DEVICE_EVENT_VARIABLE == (int)RKM04_EVENT_VARIABLE &&
                   (int)DEVICE_EVENT_FAULT == (int)RKM04_EVENT_FAULT &&
                   (int)DEVICE_EVENT_POSITION == (int)RKM04_EVENT_POSITION,
               "events have the same numbers here and there");

static struct rkm04_device *device_of(struct device_unit *unit)
{
    return (struct rkm04_device *)unit;
}

struct rkm04_unit *rkm04_of(struct device_unit *unit)
{
    return &device_of(unit)->unit;
}

static const struct rkm04_unit *core_of(const struct device_unit *unit)
{
    return &((const struct rkm04_device *)unit)->unit;
}

/* ---- Port ----------------------------------------------------------------------------------------------------------- */

static void on_steps(void *context, unsigned motor, const uint64_t *tick, size_t count, int32_t position, bool forward)
{
    const struct rkm04_device *device = context;
    device->outer->steps(device->context, motor, tick, count, position, forward);
}

static void on_direction(void *context, uint64_t tick, unsigned motor, bool forward)
{
    const struct rkm04_device *device = context;
    device->outer->direction(device->context, tick, motor, forward);
}

static void on_outputs(void *context, uint64_t tick, uint8_t mask)
{
    const struct rkm04_device *device = context;
    device->outer->outputs(device->context, tick, mask);
}

static void on_event(void *context, uint64_t tick, unsigned motor, enum rkm04_event what, uint32_t value)
{
    const struct rkm04_device *device = context;
    device->outer->event(device->context, tick, motor, (enum device_event)what, value);
}

static int on_flash_read(void *context, unsigned block, unsigned offset, void *data, unsigned length)
{
    const struct rkm04_device *device = context;
    return device->outer->flash_read(device->context, block, offset, data, length);
}

static int on_flash_erase(void *context, unsigned block)
{
    const struct rkm04_device *device = context;
    return device->outer->flash_erase(device->context, block);
}

static int on_flash_program(void *context, unsigned block, unsigned offset, const void *data, unsigned length)
{
    const struct rkm04_device *device = context;
    return device->outer->flash_program(device->context, block, offset, data, length);
}

static void connect_port(struct rkm04_device *device, const struct device_port *port, void *context)
{
    device->outer = port;
    device->context = context;
    device->port = (struct rkm04_port){
        .steps = port->steps ? on_steps : NULL,
        .direction = port->direction ? on_direction : NULL,
        .outputs = port->outputs ? on_outputs : NULL,
        .event = port->event ? on_event : NULL,
        .flash_read = port->flash_read ? on_flash_read : NULL,
        .flash_erase = port->flash_erase ? on_flash_erase : NULL,
        .flash_program = port->flash_program ? on_flash_program : NULL,
    };
}

static void begin(struct device_unit *unit, const struct device_config *config, const struct device_port *port, void *context)
{
    const struct rkm04_config settings = rkm04_settings(config);
    connect_port(device_of(unit), port, context);
    rkm04_init(rkm04_of(unit), &settings, &device_of(unit)->port, unit);
}

static void attach(struct device_unit *unit, const struct device_config *config, const struct device_port *port, void *context)
{
    const struct rkm04_config settings = rkm04_settings(config);
    struct rkm04_unit *core = rkm04_of(unit);
    connect_port(device_of(unit), port, context);
    core->config.framing = settings.framing;
    core->config.version_text = settings.version_text;
    core->port = &device_of(unit)->port;
    core->context = unit;
}

/* ---- Time and bytes ------------------------------------------------------------------------------------------------- */

static uint64_t now(const struct device_unit *unit)
{
    return rkm04_now(core_of(unit));
}

static void advance(struct device_unit *unit, uint64_t us)
{
    rkm04_advance(rkm04_of(unit), us);
}

static uint64_t next_event(const struct device_unit *unit)
{
    return rkm04_next_event(core_of(unit));
}

static uint64_t next_report(const struct device_unit *unit)
{
    return rkm04_next_report(core_of(unit));
}

static size_t receive(struct device_unit *unit, const uint8_t *bytes, size_t length)
{
    return rkm04_receive(rkm04_of(unit), bytes, length);
}

static size_t send(struct device_unit *unit, uint8_t *bytes, size_t room)
{
    return rkm04_send(rkm04_of(unit), bytes, room);
}

static bool has_answer(const struct device_unit *unit)
{
    return core_of(unit)->answer.kind != 0;
}

/* Until the flash is written and the unit can send again: after the last slot of the store (reading `store-time`). */
static uint64_t answer_wait(const struct device_unit *unit)
{
    const struct rkm04_unit *core = core_of(unit);
    uint64_t slot = (core->now + RKM04_SLOT_TICKS - 1) / RKM04_SLOT_TICKS * RKM04_SLOT_TICKS;
    return core->busy == 0 ? 0 : slot - core->now + (core->busy - 1u) * (uint64_t)RKM04_SLOT_TICKS + 1;
}

static struct device_counters counters_of(const struct device_unit *unit)
{
    const struct rkm04_counters counters = rkm04_counters(core_of(unit));
    return (struct device_counters){
        .requests = counters.requests,
        .answers = counters.answers,
        .others = counters.others,
        .dropped = counters.dropped,
    };
}

#define ESCAPE 0x7d
#define FLAG 0x7e

static bool has_check_value(const struct device_config *config)
{
    return rkm04_settings_framing(config)->link == &rkm04_hdlc;
}

/* In the low byte of the check value, or in what is sent in its place. The answer is the one that a copy of the unit sends. */
static void find_check_value(const struct device_unit *unit, uint32_t *at, uint8_t *mask)
{
    static const struct rkm04_port nothing;
    struct rkm04_unit copy = *core_of(unit);
    uint8_t last[8] = {0}; /* bytes, the last one first */
    uint32_t sent = rkm04_counters(&copy).answers, length = 0;
    copy.port = &nothing;
    while (rkm04_counters(&copy).answers == sent && rkm04_send(&copy, &last[0], 1) == 1) {
        length++;
        for (unsigned i = sizeof last - 1u; i > 0; i--)
            last[i] = last[i - 1u];
    }
    /* last[1] is the closing flag, the high byte before it may take two. */
    unsigned low = last[3] == ESCAPE ? 4 : 3;
    bool escaped = last[low + 1u] == ESCAPE;
    uint8_t other = last[low] ^ 1u;
    *at = length - low;
    *mask = escaped ? ESCAPE ^ FLAG : other == ESCAPE || other == FLAG ? 4 : 1;
}

static size_t exchange(struct device_unit *unit, const uint8_t *message, size_t length, uint8_t *answer, size_t room)
{
    return rkm04_exchange(rkm04_of(unit), message, length, answer, room);
}

/* ---- State ---------------------------------------------------------------------------------------------------------- */

static void set_inputs(struct device_unit *unit, uint32_t mask)
{
    rkm04_set_inputs(rkm04_of(unit), (uint8_t)mask);
}

static uint32_t inputs(const struct device_unit *unit)
{
    return rkm04_inputs(core_of(unit));
}

static uint32_t outputs(const struct device_unit *unit)
{
    return rkm04_outputs(core_of(unit));
}

static uint32_t variables_of(const struct device_unit *unit)
{
    return rkm04_variables(core_of(unit));
}

static unsigned node(const struct device_unit *unit)
{
    return core_of(unit)->config.node;
}

static void axis(const struct device_unit *unit, unsigned motor, struct device_axis *axis)
{
    struct rkm04_motor_state state;
    rkm04_motor_state(core_of(unit), motor, &state);
    *axis = (struct device_axis){
        .position = state.position,
        .steps = state.steps,
        .speed = state.speed,
        .index = state.index,
        .commands = state.commands,
        .state = (uint8_t)state.state,
        .fault = (uint8_t)state.fault,
        .led = (uint8_t)state.led,
        .blink_from = core_of(unit)->motor[motor - 1].blink_from,
        .lit = state.lit,
        .idle = state.state == RKM04_IDLE || state.state == RKM04_ENDED,
        .running = state.state == RKM04_READY || state.state == RKM04_MOVING || state.state == RKM04_DWELL,
        .moving = state.state == RKM04_MOVING,
        .stopping = state.stopping,
        .forward = state.forward,
        .slot = (enum device_slot)state.slot,
    };
}

static size_t plan(const struct device_unit *unit, unsigned motor, struct device_plan_point *point, size_t room)
{
    const struct rkm04_unit *core = core_of(unit);
    return motion_plan(&core->motor[motor - 1u].motion, core->now, core->motor[motor - 1u].position, point, room);
}

static size_t command_text(const struct device_unit *unit, unsigned motor, char text[DEVICE_COMMAND_SIZE])
{
    struct rkm04_motor_state state;
    rkm04_motor_state(core_of(unit), motor, &state);
    return state.index == 0 ? 0 : rkm04_format(core_of(unit)->motor[motor - 1].command, text);
}

static int set_text(struct device_unit *unit, unsigned motor, const char *text, size_t length, char error[DEVICE_ERROR_SIZE])
{
    static const char *const flags[] = {"", "a bad value", "an unknown command", "the memory is full"};
    int flag = rkm04_set_command(rkm04_of(unit), (char)('0' + motor), text, length, NULL);
    snprintf(error, DEVICE_ERROR_SIZE, "%s", flag >= 0 && flag <= 3 ? flags[flag] : "refused");
    return flag;
}

static bool is_refused(const char *text, size_t length, const struct rkm04_readings *readings)
{
    bool negative = false;
    struct rkm04_reader reader;
    struct rkm04_command command;
    enum rkm04_read found;
    rkm04_read_begin(&reader, text, length);
    do {
        found = rkm04_read(&reader, &command);
        negative = negative || (found == RKM04_READ_COMMAND && command.op == '=' && command.argument > INT32_MAX);
    } while (found == RKM04_READ_COMMAND);
    return found != RKM04_READ_END || (negative && readings->negative_position == RKM04_NEGATIVE_POSITION_NO);
}

static bool check_text(const struct device_config *config, const char *name, const char *text, size_t length, FILE *out)
{
    const struct rkm04_config settings = rkm04_settings(config);
    if (out)
        return diagnose_text(name, text, length, out) > 0 || diagnose_readings(name, text, length, &settings.readings, out) > 0;
    return is_refused(text, length, &settings.readings);
}

static bool is_stuck(const struct device_unit *unit, unsigned motor, char text[DEVICE_ERROR_SIZE])
{
    static const char *const reasons[] = {
        [RKM04_FAULT_NO_LABEL] = "a jump or call to a label that is not in memory",
        [RKM04_FAULT_LOOP_LEVELS] = "more than 8 nested loops",
        [RKM04_FAULT_NO_LOOP] = "E without a loop",
        [RKM04_FAULT_CALL_LEVELS] = "more than 6 nested calls",
        [RKM04_FAULT_NO_CALL] = ". without a call",
        [RKM04_FAULT_OVERWRITTEN] = "the start of the loop or the place to return to has been overwritten",
        [RKM04_FAULT_MOTION] = "the compound motion cannot be computed: more than ten segments, two directions, or a segment "
                               "without steps",
    };
    struct rkm04_motor_state state;
    rkm04_motor_state(core_of(unit), motor, &state);
    unsigned label = rkm04_awaited_label(&core_of(unit)->motor[motor - 1]);
    if (label != 0)
        snprintf(text, DEVICE_ERROR_SIZE, "command %u waits for label %u, which is not in memory", (unsigned)state.index, label);
    else if (state.fault != RKM04_FAULT_NONE)
        snprintf(text, DEVICE_ERROR_SIZE, "fault at command %u: %s", (unsigned)state.index, reasons[state.fault]);
    return label != 0 || state.fault != RKM04_FAULT_NONE;
}

static const char *state_name(unsigned state)
{
    return state <= RKM04_FAULTY ? rkm04_state_name((enum rkm04_state)state) : NULL;
}

static const char *fault_name(unsigned fault)
{
    return fault <= RKM04_FAULT_MOTION ? rkm04_fault_name((enum rkm04_fault)fault) : NULL;
}

static const char *led_name(unsigned led)
{
    return led <= RKM04_LED_BLINK ? rkm04_led_name((enum rkm04_led)led) : NULL;
}

static uint64_t find_repeat(void *memory, const struct device_unit *unit)
{
    return rkm04_repeat_check(memory, core_of(unit));
}

static bool is_endless(const struct device_unit *unit, unsigned motor, char text[DEVICE_ERROR_SIZE])
{
    const struct rkm04_motion *motion = &core_of(unit)->motor[motor - 1].motion;
    if (motion->kind == RKM04_MOTION_ENDLESS)
        snprintf(text, DEVICE_ERROR_SIZE, "is in an endless motion");
    else if (motion->kind == RKM04_MOTION_LIMIT)
        snprintf(text, DEVICE_ERROR_SIZE, "moves until input %02u is 1, which no stimulus sets", motion->input + 0u);
    return motion->kind == RKM04_MOTION_ENDLESS || motion->kind == RKM04_MOTION_LIMIT;
}

static json_t *state(const struct device_unit *unit, uint64_t t_us)
{
    return rkm04_json_state(core_of(unit), t_us);
}

static json_t *describe(const struct device_unit *unit, uint64_t t_us)
{
    return rkm04_json_describe(core_of(unit), t_us);
}

static json_t *program_of(const struct device_unit *unit, unsigned motor)
{
    return rkm04_json_program(core_of(unit), motor);
}

const struct device_kind rkm04_device = {
    .name = "rkm04",
    .description = DESCRIPTION,
    .size = sizeof(struct rkm04_device),
    .axes = RKM04_MOTORS,
    .inputs = RKM04_INPUTS,
    .outputs = RKM04_OUTPUTS,
    .variables = RKM04_VARIABLES,
    .first_variable = RKM04_FIRST_VARIABLE,
    .addresses = RKM04_NODE_MAX,
    .address_note = ", as set with switch S1",
    .ticks_per_us = 1,
    .slot = RKM04_SLOT_TICKS,
    .pulse = RKM04_PULSE_TICKS,
    .program = RKM04_PROGRAM_MAX,
    .flash_blocks = RKM04_FLASH_BLOCKS,
    .flash_block_size = RKM04_FLASH_BLOCK_SIZE,
    .program_message = &rkm04_program_message,
    .request_max = RKM04_MESSAGE_MAX,
    .answer_max = ANSWER_MAX,
    .begin = begin,
    .attach = attach,
    .now = now,
    .advance = advance,
    .next_event = next_event,
    .next_report = next_report,
    .receive = receive,
    .send = send,
    .has_answer = has_answer,
    .answer_wait = answer_wait,
    .counters = counters_of,
    .has_check_value = has_check_value,
    .find_check_value = find_check_value,
    .exchange = exchange,
    .set_inputs = set_inputs,
    .inputs_of = inputs,
    .outputs_of = outputs,
    .variables_of = variables_of,
    .node = node,
    .axis = axis,
    .plan = plan,
    .command_text = command_text,
    .program_of = program_of,
    .set_text = set_text,
    .check_text = check_text,
    .is_stuck = is_stuck,
    .state_name = state_name,
    .fault_name = fault_name,
    .led_name = led_name,
    .state = state,
    .describe = describe,
    .options = rkm04_options,
    .readings = &rkm04_device_readings,
    .settings = rkm04_setting_names,
    .put_settings = rkm04_put_settings,
    .read_setting = rkm04_read_setting,
    .unlike = rkm04_settings_difference,
    .framing = rkm04_settings_framing,
    .words = &rkm04_device_words,
    .repeat_size = sizeof(struct rkm04_repeat),
    .find_repeat = find_repeat,
    .is_endless = is_endless,
    .coverage = &rkm04_coverage,
};
