/* SPDX-License-Identifier: MIT */
/* The PMC-1HS and PMC-2HS as kinds of device. */
#include "pmc_device.h"

#include <stdio.h>
#include <string.h>

#include "text/text.h"

static struct pmc_device *device_of(struct device_unit *unit)
{
    return (struct pmc_device *)unit;
}

struct pmc_unit *pmc_of(struct device_unit *unit)
{
    return &device_of(unit)->unit;
}

const struct pmc_unit *pmc_in(const struct device_unit *unit)
{
    return &((const struct pmc_device *)unit)->unit;
}

/* ---- Port ----------------------------------------------------------------------------------------------------------- */

_Static_assert((int)DEVICE_EVENT_MOTION == (int)PMC_EVENT_MOTION && (int)DEVICE_EVENT_COMMAND == (int)PMC_EVENT_COMMAND,
               "motions and commands have the same numbers here and there");

static void on_steps(void *context, unsigned axis, const uint64_t *tick, size_t count, int32_t position, bool forward)
{
    const struct pmc_device *device = context;
    device->outer->steps(device->context, axis + 1u, tick, count, position, forward);
}

static void on_direction(void *context, uint64_t tick, unsigned axis, bool forward)
{
    const struct pmc_device *device = context;
    device->outer->direction(device->context, tick, axis + 1u, forward);
}

static void on_outputs(void *context, uint64_t tick, uint8_t mask)
{
    const struct pmc_device *device = context;
    device->outer->outputs(device->context, tick, mask);
}

static void on_event(void *context, uint64_t tick, unsigned axis, enum pmc_event what, uint32_t value)
{
    const struct pmc_device *device = context;
    enum device_event seen = (enum device_event)what;
    if (what == PMC_EVENT_ERRORS) {
        seen = DEVICE_EVENT_FAULT;
        value = pmc_fault_of((uint8_t)value);
    } else if (what == PMC_EVENT_POSITION) {
        seen = DEVICE_EVENT_POSITION;
    }
    device->outer->event(device->context, tick, axis + 1u, seen, value);
}

static int on_flash_read(void *context, unsigned block, unsigned offset, void *data, unsigned length)
{
    const struct pmc_device *device = context;
    return device->outer->flash_read(device->context, block, offset, data, length);
}

static int on_flash_erase(void *context, unsigned block)
{
    const struct pmc_device *device = context;
    return device->outer->flash_erase(device->context, block);
}

static int on_flash_program(void *context, unsigned block, unsigned offset, const void *data, unsigned length)
{
    const struct pmc_device *device = context;
    return device->outer->flash_program(device->context, block, offset, data, length);
}

static void connect_flash(struct pmc_device *device, const struct device_port *port, void *context)
{
    device->outer = port;
    device->context = context;
    device->port = (struct pmc_port){
        .flash_read = port->flash_read ? on_flash_read : NULL,
        .flash_erase = port->flash_erase ? on_flash_erase : NULL,
        .flash_program = port->flash_program ? on_flash_program : NULL,
    };
}

static void connect_port(struct pmc_device *device, const struct device_port *port, void *context)
{
    connect_flash(device, port, context);
    device->port.steps = port->steps ? on_steps : NULL;
    device->port.direction = port->direction ? on_direction : NULL;
    device->port.outputs = port->outputs ? on_outputs : NULL;
    device->port.event = port->event ? on_event : NULL;
}

/* Files of the command line, which have been checked, are in the flash before the first power-up (AP6). */
static void store_files(struct pmc_device *device, const struct pmc_config *config, const struct pmc_own *own)
{
    char error[DEVICE_ERROR_SIZE];
    struct pmc_unit *unit = &device->unit;
    if (!own->program && !own->parameters)
        return;
    pmc_init(unit, config, &device->port, device);
    if (own->parameters)
        (void)pmc_file_load(unit, PMC_FILE_PARAMETERS, own->parameters, strlen(own->parameters), error);
    if (own->program)
        (void)pmc_file_load(unit, PMC_FILE_PROGRAM, own->program, strlen(own->program), error);
    for (unsigned axis = 0; axis < config->axes; axis++)
        (void)pmc_store(unit, axis);
}

