/* SPDX-License-Identifier: MIT */
/* The CNC872's CNC system as a kind of device: no bus, axes without step pulses, reached by its methods. T number k is done in
 * the us 1000 k (NT1). */
#include "cnc872_device.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "text/text.h"

struct cnc_device *cnc_of(struct device_unit *unit)
{
    return (struct cnc_device *)unit;
}

const struct cnc_device *cnc_in(const struct device_unit *unit)
{
    return (const struct cnc_device *)unit;
}

/* ---- Reports ------------------------------------------------------------------------------------------------------------ */

int32_t cnc_shown_position(const struct cnc *cnc, unsigned axis)
{
    const int64_t u = cnc_position(cnc, axis, 5);
    return (int32_t)(u / CNC_U_PER_UM - (u % CNC_U_PER_UM < 0));
}

enum cnc_axis_state cnc_axis_state(const struct cnc *cnc, unsigned axis)
{
    if (cnc->axis[axis].reference.state != 0)
        return CNC_AXIS_REFERENCE;
    if (cnc->axis[axis].direction != 0)
        return CNC_AXIS_MANUAL;
    if (!cnc_bit(&cnc->cells, CNC_BIT_PO_OSxPI + axis))
        return CNC_AXIS_IDLE;
    return cnc_bit(&cnc->cells, CNC_BIT_PO_STOP) ? CNC_AXIS_STOPPED : CNC_AXIS_BLOCK;
}

static void report(const struct cnc_device *device, unsigned axis, enum device_event what, uint32_t value)
{
    if (device->outer->event)
        device->outer->event(device->context, device->cnc.turn * CNC_TICKS_PER_T, axis, what, value);
}

/* What the T has done to an axis. */
static void report_axis(struct cnc_device *device, unsigned axis)
{
    const int32_t position = cnc_shown_position(&device->cnc, axis);
    const bool was_moving = ((unsigned)device->moving >> axis & 1u) != 0;
    const bool moves = device->cnc.axis[axis].position != device->last[axis];
    device->last[axis] = device->cnc.axis[axis].position;
    if (moves && !was_moving)
        report(device, axis + 1u, DEVICE_EVENT_MOTION, 1);
    if (position != device->shown[axis])
        report(device, axis + 1u, DEVICE_EVENT_POSITION, (uint32_t)position);
    if (!moves && was_moving)
        report(device, axis + 1u, DEVICE_EVENT_MOTION, 0);
    device->shown[axis] = position;
    const uint16_t bit = (uint16_t)(1u << axis);
    device->moving = (uint16_t)((device->moving | (unsigned)bit) ^ (moves ? 0u : bit));
}

static void report_turn(struct cnc_device *device)
{
    const int64_t critical = cnc_number(&device->cnc.cells, CNC_CELL_BZH13, 0);
    for (unsigned axis = 0; axis < CNC_AXES; axis++)
        if ((device->cnc.config->axes >> axis & 1u) != 0)
            report_axis(device, axis);
    if ((critical != 0) != device->is_critical)
        report(device, 0, DEVICE_EVENT_FAULT, critical != 0);
    device->is_critical = critical != 0;
}

/* Is nothing under way but passes of the PLC program? */
static bool is_at_rest(const struct cnc_device *device)
{
    const struct cnc_machine *machine = &device->cnc.machine;
    const bool is_resting = machine->phase == CNC_IDLE || cnc_bit(&device->cnc.cells, CNC_BIT_PO_STOP);
    return is_resting && device->moving == 0 && machine->start == 0 && machine->annulment == 0 &&
           cnc_bit(&device->cnc.cells, CNC_BIT_INPOS);
}

/* A PLC program may do something in any T; what is asked for from outside ends the quiet (cnc872_methods.c). */
static bool is_quiet(const struct cnc_device *device)
{
    return device->own.text[CNC_TEXT_PLC] == NULL && is_at_rest(device);
}

/* ---- Backup memory (NO3): in the flash of the unit ----------------------------------------------------------------------- */

static int flash_program(void *context, unsigned block, unsigned offset, const void *data, unsigned length)
{
    const struct cnc_device *device = context;
    return device->outer->flash_program(device->context, block, offset, data, length);
}

static int flash_read(void *context, unsigned block, unsigned offset, void *data, unsigned length)
{
    const struct cnc_device *device = context;
    return device->outer->flash_read(device->context, block, offset, data, length);
}

static int flash_erase(void *context, unsigned block)
{
    const struct cnc_device *device = context;
    return device->outer->flash_erase(device->context, block);
}

