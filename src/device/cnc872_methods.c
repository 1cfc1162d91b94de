/* SPDX-License-Identifier: MIT */
/* Methods of a CNC872 for the control socket, scenarios and recordings (NL1). */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cnc872_device.h"
#include "text/text.h"

#define PANEL_NAMES \
    "start, stop, reset, mode, home, jog, hand, rapid, feed, spindle, block_by_block, m01, select, technology, indication, " \
    "simulation, high_speed, rtm or keys"

json_t *cnc_refuse(struct device_refusal *refusal, bool is_state, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(refusal->text, DEVICE_ERROR_SIZE, format, arguments);
    va_end(arguments);
    refusal->is_state = is_state;
    return NULL;
}

/* What a request to the core has answered. */
static json_t *result_of(enum cnc_result result, struct device_refusal *refusal)
{
    return result == CNC_OK ? json_object() : cnc_refuse(refusal, true, "%s", cnc_result_text(result));
}

/* ---- Cells -------------------------------------------------------------------------------------------------------------- */

static json_t *call_get(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    json_t *values = cnc_get_cells(cnc_of(unit), json_object_get(params, "cells"), refusal);
    return values ? json_pack("{s:I, s:o}", "t", (json_int_t)cnc_of(unit)->cnc.turn, "cells", values) : NULL;
}

static json_t *call_set(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    cnc_of(unit)->is_quiet = false;
    if (!cnc_set_cells(cnc_of(unit), json_object_get(params, "cells"), refusal))
        return NULL;
    return json_pack("{s:I}", "t", (json_int_t)cnc_of(unit)->cnc.turn);
}

static json_t *call_cells(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    return cnc_find_names(cnc_of(unit), params, refusal);
}

/* ---- Panel -------------------------------------------------------------------------------------------------------------- */

/* A member of `panel` that is a key or switch: false or true. */
static const struct {
    const char *name;
    size_t at;
} panel_switches[] = {
    {"rapid", offsetof(struct cnc_panel, rapid)}, {"hand", offsetof(struct cnc_panel, hand)},
    {"block_by_block", offsetof(struct cnc_panel, block_by_block)}, {"m01", offsetof(struct cnc_panel, m01)},
    {"indication", offsetof(struct cnc_panel, indication)}, {"simulation", offsetof(struct cnc_panel, simulation)},
    {"high_speed", offsetof(struct cnc_panel, high_speed)},
};
#define PANEL_SWITCHES (sizeof panel_switches / sizeof panel_switches[0])

/* What a call of cnc.panel wants. */
struct panel_request {
    struct cnc_panel panel;
    bool start, stop, reset, has_select, technology, has_critical;
    int home;           /* axis, -1: none */
    uint32_t select;    /* index of a block */
    uint8_t critical;
};

bool cnc_read_number_param(const char *name, const json_t *value, int64_t low, int64_t high, int64_t *number,
                           struct device_refusal *refusal)
{
    *number = json_integer_value(value);
    if (json_is_integer(value) && *number >= low && *number <= high)
        return true;
    return CNC_REFUSE(refusal, false, "%s: expected a whole number from %lld to %lld", name, (long long)low, (long long)high);
}

static int read_axis(const json_t *value, const struct cnc *cnc)
{
    const char *name = json_string_value(value);
    const int axis = name ? cnc_find_axis(name, strlen(name)) : -1;
    return axis >= 0 && (cnc->config->axes >> axis & 1u) != 0 ? axis : -1;
}