static void begin(struct device_unit *unit, const struct device_config *config, const struct device_port *port, void *context,
                  unsigned axes)
{
    struct pmc_device *device = device_of(unit);
    const struct pmc_config settings = pmc_config_of(config, axes);
    const struct pmc_own own = pmc_own_of(config);
    bool is_first = device->outer == NULL;
    connect_flash(device, port, context);
    if (is_first)
        store_files(device, &settings, &own);
    connect_port(device, port, context);
    pmc_init(&device->unit, &settings, &device->port, device);
}

static void begin_1hs(struct device_unit *unit, const struct device_config *config, const struct device_port *port, void *context)
{
    begin(unit, config, port, context, 1);
}

static void begin_2hs(struct device_unit *unit, const struct device_config *config, const struct device_port *port, void *context)
{
    begin(unit, config, port, context, 2);
}

static void attach(struct device_unit *unit, const struct device_config *config, const struct device_port *port, void *context)
{
    (void)config; /* what a unit has of it is in the unit */
    connect_port(device_of(unit), port, context);
    pmc_of(unit)->port = &device_of(unit)->port;
    pmc_of(unit)->context = device_of(unit);
}

/* ---- Time and bytes ------------------------------------------------------------------------------------------------- */

/* The us in which a tick lies. */
static uint64_t us_of(uint64_t tick)
{
    return tick == PMC_NEVER ? DEVICE_NEVER : tick / PMC_TICKS_PER_US;
}

static uint64_t now(const struct device_unit *unit)
{
    return pmc_now(pmc_in(unit)) / PMC_TICKS_PER_US;
}

static void advance(struct device_unit *unit, uint64_t us)
{
    pmc_advance(pmc_of(unit), us * PMC_TICKS_PER_US);
}

static uint64_t next_event(const struct device_unit *unit)
{
    return us_of(pmc_next_event(pmc_in(unit)));
}

static uint64_t next_report(const struct device_unit *unit)
{
    return us_of(pmc_next_report(pmc_in(unit)));
}

static unsigned pulse_ticks(const struct device_unit *unit, unsigned axis)
{
    return pmc_pulse_ticks(pmc_in(unit), axis - 1u);
}

static size_t receive(struct device_unit *unit, const uint8_t *bytes, size_t length)
{
    return pmc_in(unit)->config.face->receive(pmc_of(unit), bytes, length);
}

static size_t send(struct device_unit *unit, uint8_t *bytes, size_t room)
{
    return pmc_in(unit)->config.face->send(pmc_of(unit), bytes, room);
}

static void lose_byte(struct device_unit *unit)
{
    pmc_lose_byte(pmc_of(unit));
}

/* AS1; frames of Modbus are those of one pair of wires (AB1). */
static bool is_full_duplex(const struct device_config *config)
{
    return !pmc_own_of(config).is_modbus;
}

static uint64_t silence_end(const struct device_unit *unit)
{
    const struct pmc_face *face = pmc_in(unit)->config.face;
    return face->due ? us_of(face->due(pmc_in(unit))) : DEVICE_NEVER;
}

static bool has_answer(const struct device_unit *unit)
{
    return pmc_in(unit)->face.reply.length > 0;
}

static uint64_t answer_wait(const struct device_unit *unit)
{
    const struct pmc_unit *core = pmc_in(unit);
    uint64_t from = core->face.reply.from, tick = pmc_now(core);
    return from > tick ? (from - tick + PMC_TICKS_PER_US - 1u) / PMC_TICKS_PER_US : 0;
}

static struct device_counters counters_of(const struct device_unit *unit)
{
    const struct pmc_counters *counters = &pmc_in(unit)->face.reply.counters;
    return (struct device_counters){.requests = counters->requests,
                                    .answers = counters->answers,
                                    .others = counters->others,
                                    .dropped = counters->dropped};
}

static bool has_check_value(const struct device_config *config)
{
    return pmc_own_of(config).is_modbus;
}

/* The low byte of the CRC. */
static void find_check_value(const struct device_unit *unit, uint32_t *at, uint8_t *mask)
{
    *at = pmc_in(unit)->face.reply.length - 2u;
    *mask = 1;
}

static size_t exchange(struct device_unit *unit, const uint8_t *message, size_t length, uint8_t *answer, size_t room)
{
    return pmc_exchange(pmc_of(unit), message, length, answer, room);
}

/* ---- State ---------------------------------------------------------------------------------------------------------- */

