/* SPDX-License-Identifier: MIT */
#include "curves.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SPEED_ALIKE 1e-3    /* steps/s */
#define SLOPE_ALIKE 0.5     /* steps/s^2: the least that two accelerations differ by is 1 */
#define POSITION_ALIKE 1e-3 /* steps */
#define INTERVAL_MIN 0.25   /* us */

/* ---- Lists ---------------------------------------------------------------------------------------------------------- */

void *plot_grow_list(struct plot_curves *curves, void *list, size_t count, size_t *room, size_t size)
{
    if (count < *room)
        return list;
    if (count >= PLOT_POINTS_MAX) {
        curves->is_cut = true;
        return NULL;
    }
    size_t wanted = count < 32 ? 64 : 2 * count;
    void *grown = realloc(list, wanted * size);
    if (grown == NULL)
        curves->short_of_memory = true;
    else
        *room = wanted;
    return grown;
}

void plot_free(struct plot_curves *curves)
{
    for (unsigned i = 0; i < PLOT_MOTORS; i++) {
        free(curves->motor[i].point);
        free(curves->motor[i].band);
        free(curves->motor[i].motion);
        free(curves->motor[i].truth);
    }
    for (unsigned i = 0; i < PLOT_MASKS; i++)
        free(curves->mask[i].level);
    *curves = (struct plot_curves){0};
}

/* ---- Points --------------------------------------------------------------------------------------------------------- */

/* Does b lie on the way from a to c? Slopes decide: a corner is visible however close to the next point it is. */
static bool is_between(const struct plot_point *a, const struct plot_point *b, const struct plot_point *c)
{
    if (b->us - a->us < INTERVAL_MIN || c->us - b->us < INTERVAL_MIN)
        return false;
    if (a->speed == 0 && b->speed == 0 && c->speed == 0)
        return fabs(a->position - b->position) < POSITION_ALIKE && fabs(b->position - c->position) < POSITION_ALIKE;
    double before = (b->speed - a->speed) * 1e6 / (b->us - a->us), behind = (c->speed - b->speed) * 1e6 / (c->us - b->us);
    return fabs(behind - before) < SLOPE_ALIKE;
}

static bool is_alike(const struct plot_point *a, const struct plot_point *b)
{
    return fabs(a->us - b->us) < INTERVAL_MIN && fabs(a->speed - b->speed) < SPEED_ALIKE &&
           fabs(a->position - b->position) < POSITION_ALIKE && (a->speed == 0) == (b->speed == 0);
}

void plot_add_point(struct plot_curves *curves, struct plot_motor *motor, struct plot_point point)
{
    size_t n = motor->points;
    if (n > 0 && is_alike(&motor->point[n - 1], &point))
        return;
    if (n >= 2 && is_between(&motor->point[n - 2], &motor->point[n - 1], &point)) {
        motor->point[n - 1] = point;
        return;
    }
    struct plot_point *list = plot_grow_list(curves, motor->point, n, &motor->points_room, sizeof *motor->point);
    if (list == NULL)
        return;
    motor->point = list;
    motor->point[motor->points++] = point;
}

size_t plot_find(const struct plot_motor *motor, double us)
{
    size_t low = 0, high = motor->points;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (motor->point[middle].us < us)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* On the way from a to b, a->us <= us < b->us. */
static struct plot_point point_between(const struct plot_point *a, const struct plot_point *b, double us)
{
    double part = (us - a->us) / (b->us - a->us), speed = a->speed + (b->speed - a->speed) * part;
    return (struct plot_point){us, speed, a->position + (a->speed + speed) / 2 * (us - a->us) * 1e-6};
}

struct plot_point plot_point_at(const struct plot_motor *motor, double us)
{
    size_t at = plot_find(motor, us);
    if (motor->points == 0)
        return (struct plot_point){.us = us};
    if (at == motor->points || at == 0)
        return (struct plot_point){us, 0, motor->point[at == 0 ? 0 : at - 1].position};
    return motor->point[at].us > us ? point_between(&motor->point[at - 1], &motor->point[at], us) : motor->point[at];
}

void plot_cut(struct plot_curves *curves, struct plot_motor *motor, double us)
{
    struct plot_point behind = {.us = us};
    while (motor->points > 0 && motor->point[motor->points - 1].us > us)
        behind = motor->point[--motor->points];
    if (behind.us > us && motor->points > 0)
        plot_add_point(curves, motor, point_between(&motor->point[motor->points - 1], &behind, us));
}

struct plot_point plot_peak(const struct plot_motor *motor, const struct plot_motion *motion)
{
    struct plot_point peak = {.us = motion->from};
    for (size_t i = plot_find(motor, motion->from); i < motor->points && motor->point[i].us <= motion->to; i++) {
        const struct plot_point *point = &motor->point[i];
        if (fabs(point->speed) <= fabs(peak.speed) + SPEED_ALIKE)
            continue;
        peak = *point;
        if (i + 1 < motor->points && fabs(point[1].speed - point->speed) < SPEED_ALIKE)
            peak.us = (point->us + fmin(point[1].us, motion->to)) / 2;
    }
    return peak;
}

/* ---- What happens beside ---------------------------------------------------------------------------------------------- */

void plot_add_level(struct plot_curves *curves, enum plot_mask mask, double us, uint32_t value)
{
    struct plot_levels *list = &curves->mask[mask];
    if (list->levels > 0 && list->level[list->levels - 1].us == us) {
        list->level[list->levels - 1].mask = value;
        return;
    }
    struct plot_level *level = plot_grow_list(curves, list->level, list->levels, &list->levels_room, sizeof *level);
    if (level == NULL)
        return;
    list->level = level;
    list->level[list->levels++] = (struct plot_level){us, value};
}

static void begin_motion(struct plot_curves *curves, struct plot_motor *motor, double us)
{
    struct plot_motion *motion = plot_grow_list(curves, motor->motion, motor->motions, &motor->motions_room, sizeof *motion);
    if (motion == NULL)
        return;
    motor->motion = motion;
    motor->motion[motor->motions++] = (struct plot_motion){us, us};
    motor->is_moving = true;
}

void plot_mark_motion(struct plot_curves *curves, struct plot_motor *motor, double us, bool begins)
{
    if (!begins && motor->is_moving) {
        motor->motion[motor->motions - 1].to = us;
        motor->is_moving = false;
    } else if (begins) {
        begin_motion(curves, motor, us);
    }
    motor->is_used = true;
}

void plot_mark_state(struct plot_curves *curves, struct plot_motor *motor, double us, const char *state, const char *command)
{
    struct plot_band *last = motor->bands > 0 ? &motor->band[motor->bands - 1] : NULL;
    bool is_open = last != NULL && last->to < 0;
    if (is_open && state != NULL && strcmp(last->state, state) == 0 && strcmp(last->command, command) == 0)
        return;
    if (is_open)
        last->to = us;
    struct plot_band *band = NULL;
    if (state != NULL)
        band = plot_grow_list(curves, motor->band, motor->bands, &motor->bands_room, sizeof *band);
    if (band == NULL)
        return;
    motor->band = band;
    band += motor->bands++;
    *band = (struct plot_band){.from = us, .to = -1};
    snprintf(band->state, sizeof band->state, "%s", state);
    snprintf(band->command, sizeof band->command, "%s", command);
    motor->is_used = true;
}
