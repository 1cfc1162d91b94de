/* SPDX-License-Identifier: MIT */
/* The panel of a CNC872: its axes, and what block, stops, PLC program, feed and spindle do, a line each. */
#include "client_panel_cnc.h"

#include <inttypes.h>
#include <stdint.h>
#include <string.h>

#define U_PER_UM 65536
#define GAP 3

/* ---- Values ----------------------------------------------------------------------------------------------------------- */

static json_int_t integer_of(const json_t *object, const char *key)
{
    return json_integer_value(json_object_get(object, key));
}

/* A position of u in mm, rounded down to um; "-" where there is none. */
static const char *position_text(const json_t *axis, const char *key, char text[32])
{
    const json_t *number = json_object_get(axis, key);
    const json_int_t u = json_integer_value(number), um = u / U_PER_UM - (u % U_PER_UM < 0), size = um < 0 ? -um : um;
    if (json_is_integer(number))
        snprintf(text, 32, "%s%" JSON_INTEGER_FORMAT ".%03d", um < 0 ? "-" : "", size / 1000, (int)(size % 1000));
    else
        strcpy(text, "-");
    return text;
}

static int put_number(struct panel *panel, int row, int column, const char *name, const json_t *object, const char *key)
{
    char text[24];
    return grid_put_whole(panel, row, column, PANEL_PLAIN, "%s %s", name, grid_number(object, key, text)) + GAP;
}

/* Names of the members that are true, "-" if there is none. */
static void put_true(struct panel *panel, int row, int column, enum panel_style style, const json_t *object)
{
    const int begin = column;
    const char *name;
    json_t *value;
    json_object_foreach((json_t *)object, name, value)
        if (json_is_true(value))
            column = grid_put_whole(panel, row, column, style, "%s", name) + GAP;
    if (column == begin)
        grid_put_whole(panel, row, column, PANEL_PLAIN, "-");
}

/* ---- Axes ------------------------------------------------------------------------------------------------------------- */

enum field { FIELD_AXIS, FIELD_STATE, FIELD_POSITION, FIELD_ACTUAL, FIELD_DIFFERENCE, FIELD_HOMED, FIELD_ENABLED, FIELDS };

/* How wide, and which of them go first when there is little room: the ones with the highest number. */
static const struct {
    const char *head;
    int width, goes;
} fields[FIELDS] = {
    [FIELD_AXIS] = {"axis", -4, 0},          [FIELD_STATE] = {"state", -9, 2},     [FIELD_POSITION] = {"mm", 11, 1},
    [FIELD_ACTUAL] = {"actual mm", 11, 4},   [FIELD_DIFFERENCE] = {"dif. um", 7, 5},    [FIELD_HOMED] = {"homed", 5, 3},
    [FIELD_ENABLED] = {"enabled", 7, 6},
};

#define GOES_FIRST 6

static void choose_fields(const struct panel *panel, int column[FIELDS])
{
    for (int most = GOES_FIRST; most >= 0; most--) {
        int at = 1;
        for (int i = 0; i < FIELDS; i++) {
            const int width = fields[i].width < 0 ? -fields[i].width : fields[i].width;
            column[i] = fields[i].goes <= most ? at : -1;
            at += column[i] >= 0 ? width + 2 : 0;
        }
        if (at - 2 <= panel->columns)
            return;
    }
}

static void put_field(struct panel *panel, int row, const int column[FIELDS], enum field field, enum panel_style style,
                      const char *text)
{
    if (column[field] >= 0)
        grid_put_whole(panel, row, column[field], style, "%*s", fields[field].width, text);
}

/* Positions of rotary axes are in degrees. */
static const char *head_of(enum field field, json_t *axes)
{
    const char *name;
    json_t *axis;
    if (field == FIELD_POSITION)
        json_object_foreach(axes, name, axis)
            if (json_is_true(json_object_get(axis, "rotary")))
                return "mm or deg";
    return fields[field].head;
}

static const char *yes_no(const json_t *axis, const char *key)
{
    return json_is_true(json_object_get(axis, key)) ? "yes" : "no";
}

static void put_axis(struct panel *panel, int row, const int column[FIELDS], const char *name, const json_t *axis)
{
    char text[32];
    put_field(panel, row, column, FIELD_AXIS, PANEL_PLAIN, name);
    put_field(panel, row, column, FIELD_STATE, PANEL_PLAIN, grid_string(axis, "state", "-"));
    put_field(panel, row, column, FIELD_POSITION, PANEL_PLAIN, position_text(axis, "position", text));
    put_field(panel, row, column, FIELD_ACTUAL, PANEL_PLAIN, position_text(axis, "actual", text));
    put_field(panel, row, column, FIELD_DIFFERENCE, PANEL_PLAIN, grid_number(axis, "difference", text));
    put_field(panel, row, column, FIELD_HOMED, PANEL_PLAIN, yes_no(axis, "homed"));
    put_field(panel, row, column, FIELD_ENABLED, PANEL_PLAIN, yes_no(axis, "enabled"));
}

