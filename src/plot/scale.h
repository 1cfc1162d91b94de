/* SPDX-License-Identifier: MIT */
/* scale.h: round numbers along an axis, and a value's place on it. Private. */
#ifndef RKM04_PLOT_SCALE_H
#define RKM04_PLOT_SCALE_H

struct plot_scale {
    double low, high; /* values at the two ends */
    double step;      /* between two marks */
    double size;      /* px from low to high */
};

/* An axis of `size` px that shows low..high, its ends at marks, about `parts` of them. */
struct plot_scale plot_scale_around(double low, double high, double size, unsigned parts);

/* One that shows from..to exactly, with at most `parts` marks. */
struct plot_scale plot_scale_exact(double from, double to, double size, unsigned parts);

/* px from the end `low`. */
double plot_scale_place(const struct plot_scale *scale, double value);

#endif
