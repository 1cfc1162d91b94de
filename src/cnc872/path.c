/* SPDX-License-Identifier: MIT */
#include "path.h"

#include <stddef.h>

/* A way that no path has: the longest has less than 2^48 u. */
#define FAR (INT64_C(1) << 61)

static int64_t smaller(int64_t a, int64_t b)
{
    return a < b ? a : b;
}

static int64_t larger(int64_t a, int64_t b)
{
    return a > b ? a : b;
}

/* Sum of w - i*a over i = 1 ... n, n*a <= w; FAR if it is at least that. */
static int64_t ramp_way(int64_t w, int64_t a, int64_t n)
{
    if (w > 0 && n > FAR / w)
        return FAR;
    return n * w - (n % 2 == 0 ? n / 2 * (n + 1) : (n + 1) / 2 * n) * a;
}

/* Way of the T's in which w falls by a each. */
static int64_t brake_way(int64_t w, int64_t a)
{
    return ramp_way(w, a, w / a);
}

/* Way that the input stage needs from w, this T included, to come down to `speed` (NM8). */
static int64_t border_way(const struct cnc_path *path, int64_t w, int64_t speed)
{
    const int64_t steps = (w - speed + path->acceleration - 1) / path->acceleration - 1;
    return w + ramp_way(w, path->acceleration, steps) + (path->n > 1 ? speed * (path->n + 1) / 2 : 0);
}

/* Does the input stage, at w in this T, still come down to the speeds of all borders ahead (NM8)? */
static bool meets_borders(const struct cnc_path *path, int64_t w, const struct cnc_borders *borders)
{
    const int64_t at = path->length - path->left;
    for (unsigned i = 0; i < borders->count; i++) {
        const struct cnc_border *next = &borders->border[i];
        if (next->at <= at || w <= next->speed)
            continue;
        if (border_way(path, w, next->speed) > next->at - at)
            return false;
    }
    return true;
}

static bool is_allowed(const struct cnc_path *path, int64_t w, const struct cnc_borders *borders)
{
    if (path->length == CNC_ENDLESS)
        return true;
    return w + brake_way(w, path->acceleration) <= path->left && (borders == NULL || meets_borders(path, w, borders));
}

/* The speed of the input stage in this T (NM2). What is allowed is so for all smaller speeds. */
static int64_t pick_speed(const struct cnc_path *path, int64_t target, const struct cnc_borders *borders)
{
    int64_t low = larger(0, path->u - path->acceleration);
    int64_t high = smaller(path->u + path->acceleration, larger(target, low));
    if (is_allowed(path, high, borders))
        return high;
    if (!is_allowed(path, low, borders))
        return smaller(low, path->left);
    while (low + 1 < high) {
        const int64_t middle = low + (high - low) / 2;
        if (is_allowed(path, middle, borders))
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* All values of the average are v. */
static void fill_ring(struct cnc_path *path, int64_t *ring, int64_t v)
{
    path->at = 0;
    path->sum = 0;
    if (path->n == 1)
        return;
    for (unsigned i = 0; i < path->n; i++)
        ring[i] = v;
    path->sum = v * path->n;
}

void cnc_path_begin(struct cnc_path *path, int64_t *ring, int64_t length, int64_t acceleration, unsigned n)
{
    *path = (struct cnc_path){.length = length, .left = length, .acceleration = acceleration, .n = (uint16_t)n};
    fill_ring(path, ring, 0);
}

bool cnc_path_change(struct cnc_path *path, int64_t *ring, int64_t acceleration, unsigned n)
{
    if (acceleration == path->acceleration && n == path->n)
        return true;
    const int64_t twice = path->v * (n - 1); /* of the way that the average still gives */
    const int64_t left = cnc_path_rest(path) - (twice + 1) / 2;
    if (left < brake_way(path->v, acceleration))
        return false;
    path->acceleration = acceleration;
    path->n = (uint16_t)n;
    path->u = path->v;
    path->left = left;
    path->carry = (uint16_t)(twice % 2 != 0 ? n / 2 : 0);
    fill_ring(path, ring, path->v);
    return true;
}

void cnc_path_halt(struct cnc_path *path, int64_t *ring)
{
    path->u = path->v = 0;
    path->carry = 0;
    path->left = path->length == CNC_ENDLESS ? CNC_ENDLESS : cnc_path_rest(path);
    fill_ring(path, ring, 0);
}

int64_t cnc_path_step(struct cnc_path *path, int64_t *ring, int64_t target, int64_t hold, const struct cnc_borders *borders)
{
    int64_t w = pick_speed(path, target, borders);
    if (hold > 0)
        w = smaller(w, larger(0, path->u - hold));
    path->u = w;
    if (path->length != CNC_ENDLESS)
        path->left -= w;
    if (path->n == 1) {
        path->v = w;
    } else {
        path->sum += w - ring[path->at];
        ring[path->at] = w;
        path->at = (uint16_t)(path->at + 1u < path->n ? path->at + 1u : 0u);
        const int64_t all = path->sum + path->carry;
        path->v = all / path->n;
        path->carry = (uint16_t)(all % path->n);
    }
    if (path->length != CNC_ENDLESS)
        path->done += path->v;
    return path->v;
}

/* The average has the speed v alone. */
static bool is_uniform(const struct cnc_path *path, const int64_t *ring, int64_t v)
{
    for (unsigned i = 0; path->n > 1 && i < path->n; i++)
        if (ring[i] != v)
            return false;
    return true;
}

/* T's of `speed` that begin with `need` u or more of `way` before them. */
static int64_t turns(int64_t way, int64_t need, int64_t speed)
{
    return way < need ? 0 : (way - need) / speed + 1;
}

int64_t cnc_path_glide(struct cnc_path *path, const int64_t *ring, int64_t target, const struct cnc_borders *borders,
                       int64_t input_until, int64_t path_until, int64_t limit)
{
    if (target <= 0 || path->u != target || path->v != target || !is_uniform(path, ring, target))
        return 0;
    const int64_t a = path->acceleration, at = path->length - path->left;
    int64_t count = smaller(limit, turns(path->left, target + brake_way(target, a), target));
    count = smaller(count, turns(input_until - at, 1, target));
    count = smaller(count, turns(path_until - path->done, 1, target));
    for (unsigned i = 0; i < borders->count; i++) {
        const struct cnc_border *next = &borders->border[i];
        if (next->at <= at || target <= next->speed)
            continue;
        count = smaller(count, turns(next->at - at, border_way(path, target, next->speed), target));
    }
    path->left -= count * target;
    path->done += count * target;
    return count;
}
