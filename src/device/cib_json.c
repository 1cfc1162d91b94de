/* SPDX-License-Identifier: MIT */
/* The state of a CIB module as JSON. */
#include "cib_device.h"

static const char *drive_name(unsigned drive)
{
    return drive == 0 ? "A" : "B";
}

/* MOVE is on from the tick in which a command is taken (BC5). */
enum cib_state cib_state_of(const struct cib_drive_state *state)
{
    if ((state->status & CIB_MOVE) == 0)
        return CIB_IDLE;
    return state->turning ? CIB_TURNING : state->stopping ? CIB_STOPPING : CIB_MOVING;
}

const char *cib_state_name(unsigned state)
{
    static const char *const names[] = {
        [CIB_IDLE] = "idle", [CIB_MOVING] = "moving", [CIB_STOPPING] = "stopping", [CIB_TURNING] = "turning"};
    return state <= CIB_TURNING ? names[state] : NULL;
}

/* As docs/CONTROL.md has it for every kind, and what a drive has besides. */
static json_t *motor_json(const struct cib_unit *unit, unsigned drive, bool whole)
{
    struct cib_drive_state state;
    cib_drive_state(unit, drive, &state);
    json_t *motor = json_pack("{s:i, s:i, s:s, s:i, s:s, s:s?}", "motor", (int)drive + 1, "position", (int)state.position,
                              "state", cib_state_name((unsigned)cib_state_of(&state)), "index", 0, "led", "off", "fault",
                              state.error != 0 ? cib_error_name(state.error) : NULL);
    json_t *more = NULL;
    if (whole)
        more = json_pack("{s:s, s:b, s:i, s:i, s:i, s:i, s:i, s:i, s:i, s:i, s:i, s:b, s:n}", "drive", drive_name(drive),
                         "configured", (int)state.configured, "speed", (int)state.speed, "steps",
                         state.moving ? (int)state.steps : 0, "row", (int)state.row, "mcstat", (int)state.status, "mcerr",
                         (int)state.error, "start_speed", (int)state.start_speed, "acceleration", (int)state.acceleration,
                         "deceleration", (int)state.deceleration, "stop_deceleration", (int)state.stop_deceleration, "off",
                         (int)state.off, "true_position");
    if (more)
        json_object_update(motor, more);
    json_decref(more);
    return motor;
}

static json_t *state_json(const struct device_unit *unit, uint64_t t_us, bool whole)
{
    const struct cib_unit *core = &cib_device_read(unit)->unit;
    json_t *motors = json_array();
    uint32_t variables = 0;
    for (unsigned drive = 0; drive < CIB_DRIVES; drive++) {
        struct cib_drive_state state;
        cib_drive_state(core, drive, &state);
        variables |= (uint32_t)(state.status & 0x3fu) << 6u * drive;
        json_array_append_new(motors, motor_json(core, drive, whole));
    }
    return json_pack("{s:I, s:o, s:i, s:i, s:i}", "t_us", (json_int_t)t_us, "motors", motors, "di",
                     (int)(cib_inputs(core) | (unsigned)core->buttons << 8), "do", (int)cib_driven(core), "var", (int)variables);
}

json_t *cib_json_state(const struct device_unit *unit, uint64_t t_us)
{
    return state_json(unit, t_us, false);
}

json_t *cib_json_describe(const struct device_unit *unit, uint64_t t_us)
{
    const struct cib_unit *core = &cib_device_read(unit)->unit;
    json_t *all = state_json(unit, t_us, true), *duties = json_array();
    for (uint16_t output = 1; output <= CIB_OUTPUTS; output++)
        json_array_append_new(duties, json_integer(cib_read(core, CIB_OUTPUT_ZONE, output)));
    const struct cib_rtu_counters *counters = &cib_device_read(unit)->rtu.counters;
    const struct cib_setup setup = cib_setup_read(core, CIB_INPUT_ZONE);
    json_t *more = json_pack("{s:i, s:i, s:i, s:i, s:o, s:o, s:i}", "node", (int)cib_device_read(unit)->rtu.address, "di_shown",
                             (int)cib_read(core, CIB_INPUT_ZONE, 0), "buttons", (int)core->buttons, "do_register",
                             (int)cib_read(core, CIB_OUTPUT_ZONE, 0), "pwm", duties, "setup", cib_setup_json(&setup),
                             "apply_result", (int)cib_read(core, CIB_INPUT_ZONE, 0x100));
    json_object_set_new(more, "counters", json_pack("{s:I, s:I, s:I, s:I}", "requests", (json_int_t)counters->requests, "answers",
                                                    (json_int_t)counters->answers, "others", (json_int_t)counters->others,
                                                    "dropped", (json_int_t)counters->dropped));
    json_object_update(all, more);
    json_decref(more);
    return all;
}
