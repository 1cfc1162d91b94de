/* SPDX-License-Identifier: MIT */
#include "scale.h"

#include <math.h>

/* 1, 2 or 5 times a power of ten, not less than `least`. */
static double round_up(double least)
{
    double power = pow(10, floor(log10(least))), part = least / power;
    if (part <= 1.0000001)
        return power;
    return part <= 2 ? 2 * power : part <= 5 ? 5 * power : 10 * power;
}

struct plot_scale plot_scale_around(double low, double high, double size, unsigned parts)
{
    if (high - low < 1e-9)
        high = low + 1;
    double step = round_up((high - low) / parts);
    return (struct plot_scale){floor(low / step + 1e-9) * step, ceil(high / step - 1e-9) * step, step, size};
}

struct plot_scale plot_scale_exact(double from, double to, double size, unsigned parts)
{
    return (struct plot_scale){from, to, round_up((to - from) / (parts > 0 ? parts : 1)), size};
}

double plot_scale_place(const struct plot_scale *scale, double value)
{
    return (value - scale->low) / (scale->high - scale->low) * scale->size;
}
