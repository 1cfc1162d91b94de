/* SPDX-License-Identifier: MIT */
/* The CIB module C-OS-0808M as a kind of device. Inputs 1-8 are DI1-DI8, 9-16 the push buttons of DO1-DO8; outputs 1-8 are what
 * is on or + of DO1-DO8, 9-16 what is -; variables 1-6 the bits of drive A's MCSTAT, 7-12 those of drive B's. */
#include "cib_device.h"

#include <stdio.h>

#include "motion_plan.h"
#include "text/text.h"

#define BUTTONS_SHIFT 8u /* of the mask of inputs */
#define STATUS_BITS 6u   /* of MCSTAT */
#define PULSE 50u        /* us: half of the shortest distance */

/* ---- Port --------------------------------------------------------------------------------------------------------------- */

static void on_steps(void *context, unsigned axis, const uint64_t *tick, size_t count, int32_t position, bool forward)
{
    const struct cib_device *device = context;
    device->outer->steps(device->context, axis, tick, count, position, forward);
}

static void on_direction(void *context, uint64_t tick, unsigned axis, bool forward)
{
    const struct cib_device *device = context;
    device->outer->direction(device->context, tick, axis, forward);
}

static void on_outputs(void *context, uint64_t tick, uint16_t driven)
{
    const struct cib_device *device = context;
    device->outer->outputs(device->context, tick, driven);
}

static uint32_t variables_of(const struct device_unit *unit)
{
    uint32_t all = 0;
    for (unsigned drive = 0; drive < CIB_DRIVES; drive++) {
        struct cib_drive_state state;
        cib_drive_state(&cib_device_read(unit)->unit, drive, &state);
        all |= (uint32_t)(state.status & ((1u << STATUS_BITS) - 1u)) << drive * STATUS_BITS;
    }
    return all;
}

static void report(const struct cib_device *device, uint64_t tick, unsigned axis, enum device_event what, uint32_t value)
{
    device->outer->event(device->context, tick, axis, what, value);
}

/* A command that is taken clears the fault of the one before. */
static void report_command(struct cib_device *device, uint64_t tick, unsigned axis, uint32_t number, uint32_t error)
{
    uint8_t *fault = &device->fault[axis - 1u];
    if (*fault != error)
        report(device, tick, axis, DEVICE_EVENT_FAULT, error);
    *fault = (uint8_t)error;
    if (error == 0)
        report(device, tick, axis, DEVICE_EVENT_COMMAND, number);
}

static void report_status(struct cib_device *device, uint64_t tick, unsigned axis, uint32_t status)
{
    unsigned shift = (axis - 1u) * STATUS_BITS;
    uint32_t mask = ((1u << STATUS_BITS) - 1u) << shift;
    device->status = (uint16_t)((device->status & ~mask) | (status << shift & mask));
    report(device, tick, 0, DEVICE_EVENT_VARIABLE, device->status);
}

static void on_event(void *context, uint64_t tick, unsigned axis, enum cib_event what, uint32_t value)
{
    struct cib_device *device = context;
    switch (what) {
    case CIB_EVENT_STATUS:
        report_status(device, tick, axis, value);
        break;
    case CIB_EVENT_MOTION:
        report(device, tick, axis, DEVICE_EVENT_MOTION, value);
        break;
    case CIB_EVENT_TAKEN:
        report_command(device, tick, axis, value, 0);
        break;
    case CIB_EVENT_REFUSED:
        report_command(device, tick, axis, 0, value);
        break;
    case CIB_EVENT_POSITION:
        report(device, tick, axis, DEVICE_EVENT_POSITION, value);
        break;
    case CIB_EVENT_DUTY:
        report(device, tick, axis, DEVICE_EVENT_VALUE, value);
        break;
    default: /* not seen from outside */
        break;
    }
}