/* {"X": "+", "Y": "-", "Z": ""}: the keys that are pressed, those of other axes stay. */
static bool read_jog(const struct cnc *cnc, const json_t *value, struct cnc_panel *panel, struct device_refusal *refusal)
{
    const char *name;
    const json_t *key;
    if (!json_is_object(value))
        return CNC_REFUSE(refusal, false, "jog: expected keys, as in {\"X\": \"+\", \"Y\": \"\"}");
    json_object_foreach((json_t *)value, name, key) {
        const char *pressed = json_string_value(key);
        const int axis = cnc_find_axis(name, strlen(name));
        if (axis < 0 || (cnc->config->axes >> axis & 1u) == 0)
            return CNC_REFUSE(refusal, false, "jog: the configuration has no axis `%.20s'", name);
        if (!pressed || (strcmp(pressed, "") != 0 && strcmp(pressed, "+") != 0 && strcmp(pressed, "-") != 0))
            return CNC_REFUSE(refusal, false, "jog: %s: expected \"+\", \"-\" or \"\"", name);
        const uint16_t bit = (uint16_t)(1u << axis);
        panel->jog_plus = (uint16_t)(*pressed == '+' ? panel->jog_plus | bit : panel->jog_plus & ~bit);
        panel->jog_minus = (uint16_t)(*pressed == '-' ? panel->jog_minus | bit : panel->jog_minus & ~bit);
    }
    return true;
}

static bool read_keys(const json_t *value, struct cnc_panel *panel, struct device_refusal *refusal)
{
    static const char *const names[] = {"P1", "P1_2", "P2", "P2_2"};
    const char *name;
    const json_t *key;
    if (!json_is_object(value))
        return CNC_REFUSE(refusal, false, "keys: expected words, as in {\"P1\": 1}");
    json_object_foreach((json_t *)value, name, key) {
        unsigned at = 0;
        int64_t number;
        while (at < 4 && strcmp(names[at], name) != 0)
            at++;
        if (at == 4)
            return CNC_REFUSE(refusal, false, "keys: `%.20s' is unknown: expected P1, P1_2, P2, P2_2", name);
        if (!cnc_read_number_param(name, key, 0, UINT16_MAX, &number, refusal))
            return false;
        panel->key[at] = (uint16_t)number;
    }
    return true;
}

static bool read_mode(const json_t *value, struct cnc_panel *panel, struct device_refusal *refusal)
{
    const char *mode = json_string_value(value);
    if (!mode || (strcmp(mode, "manual") != 0 && strcmp(mode, "aut") != 0))
        return CNC_REFUSE(refusal, false, "mode: expected \"aut\" or \"manual\"");
    panel->manual = *mode == 'm';
    return true;
}

static bool read_flag(const char *name, const json_t *value, bool *flag, struct device_refusal *refusal)
{
    *flag = json_is_true(value);
    return json_is_boolean(value) ? true : CNC_REFUSE(refusal, false, "%s: expected true or false", name);
}

/* A key that is pressed once: only true has a meaning. */
static bool read_press(const char *name, const json_t *value, bool *is_pressed, struct device_refusal *refusal)
{
    *is_pressed = true;
    return json_is_true(value) ? true : CNC_REFUSE(refusal, false, "%s: expected true", name);
}

/* A number of the panel, into the request. */
static bool read_pot(const char *name, const json_t *value, struct panel_request *request, struct device_refusal *refusal)
{
    int64_t number;
    const bool is_pot = strcmp(name, "rtm") != 0 && strcmp(name, "select") != 0;
    const int64_t most = is_pot ? CNC_PERCENT_MAX : *name == 'r' ? UINT8_MAX : CNC_NC_BLOCKS_MAX - 1;
    if (!cnc_read_number_param(name, value, 0, most, &number, refusal))
        return false;
    if (strcmp(name, "feed") == 0)
        request->panel.feed = (uint16_t)number;
    else if (strcmp(name, "spindle") == 0)
        request->panel.spindle = (uint16_t)number;
    else if (*name == 'r')
        request->critical = (uint8_t)number;
    else
        request->select = (uint32_t)number;
    request->has_critical = request->has_critical || strcmp(name, "rtm") == 0;
    request->has_select = request->has_select || strcmp(name, "select") == 0;
    return true;
}

