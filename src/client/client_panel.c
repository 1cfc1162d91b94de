/* SPDX-License-Identifier: MIT */
#include "client_panel.h"

#include <inttypes.h>
#include <stdint.h>
#include <string.h>

#include "client_panel_cnc.h"

#define MOTORS 4 /* that have room */
#define LAMPS_MAX 16

/* ---- Values ----------------------------------------------------------------------------------------------------------- */

static unsigned mask_of(const json_t *object, const char *key)
{
    return (unsigned)json_integer_value(json_object_get(object, key));
}

static bool is_powered(const struct panel_view *view)
{
    return !json_is_false(json_object_get(view->state, "powered"));
}

/* A number of the device: "inputs", "outputs", "variables", "first_variable"; `usual`: the RKM04's, whose state has none. */
static unsigned number_of(const struct panel_view *view, const char *key, unsigned usual)
{
    const json_t *device = json_object_get(view->state, "device");
    return device != NULL ? (unsigned)json_integer_value(json_object_get(device, key)) : usual;
}

static unsigned lamps_of(const struct panel_view *view, const char *key, unsigned usual)
{
    unsigned count = number_of(view, key, usual);
    return count < LAMPS_MAX ? count : LAMPS_MAX;
}

static unsigned motors_of(const struct panel_view *view)
{
    unsigned count = number_of(view, "axes", MOTORS);
    return count < MOTORS ? count : MOTORS;
}

/* ---- The motors ------------------------------------------------------------------------------------------------------- */

enum field { FIELD_MOTOR, FIELD_LED, FIELD_STATE, FIELD_POSITION, FIELD_TRUE, FIELD_SPEED, FIELD_PLACE, FIELD_COMMAND, FIELDS };

/* How wide, and which of them go first when there is little room: the ones with the highest number. */
static const struct {
    const char *head;
    int width;
    int goes;
    bool right;
} fields[FIELDS] = {
    [FIELD_MOTOR] = {"M", 1, 0, false},
    [FIELD_LED] = {"LED", 3, 0, false},
    [FIELD_STATE] = {"state", 7, 2, false},
    [FIELD_POSITION] = {"position", 11, 1, true},
    [FIELD_TRUE] = {"true pos.", 11, 4, true},
    [FIELD_SPEED] = {"speed", 6, 3, true},
    [FIELD_PLACE] = {"place", 5, 6, true},
    [FIELD_COMMAND] = {"command", 9, 5, false},
};

#define GOES_FIRST 6
#define GAP 2

/* Does the unit have a plant? */
static bool has_plant(const json_t *state)
{
    size_t i;
    json_t *motor;
    json_array_foreach(json_object_get(state, "motors"), i, motor)
        if (json_is_integer(json_object_get(motor, "true_position")))
            return true;
    return false;
}

/* Choose the fields that there is room for: column[] is -1 for the others. */
static void choose_fields(const struct panel_view *view, int columns, int column[FIELDS])
{
    for (int most = GOES_FIRST; most >= 0; most--) {
        int at = 1;
        for (int i = 0; i < FIELDS; i++) {
            bool shown = fields[i].goes <= most && (i != FIELD_TRUE || has_plant(view->state));
            column[i] = shown ? at : -1;
            at += shown ? fields[i].width + GAP : 0;
        }
        if (at - GAP <= columns)
            return;
    }
}

static void put_field(struct panel *panel, int row, const int column[FIELDS], enum field field, enum panel_style style,
                      const char *text)
{
    if (column[field] < 0)
        return;
    if (field == FIELD_COMMAND)
        grid_put_whole(panel, row, column[field], style, "%s", text);
    else if (fields[field].right)
        grid_put(panel, row, column[field], style, "%*.*s", fields[field].width, fields[field].width, text);
    else
        grid_put(panel, row, column[field], style, "%-*.*s", fields[field].width, fields[field].width, text);
}

/* What the command waits for, as far as there is room for it: "10 of 5000 steps", "10/5000", or nothing. Returns the column
 * after it. */