/* ---- Lines ------------------------------------------------------------------------------------------------------------ */

#define LINE_LEFT 10

static void put_block(struct panel *panel, int row, const json_t *cnc)
{
    const json_t *block = json_object_get(cnc, "block");
    int column = grid_put_whole(panel, row, LINE_LEFT, PANEL_PLAIN, "%s", grid_string(block, "phase", "-")) + GAP;
    column = put_number(panel, row, column, "block", block, "block");
    column = put_number(panel, row, column, "line", block, "line");
    column = put_number(panel, row, column, "next", block, "next");
    put_number(panel, row, column, "of", block, "blocks");
}

/* u/T are 15/16384 mm/min. */
static void put_feed(struct panel *panel, int row, const json_t *cnc)
{
    const json_t *switches = json_object_get(cnc, "panel");
    const json_int_t speed = integer_of(cnc, "speed"), tenths = speed / 16384 * 150 + (speed % 16384 * 150 + 8192) / 16384;
    int column = grid_put_whole(panel, row, LINE_LEFT, PANEL_PLAIN, "%" JSON_INTEGER_FORMAT ".%d mm/min", tenths / 10,
                                (int)(tenths % 10)) + GAP;
    column = grid_put_whole(panel, row, column, PANEL_PLAIN, "feed %" JSON_INTEGER_FORMAT " %%",
                            integer_of(switches, "feed")) + GAP;
    column = grid_put_whole(panel, row, column, PANEL_PLAIN, "%s", grid_string(switches, "mode", "-")) + GAP;
    put_true(panel, row, column, PANEL_PLAIN, switches);
}

static void put_stops(struct panel *panel, int row, const json_t *cnc)
{
    put_true(panel, row, LINE_LEFT, PANEL_WRONG, json_object_get(cnc, "stops"));
}

static void put_plc(struct panel *panel, int row, const json_t *cnc)
{
    static const char *const passes[] = {"-", "init", "move", "delay", "done"};
    const json_int_t pass = integer_of(cnc, "plc_pass"), error = integer_of(cnc, "plc_error");
    const json_int_t critical = integer_of(cnc, "critical");
    int column = grid_put_whole(panel, row, LINE_LEFT, PANEL_PLAIN, "pass %s", pass >= 0 && pass <= 4 ? passes[pass] : "?") + GAP;
    column = grid_put_whole(panel, row, column, error != 0 ? PANEL_WRONG : PANEL_PLAIN, "error %" PRIX64 "h", (uint64_t)error);
    if (critical != 0)
        grid_put_whole(panel, row, column + GAP, PANEL_WRONG, "critical error %" JSON_INTEGER_FORMAT, critical);
}

/* A speed of 1/1000 rev/min in rev/min, rounded to tenths; "-" where there is none. */
static const char *turns_text(const json_t *spindle, const char *key, char text[32])
{
    const json_int_t number = integer_of(spindle, key), tenths = (number < 0 ? number - 50 : number + 50) / 100;
    const json_int_t size = tenths < 0 ? -tenths : tenths;
    if (json_is_integer(json_object_get(spindle, key)))
        snprintf(text, 32, "%s%" JSON_INTEGER_FORMAT ".%d", tenths < 0 ? "-" : "", size / 10, (int)(size % 10));
    else
        strcpy(text, "-");
    return text;
}

static void put_spindle(struct panel *panel, int row, const json_t *cnc)
{
    const json_t *spindle = json_object_get(cnc, "spindle");
    char actual[32], required[32];
    int column = grid_put_whole(panel, row, LINE_LEFT, PANEL_PLAIN, "%s", grid_string(spindle, "turns", "-")) + GAP;
    column = grid_put_whole(panel, row, column, PANEL_PLAIN, "%s of %s rev/min", turns_text(spindle, "actual", actual),
                            turns_text(spindle, "required", required)) + GAP;
    column = put_number(panel, row, column, "gear", spindle, "gear");
    grid_put_whole(panel, row, column, PANEL_PLAIN, "spindle %" JSON_INTEGER_FORMAT " %%",
                   integer_of(json_object_get(cnc, "panel"), "spindle"));
}

/* The last of them goes first when there is little room. */
static const struct {
    const char *name;
    void (*put)(struct panel *panel, int row, const json_t *cnc);
} lines[] = {{"block", put_block}, {"feed", put_feed}, {"stops", put_stops}, {"PLC", put_plc}, {"spindle", put_spindle}};

