/* SPDX-License-Identifier: MIT */
/* One JSON object a line: `begin` with what there is, every event as in event_json.h, `end`. */
#include <stdlib.h>

#include "event_json.h"
#include "text/text.h"
#include "trace_writer.h"

#define MOTOR_ROOM 200u
#define VALUE_ROOM (DEVICE_BIT_NAME_SIZE + 16u)
#define UNIT_ROOM (160u + DEVICE_AXES_MAX * MOTOR_ROOM + DEVICE_VALUES_MAX * VALUE_ROOM)

static void on_event(void *context, const struct watch_event *event)
{
    struct trace_file *file = context;
    size_t room = event_json_room(event) + 3u;
    char *apart = room > TRACE_BUFFER ? malloc(room) : NULL;
    if (room > TRACE_BUFFER && !apart)
        return;
    char *start = apart ? apart : trace_room(file, room), *at = start;
    *at++ = '{';
    at = event_json(at, file->sim, event);
    *at++ = '}';
    *at++ = '\n';
    if (apart)
        trace_put(file, apart, (size_t)(at - start));
    else
        trace_wrote(file, at);
    free(apart);
}

static char *put_member(char *at, const char *name, int32_t value)
{
    return put_signed(put_text(at, name), value);
}

/* All inputs, outputs or variables, the first in bit 0. */
static char *put_mask(char *at, const char *name, uint32_t mask)
{
    return put_number(put_text(at, name), mask);
}

static char *put_motor(char *at, struct sim *sim, unsigned number, unsigned motor)
{
    const struct device_axis state = sim_axis(sim, number, motor);
    at = put_member(at, motor == 1 ? "{\"motor\":" : ",{\"motor\":", (int32_t)motor);
    at = put_member(at, ",\"position\":", state.position);
    at = put_member(at, ",\"direction\":", state.forward);
    at = put_member(at, ",\"motion\":", state.moving);
    at = put_member(at, ",\"command\":", state.index);
    at = put_text(put_text(at, ",\"led\":\""), sim_device(sim)->led_name(state.led));
    at = put_text(put_text(at, "\",\"fault\":\""), sim_device(sim)->fault_name(state.fault));
    return put_text(at, "\"}");
}

/* `"values":{"pwm1":0,…},` of a device that has any. */
static char *put_values(char *at, const struct device_kind *kind, const struct device_unit *core)
{
    for (unsigned value = 1; value <= kind->values; value++) {
        at = put_text(put_text(at, value == 1 ? ",\"values\":{\"" : ",\""), kind->value_names[value - 1u]);
        at = put_member(at, "\":", kind->value(core, value));
    }
    return kind->values > 0 ? put_text(at, "}") : at;
}

static void put_unit(struct trace_file *file, unsigned number)
{
    const struct device_kind *kind = sim_device(file->sim);
    const struct device_unit *core = sim_core(file->sim, number);
    char *at = trace_room(file, UNIT_ROOM);
    at = put_text(at, number == 1 ? "{\"unit\":\"" : ",{\"unit\":\"");
    at = put_text(at, file->sim->unit[number - 1u].name);
    at = put_member(at, "\",\"power\":", sim_powered(file->sim, number));
    at = put_mask(at, ",\"inputs\":", kind->inputs_of(core));
    at = put_mask(at, ",\"outputs\":", kind->outputs_of(core));
    at = put_mask(at, ",\"variables\":", kind->variables_of(core));
    at = put_text(put_values(at, kind, core), ",\"motors\":[");
    for (unsigned motor = 1; motor <= kind->axes; motor++)
        at = put_motor(at, file->sim, number, motor);
    trace_wrote(file, put_text(at, "]}"));
}

static void put_edge(struct trace_file *file, const char *text)
{
    char *at = trace_room(file, 2u * DIGITS_MAX + 64u);
    at = put_number(put_text(at, "{\"t_us\":"), sim_now(file->sim));
    trace_wrote(file, put_text(at, text));
}

static void begin(struct trace_file *file)
{
    put_edge(file, ",\"kind\":\"begin\",\"units\":[");
    for (unsigned number = 1; number <= sim_units(file->sim); number++)
        put_unit(file, number);
    trace_put(file, "]}\n", 3);
}

static void end(struct trace_file *file)
{
    put_edge(file, ",\"kind\":\"end\"}\n");
}

const struct trace_writer trace_jsonl = {
    .suffix = ".jsonl",
    .kind = {.name = "a JSON Lines trace", .begins = {"{\"t_us\":"}},
    .kinds = WATCH_ALL,
    .begin = begin,
    .on_event = on_event,
    .end = end,
};