static void set_inputs(struct device_unit *unit, uint32_t mask)
{
    pmc_set_inputs(pmc_of(unit), (uint16_t)mask);
}

static uint32_t inputs_of(const struct device_unit *unit)
{
    return pmc_inputs(pmc_in(unit));
}

static uint32_t outputs_of(const struct device_unit *unit)
{
    return pmc_outputs(pmc_in(unit));
}

static uint32_t variables_of(const struct device_unit *unit)
{
    (void)unit;
    return 0;
}

static unsigned node(const struct device_unit *unit)
{
    return pmc_in(unit)->config.address;
}

/* Registers that are not NOP. */
static uint16_t count_commands(const struct pmc_axis *axis)
{
    uint16_t count = 0;
    for (unsigned reg = 0; reg < PMC_REGISTERS; reg++)
        count = (uint16_t)(count + (axis->program[reg].op != PMC_NOP));
    return count;
}

static void axis(const struct device_unit *unit, unsigned number, struct device_axis *axis)
{
    struct pmc_axis_state state;
    pmc_axis_state(pmc_in(unit), number - 1u, &state);
    *axis = (struct device_axis){
        .position = state.commanded,
        .steps = state.made,
        .speed = state.speed,
        .index = (uint16_t)(state.reg + 1),
        .commands = count_commands(&pmc_in(unit)->axis[number - 1u]),
        .state = (uint8_t)state.state,
        .fault = (uint8_t)pmc_fault_of(state.errors),
        .led = DEVICE_LED_OFF,
        .idle = !pmc_is_busy(pmc_in(unit), number - 1u),
        .running = state.state != PMC_IDLE || pmc_is_busy(pmc_in(unit), number - 1u),
        .moving = state.moving,
        .stopping = state.stopping,
        .forward = state.forward,
    };
}

static size_t command_text(const struct device_unit *unit, unsigned number, char text[DEVICE_COMMAND_SIZE])
{
    struct pmc_axis_state state;
    pmc_axis_state(pmc_in(unit), number - 1u, &state);
    return state.reg < 0 ? 0 : pmc_command_write(&pmc_in(unit)->axis[number - 1u].program[state.reg], text);
}

/* A program: it is loaded, and begins at REG 00 on every axis that has a command. */
static int set_text(struct device_unit *unit, unsigned number, const char *text, size_t length, char error[DEVICE_ERROR_SIZE])
{
    struct pmc_unit *core = pmc_of(unit);
    struct pmc_request run = {.kind = PMC_RUN};
    (void)number; /* the text is for all axes */
    enum pmc_answer answer = pmc_file_load(core, PMC_FILE_PROGRAM, text, length, error);
    for (unsigned at = 0; at < core->config.axes; at++)
        run.axes |= (uint8_t)((count_commands(&core->axis[at]) > 0 ? 1u : 0u) << at);
    if (answer == PMC_OK && run.axes != 0)
        answer = pmc_request(core, &run);
    if (answer == PMC_BUSY)
        snprintf(error, DEVICE_ERROR_SIZE, "an axis is busy");
    return (int)answer;
}

static bool check_text_1hs(const struct device_config *config, const char *name, const char *text, size_t length, FILE *out)
{
    (void)config;
    return pmc_file_is_wrong(PMC_FILE_PROGRAM, 1, name, text, length, out);
}

static bool check_text_2hs(const struct device_config *config, const char *name, const char *text, size_t length, FILE *out)
{
    (void)config;
    return pmc_file_is_wrong(PMC_FILE_PROGRAM, 2, name, text, length, out);
}

static bool is_stuck(const struct device_unit *unit, unsigned number, char text[DEVICE_ERROR_SIZE])
{
    static const char *const reasons[] = {
        "", "the plus software limit", "the minus software limit", "the plus limit switch", "the minus limit switch",
        "emergency stop", "an error in the program", "the home search has failed", "a register that cannot be executed alone"};
    uint8_t errors = pmc_in(unit)->axis[number - 1u].errors;
    if (errors != 0)
        snprintf(text, DEVICE_ERROR_SIZE, "error %s: %s", pmc_fault_name(pmc_fault_of(errors)), reasons[pmc_fault_of(errors)]);
    return errors != 0;
}

static bool is_endless(const struct device_unit *unit, unsigned number, char text[DEVICE_ERROR_SIZE])
{
    struct pmc_axis_state state;
    pmc_axis_state(pmc_in(unit), number - 1u, &state);
    if (state.endless)
        snprintf(text, DEVICE_ERROR_SIZE, "is in a continuous move");
    return state.endless;
}

