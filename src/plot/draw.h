/* SPDX-License-Identifier: MIT */
/* draw.h: curves as a picture. */
#ifndef RKM04_PLOT_DRAW_H
#define RKM04_PLOT_DRAW_H

#include <stdio.h>

#include "curves.h"

#define PLOT_WIDTH_MIN 240u
#define PLOT_WIDTH_MAX 8000u

struct plot_view {
    const char *title;   /* UTF-8 */
    unsigned width;      /* px, PLOT_WIDTH_MIN..PLOT_WIDTH_MAX */
    double from, to;     /* us; from < to */
};

/* A complete SVG file: light or dark as its reader likes. What goes wrong shows in ferror(). */
void plot_draw_svg(FILE *out, const struct plot_curves *curves, const struct plot_view *view);

/* A page with that picture, which zooms and shows values under the pointer; it loads nothing. */
void plot_draw_html(FILE *out, const struct plot_curves *curves, const struct plot_view *view);

/* Rows `t_us,motor,speed,position`: the corners between which the acceleration is constant. */
void plot_draw_csv(FILE *out, const struct plot_curves *curves, const struct plot_view *view);

#endif
