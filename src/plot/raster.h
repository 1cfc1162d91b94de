/* SPDX-License-Identifier: MIT */
/* raster.h: an SVG as PNG, by librsvg's program rsvg-convert: it draws as browsers do, and who makes no PNG does not need it. */
#ifndef RKM04_PLOT_RASTER_H
#define RKM04_PLOT_RASTER_H

#include <stdbool.h>
#include <stdio.h>

/* Write the picture in `svg`, a file open for reading at its beginning, to `png`, `scale` px for each px of it, 1..4.
 * Returns NULL, or why it did not work, for a message. */
const char *plot_rasterize(FILE *svg, FILE *png, unsigned scale);

#endif
