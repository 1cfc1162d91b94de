/* SPDX-License-Identifier: MIT */
#include "client_panel_grid.h"

#include <inttypes.h>
#include <stdarg.h>
#include <string.h>

#define TEXT_MAX 160

/* ---- The grid --------------------------------------------------------------------------------------------------------- */

static void grid_put_character(struct panel *panel, int row, int column, enum panel_style style, wchar_t character)
{
    if (row >= 0 && row < panel->rows && column >= 0 && column < panel->columns)
        panel->cell[row][column] = (struct panel_cell){character, (unsigned char)style};
}

/* Put text, of which only printable ASCII is shown as it is. Returns the column after it. */
int grid_put(struct panel *panel, int row, int column, enum panel_style style, const char *format, ...)
{
    char text[TEXT_MAX];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    for (const char *at = text; *at != '\0'; at++)
        grid_put_character(panel, row, column++, style, *at >= 0x20 && *at < 0x7F ? (wchar_t)*at : L'?');
    return column;
}

/* Put text if all of it has room: part of a number would be another number. Returns the column after it, beyond the last one if
 * it has none: what would follow has none, either. */
int grid_put_whole(struct panel *panel, int row, int column, enum panel_style style, const char *format, ...)
{
    char text[TEXT_MAX];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (column + (int)strlen(text) > panel->columns)
        return panel->columns + 1;
    return grid_put(panel, row, column, style, "%s", text);
}

void grid_fill_row(struct panel *panel, int row, enum panel_style style)
{
    for (int column = 0; column < panel->columns; column++)
        grid_put_character(panel, row, column, style, L' ');
}

void grid_put_lamp(struct panel *panel, const struct panel_view *view, int row, int column, bool lit)
{
    wchar_t on = view->round ? L'\u25CF' : L'*', off = view->round ? L'\u25CB' : L'.';
    grid_put_character(panel, row, column, lit ? PANEL_LIT : PANEL_DARK, lit ? on : off);
}

/* A whole number as text, "-" where there is none. */
const char *grid_number(const json_t *object, const char *key, char text[24])
{
    const json_t *number = json_object_get(object, key);
    if (json_is_integer(number))
        snprintf(text, 24, "%" JSON_INTEGER_FORMAT, json_integer_value(number));
    else
        strcpy(text, "-");
    return text;
}

const char *grid_string(const json_t *object, const char *key, const char *missing)
{
    const char *text = json_string_value(json_object_get(object, key));
    return text != NULL ? text : missing;
}
