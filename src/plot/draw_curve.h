/* SPDX-License-Identifier: MIT */
/* draw_curve.h: the curves of one motor as paths, in px of a panel. Private. */
#ifndef RKM04_PLOT_DRAW_CURVE_H
#define RKM04_PLOT_DRAW_CURVE_H

#include <stdio.h>

#include "curves.h"
#include "scale.h"

/* The attribute d of the speed over time: straight lines. y grows downwards. */
void plot_path_speed(FILE *out, const struct plot_motor *motor, const struct plot_scale *time, const struct plot_scale *speed);

/* Of the position: parabolas, drawn exactly. */
void plot_path_position(FILE *out, const struct plot_motor *motor, const struct plot_scale *time,
                        const struct plot_scale *position);

/* Of where the plant is. */
void plot_path_truth(FILE *out, const struct plot_motor *motor, const struct plot_scale *time, const struct plot_scale *position);

#endif