static struct cnc_flash flash_of(struct cnc_device *device)
{
    return (struct cnc_flash){.read = flash_read, .program = flash_program, .erase = flash_erase, .context = device};
}

static bool has_flash(const struct cnc_device *device)
{
    return device->outer->flash_read && device->outer->flash_program && device->outer->flash_erase;
}

static bool on_save(void *context, const uint8_t *bytes, size_t size)
{
    struct cnc_device *device = context;
    const struct cnc_flash flash = flash_of(device);
    return size == CNC_BACKUP_SIZE && has_flash(device) && cnc_backup_store(&flash, bytes, &device->backup);
}

/* A regular end: what has not been saved is. */
static void end(struct device_unit *unit)
{
    struct cnc_device *device = cnc_of(unit);
    uint8_t stored[CNC_BACKUP_SIZE];
    uint32_t number;
    const struct cnc_flash flash = flash_of(device);
    if (!has_flash(device))
        return;
    (void)cnc_backup_load(&flash, stored, &number);
    if (memcmp(stored, cnc_backup(&device->cnc), sizeof stored) != 0)
        (void)on_save(device, cnc_backup(&device->cnc), sizeof stored);
}

void cnc_note(const struct cnc_device *device, const char *format, ...)
{
    char text[DEVICE_ERROR_SIZE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (device->outer->note)
        device->outer->note(device->context, device->now, 0, text);
}

/* NL2. */
static void on_event(void *context, enum cnc_event event, int64_t value)
{
    static const struct {
        const char *before, *after; /* the value; without `after` there is none */
    } texts[CNC_EVENTS] = {
        [CNC_EVENT_BLOCK] = {"the block of line ", " begins"},
        [CNC_EVENT_BLOCK_END] = {"the block of line ", " has ended"},
        [CNC_EVENT_SHORT_STOPPI] = {"STOPPI was 1 for ", " ms: expected 200 or more"},
        [CNC_EVENT_BEYOND_QUEUE] = {"a PLC program has read BLK[", "], beyond the queue"},
        [CNC_EVENT_PLC_ERROR] = {"PLC_ERROR is ", ""},
        [CNC_EVENT_PLC_DIVISION] = {"division by 0 in line ", " of the PLC program"},
        [CNC_EVENT_PLC_FAULT] = {"the PLC program has halted in line ", ""},
        [CNC_EVENT_CRITICAL] = {"critical error ", ""},
        [CNC_EVENT_BLOCK_REFUSED] = {"the block of line ", " is refused: S is outside of the limits of the gear"},
        [CNC_EVENT_SAVED] = {"the backup memory is saved", NULL},
        [CNC_EVENT_NOT_SAVED] = {"the backup memory cannot be saved", NULL},
    };
    struct cnc_device *device = context;
    if (event == CNC_EVENT_BLOCK)
        device->refused = CNC_OK;
    else if (event == CNC_EVENT_BLOCK_REFUSED)
        device->refused = CNC_RESULTS;
    else if (event == CNC_EVENT_START_REFUSED)
        device->refused = (uint8_t)value;
    if (event == CNC_EVENT_START_REFUSED)
        cnc_note(device, "start refused: %s", cnc_result_text((enum cnc_result)value));
    else if (event == CNC_EVENT_REFERENCE_DONE || event == CNC_EVENT_REFERENCE_FAILED)
        cnc_note(device, "reference of %s %s", cnc_axis_names[value & 15],
             event == CNC_EVENT_REFERENCE_DONE ? "is done" : "has ended without a position");
    else if (texts[event].after)
        cnc_note(device, "%s%lld%s", texts[event].before, (long long)value, texts[event].after);
    else if (texts[event].before)
        cnc_note(device, "%s", texts[event].before);
}

/* ---- Power and time ----------------------------------------------------------------------------------------------------- */

static void connect_port(struct cnc_device *device, const struct device_port *port, void *context)
{
    device->outer = port;
    device->context = context;
    device->port = (struct cnc_port){.event = on_event, .save_backup = on_save};
    device->cnc.port = &device->port;
    device->cnc.context = device;
}

struct cnc_setup cnc_setup_of(struct cnc_device *device, const struct cnc_own *own, const uint8_t *backup)
{
    const struct cnc_text *const *text = own->text;
    return (struct cnc_setup){
        .config = text[CNC_TEXT_CONFIG] ? text[CNC_TEXT_CONFIG]->config : cnc_default_config(),
        .program = text[CNC_TEXT_NC] ? text[CNC_TEXT_NC]->program : NULL,
        .plc = text[CNC_TEXT_PLC] ? text[CNC_TEXT_PLC]->plc : NULL,
        .switches = text[CNC_TEXT_MACHINE] ? text[CNC_TEXT_MACHINE]->machine.list : NULL,
        .switch_count = text[CNC_TEXT_MACHINE] ? text[CNC_TEXT_MACHINE]->machine.count : 0,
        .backup = backup,
        .port = &device->port,
        .context = device,
    };
}

/* The memory of a unit that has been without power has the texts that were loaded. */
static void begin(struct device_unit *unit, const struct device_config *config, const struct device_port *port, void *context)
{
    struct cnc_device *device = cnc_of(unit);
    uint8_t backup[CNC_BACKUP_SIZE] = {0};
    const struct cnc_text *loaded[CNC_TEXT_KINDS];
    memcpy(loaded, device->loaded, sizeof loaded);
    memset(device, 0, sizeof *device);
    memcpy(device->loaded, loaded, sizeof loaded);
    device->own = cnc_own_of(config);
    for (unsigned kind = 0; kind < CNC_TEXT_KINDS; kind++)
        if (loaded[kind])
            device->own.text[kind] = loaded[kind];
    connect_port(device, port, context);
    const struct cnc_flash flash = flash_of(device);
    if (has_flash(device))
        (void)cnc_backup_load(&flash, backup, &device->backup);
    const struct cnc_setup setup = cnc_setup_of(device, &device->own, backup);
    cnc_begin(&device->cnc, &setup);
    for (unsigned axis = 0; axis < CNC_AXES; axis++)
        device->shown[axis] = cnc_shown_position(&device->cnc, axis);
}

/* Texts are shared, and stay; what a unit has of its settings is in the unit. */
static void attach(struct device_unit *unit, const struct device_config *config, const struct device_port *port, void *context)
{
    (void)config;
    connect_port(cnc_of(unit), port, context);
}

static uint64_t now(const struct device_unit *unit)
{
    return cnc_in(unit)->now;
}

/* The us in which the next T is done. */
static uint64_t next_turn(const struct device_unit *unit)
{
    return (cnc_in(unit)->cnc.turn + 1u) * CNC_TICKS_PER_T;
}

static uint64_t next_event(const struct device_unit *unit)
{
    return cnc_in(unit)->is_quiet ? DEVICE_NEVER : next_turn(unit);
}

/* A PLC program has no end of its own. */
static uint64_t next_report(const struct device_unit *unit)
{
    return is_at_rest(cnc_in(unit)) ? DEVICE_NEVER : next_event(unit);
}

static void advance(struct device_unit *unit, uint64_t us)
{
    struct cnc_device *device = cnc_of(unit);
    const uint64_t end = device->now + us;
    while (next_turn(unit) < end) {
        device->now = next_turn(unit);
        cnc_tick(&device->cnc);
        report_turn(device);
        if (device->outer->slot)
            device->outer->slot(device->context, device->now);
        device->is_quiet = is_quiet(device);
    }
    device->now = end;
}

/* ---- State -------------------------------------------------------------------------------------------------------------- */

static void set_inputs(struct device_unit *unit, uint32_t mask)
{
    (void)unit;
    (void)mask;
}

static uint32_t no_bits(const struct device_unit *unit)
{
    (void)unit;
    return 0;
}

static unsigned node(const struct device_unit *unit)
{
    (void)unit;
    return 1;
}

static void axis(const struct device_unit *unit, unsigned number, struct device_axis *state)
{
    const struct cnc_device *device = cnc_in(unit);
    const struct cnc *cnc = &device->cnc;
    const bool is_asked = cnc->machine.start != 0 || cnc->machine.annulment != 0;
    const bool is_busy = is_asked || (cnc->machine.phase != CNC_IDLE && !cnc_bit(&cnc->cells, CNC_BIT_PO_STOP));
    const bool moves = ((unsigned)device->moving >> (number - 1u) & 1u) != 0;
    *state = (struct device_axis){
        .position = cnc_shown_position(cnc, number - 1u),
        .state = (uint8_t)cnc_axis_state(cnc, number - 1u),
        .fault = (uint8_t)device->is_critical,
        .led = DEVICE_LED_OFF,
        .absent = (cnc->config->axes >> (number - 1u) & 1u) == 0,
        .idle = !is_busy && !moves,
        .running = is_busy || moves,
        .moving = moves,
        .forward = !cnc_bit(&cnc->cells, CNC_BIT_SM_POxPI + number - 1u),
    };
}

static bool has_program(const struct device_config *config)
{
    return cnc_own_of(config).text[CNC_TEXT_NC] != NULL;
}

/* An NC program, as of `rkm04 exec`: it is loaded, and started. */
static int set_text(struct device_unit *unit, unsigned number, const char *text, size_t length, char error[DEVICE_ERROR_SIZE])
{
    struct cnc_device *device = cnc_of(unit);
    struct device_refusal refusal;
    (void)number; /* the text is for all axes */
    device->is_quiet = false;
    const struct cnc_text *program =
        text ? cnc_text_read(CNC_TEXT_NC, device->own.text[CNC_TEXT_CONFIG], "nc", text, length, NULL) : NULL;
    if (text && !program) {
        snprintf(error, DEVICE_ERROR_SIZE, "the NC program is wrong");
        return 1;
    }
    if (text && device->cnc.machine.start != 0) {
        snprintf(error, DEVICE_ERROR_SIZE, "another NC program has just been started: expected one");
        return 2;
    }
    if (text && !cnc_load_program(device, program, &refusal)) {
        snprintf(error, DEVICE_ERROR_SIZE, "%s", refusal.text);
        return 2;
    }
    const enum cnc_result result = cnc_start(&device->cnc);
    if (result != CNC_OK)
        snprintf(error, DEVICE_ERROR_SIZE, "%s", cnc_result_text(result));
    return result == CNC_OK ? 0 : 2;
}

static bool is_stuck(const struct device_unit *unit, unsigned number, char text[DEVICE_ERROR_SIZE])
{
    const struct cnc *cnc = &cnc_in(unit)->cnc;
    (void)number;
    if (cnc_in(unit)->is_critical)
        snprintf(text, DEVICE_ERROR_SIZE, "critical error %d", (int)cnc_number(&cnc->cells, CNC_CELL_BZH13, 0));
    else if (cnc_bit(&cnc->cells, CNC_BIT_PO_STOP))
        snprintf(text, DEVICE_ERROR_SIZE, "the program is stopped: START makes it go on");
    else if (cnc_in(unit)->refused == CNC_RESULTS)
        snprintf(text, DEVICE_ERROR_SIZE, "a block is refused: S is outside of the limits of the gear");
    else if (cnc_in(unit)->refused != CNC_OK)
        snprintf(text, DEVICE_ERROR_SIZE, "start refused: %s", cnc_result_text(cnc_in(unit)->refused));
    else
        return false;
    return true;
}

static bool is_endless(const struct device_unit *unit, unsigned number, char text[DEVICE_ERROR_SIZE])
{
    (void)unit;
    (void)number;
    (void)text;
    return false;
}

static const char *led_name(unsigned led)
{
    return led == DEVICE_LED_OFF ? "off" : NULL; /* it has none */
}

static uint64_t exchange_end(const struct device_unit *unit, unsigned slots)
{
    return slots == 0 ? cnc_in(unit)->now : (cnc_in(unit)->cnc.turn + slots) * CNC_TICKS_PER_T + 1u;
}

static const struct device_exchange exchange = {
    .name = "cnc.exchange", .set = "cnc.set", .get = "cnc.get", .member = "cells", .end = exchange_end};

const struct device_kind cnc872_device = {
    .name = "cnc872",
    .description = "CNC system with the interface CNC872 to a PLC program, without a bus",
    .size = sizeof(struct cnc_device),
    .axes = CNC_AXES,
    .addresses = 1,
    .ticks_per_us = 1,
    .slot = CNC_TICKS_PER_T,
    .pulse = 1,
    .has_no_steps = true,
    .is_program_whole = true,
    .flash_blocks = CNC_BACKUP_BLOCKS,
    .flash_block_size = CNC_BACKUP_BLOCK,
    .flash_name = "backup",
    .begin = begin,
    .end = end,
    .attach = attach,
    .now = now,
    .advance = advance,
    .next_event = next_event,
    .next_report = next_report,
    .set_inputs = set_inputs,
    .inputs_of = no_bits,
    .outputs_of = no_bits,
    .variables_of = no_bits,
    .node = node,
    .axis = axis,
    .set_text = set_text,
    .has_program = has_program,
    .check_text = cnc_check_text,
    .is_stuck = is_stuck,
    .state_name = cnc_state_name,
    .fault_name = cnc_fault_name,
    .led_name = led_name,
    .state = cnc_json_state,
    .describe = cnc_json_describe,
    .options = cnc_options,
    .methods = cnc_methods,
    .exchange_of = &exchange,
    .find_cell = cnc_find_cell_code,
    .cell = cnc_cell_value,
    .settings = cnc_setting_names,
    .put_settings = cnc_put_settings,
    .read_setting = cnc_read_setting,
    .unlike = cnc_settings_difference,
    .is_endless = is_endless,
};
