/* SPDX-License-Identifier: MIT */
/* The picture: for each motor a panel of its speed with what it waits for below, and one of its position; then a line for each
 * input, output and variable that changes; one time axis for all. */
#include <math.h>
#include <string.h>

#include "draw.h"
#include "draw_curve.h"
#include "picture.h"
#include "scale.h"

#define LEFT 70.0          /* px beside a panel, for the numbers */
#define RIGHT 18.0
#define TOP 42.0           /* for the title */
#define SPEED_HEIGHT 150.0
#define BAND_HEIGHT 16.0
#define POSITION_HEIGHT 90.0
#define GAP 12.0
#define MOTOR_GAP 34.0
#define LANE_HEIGHT 14.0
#define LANE_GAP 8.0
#define BOTTOM 40.0
#define CHARACTER 6.3      /* px of a character, about */
#define MARK_EVERY 90.0    /* px between two times, at least */

/* Written out twice: some readers of SVG know no variables. */
static const char style[] =
    "<style>\n"
    ".plot{font:11px 'DejaVu Sans',Verdana,sans-serif}.title{font-size:14px;font-weight:bold}\n"
    ".paper{fill:#fff}.ink{fill:#1f2933}.soft{fill:#5b6875}.wait{fill:#f3d9a4}.dwell{fill:#cfe0f3}.hold{fill:#f3c4c4}\n"
    ".grid,.zero,.frame,.speed,.place,.true,.lane{fill:none;vector-effect:non-scaling-stroke}\n"
    ".grid{stroke:#dde3e9}.zero,.frame{stroke:#5b6875}.lane{stroke:#1f2933}.speed,.place,.true{stroke-width:1.6}\n"
    ".speed{stroke:#0b5fa5}.place{stroke:#2e7d32}.true{stroke:#b3541e;stroke-dasharray:5 3}\n"
    ".end{text-anchor:end}.middle{text-anchor:middle}\n"
    "@media (prefers-color-scheme:dark){\n"
    ".paper{fill:#14181d}.ink{fill:#e6eaee}.soft{fill:#a3afba}.wait{fill:#6b5320}.dwell{fill:#2c4766}.hold{fill:#6e3333}\n"
    ".grid{stroke:#323a43}.zero,.frame{stroke:#a3afba}.lane{stroke:#e6eaee}\n"
    ".speed{stroke:#6cb6ff}.place{stroke:#7fce86}.true{stroke:#ffab70}\n"
    "}\n"
    "</style>\n";

/* What is being drawn. */
struct drawing {
    FILE *out;
    const struct plot_curves *curves;
    const struct plot_view *view;
    struct plot_scale time;
    double y; /* px from the top, of what comes next */
};

void plot_text(FILE *out, const char *text)
{
    for (; *text != '\0'; text++) {
        const char *as = *text == '<' ? "&lt;" : *text == '>' ? "&gt;" : *text == '&' ? "&amp;" : *text == '"' ? "&quot;" : NULL;
        if (as != NULL)
            fputs(as, out);
        else if ((unsigned char)*text >= ' ')
            fputc(*text, out);
    }
}

/* ---- Sizes ------------------------------------------------------------------------------------------------------------ */

static bool has_changed(const struct plot_levels *levels, unsigned bit, const struct plot_view *view)
{
    bool level = false;
    for (size_t i = 0; i < levels->levels && levels->level[i].us <= view->to; i++) {
        bool next = levels->level[i].mask >> bit & 1u;
        if (i > 0 && next != level)
            return true;
        level = next;
    }
    return false;
}

static unsigned count_lanes(const struct plot_curves *curves, const struct plot_view *view)
{
    unsigned lanes = 0;
    for (unsigned mask = 0; mask < PLOT_MASKS; mask++)
        for (unsigned bit = 0; bit < 32; bit++)
            lanes += has_changed(&curves->mask[mask], bit, view);
    return lanes;
}

static bool is_drawn(const struct plot_curves *curves, unsigned i)
{
    bool any = false;
    for (unsigned k = 0; k < curves->motors; k++)
        any = any || curves->motor[k].is_used;
    return curves->motor[i].is_used || (!any && i == 0);
}

