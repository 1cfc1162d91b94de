/* SPDX-License-Identifier: MIT */
#include "draw.h"

#include <math.h>

/* Without a minus in front of 0.000. */
static double rounded(double value)
{
    return fabs(value) < 0.0005 ? 0 : value;
}

void plot_draw_csv(FILE *out, const struct plot_curves *curves, const struct plot_view *view)
{
    fputs("t_us,motor,speed,position\n", out);
    for (unsigned i = 0; i < curves->motors; i++) {
        const struct plot_motor *motor = &curves->motor[i];
        for (size_t k = plot_find(motor, view->from); motor->is_used && k < motor->points; k++) {
            const struct plot_point *point = &motor->point[k];
            if (point->us > view->to)
                break;
            fprintf(out, "%.3f,%u,%.3f,%.3f\n", point->us, i + 1, rounded(point->speed), rounded(point->position));
        }
    }
}