static int put_wait(struct panel *panel, int row, int column, const char *waits_for)
{
    const char *progress = strstr(waits_for, ": "); /* "the end of R: 10 of 5000 steps done" */
    const char *shown = progress != NULL ? progress + 2 : waits_for;
    const char *done = progress != NULL ? strstr(shown, " done") : NULL, *of = done != NULL ? strstr(shown, " of ") : NULL;
    int length = done != NULL ? (int)(done - shown) : (int)strlen(shown);
    if (of == NULL || column + 2 + length <= panel->columns)
        return grid_put_whole(panel, row, column, PANEL_PLAIN, "  %.*s", length, shown);
    return grid_put_whole(panel, row, column, PANEL_PLAIN, "  %.*s/%.*s", (int)(of - shown), shown, (int)strcspn(of + 4, " "),
                          of + 4);
}

/* Guards that are armed, as the commands that armed them: "  X04  M01". */
static void put_guards(struct panel *panel, int row, int column, const json_t *motor)
{
    static const char *const keys[] = {"x", "m", "n"};
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
        const json_t *input = json_object_get(json_object_get(motor, "guards"), keys[i]);
        if (json_is_integer(input))
            column = grid_put_whole(panel, row, column, PANEL_PLAIN, "  %c%02d", keys[i][0] - 'a' + 'A',
                                    (int)json_integer_value(input));
    }
}

static void put_command(struct panel *panel, int row, const int column[FIELDS], const json_t *motor)
{
    const char *fault = grid_string(motor, "fault", NULL), *waits_for = grid_string(motor, "waits_for", NULL);
    int at = column[FIELD_COMMAND];
    bool wrong = fault != NULL && strcmp(fault, "none") != 0;
    if (at < 0)
        return;
    at = grid_put_whole(panel, row, at, wrong ? PANEL_WRONG : PANEL_PLAIN, "%s", grid_string(motor, "command", "-"));
    if (wrong) {
        grid_put_whole(panel, row, at, PANEL_WRONG, "  fault: %s", fault);
        return;
    }
    if (waits_for != NULL)
        at = put_wait(panel, row, at, waits_for);
    put_guards(panel, row, at, motor);
}

static void put_motor(struct panel *panel, const struct panel_view *view, int row, const int column[FIELDS], unsigned number)
{
    const json_t *motor = json_array_get(json_object_get(view->state, "motors"), number - 1);
    char text[24], signed_text[26];
    const char *speed = grid_number(motor, "speed", text);
    bool back = json_is_false(json_object_get(motor, "forward")) && strspn(speed, "123456789") > 0;
    snprintf(signed_text, sizeof signed_text, "%s%s", back ? "-" : "", speed);
    grid_put(panel, row, column[FIELD_MOTOR], PANEL_PLAIN, "%u", number);
    grid_put_lamp(panel, view, row, column[FIELD_LED] + 1, json_is_true(json_object_get(motor, "lit")));
    put_field(panel, row, column, FIELD_SPEED, PANEL_PLAIN, signed_text);
    const char *state = grid_string(motor, "state", "-");
    bool wrong = strncmp(state, "fault", 5) == 0;
    put_field(panel, row, column, FIELD_STATE, wrong ? PANEL_WRONG : PANEL_PLAIN, state);
    put_field(panel, row, column, FIELD_POSITION, PANEL_PLAIN, grid_number(motor, "position", text));
    put_field(panel, row, column, FIELD_TRUE, PANEL_PLAIN, grid_number(motor, "true_position", text));
    grid_number(motor, "index", text);
    put_field(panel, row, column, FIELD_PLACE, PANEL_PLAIN, strcmp(text, "0") == 0 ? "-" : text);
    put_command(panel, row, column, motor);
}

/* ---- Lamps ------------------------------------------------------------------------------------------------------------ */

#define LAMPS_LEFT 6

/* How many columns from lamp to lamp: numbers have room above them, or not. */
static int lamp_step(const struct panel *panel)
{
    return LAMPS_LEFT + 16 * 3 <= panel->columns ? 3 : LAMPS_LEFT + 16 * 2 <= panel->columns ? 2 : 1;
}

static void put_lamps(struct panel *panel, const struct panel_view *view, int row, const char *key, unsigned count)
{
    char name[8] = "";
    for (size_t i = 0; key[i] != '\0'; i++)
        name[i] = (char)(key[i] - 'a' + 'A');
    grid_put(panel, row, 1, PANEL_PLAIN, "%s", name);
    for (unsigned i = 0; i < count; i++)
        grid_put_lamp(panel, view, row, LAMPS_LEFT + (int)i * lamp_step(panel) + lamp_step(panel) / 2,
                 (mask_of(view->state, key) >> i & 1) != 0);
}

