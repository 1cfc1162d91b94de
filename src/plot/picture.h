/* SPDX-License-Identifier: MIT */
/* picture.h: what the forms of a picture share. Private. */
#ifndef RKM04_PLOT_PICTURE_H
#define RKM04_PLOT_PICTURE_H

#include <stdio.h>

#include "draw.h"

/* px. */
double plot_height(const struct plot_curves *curves, const struct plot_view *view);

/* Text for XML and HTML. */
void plot_text(FILE *out, const char *text);

#endif