/* Edges of PWM are wanted by those who want pulses. */
static void connect_port(struct cib_device *device, const struct device_port *port, void *context)
{
    device->outer = port;
    device->context = context;
    device->port = (struct cib_port){
        .steps = port->steps ? on_steps : NULL,
        .direction = port->direction ? on_direction : NULL,
        .outputs = port->outputs ? on_outputs : NULL,
        .edges = port->outputs && port->steps ? on_outputs : NULL,
        .event = port->event ? on_event : NULL,
    };
}

static void begin(struct device_unit *unit, const struct device_config *config, const struct device_port *port, void *context)
{
    const struct cib_settings settings = cib_settings_of(config);
    struct cib_device *device = cib_device_of(unit);
    *device = (struct cib_device){.rtu = {.address = config->node, .silence = settings.silence}};
    connect_port(device, port, context);
    cib_begin(&device->unit, &settings.config, &device->port, device);
    device->status = (uint16_t)variables_of(unit);
}

static void attach(struct device_unit *unit, const struct device_config *config, const struct device_port *port, void *context)
{
    struct cib_device *device = cib_device_of(unit);
    (void)config;
    connect_port(device, port, context);
    cib_attach(&device->unit, &device->port, device);
}

/* ---- Time and bytes ----------------------------------------------------------------------------------------------------- */

static uint64_t now(const struct device_unit *unit)
{
    return cib_now(&cib_device_read(unit)->unit);
}

/* Silence is over before anything else happens in its tick. */
static void advance(struct device_unit *unit, uint64_t us)
{
    struct cib_device *device = cib_device_of(unit);
    uint64_t end = cib_now(&device->unit) + us;
    for (;;) {
        uint64_t at = cib_now(&device->unit), due = cib_rtu_due(&device->rtu);
        if (due >= end) {
            cib_advance(&device->unit, end - at);
            return;
        }
        cib_advance(&device->unit, due > at ? due - at : 0);
        cib_rtu_check_silence(&device->rtu, &device->unit);
    }
}