double plot_height(const struct plot_curves *curves, const struct plot_view *view)
{
    double height = TOP;
    for (unsigned i = 0; i < curves->motors; i++)
        if (is_drawn(curves, i))
            height += SPEED_HEIGHT + BAND_HEIGHT + GAP + POSITION_HEIGHT + MOTOR_GAP;
    return height + count_lanes(curves, view) * (LANE_HEIGHT + LANE_GAP) + BOTTOM - 20;
}

/* ---- Panels ----------------------------------------------------------------------------------------------------------- */

/* Open a panel of this height at the present y. What is drawn in it is cut off at its edges. */
static void open_panel(const struct drawing *drawing, double height, const char *class)
{
    fprintf(drawing->out,
            "<svg class=\"panel %s\" x=\"%g\" y=\"%.1f\" width=\"%g\" height=\"%g\" viewBox=\"0 0 %g %g\" "
            "preserveAspectRatio=\"none\">\n",
            class, LEFT, drawing->y, drawing->time.size, height, drawing->time.size, height);
}

static void close_panel(const struct drawing *drawing, double height)
{
    fputs("</svg>\n", drawing->out);
    fprintf(drawing->out, "<rect class=\"frame\" x=\"%g\" y=\"%.1f\" width=\"%g\" height=\"%g\"/>\n", LEFT, drawing->y,
            drawing->time.size, height);
}

static double first_mark(const struct plot_scale *scale)
{
    return ceil(scale->low / scale->step - 1e-9) * scale->step + 0.0; /* never -0 */
}

static void draw_time_grid(const struct drawing *drawing, double height)
{
    fputs("<path class=\"grid times\" d=\"", drawing->out);
    for (double us = first_mark(&drawing->time); us <= drawing->time.high * (1 + 1e-12); us += drawing->time.step)
        fprintf(drawing->out, "M%.2f 0V%g", plot_scale_place(&drawing->time, us), height);
    fputs("\"/>\n", drawing->out);
}

static void draw_value_grid(const struct drawing *drawing, const struct plot_scale *scale)
{
    fputs("<path class=\"grid\" d=\"", drawing->out);
    for (double value = first_mark(scale); value < scale->high + scale->step / 2; value += scale->step)
        fprintf(drawing->out, "M0 %.2fH%g", scale->size - plot_scale_place(scale, value), drawing->time.size);
    fputs("\"/>\n", drawing->out);
    if (scale->low < 0 && scale->high > 0)
        fprintf(drawing->out, "<path class=\"zero\" d=\"M0 %.2fH%g\"/>\n", scale->size - plot_scale_place(scale, 0),
                drawing->time.size);
}

static void draw_values(const struct drawing *drawing, const struct plot_scale *scale, const char *what)
{
    for (double value = first_mark(scale); value < scale->high + scale->step / 2; value += scale->step)
        fprintf(drawing->out, "<text class=\"soft end\" x=\"%g\" y=\"%.1f\">%.10g</text>\n", LEFT - 6,
                drawing->y + scale->size - plot_scale_place(scale, value) + 4, fabs(value) < scale->step / 2 ? 0 : value);
    fprintf(drawing->out, "<text class=\"ink middle\" transform=\"translate(14 %.1f) rotate(-90)\">%s</text>\n",
            drawing->y + scale->size / 2, what);
}

/* ---- Labels ----------------------------------------------------------------------------------------------------------- */

static double width_of(const char *text)
{
    return (double)strlen(text) * CHARACTER;
}

/* Draw the first of the texts that fits into `room` px, in the middle at `us`. */
static void draw_label(const struct drawing *drawing, double us, double y, double room, const char *const *texts)
{
    double x = plot_scale_place(&drawing->time, us);
    for (; *texts != NULL; texts++) {
        double half = width_of(*texts) / 2;
        if (2 * half > room || x < 0 || x > drawing->time.size)
            continue;
        double at = fmin(fmax(x, half + 2), drawing->time.size - half - 2);
        fprintf(drawing->out, "<text class=\"ink middle label\" data-us=\"%.0f\" x=\"%.1f\" y=\"%.1f\">", us, LEFT + at, y);
        plot_text(drawing->out, *texts);
        fputs("</text>\n", drawing->out);
        return;
    }
}

static void format_time(char text[32], double us)
{
    if (us >= 1e6)
        snprintf(text, 32, "%.4g s", us * 1e-6);
    else
        snprintf(text, 32, "%.4g ms", us * 1e-3);
}