static const char *led_name(unsigned led)
{
    return led == DEVICE_LED_OFF ? "off" : NULL; /* it has none */
}

static unsigned baud_of(const struct device_config *config)
{
    const struct pmc_own own = pmc_own_of(config);
    return own.baud > 0 ? own.baud : PMC_BAUD;
}

/* ---- Kinds ---------------------------------------------------------------------------------------------------------- */

static const char *const inputs_1hs[] = {"in0", "in1", "near", "home", "z", "lmt+", "lmt-", "emg"};
static const char *const inputs_2hs[] = {"x.in0",  "x.in1", "x.near", "x.home", "x.z",    "x.lmt+", "x.lmt-", "emg",
                                         "y.in0", "y.in1",  "y.near", "y.home", "y.z", "y.lmt+", "y.lmt-"};
static const char *const outputs_1hs[] = {"out0", "out1"};
static const char *const outputs_2hs[] = {"x.out0", "x.out1", "y.out0", "y.out1"};

#define PULSE_US (PMC_PULSE_TICKS / PMC_TICKS_PER_US)
#define SPEED_MAX 4000000u /* AP2 */
#define SLOT_US (PMC_SLOT_TICKS / PMC_TICKS_PER_US)

/* What both kinds have. */
#define PMC_DEVICE \
    .size = sizeof(struct pmc_device), .addresses = PMC_ADDRESS_MAX, .ticks_per_us = PMC_TICKS_PER_US, .slot = SLOT_US, \
    .pulse = PULSE_US, .speed_max = SPEED_MAX, .baud = baud_of, .turnaround = 1, .program = PMC_REGISTERS, \
    .is_program_whole = true, .flash_blocks = PMC_FLASH_BLOCKS, .flash_block_size = PMC_FLASH_BLOCK_SIZE, \
    .request_max = PMC_FRAME_MAX, \
    .answer_max = PMC_FRAME_MAX, .attach = attach, .now = now, .advance = advance, .next_event = next_event, \
    .next_report = next_report, .pulse_ticks = pulse_ticks, .receive = receive, .send = send, .lose_byte = lose_byte, \
    .is_full_duplex = is_full_duplex, .silence_end = silence_end, \
    .has_answer = has_answer, .answer_wait = answer_wait, .counters = counters_of, .has_check_value = has_check_value, \
    .find_check_value = find_check_value, .exchange = exchange, .set_inputs = set_inputs, .inputs_of = inputs_of, \
    .outputs_of = outputs_of, .variables_of = variables_of, .node = node, .axis = axis, .plan = pmc_device_plan, \
    .command_text = command_text, .set_text = set_text, .is_stuck = is_stuck, .state_name = pmc_state_name, \
    .fault_name = pmc_fault_name, .led_name = led_name, .state = pmc_json_state, .describe = pmc_json_describe, \
    .methods = pmc_methods, .services = pmc_services, .settings = pmc_setting_names, .put_settings = pmc_put_settings, \
    .unlike = pmc_settings_difference, .framing = pmc_framing, .words = &pmc_words, \
    .repeat_size = sizeof(struct pmc_repeat), .find_repeat = pmc_find_repeat, .is_endless = is_endless

const struct device_kind pmc_1hs_device = {
    PMC_DEVICE,
    .name = "pmc-1hs",
    .description = "motion controller for one axis (Autonics PMC-1HS)",
    .axes = 1,
    .inputs = 8,
    .outputs = 2,
    .input_names = inputs_1hs,
    .output_names = outputs_1hs,
    .begin = begin_1hs,
    .check_text = check_text_1hs,
    .options = pmc_1hs_options,
    .read_setting = pmc_read_setting_1hs,
};

const struct device_kind pmc_2hs_device = {
    PMC_DEVICE,
    .name = "pmc-2hs",
    .description = "motion controller for two axes (Autonics PMC-2HS)",
    .axes = 2,
    .inputs = 15,
    .outputs = 4,
    .input_names = inputs_2hs,
    .output_names = outputs_2hs,
    .begin = begin_2hs,
    .check_text = check_text_2hs,
    .options = pmc_2hs_options,
    .read_setting = pmc_read_setting_2hs,
};
