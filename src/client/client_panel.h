/* SPDX-License-Identifier: MIT */
/* client_panel.h: the front panel of a unit as a grid of characters, drawn from the result of `state` (docs/CONTROL.md): for the
 * terminal (client_watch.h) and as text. It is laid out again for each size: what matters least goes first. */
#ifndef RKM04_CLIENT_PANEL_H
#define RKM04_CLIENT_PANEL_H

#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>
#include <wchar.h>

#define PANEL_ROWS 24
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

/* Draw the panel for a terminal of this size, of which it takes as much as it needs and has. Whatever `state` lacks is shown as
 * a dash. */
void client_panel_draw(struct panel *panel, const struct panel_view *view, int rows, int columns);

/* Print it as lines of text, without blanks at their ends. */
void client_panel_print(const struct panel *panel, FILE *file);

#endif