/* Peak, steps and duration of a motion, where there is room. */
static void label_motion(const struct drawing *drawing, const struct plot_motor *motor, const struct plot_motion *motion,
                         const struct plot_scale *speed)
{
    struct plot_point peak = plot_peak(motor, motion);
    double steps = fabs(round(plot_point_at(motor, motion->to).position - plot_point_at(motor, motion->from).position));
    double room = (motion->to - motion->from) / (drawing->time.high - drawing->time.low) * drawing->time.size;
    double top = drawing->y + speed->size - plot_scale_place(speed, peak.speed);
    double zero = drawing->y + speed->size - plot_scale_place(speed, 0);
    bool back = peak.speed < 0;
    char full[96], half[32], count[32], fast[64], number[32];
    format_time(half, motion->to - motion->from);
    snprintf(count, sizeof count, "%.0f", steps);
    snprintf(full, sizeof full, "%s steps, %s", count, half);
    snprintf(number, sizeof number, "%.0f", floor(fabs(peak.speed) + 1e-6));
    snprintf(fast, sizeof fast, "%s steps/s", number);
    double middle = (motion->from + motion->to) / 2;
    draw_label(drawing, peak.us, back ? top + 13 : top - 5, room, (const char *const[]){fast, number, NULL});
    if (fabs(top - zero) > 34)
        draw_label(drawing, middle, back ? zero + 14 : zero - 6, room * 0.9, (const char *const[]){full, count, NULL});
}

static void label_motions(const struct drawing *drawing, const struct plot_motor *motor, const struct plot_scale *speed)
{
    for (size_t i = 0; i < motor->motions; i++)
        if (motor->motion[i].to >= drawing->view->from && motor->motion[i].from <= drawing->view->to)
            label_motion(drawing, motor, &motor->motion[i], speed);
}

/* ---- Bands ------------------------------------------------------------------------------------------------------------ */

static const char *band_class(const struct plot_band *band)
{
    if (strcmp(band->state, "dwell") == 0)
        return "dwell";
    return strcmp(band->state, "wait") == 0 || strcmp(band->state, "block") == 0 ? "wait" : "hold";
}

static void draw_band(const struct drawing *drawing, const struct plot_band *band)
{
    double from = plot_scale_place(&drawing->time, band->from), to = plot_scale_place(&drawing->time, band->to);
    fprintf(drawing->out, "<rect class=\"%s\" x=\"%.2f\" y=\"1\" width=\"%.2f\" height=\"%g\"><title>%s ", band_class(band), from,
            fmax(to - from, 0.5), BAND_HEIGHT - 2, band->state);
    plot_text(drawing->out, band->command);
    fprintf(drawing->out, " %.6g s</title></rect>\n", (band->to - band->from) * 1e-6);
}

/* More than so many cannot be distinguished: those of one px are drawn once. */
static void draw_bands(struct drawing *drawing, const struct plot_motor *motor)
{
    double drawn = -1;
    open_panel(drawing, BAND_HEIGHT, "bands");
    for (size_t i = 0; i < motor->bands; i++) {
        const struct plot_band *band = &motor->band[i];
        double px = floor(2 * plot_scale_place(&drawing->time, band->to));
        if (band->to < drawing->view->from || band->from > drawing->view->to || px <= drawn)
            continue;
        drawn = px;
        draw_band(drawing, band);
    }
    close_panel(drawing, BAND_HEIGHT);
    for (size_t i = 0; i < motor->bands; i++) {
        const struct plot_band *band = &motor->band[i];
        double from = fmax(band->from, drawing->view->from), to = fmin(band->to, drawing->view->to);
        char both[2 * PLOT_TEXT_SIZE + 2];
        snprintf(both, sizeof both, "%s%s%s", band->command, band->command[0] != '\0' ? " " : "", band->state);
        if (to > from)
            draw_label(drawing, (from + to) / 2, drawing->y + 12, (to - from) / (drawing->time.high - drawing->time.low) *
                       drawing->time.size, (const char *const[]){both, band->command, NULL});
    }
    drawing->y += BAND_HEIGHT;
}

/* ---- Motors ----------------------------------------------------------------------------------------------------------- */

