/* SPDX-License-Identifier: MIT */
/* client_panel_grid.h: the grid that panels are drawn into. Beyond its edges nothing is drawn. */
#ifndef RKM04_CLIENT_PANEL_GRID_H
#define RKM04_CLIENT_PANEL_GRID_H

#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>
#include <wchar.h>

#define PANEL_ROWS 48
#define PANEL_COLUMNS 120

enum panel_style { PANEL_PLAIN, PANEL_TITLE, PANEL_HEAD, PANEL_LIT, PANEL_DARK, PANEL_WRONG, PANEL_STYLES };

struct panel_cell {
    wchar_t character;
    unsigned char style; /* enum panel_style */
};

struct panel {
    int rows, columns; /* of the grid, up to PANEL_ROWS and PANEL_COLUMNS */
    struct panel_cell cell[PANEL_ROWS][PANEL_COLUMNS];
};

struct panel_view {
    const json_t *state; /* result of `state` */
    const json_t *units; /* names of the units of the line; NULL: not to be shown */
    const char *keys;    /* what can be pressed; NULL: nothing */
    bool round;          /* lamps as circles of Unicode, otherwise * and . */
};

/* Put text, of which only printable ASCII is shown as it is. Returns the column after it. */
int grid_put(struct panel *panel, int row, int column, enum panel_style style, const char *format, ...)
    __attribute__((format(printf, 5, 6)));

/* Put text if all of it has room: part of a number would be another number. Returns the column after it, beyond the last one if
 * it has none: what would follow has none, either. */
int grid_put_whole(struct panel *panel, int row, int column, enum panel_style style, const char *format, ...)
    __attribute__((format(printf, 5, 6)));

void grid_fill_row(struct panel *panel, int row, enum panel_style style);
void grid_put_lamp(struct panel *panel, const struct panel_view *view, int row, int column, bool lit);

/* A whole number as text, "-" where there is none. */
const char *grid_number(const json_t *object, const char *key, char text[24]);

/* A string, `missing` where there is none. */
const char *grid_string(const json_t *object, const char *key, const char *missing);

#endif
