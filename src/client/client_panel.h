/* SPDX-License-Identifier: MIT */
/* client_panel.h: the front panel of a unit as a grid of characters, drawn from the result of `state` (docs/CONTROL.md): for the
 * terminal (client_watch.h) and as text. It is laid out again for each size: what matters least goes first. */
#ifndef RKM04_CLIENT_PANEL_H
#define RKM04_CLIENT_PANEL_H

#include "client_panel_grid.h"

/* Draw the panel for a terminal of this size, of which it takes as much as it needs and has. Whatever `state` lacks is shown as
 * a dash. */
void client_panel_draw(struct panel *panel, const struct panel_view *view, int rows, int columns);

/* Print it as lines of text, without blanks at their ends. */
void client_panel_print(const struct panel *panel, FILE *file);

#endif