static struct plot_scale scale_of(const struct drawing *drawing, const struct plot_motor *motor, bool speed, double size)
{
    double low = 0, high = 0;
    struct plot_point ends[] = {plot_point_at(motor, drawing->view->from), plot_point_at(motor, drawing->view->to)};
    size_t first = plot_find(motor, drawing->view->from);
    for (size_t i = first; i < motor->points && motor->point[i].us <= drawing->view->to; i++) {
        low = fmin(low, speed ? motor->point[i].speed : motor->point[i].position);
        high = fmax(high, speed ? motor->point[i].speed : motor->point[i].position);
    }
    for (size_t i = 0; i < 2; i++) {
        low = fmin(low, speed ? ends[i].speed : ends[i].position);
        high = fmax(high, speed ? ends[i].speed : ends[i].position);
    }
    for (size_t i = 0; !speed && i < motor->truths; i++) {
        low = fmin(low, motor->truth[i].position);
        high = fmax(high, motor->truth[i].position);
    }
    /* room for the labels of the peaks, which lie outside */
    return speed ? plot_scale_around(low * 1.3, high * 1.12, size, 7) : plot_scale_around(low, high, size, 3);
}

static void draw_speed(struct drawing *drawing, const struct plot_motor *motor)
{
    const struct plot_scale speed = scale_of(drawing, motor, true, SPEED_HEIGHT);
    draw_values(drawing, &speed, drawing->curves->from_pulses ? "steps/s (mean)" : "steps/s");
    open_panel(drawing, SPEED_HEIGHT, "of-speed");
    draw_time_grid(drawing, SPEED_HEIGHT);
    draw_value_grid(drawing, &speed);
    fputs("<path class=\"speed\" d=\"", drawing->out);
    plot_path_speed(drawing->out, motor, &drawing->time, &speed);
    fputs("\"/>\n", drawing->out);
    close_panel(drawing, SPEED_HEIGHT);
    label_motions(drawing, motor, &speed);
    drawing->y += SPEED_HEIGHT;
}

static void draw_position(struct drawing *drawing, const struct plot_motor *motor)
{
    const struct plot_scale position = scale_of(drawing, motor, false, POSITION_HEIGHT);
    draw_values(drawing, &position, "position");
    open_panel(drawing, POSITION_HEIGHT, "of-position");
    draw_time_grid(drawing, POSITION_HEIGHT);
    draw_value_grid(drawing, &position);
    fputs("<path class=\"place\" d=\"", drawing->out);
    plot_path_position(drawing->out, motor, &drawing->time, &position);
    fputs("\"/>\n", drawing->out);
    if (motor->truths > 0) {
        fputs("<path class=\"true\" d=\"", drawing->out);
        plot_path_truth(drawing->out, motor, &drawing->time, &position);
        fputs("\"><title>true position</title></path>\n", drawing->out);
    }
    close_panel(drawing, POSITION_HEIGHT);
    if (motor->truths > 0)
        fprintf(drawing->out, "<text class=\"soft end\" x=\"%g\" y=\"%.1f\">dashed: true position</text>\n",
                LEFT + drawing->time.size, drawing->y + POSITION_HEIGHT + 13);
    drawing->y += POSITION_HEIGHT;
}

static void draw_motor(struct drawing *drawing, unsigned number)
{
    const struct plot_motor *motor = &drawing->curves->motor[number - 1];
    fprintf(drawing->out, "<g class=\"motor\" data-motor=\"%u\">\n<text class=\"ink\" x=\"%g\" y=\"%.1f\" "
            "font-weight=\"bold\">Motor %u</text>\n", number, LEFT, drawing->y - 5, number);
    draw_speed(drawing, motor);
    draw_bands(drawing, motor);
    drawing->y += GAP;
    draw_position(drawing, motor);
    drawing->y += MOTOR_GAP;
    fputs("</g>\n", drawing->out);
}

/* ---- Levels ----------------------------------------------------------------------------------------------------------- */

