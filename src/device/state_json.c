/* SPDX-License-Identifier: MIT */
#include "state_json.h"

static json_t *motor_json(const struct rkm04_unit *unit, unsigned motor)
{
    struct rkm04_motor_state state;
    rkm04_motor_state(unit, motor, &state);
    const char *fault = state.fault == RKM04_FAULT_NONE ? NULL : rkm04_fault_name(state.fault);
    return json_pack("{s:i, s:I, s:s, s:i, s:s, s:s?}", "motor", (int)motor, "position", (json_int_t)state.position, "state",
                     rkm04_state_name(state.state), "index", (int)state.index, "led", rkm04_led_name(state.led), "fault",
                     fault);
}

json_t *state_json(const struct rkm04_unit *unit, uint64_t tick)
{
    json_t *motors = json_array();
    for (unsigned motor = 1; motor <= RKM04_MOTORS; motor++) {
        if (motors != NULL && json_array_append_new(motors, motor_json(unit, motor)) != 0) {
            json_decref(motors);
            motors = NULL;
        }
    }
    if (motors == NULL)
        return NULL;
    return json_pack("{s:I, s:o, s:i, s:i, s:i}", "t_us", (json_int_t)tick, "motors", motors, "di",
                     (int)rkm04_inputs(unit), "do", (int)rkm04_outputs(unit), "var", (int)rkm04_variables(unit));
}
