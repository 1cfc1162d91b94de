/* SPDX-License-Identifier: MIT */
/* The state of a CNC872 as JSON. */
#include <stdio.h>
#include <string.h>

#include "cnc872_device.h"

static const char *const state_names[CNC_AXIS_STATES] = {"idle", "block", "stopped", "manual", "reference"};
static const char *const phase_names[] = {"idle", "init", "move", "delay", "done"};

const char *cnc_state_name(unsigned state)
{
    return state < CNC_AXIS_STATES ? state_names[state] : NULL;
}

const char *cnc_fault_name(unsigned fault)
{
    static const char *const names[] = {"none", "critical"};
    return fault < 2 ? names[fault] : NULL;
}

/* Put `value` into the object, which is NULL if memory has been short. */
static void put(json_t *object, const char *name, json_t *value)
{
    if (!value || !object)
        json_decref(value);
    else
        json_object_set_new(object, name, value);
}

static bool has_bit(const struct cnc *cnc, unsigned place)
{
    return cnc_bit(&cnc->cells, place);
}

static int64_t number_of(const struct cnc *cnc, enum cnc_cell cell)
{
    return cnc_number(&cnc->cells, cell, 0);
}

/* ---- As every device ---------------------------------------------------------------------------------------------------- */

static const char *fault_of(const struct cnc *cnc)
{
    return number_of(cnc, CNC_CELL_BZH13) != 0 ? cnc_fault_name(1) : NULL;
}

json_t *cnc_json_state(const struct device_unit *unit, uint64_t t_us)
{
    const struct cnc *cnc = &cnc_in(unit)->cnc;
    json_t *motors = json_array();
    for (unsigned axis = 0; axis < CNC_AXES; axis++)
        json_array_append_new(motors, json_pack("{s:i, s:i, s:s, s:i, s:s, s:s?}", "motor", (int)axis + 1, "position",
                                                (int)cnc_shown_position(cnc, axis), "state",
                                                cnc_state_name(cnc_axis_state(cnc, axis)), "index", 0, "led", "off", "fault",
                                                fault_of(cnc)));
    return json_pack("{s:I, s:o, s:i, s:i, s:i}", "t_us", (json_int_t)t_us, "motors", motors, "di", 0, "do", 0, "var", 0);
}

/* ---- cnc.state ---------------------------------------------------------------------------------------------------------- */

static json_t *axis_json(const struct cnc *cnc, unsigned axis)
{
    return json_pack("{s:I, s:I, s:I, s:I, s:s, s:b, s:b, s:b}", "position", (json_int_t)cnc_position(cnc, axis, 5), "actual",
                     (json_int_t)cnc_position(cnc, axis, 6), "pos0", (json_int_t)cnc_position(cnc, axis, 0), "difference",
                     (json_int_t)cnc_number(&cnc->cells, CNC_CELL_DIFCIT_X, axis), "state",
                     cnc_state_name(cnc_axis_state(cnc, axis)), "homed",
                     (int)(number_of(cnc, CNC_CELL_HOMING) >> axis & 1), "enabled", (int)has_bit(cnc, CNC_BIT_MPxPI + axis),
                     "rotary", (int)cnc->config->axis[axis].is_rotary);
}

static json_t *axes_json(const struct cnc *cnc)
{
    json_t *axes = json_object();
    for (unsigned axis = 0; axis < CNC_AXES; axis++)
        if ((cnc->config->axes >> axis & 1u) != 0)
            put(axes, cnc_axis_names[axis], axis_json(cnc, axis));
    return axes;
}

/* The keys that are pressed, as cnc.panel takes them. */
static json_t *jog_json(const struct cnc *cnc)
{
    json_t *jog = json_object();
    for (unsigned axis = 0; axis < CNC_AXES; axis++)
        if (((cnc->panel.jog_plus | cnc->panel.jog_minus) >> axis & 1) != 0)
            put(jog, cnc_axis_names[axis], json_string((cnc->panel.jog_plus >> axis & 1) != 0 ? "+" : "-"));
    return jog;
}

static json_t *panel_json(const struct cnc *cnc)
{
    const struct cnc_panel *panel = &cnc->panel;
    return json_pack("{s:s, s:o, s:i, s:i, s:b, s:b, s:b, s:b, s:b, s:b, s:b, s:[i, i, i, i]}", "mode",
                     panel->manual ? "manual" : "aut", "jog", jog_json(cnc), "feed", (int)panel->feed, "spindle",
                     (int)panel->spindle, "rapid", (int)panel->rapid, "hand",
                     (int)panel->hand, "block_by_block", (int)panel->block_by_block, "m01", (int)panel->m01, "indication",
                     (int)panel->indication, "simulation", (int)panel->simulation, "high_speed",
                     (int)panel->high_speed, "keys",
                     (int)panel->key[0], (int)panel->key[1], (int)panel->key[2], (int)panel->key[3]);
}