static void draw_lane(struct drawing *drawing, const struct plot_levels *levels, unsigned bit, const char *name)
{
    const double low = LANE_HEIGHT - 1.5, high = 1.5;
    double last = -1;
    bool level = false;
    fprintf(drawing->out, "<text class=\"soft end\" x=\"%g\" y=\"%.1f\">%s %02u</text>\n", LEFT - 6, drawing->y + 11, name,
            levels->first + bit);
    open_panel(drawing, LANE_HEIGHT, "of-level");
    fputs("<path class=\"lane\" d=\"M-1 ", drawing->out);
    for (size_t i = 0; i < levels->levels; i++) {
        bool next = levels->level[i].mask >> bit & 1u;
        double x = plot_scale_place(&drawing->time, levels->level[i].us);
        if (i == 0)
            fprintf(drawing->out, "%g", next ? high : low);
        else if (next != level && (x - last > 0.2 || x < 0))
            fprintf(drawing->out, "H%.2fV%g", last = x, next ? high : low);
        level = next;
    }
    fprintf(drawing->out, "H%.2f\"/>\n</svg>\n", drawing->time.size + 1);
    drawing->y += LANE_HEIGHT + LANE_GAP;
}

static void draw_lanes(struct drawing *drawing)
{
    static const char *const names[] = {"DI", "DO", "VAR"};
    drawing->y -= 14;
    for (unsigned mask = 0; mask < PLOT_MASKS; mask++)
        for (unsigned bit = 0; bit < 32; bit++)
            if (has_changed(&drawing->curves->mask[mask], bit, drawing->view))
                draw_lane(drawing, &drawing->curves->mask[mask], bit, names[mask]);
}

/* ---- All of it -------------------------------------------------------------------------------------------------------- */

static void draw_times(const struct drawing *drawing)
{
    const bool ms = drawing->time.step < 1e4;
    const double unit = ms ? 1e-3 : 1e-6;
    fputs("<g class=\"axis\">\n", drawing->out);
    for (double us = first_mark(&drawing->time); us <= drawing->time.high * (1 + 1e-12); us += drawing->time.step)
        fprintf(drawing->out, "<text class=\"soft middle\" x=\"%.1f\" y=\"%.1f\">%.10g</text>\n",
                LEFT + plot_scale_place(&drawing->time, us), drawing->y + 4, us * unit);
    fprintf(drawing->out, "</g>\n<text class=\"ink middle unit\" x=\"%.1f\" y=\"%.1f\">%s</text>\n",
            LEFT + drawing->time.size / 2, drawing->y + 20, ms ? "ms" : "s");
}

/* What the picture shows, in words. */
static void describe(const struct drawing *drawing)
{
    const struct plot_curves *curves = drawing->curves;
    for (unsigned i = 0; i < curves->motors; i++) {
        const struct plot_motor *motor = &curves->motor[i];
        double peak = 0;
        for (size_t k = 0; k < motor->motions; k++)
            peak = fmax(peak, fabs(plot_peak(motor, &motor->motion[k]).speed));
        if (motor->is_used)
            fprintf(drawing->out, "Motor %u: %zu motion%s, at most %.0f steps/s, position %.0f after %.6g s. ", i + 1,
                    motor->motions, motor->motions == 1 ? "" : "s", floor(peak + 1e-6),
                    round(plot_point_at(motor, drawing->view->to).position), drawing->view->to * 1e-6);
    }
}

void plot_draw_svg(FILE *out, const struct plot_curves *curves, const struct plot_view *view)
{
    const double width = view->width, height = plot_height(curves, view), panel = width - LEFT - RIGHT;
    struct drawing drawing = {.out = out, .curves = curves, .view = view, .y = TOP};
    drawing.time = plot_scale_exact(view->from, view->to, panel, (unsigned)(panel / MARK_EVERY));
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"plot\" width=\"%g\" height=\"%g\" viewBox=\"0 0 %g %g\" "
            "role=\"img\" "
            "aria-labelledby=\"title desc\" data-from=\"%.0f\" data-to=\"%.0f\" data-left=\"%g\">\n<title id=\"title\">",
            width, height, width, height, view->from, view->to, LEFT);
    plot_text(out, view->title);
    fputs("</title>\n<desc id=\"desc\">", out);
    describe(&drawing);
    fprintf(out, "</desc>\n%s<rect class=\"paper\" width=\"%g\" height=\"%g\"/>\n", style, width, height);
    fputs("<text class=\"ink title\" x=\"14\" y=\"20\">", out);
    plot_text(out, view->title);
    fputs("</text>\n", out);
    for (unsigned i = 0; i < curves->motors; i++)
        if (is_drawn(curves, i))
            draw_motor(&drawing, i + 1);
    draw_lanes(&drawing);
    draw_times(&drawing);
    fputs("</svg>\n", out);
}
