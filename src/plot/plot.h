/* SPDX-License-Identifier: MIT */
/* plot.h: pictures of what motors do: speed and position over time, as in the manual's figures; the face of the room.
 *
 *     curves        what a picture shows; pure
 *     collect       fills curves from a sim while it runs: the speed that is planned, not the reciprocal of intervals
 *     read_trace    fills curves from a trace file, which has pulses only
 *     draw          curves as SVG, as a page that zooms, as CSV
 *     raster        an SVG as PNG
 *
 * Nothing here moves a unit. `rkm04 plot` (room run) has the options. */
#ifndef RKM04_PLOT_H
#define RKM04_PLOT_H

#include "collect.h"
#include "curves.h"
#include "draw.h"
#include "raster.h"
#include "read_trace.h"

#endif