static void put_numbers(struct panel *panel, int row, unsigned first, unsigned count)
{
    for (unsigned i = 0; i < count && lamp_step(panel) == 3; i++)
        grid_put(panel, row, LAMPS_LEFT + (int)i * 3, PANEL_DARK, "%02u", first + i);
}

/* ---- Rows ------------------------------------------------------------------------------------------------------------- */

enum row {
    ROW_TITLE, ROW_GAP_1, ROW_HEAD, ROW_MOTOR_1, ROW_MOTOR_2, ROW_MOTOR_3, ROW_MOTOR_4, ROW_GAP_2, ROW_NUMBERS, ROW_DI, ROW_DO,
    ROW_GAP_3, ROW_VAR_NUMBERS, ROW_VAR, ROW_GAP_4, ROW_COUNTERS, ROW_WIRES, ROW_GAP_5, ROW_KEYS, ROWS
};

/* Which of them go first when there is little room: the ones with the highest number. */
static const int row_goes[ROWS] = {
    [ROW_GAP_1] = 12, [ROW_GAP_5] = 12, [ROW_GAP_3] = 11, [ROW_GAP_2] = 10, [ROW_GAP_4] = 9, [ROW_WIRES] = 8,
    [ROW_VAR_NUMBERS] = 7, [ROW_NUMBERS] = 6, [ROW_KEYS] = 5, [ROW_COUNTERS] = 4, [ROW_HEAD] = 3, [ROW_VAR] = 2,
    [ROW_DI] = 1, [ROW_DO] = 1,
};

#define ROW_GOES_FIRST 12

/* Has the unit nothing to show in this row? */
static bool is_missing(const struct panel_view *view, int row)
{
    const unsigned inputs = lamps_of(view, "inputs", 8), outputs = lamps_of(view, "outputs", 8);
    switch (row) {
    case ROW_GAP_3:
    case ROW_VAR_NUMBERS:
    case ROW_VAR:
        return lamps_of(view, "variables", 16) == 0;
    case ROW_DI:
        return inputs == 0;
    case ROW_DO:
        return outputs == 0;
    case ROW_GAP_2:
    case ROW_NUMBERS:
        return inputs + outputs == 0;
    case ROW_GAP_4:
    case ROW_COUNTERS:
    case ROW_WIRES:
        return json_is_false(json_object_get(json_object_get(view->state, "device"), "bus"));
    case ROW_KEYS:
    case ROW_GAP_5:
        return view->keys == NULL;
    default:
        return row >= ROW_MOTOR_1 + (int)motors_of(view) && row <= ROW_MOTOR_4;
    }
}

/* Choose the rows that there is room for: at[] is -1 for the others. Returns how many there are. */
static int choose_rows(const struct panel_view *view, int rows, int lamps, int at[ROWS])
{
    int count = 0;
    for (int most = ROW_GOES_FIRST; most >= 0; most--) {
        count = 0;
        for (int i = 0; i < ROWS; i++) {
            bool numbers = i == ROW_NUMBERS || i == ROW_VAR_NUMBERS;
            bool shown = row_goes[i] <= most && (!numbers || lamps == 3) && !is_missing(view, i);
            at[i] = shown ? count++ : -1;
        }
        if (count <= rows)
            break;
    }
    return count <= rows ? count : rows;
}