static uint64_t earlier(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

static uint64_t next_event(const struct device_unit *unit)
{
    const struct cib_device *device = cib_device_read(unit);
    uint64_t due = cib_rtu_due(&device->rtu), at = cib_now(&device->unit);
    return earlier(cib_next_event(&device->unit), due > at ? due : at);
}

static uint64_t next_report(const struct device_unit *unit)
{
    const struct cib_device *device = cib_device_read(unit);
    uint64_t due = cib_rtu_due(&device->rtu), at = cib_now(&device->unit);
    return earlier(cib_next_report(&device->unit), due > at ? due : at);
}

static size_t receive(struct device_unit *unit, const uint8_t *bytes, size_t length)
{
    struct cib_device *device = cib_device_of(unit);
    cib_rtu_check_silence(&device->rtu, &device->unit);
    for (size_t i = 0; i < length; i++)
        if (!cib_rtu_receive(&device->rtu, &device->unit, bytes[i]))
            return i;
    return length;
}

static size_t send(struct device_unit *unit, uint8_t *bytes, size_t room)
{
    struct cib_device *device = cib_device_of(unit);
    size_t length = 0;
    while (length < room && cib_rtu_send(&device->rtu, &device->unit, &bytes[length]))
        length++;
    return length;
}

static uint64_t silence_end(const struct device_unit *unit)
{
    return cib_rtu_due(&cib_device_read(unit)->rtu);
}

static bool has_answer(const struct device_unit *unit)
{
    return cib_device_read(unit)->rtu.answer_length > 0;
}

static uint64_t answer_wait(const struct device_unit *unit)
{
    (void)unit;
    return 0;
}

static struct device_counters counters_of(const struct device_unit *unit)
{
    const struct cib_rtu_counters *counters = &cib_device_read(unit)->rtu.counters;
    return (struct device_counters){.requests = counters->requests,
                                    .answers = counters->answers,
                                    .others = counters->others,
                                    .dropped = counters->dropped};
}

static bool has_check_value(const struct device_config *config)
{
    (void)config;
    return true;
}

static void find_check_value(const struct device_unit *unit, uint32_t *at, uint8_t *mask)
{
    *at = cib_device_read(unit)->rtu.answer_length - 2u;
    *mask = 1;
}

/* Function and data, without address and check value. */
static size_t exchange(struct device_unit *unit, const uint8_t *message, size_t length, uint8_t *answer, size_t room)
{
    struct cib_device *device = cib_device_of(unit);
    uint8_t whole[MODBUS_PDU_MAX];
    if (length < 1 || length > MODBUS_PDU_MAX)
        return 0;
    cib_note_request(&device->unit);
    size_t answered = cib_modbus(&device->unit, message, length, whole);
    for (size_t i = 0; i < answered && i < room; i++)
        answer[i] = whole[i];
    return answered;
}

static const struct device_framing *framing(const struct device_config *config)
{
    (void)config;
    return &cib_framing;
}

/* ---- State -------------------------------------------------------------------------------------------------------------- */

static void set_inputs(struct device_unit *unit, uint32_t mask)
{
    cib_set_inputs(&cib_device_of(unit)->unit, (uint8_t)(mask & 0xffu));
    cib_set_buttons(&cib_device_of(unit)->unit, (uint8_t)(mask >> BUTTONS_SHIFT & 0xffu));
}

static uint32_t inputs_of(const struct device_unit *unit)
{
    const struct cib_unit *core = &cib_device_read(unit)->unit;
    return cib_inputs(core) | (uint32_t)core->buttons << BUTTONS_SHIFT;
}

/* BT4: coil a is DO1 - DO3, b is DO2 - DO4 with 1 or + = 1. A rotor at rest is where the last row would have left it (BT3). */
static bool coils(const struct device_unit *unit, unsigned axis, struct device_coils *driven)
{
    const struct cib_unit *core = &cib_device_read(unit)->unit;
    const uint8_t first = (uint8_t)(4u * (axis - 1u) + 1u);
    if (!cib_has_drive(core, axis - 1u))
        return false;
    const unsigned table = core->setup.drive[axis - 1u].mode & ~1u; /* unipolar and bipolar alike */
    *driven = (struct device_coils){
        .output = {first, (uint8_t)(first + 1u), (uint8_t)(first + 2u), (uint8_t)(first + 3u)},
        .eighths = table == 32u ? 1 : 2,
        .rest = table == 16u ? 8 : 9,
    };
    return true;
}

static uint32_t outputs_of(const struct device_unit *unit)
{
    return cib_driven(&cib_device_read(unit)->unit);
}

static unsigned node(const struct device_unit *unit)
{
    return cib_device_read(unit)->rtu.address;
}

static const char *state_name(unsigned state)
{
    return cib_state_name(state);
}

static const char *fault_name(unsigned fault)
{
    return fault <= CIB_ERROR_MAX ? cib_error_name((uint16_t)fault) : NULL;
}

static const char *led_name(unsigned led)
{
    static const char *const names[] = {"off", "on"};
    return led < 2 ? names[led] : NULL;
}

static void axis(const struct device_unit *unit, unsigned number, struct device_axis *axis)
{
    struct cib_drive_state state;
    cib_drive_state(&cib_device_read(unit)->unit, number - 1u, &state);
    bool runs = (state.status & CIB_MOVE) != 0 || state.waiting;
    *axis = (struct device_axis){
        .position = state.position,
        .steps = state.moving ? state.steps : 0,
        .speed = (uint32_t)(state.speed < 0 ? -state.speed : state.speed),
        .state = (uint8_t)cib_state_of(&state),
        .fault = (uint8_t)state.error,
        .idle = !runs,
        .running = runs,
        .moving = state.moving,
        .stopping = state.stopping,
        .forward = state.forward,
    };
}

static bool is_stuck(const struct device_unit *unit, unsigned number, char text[DEVICE_ERROR_SIZE])
{
    struct cib_drive_state state;
    cib_drive_state(&cib_device_read(unit)->unit, number - 1u, &state);
    if (state.error != 0)
        snprintf(text, DEVICE_ERROR_SIZE, "the last command was refused: %s", cib_error_name(state.error));
    return state.error != 0;
}

/* Up to a turn, if the drive has to: what follows is planned there. */
static size_t plan(const struct device_unit *unit, unsigned number, struct device_plan_point *point, size_t room)
{
    const struct cib_unit *core = &cib_device_read(unit)->unit;
    const struct cib_drive *drive = &core->drive[number - 1u];
    return motion_plan(&drive->motion, core->now, drive->position, point, room);
}

static bool is_endless(const struct device_unit *unit, unsigned number, char text[DEVICE_ERROR_SIZE])
{
    const struct cib_unit *core = &cib_device_read(unit)->unit;
    struct cib_drive_state state;
    cib_drive_state(core, number - 1u, &state);
    bool is_endless = state.moving && !state.stopping && core->drive[number - 1u].motion.kind == RKM04_MOTION_ENDLESS;
    if (is_endless)
        snprintf(text, DEVICE_ERROR_SIZE, "is in an endless motion");
    return is_endless;
}

/* The duty registers, in 0.01 %. */
static int32_t value(const struct device_unit *unit, unsigned number)
{
    return cib_read(&cib_device_read(unit)->unit, CIB_OUTPUT_ZONE, (uint16_t)number);
}

static const char *const value_names[CIB_OUTPUTS] = {"pwm1", "pwm2", "pwm3", "pwm4", "pwm5", "pwm6", "pwm7", "pwm8"};
static const char *const input_names[] = {"di1", "di2", "di3", "di4", "di5", "di6", "di7", "di8",
                                          "button1", "button2", "button3", "button4", "button5", "button6", "button7", "button8"};
static const char *const output_names[] = {"do1", "do2", "do3", "do4", "do5", "do6", "do7", "do8",
                                           "do1-", "do2-", "do3-", "do4-", "do5-", "do6-", "do7-", "do8-"};

const struct device_kind cib_device = {
    .name = "cib",
    .description = "module of 8 inputs and 8 outputs for two stepper motors, PWM or plain outputs (Teco C-OS-0808M)",
    .size = sizeof(struct cib_device),
    .axes = CIB_DRIVES,
    .inputs = 2 * CIB_INPUTS,
    .outputs = 2 * CIB_OUTPUTS,
    .input_names = input_names,
    .output_names = output_names,
    .values = CIB_OUTPUTS,
    .value_names = value_names,
    .value = value,
    .variables = CIB_DRIVES * STATUS_BITS,
    .first_variable = 1,
    .addresses = MODBUS_ADDRESS_MAX,
    .ticks_per_us = 1,
    .slot = CIB_SLOT_TICKS,
    .pulse = PULSE,
    .turnaround = CIB_TURNAROUND,
    .coils = coils,
    .deaf_to_answers = true,
    .request_max = MODBUS_FRAME_MAX,
    .answer_max = MODBUS_FRAME_MAX,
    .begin = begin,
    .attach = attach,
    .now = now,
    .advance = advance,
    .next_event = next_event,
    .next_report = next_report,
    .receive = receive,
    .send = send,
    .silence_end = silence_end,
    .has_answer = has_answer,
    .answer_wait = answer_wait,
    .counters = counters_of,
    .has_check_value = has_check_value,
    .find_check_value = find_check_value,
    .exchange = exchange,
    .set_inputs = set_inputs,
    .inputs_of = inputs_of,
    .outputs_of = outputs_of,
    .variables_of = variables_of,
    .node = node,
    .axis = axis,
    .plan = plan,
    .is_stuck = is_stuck,
    .state_name = state_name,
    .fault_name = fault_name,
    .led_name = led_name,
    .state = cib_json_state,
    .describe = cib_json_describe,
    .options = cib_options,
    .methods = cib_methods,
    .services = cib_services,
    .settings = cib_setting_names,
    .put_settings = cib_put_settings,
    .read_setting = cib_read_setting,
    .unlike = cib_settings_difference,
    .framing = framing,
    .words = &cib_words,
    .is_endless = is_endless,
};
