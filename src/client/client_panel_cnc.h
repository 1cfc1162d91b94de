/* SPDX-License-Identifier: MIT */
/* client_panel_cnc.h: the panel of a CNC872. */
#ifndef RKM04_CLIENT_PANEL_CNC_H
#define RKM04_CLIENT_PANEL_CNC_H

#include "client_panel_grid.h"

/* Draw all but the title, which has the first row, of a unit whose state has `cnc`, into a panel whose columns are set and that
 * has up to `rows` rows. Sets how many it has. */
void client_panel_draw_cnc(struct panel *panel, const struct panel_view *view, int rows);

#endif