static json_t *spindle_json(const struct cnc *cnc)
{
    return json_pack("{s:I, s:I, s:I, s:s}", "required", (json_int_t)number_of(cnc, CNC_CELL_REQ_SPEED_PM), "actual",
                     (json_int_t)number_of(cnc, CNC_CELL_ACT_SPEED_PM), "gear",
                     (json_int_t)number_of(cnc, CNC_CELL_SPINDLE_GEAR_ACT_1), "turns",
                     has_bit(cnc, CNC_BIT_M03PI)   ? "m3"
                     : has_bit(cnc, CNC_BIT_M04PI) ? "m4"
                                                   : "off");
}

/* The lines of a display; what was never written to is a blank. */
static json_t *display_json(const struct cnc_display *display)
{
    json_t *lines = json_array();
    for (unsigned line = 0; line < CNC_DISPLAY_LINES; line++) {
        char text[CNC_DISPLAY_COLUMNS + 1u] = "";
        for (unsigned at = 0; at < CNC_DISPLAY_COLUMNS; at++)
            text[at] = display->text[line][at] >= ' ' && display->text[line][at] < 127 ? (char)display->text[line][at] : ' ';
        json_array_append_new(lines, json_string(text));
    }
    return json_pack("{s:o, s:i, s:i}", "lines", lines, "size", (int)display->size, "inverse", (int)display->inverse);
}

static json_t *stops_json(const struct cnc *cnc)
{
    return json_pack("{s:b, s:b, s:b, s:b, s:b}", "po_stop", (int)has_bit(cnc, CNC_BIT_PO_STOP), "sf_stop",
                     (int)has_bit(cnc, CNC_BIT_SF_STOP), "limit", (int)has_bit(cnc, CNC_BIT_SF_LS), "software_limit",
                     (int)has_bit(cnc, CNC_BIT_SF_SLS), "moved_since", (int)has_bit(cnc, CNC_BIT_SF_STOPPOSCHANGED));
}

static json_t *block_json(const struct cnc *cnc)
{
    const struct cnc_machine *machine = &cnc->machine;
    const struct cnc_nc_program *program = cnc->program;
    const bool is_there = program && machine->block < program->block_count;
    return json_pack("{s:s, s:o, s:o, s:I, s:I}", "phase", phase_names[machine->phase], "block",
                     is_there ? json_integer(machine->block) : json_null(), "line",
                     is_there ? json_integer(program->blocks[machine->block].line) : json_null(), "next",
                     (json_int_t)machine->next, "blocks", (json_int_t)(program ? program->block_count : 0));
}

json_t *cnc_json_describe(const struct device_unit *unit, uint64_t t_us)
{
    const struct cnc *cnc = &cnc_in(unit)->cnc;
    json_t *state = cnc_json_state(unit, t_us), *displays = json_array();
    size_t at;
    json_t *motor;
    json_array_foreach(json_object_get(state, "motors"), at, motor) {
        put(motor, "true_position", json_null());
        put(motor, "axis", json_string(cnc_axis_names[at]));
        put(motor, "configured", json_boolean(cnc->config->axes >> at & 1u));
    }
    put(state, "node", json_integer(1));
    for (unsigned which = 0; which < CNC_DISPLAYS; which++)
        json_array_append_new(displays, display_json(&cnc->display[which]));
    put(state, "cnc", json_pack("{s:o, s:o, s:o, s:o, s:o, s:I, s:I, s:I, s:I, s:I, s:o}", "block",
                                block_json(cnc), "axes", axes_json(cnc), "stops", stops_json(cnc), "panel", panel_json(cnc),
                                "spindle", spindle_json(cnc), "speed", (json_int_t)cnc->move.v, "critical",
                                (json_int_t)number_of(cnc, CNC_CELL_BZH13), "plc_error",
                                (json_int_t)number_of(cnc, CNC_CELL_PLC_ERROR), "plc_pass",
                                (json_int_t)number_of(cnc, CNC_CELL_PLC_PASS), "plc_loads", (json_int_t)cnc_in(unit)->loads,
                                "displays", displays));
    return state;
}
