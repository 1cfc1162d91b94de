/* SPDX-License-Identifier: MIT */
/* A run can have more corners than a picture has px: then each px shows the lowest and the highest of its corners. */
#include "draw_curve.h"

#include <math.h>

#define CORNERS_A_PX 3u

static double value_of(const struct plot_point *point, bool speed)
{
    return speed ? point->speed : point->position;
}

static double y_of(const struct plot_scale *scale, double value)
{
    return scale->size - plot_scale_place(scale, value);
}

/* The corners that can be seen: the one before the window to the one after it. */
static void visible(const struct plot_motor *motor, const struct plot_scale *time, size_t *first, size_t *last)
{
    size_t from = plot_find(motor, time->low), to = plot_find(motor, time->high);
    *first = from > 0 ? from - 1 : 0;
    *last = to < motor->points ? to : motor->points - 1;
}

/* All corners of a px: where it begins, its lowest and highest value, where it ends. */
static size_t draw_px(FILE *out, const struct plot_motor *motor, size_t i, size_t last, const struct plot_scale *time,
                      const struct plot_scale *scale, bool speed)
{
    double px = floor(plot_scale_place(time, motor->point[i].us)), low = INFINITY, high = -INFINITY;
    double end = 0;
    for (; i <= last && floor(plot_scale_place(time, motor->point[i].us)) <= px; i++) {
        end = value_of(&motor->point[i], speed);
        low = fmin(low, end);
        high = fmax(high, end);
    }
    fprintf(out, "L%.1f %.1fV%.1fV%.1f", px + 0.5, y_of(scale, low), y_of(scale, high), y_of(scale, end));
    return i;
}

static void draw_many(FILE *out, const struct plot_motor *motor, size_t first, size_t last, const struct plot_scale *time,
                      const struct plot_scale *scale, bool speed)
{
    size_t i = first;
    while (i < last && motor->point[i].us < time->low)
        i++;
    fprintf(out, "M%.1f %.1f", plot_scale_place(time, motor->point[i].us), y_of(scale, value_of(&motor->point[i], speed)));
    while (i <= last)
        i = draw_px(out, motor, i, last, time, scale, speed);
}

static bool is_too_much(const struct plot_scale *time, size_t corners)
{
    return (double)corners > CORNERS_A_PX * time->size;
}

void plot_path_speed(FILE *out, const struct plot_motor *motor, const struct plot_scale *time, const struct plot_scale *speed)
{
    size_t first, last;
    if (motor->points == 0)
        return;
    visible(motor, time, &first, &last);
    if (is_too_much(time, last - first)) {
        draw_many(out, motor, first, last, time, speed, true);
        return;
    }
    for (size_t i = first; i <= last; i++)
        fprintf(out, "%c%.2f %.2f", i == first ? 'M' : 'L', plot_scale_place(time, motor->point[i].us),
                y_of(speed, motor->point[i].speed));
}

/* A parabola is a quadratic curve whose control point lies on the tangents, at half time. */
static void draw_parabola(FILE *out, const struct plot_point *a, const struct plot_point *b, const struct plot_scale *time,
                          const struct plot_scale *position)
{
    double half = (b->us - a->us) / 2;
    if (half <= 0) {
        fprintf(out, "L%.2f %.2f", plot_scale_place(time, b->us), y_of(position, b->position));
        return;
    }
    fprintf(out, "Q%.2f %.2f %.2f %.2f", plot_scale_place(time, a->us + half),
            y_of(position, a->position + a->speed * half * 1e-6), plot_scale_place(time, b->us), y_of(position, b->position));
}

void plot_path_position(FILE *out, const struct plot_motor *motor, const struct plot_scale *time,
                        const struct plot_scale *position)
{
    size_t first, last;
    if (motor->points == 0)
        return;
    visible(motor, time, &first, &last);
    if (is_too_much(time, last - first)) {
        draw_many(out, motor, first, last, time, position, false);
        return;
    }
    fprintf(out, "M%.2f %.2f", plot_scale_place(time, motor->point[first].us), y_of(position, motor->point[first].position));
    for (size_t i = first + 1; i <= last; i++)
        draw_parabola(out, &motor->point[i - 1], &motor->point[i], time, position);
}

void plot_path_truth(FILE *out, const struct plot_motor *motor, const struct plot_scale *time, const struct plot_scale *position)
{
    for (size_t i = 0; i < motor->truths; i++)
        fprintf(out, "%c%.1f %.1f", i == 0 ? 'M' : 'L', plot_scale_place(time, motor->truth[i].us),
                y_of(position, motor->truth[i].position));
}