static bool read_member(const struct cnc *cnc, const char *name, const json_t *value, struct panel_request *request,
                        struct device_refusal *refusal)
{
    static const char *const pots[] = {"feed", "spindle", "rtm", "select"};
    for (size_t i = 0; i < PANEL_SWITCHES; i++)
        if (strcmp(panel_switches[i].name, name) == 0)
            return read_flag(name, value, (bool *)((char *)&request->panel + panel_switches[i].at), refusal);
    for (size_t i = 0; i < sizeof pots / sizeof pots[0]; i++)
        if (strcmp(pots[i], name) == 0)
            return read_pot(name, value, request, refusal);
    if (strcmp(name, "start") == 0)
        return read_press(name, value, &request->start, refusal);
    if (strcmp(name, "stop") == 0)
        return read_press(name, value, &request->stop, refusal);
    if (strcmp(name, "reset") == 0)
        return read_press(name, value, &request->reset, refusal);
    if (strcmp(name, "technology") == 0)
        return read_flag(name, value, &request->technology, refusal);
    if (strcmp(name, "mode") == 0)
        return read_mode(value, &request->panel, refusal);
    if (strcmp(name, "jog") == 0)
        return read_jog(cnc, value, &request->panel, refusal);
    if (strcmp(name, "keys") == 0)
        return read_keys(value, &request->panel, refusal);
    if (strcmp(name, "home") == 0) {
        request->home = read_axis(value, cnc);
        return request->home >= 0 ? true : CNC_REFUSE(refusal, false, "home: expected the name of a configured axis");
    }
    return strcmp(name, "unit") == 0 ||
           CNC_REFUSE(refusal, false,
                      "unknown parameter `%.40s': expected " PANEL_NAMES "%s", name, nearest_hint(name, PANEL_NAMES));
}

static json_t *call_panel(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    struct cnc *cnc = &cnc_of(unit)->cnc;
    cnc_of(unit)->is_quiet = false;
    struct panel_request request = {.panel = cnc->panel, .technology = true, .home = -1};
    enum cnc_result result = CNC_OK;
    const char *name;
    const json_t *value;
    json_object_foreach((json_t *)params, name, value)
        if (!read_member(cnc, name, value, &request, refusal))
            return NULL;
    /* What may be refused comes first, and is taken back then. */
    const struct cnc_machine before = cnc->machine;
    if (request.has_select)
        result = cnc_select(cnc, request.select, request.technology);
    if (result == CNC_OK && request.start)
        result = cnc_start(cnc);
    if (result == CNC_OK && request.home >= 0)
        result = cnc_home(cnc, (unsigned)request.home);
    if (result != CNC_OK) {
        cnc->machine = before;
        return result_of(result, refusal);
    }
    cnc->panel = request.panel;
    if (request.stop)
        cnc_stop(cnc);
    if (request.reset)
        cnc_reset(cnc);
    if (request.has_critical)
        cnc_set_critical(cnc, request.critical);
    return json_pack("{s:I}", "t", (json_int_t)cnc->turn);
}

/* ---- State -------------------------------------------------------------------------------------------------------------- */

static json_t *call_state(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    (void)params;
    json_t *all = cnc_json_describe(unit, cnc_of(unit)->cnc.tick), *state = json_incref(json_object_get(all, "cnc"));
    if (state)
        json_object_set_new(state, "t", json_integer((json_int_t)cnc_of(unit)->cnc.turn));
    json_decref(all);
    return state ? state : cnc_refuse(refusal, true, "out of memory");
}

#define NAMES(...) (const char *const[]){__VA_ARGS__, NULL}

const struct device_method cnc_methods[] = {
    {"cnc.get", call_get, false, NAMES("cells")},
    {"cnc.set", call_set, true, NAMES("cells")},
    {"cnc.cells", call_cells, false, NAMES("search", "section", "limit")},
    {"cnc.panel", call_panel, true, NULL}, /* it reports more about its own */
    {"cnc.load", cnc_load_texts, true, NAMES("text", "plc", "machine", "name", "plc_name", "machine_name", "config")},
    {"cnc.plc", cnc_show_plc, false, NAMES("first", "lines")},
    {"cnc.state", call_state, false, (const char *const[]){NULL}},
    {NULL, NULL, false, NULL},
};