static void put_title(struct panel *panel, const struct panel_view *view, int row)
{
    size_t i;
    json_t *unit;
    json_int_t t_us = json_integer_value(json_object_get(view->state, "t_us"));
    const char *name = grid_string(view->state, "unit", "-");
    if (row < 0)
        return;
    grid_fill_row(panel, row, PANEL_TITLE);
    int column = grid_put_whole(panel, row, 1, PANEL_TITLE, "%s unit %s",
                                grid_string(json_object_get(view->state, "device"), "name", "RKM04"), name);
    if (!is_powered(view))
        column = grid_put_whole(panel, row, column, PANEL_TITLE, ": no power");
    column = grid_put_whole(panel, row, column + 2, PANEL_TITLE, "%" PRId64 ".%06d s", (int64_t)(t_us / 1000000),
                            (int)(t_us % 1000000));
    column = grid_put_whole(panel, row, column + 2, PANEL_TITLE, "clock %s", grid_string(view->state, "clock", "-"));
    if (json_is_true(json_object_get(view->state, "simulation")))
        column = grid_put_whole(panel, row, column + 2, PANEL_TITLE, "simulation");
    if (json_array_size(view->units) < 2)
        return;
    column = grid_put_whole(panel, row, column + 2, PANEL_TITLE, "units");
    json_array_foreach(view->units, i, unit) {
        const char *other = json_string_value(unit) != NULL ? json_string_value(unit) : "-";
        column = grid_put_whole(panel, row, column + 1, PANEL_TITLE, strcmp(other, name) == 0 ? "[%s]" : "%s", other);
    }
}

static void put_count(struct panel *panel, int row, int *column, const json_t *counters, const char *key, const char *text)
{
    char number[24];
    *column = grid_put_whole(panel, row, *column, PANEL_PLAIN, "%s %s", grid_number(counters, key, number), text) + 3;
}

static void put_counters(struct panel *panel, const struct panel_view *view, const int at[ROWS])
{
    const json_t *counters = json_object_get(view->state, "counters"), *line = json_object_get(view->state, "line");
    int row = at[ROW_COUNTERS], column = 1;
    put_count(panel, row, &column, counters, "requests", "requests");
    put_count(panel, row, &column, counters, "answers", "answers");
    put_count(panel, row, &column, counters, "others", "for others");
    put_count(panel, row, &column, counters, "dropped", "dropped");
    row = at[ROW_WIRES];
    column = 1;
    put_count(panel, row, &column, line, "bytes", "bytes on the line");
    put_count(panel, row, &column, line, "collisions", "collisions");
    put_count(panel, row, &column, line, "framing_errors", "framing errors");
}

void client_panel_draw(struct panel *panel, const struct panel_view *view, int rows, int columns)
{
    int at[ROWS], column[FIELDS];
    *panel = (struct panel){.columns = columns < PANEL_COLUMNS ? columns : PANEL_COLUMNS};
    if (json_object_get(view->state, "cnc") != NULL) {
        client_panel_draw_cnc(panel, view, rows);
        put_title(panel, view, 0);
        return;
    }
    panel->rows = choose_rows(view, rows < PANEL_ROWS ? rows : PANEL_ROWS, lamp_step(panel), at);
    for (int row = 0; row < panel->rows; row++)
        grid_fill_row(panel, row, PANEL_PLAIN);
    put_title(panel, view, at[ROW_TITLE]);
    choose_fields(view, panel->columns, column);
    for (int i = 0; i < FIELDS; i++)
        put_field(panel, at[ROW_HEAD], column, (enum field)i, PANEL_HEAD, fields[i].head);
    for (unsigned motor = 1; motor <= motors_of(view); motor++)
        put_motor(panel, view, at[ROW_MOTOR_1 + motor - 1], column, motor);
    unsigned inputs = lamps_of(view, "inputs", 8), outputs = lamps_of(view, "outputs", 8);
    put_numbers(panel, at[ROW_NUMBERS], 1, inputs > outputs ? inputs : outputs);
    put_lamps(panel, view, at[ROW_DI], "di", inputs);
    put_lamps(panel, view, at[ROW_DO], "do", outputs);
    put_numbers(panel, at[ROW_VAR_NUMBERS], number_of(view, "first_variable", 80), lamps_of(view, "variables", 16));
    put_lamps(panel, view, at[ROW_VAR], "var", lamps_of(view, "variables", 16));
    put_counters(panel, view, at);
    if (view->keys != NULL)
        grid_put(panel, at[ROW_KEYS], 1, PANEL_DARK, "%s", view->keys);
}

void client_panel_print(const struct panel *panel, FILE *file)
{
    for (int row = 0; row < panel->rows; row++) {
        int length = panel->columns;
        while (length > 0 && panel->cell[row][length - 1].character == L' ')
            length--;
        for (int column = 0; column < length; column++)
            fputc(panel->cell[row][column].character < 0x7F ? (int)panel->cell[row][column].character : '?', file);
        fputc('\n', file);
    }
}