#define LINES ((int)(sizeof lines / sizeof lines[0]))

/* ---- Displays --------------------------------------------------------------------------------------------------------- */

#define DISPLAY_STEP 19 /* columns from one to the next */

static const char *display_line(const json_t *cnc, size_t display, int line)
{
    const json_t *shown = json_array_get(json_object_get(cnc, "displays"), display);
    const char *text = json_string_value(json_array_get(json_object_get(shown, "lines"), (size_t)line));
    return text != NULL ? text : "";
}

/* Rows for the displays with their heads: up to the last line in which something is written, none if nothing is. */
static int display_rows(const json_t *cnc)
{
    int rows = 0;
    size_t at;
    const json_t *display;
    json_array_foreach(json_object_get(cnc, "displays"), at, display)
        for (int line = 0; line < (int)json_array_size(json_object_get(display, "lines")); line++)
            if (strspn(display_line(cnc, at, line), " ") < strlen(display_line(cnc, at, line)) && line >= rows)
                rows = line + 1;
    return rows > 0 ? rows + 1 : 0;
}

static void put_displays(struct panel *panel, int row, int rows, const json_t *cnc)
{
    for (size_t at = 0; at < json_array_size(json_object_get(cnc, "displays")); at++) {
        const int column = 1 + (int)at * DISPLAY_STEP;
        grid_put_whole(panel, row, column, PANEL_HEAD, "display %d", (int)at + 1);
        for (int line = 0; line + 1 < rows; line++)
            grid_put_whole(panel, row + 1 + line, column, PANEL_PLAIN, "%s", display_line(cnc, at, line));
    }
}

/* ---- All -------------------------------------------------------------------------------------------------------------- */

#define AXES_FIRST 3 /* axes that have room before the lines */

/* How many of `wanted` rows have room; they are taken from `room`. */
static int take_rows(int *room, int wanted)
{
    const int taken = *room < wanted ? *room < 0 ? 0 : *room : wanted;
    *room -= taken;
    return taken;
}

/* All of `wanted` rows, or none. */
static int take_all_rows(int *room, int wanted)
{
    return *room < wanted ? 0 : take_rows(room, wanted);
}

/* The axes, in so many rows; the last of them says how many have no room. Returns the row behind them. */
static int put_axes(struct panel *panel, int row, int rows, const int column[FIELDS], json_t *axes)
{
    const char *name;
    json_t *axis;
    int left = (int)json_object_size(axes);
    json_object_foreach(axes, name, axis) {
        if (rows == 0)
            break;
        if (rows == 1 && left > 1) {
            grid_put_whole(panel, row, 1, PANEL_DARK, "%d more axes: not enough rows", left);
            return row + 1;
        }
        put_axis(panel, row++, column, name, axis);
        rows--;
        left--;
    }
    return row;
}

void client_panel_draw_cnc(struct panel *panel, const struct panel_view *view, int rows)
{
    const json_t *cnc = json_object_get(view->state, "cnc");
    json_t *axes = json_object_get(cnc, "axes");
    const int all = (int)json_object_size(axes), first = all < AXES_FIRST ? all : AXES_FIRST;
    int column[FIELDS], room = rows < PANEL_ROWS ? rows : PANEL_ROWS, line = 0;
    int row = take_rows(&room, 1), shown = take_rows(&room, first);
    const int count = take_rows(&room, LINES);
    shown += take_rows(&room, all - shown);
    const int head = take_rows(&room, 1), keys = take_rows(&room, view->keys ? 1 : 0);
    const int gaps = take_all_rows(&room, 2 + keys) > 0 ? 1 : 0, wanted = display_rows(cnc);
    const int displays = take_all_rows(&room, wanted > 0 ? wanted + gaps : 0);
    choose_fields(panel, column);
    panel->rows = PANEL_ROWS; /* what is drawn below sets how many there are */
    for (int i = 0; i < PANEL_ROWS; i++)
        grid_fill_row(panel, i, PANEL_PLAIN);
    row += gaps;
    for (int i = 0; i < FIELDS && head; i++)
        put_field(panel, row, column, (enum field)i, PANEL_HEAD, head_of((enum field)i, axes));
    row = put_axes(panel, row + head, shown, column, axes);
    for (row += gaps; line < count; line++, row++) {
        grid_put_whole(panel, row, 1, PANEL_PLAIN, "%s", lines[line].name);
        lines[line].put(panel, row, cnc);
    }
    if (displays > 0)
        put_displays(panel, row + gaps, wanted, cnc);
    row += displays + gaps * keys;
    if (keys)
        grid_put(panel, row++, 1, PANEL_DARK, "%s", view->keys);
    panel->rows = row;
}
