/* SPDX-License-Identifier: MIT */
/* Rows `t_us,source,event,value`. With several units on the line the source has the unit's name in front: `3.m1`. */
#include "event_json.h"
#include "text/text.h"
#include "trace_writer.h"

#define ROW_MAX 80u /* a tick, names of a unit and of a value, and a number are 66 with the separators */

static const char *const names[WATCH_KINDS] = {
    [WATCH_STEP] = ",step,",  [WATCH_DIRECTION] = ",dir,", [WATCH_MOTION] = ",motion,",   [WATCH_COMMAND] = ",command,",
    [WATCH_LED] = ",led,",    [WATCH_INPUTS] = ",di,",     [WATCH_OUTPUTS] = ",do,",      [WATCH_VARIABLES] = ",var,",
    [WATCH_POWER] = ",power,", [WATCH_POSITION] = ",position,", [WATCH_VALUE] = ",",
};

static char *put_value(char *at, const struct sim *sim, const struct watch_event *event)
{
    switch ((enum watch_kind)event->kind) {
    case WATCH_DIRECTION:
        return put_text(at, event->value ? "1" : "-1");
    case WATCH_MOTION:
        return put_text(at, event->value ? "begin" : "end");
    case WATCH_LED:
        return put_text(at, sim_device(sim)->led_name((unsigned)event->value));
    case WATCH_POWER:
        return put_text(at, event->value ? "on" : "off");
    case WATCH_INPUTS:
    case WATCH_OUTPUTS:
    case WATCH_VARIABLES:
        return put_number(at, (uint32_t)event->value);
    default:
        return put_signed(at, event->value);
    }
}

static void write_row(struct trace_file *file, const struct watch_event *event, const char *name)
{
    char *at = event_time(trace_room(file, ROW_MAX), file->sim, event);
    *at++ = ',';
    if (sim_units(file->sim) > 1) {
        at = put_text(at, file->sim->unit[event->unit - 1u].name);
        *at++ = '.';
    }
    if (event->motor == 0) {
        at = put_text(at, "unit");
    } else {
        *at++ = 'm';
        at = put_number(at, event->motor);
    }
    at = put_text(at, name);
    if (event->number != 0) {
        at = put_text(at, sim_device(file->sim)->value_names[event->number - 1u]);
        *at++ = ',';
    }
    at = put_value(at, file->sim, event);
    *at++ = '\n';
    trace_wrote(file, at);
}

static void on_event(void *context, const struct watch_event *event)
{
    write_row(context, event, names[event->kind]);
}

/* ---- What there is at the beginning --------------------------------------------------------------------------------- */

static void write_initial(struct trace_file *file, unsigned number, unsigned motor, enum watch_kind kind, int32_t value)
{
    struct watch_event event = {
        .tick = sim_now(file->sim), .value = value, .kind = (uint8_t)kind, .unit = (uint8_t)number, .motor = (uint8_t)motor};
    if (value != 0 || kind == WATCH_POWER)
        write_row(file, &event, names[kind]);
}

static void write_initial_value(struct trace_file *file, unsigned number, unsigned value)
{
    struct watch_event event = {.tick = sim_now(file->sim),
                                .value = sim_device(file->sim)->value(sim_core(file->sim, number), value),
                                .kind = WATCH_VALUE,
                                .unit = (uint8_t)number,
                                .number = (uint8_t)value};
    if (event.value != 0)
        write_row(file, &event, names[WATCH_VALUE]);
}

static void write_initial_motor(struct trace_file *file, unsigned number, unsigned motor)
{
    const struct device_axis state = sim_axis(file->sim, number, motor);
    write_initial(file, number, motor, WATCH_POSITION, state.position);
    write_initial(file, number, motor, WATCH_COMMAND, state.index);
    write_initial(file, number, motor, WATCH_DIRECTION, state.forward);
    write_initial(file, number, motor, WATCH_LED, state.led);
    write_initial(file, number, motor, WATCH_MOTION, state.moving);
}

/* A trace that begins later begins with what is not as after power-up. */
static void begin(struct trace_file *file)
{
    static const char header[] = "t_us,source,event,value\n";
    const struct device_kind *kind = sim_device(file->sim);
    trace_put(file, header, sizeof header - 1u);
    for (unsigned number = 1; number <= sim_units(file->sim); number++) {
        const struct device_unit *core = sim_core(file->sim, number);
        if (!sim_powered(file->sim, number)) {
            write_initial(file, number, 0, WATCH_POWER, 0);
            continue;
        }
        write_initial(file, number, 0, WATCH_INPUTS, (int32_t)kind->inputs_of(core));
        write_initial(file, number, 0, WATCH_OUTPUTS, (int32_t)kind->outputs_of(core));
        write_initial(file, number, 0, WATCH_VARIABLES, (int32_t)kind->variables_of(core));
        for (unsigned value = 1; value <= kind->values; value++)
            write_initial_value(file, number, value);
        for (unsigned motor = 1; motor <= kind->axes; motor++)
            write_initial_motor(file, number, motor);
    }
}

static void end(struct trace_file *file)
{
    (void)file;
}

const struct trace_writer trace_csv = {
    .suffix = ".csv",
    .kind = {.name = "a CSV trace", .begins = {"t_us,source,event,value"}},
    .kinds = WATCH_BIT(WATCH_STEP) | WATCH_BIT(WATCH_DIRECTION) | WATCH_BIT(WATCH_MOTION) | WATCH_BIT(WATCH_COMMAND) |
             WATCH_BIT(WATCH_LED) | WATCH_BIT(WATCH_INPUTS) | WATCH_BIT(WATCH_OUTPUTS) | WATCH_BIT(WATCH_VARIABLES) |
             WATCH_BIT(WATCH_POWER) | WATCH_BIT(WATCH_POSITION) | WATCH_BIT(WATCH_VALUE),
    .begin = begin,
    .on_event = on_event,
    .end = end,
};
