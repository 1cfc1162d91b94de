/* SPDX-License-Identifier: MIT */
#include "reference.h"

#include <stdlib.h>
#include <string.h>

/* ---- Memory -------------------------------------------------------------------------------------------------------- */

/* GMP takes and gives back millions of small numbers; a list of free blocks spares the sanitizers the trouble. */
#define BLOCK_BYTES 640 /* a number of REF_BITS and half as much again */

union block {
    union block *next;
    unsigned char bytes[BLOCK_BYTES];
};

static union block *free_blocks;

static void *take(size_t size)
{
    union block *block = free_blocks;
    if (size <= BLOCK_BYTES && block) {
        free_blocks = block->next;
        return block;
    }
    block = malloc(size <= BLOCK_BYTES ? sizeof *block : size);
    if (!block)
        abort();
    return block;
}

static void give_back(void *memory, size_t size)
{
    if (size > BLOCK_BYTES) {
        free(memory);
        return;
    }
    union block *block = memory;
    block->next = free_blocks;
    free_blocks = block;
}

static void *resize(void *memory, size_t old_size, size_t size)
{
    void *moved = take(size);
    memcpy(moved, memory, old_size < size ? old_size : size);
    give_back(memory, old_size);
    return moved;
}

void ref_use_blocks(void)
{
    mp_set_memory_functions(take, resize, give_back);
}

/* ---- R1, exact ----------------------------------------------------------------------------------------------------
 *
 * Each phase asks for the smallest whole t with an inequality between t and one or two square roots. Multiplied by all
 * denominators it is one between whole numbers and roots of whole numbers, and that is decided by squaring.
 *
 *   speed                                   X = 10^12 (s^2 + 2ak) for the rising, 10^12 (s^2 + 2a(N-k)) for the falling phase
 *   v     ________________
 *        /                \                 rising    a t + 10^6 s >= sqrt X
 *       /                  \                constant  2av t >= 10^6 (2av t_a + 2a(k - d_a))
 *   s  /                    \               falling   av t >= 10^6 (av T_end + vs) - v sqrt X, or for a triangle
 *      |rising|constant|falling                       a t + 10^6 s >= 2 sqrt(10^12 p^2) - sqrt X
 */

static unsigned long rate = 1000000; /* ticks a second; 10^6 in the formulas above */

void ref_use_rate(unsigned long ticks_per_second)
{
    rate = ticks_per_second;
}

/* whole = 10^12 (s^2 + 2 a steps) */
static void set_radicand(mpz_t whole, unsigned s, unsigned a, uint64_t steps)
{
    mpz_set_ui(whole, 2ul * a);
    mpz_mul_ui(whole, whole, steps);
    mpz_add_ui(whole, whole, (unsigned long)s * s);
    mpz_mul_ui(whole, whole, rate * rate);
}

/* root = sqrt(x), rounded up */
static void root_up(mpz_t root, const mpz_t x)
{
    mpz_t rest;
    mpz_init(rest);
    mpz_sqrtrem(root, rest, x);
    if (mpz_sgn(rest) != 0)
        mpz_add_ui(root, root, 1);
    mpz_clear(rest);
}

/* Is m >= sqrt(x) - sqrt(y)? That is m + sqrt(y) >= sqrt(x), both sides squared twice. m >= 0 */
static bool reaches(const mpz_t m, const mpz_t x, const mpz_t y)
{
    mpz_t missing, left;
    mpz_init(missing);
    mpz_init(left);
    mpz_sub(missing, x, y);
    mpz_submul(missing, m, m); /* still to be covered by 2 m sqrt(y) */
    mpz_mul(left, m, m);
    mpz_mul(left, left, y);
    mpz_mul_ui(left, left, 4);
    bool enough = mpz_sgn(missing) <= 0;
    if (!enough) {
        mpz_mul(missing, missing, missing);
        enough = mpz_cmp(left, missing) >= 0;
    }
    mpz_clear(missing);
    mpz_clear(left);
    return enough;
}

/* The peak of the motion stays below V, or just reaches it. */
static bool is_triangle(unsigned s, const struct ref_segment *m)
{
    return (uint64_t)m->speed * m->speed - (uint64_t)s * s > m->acceleration * m->steps;
}

void ref_single_phases(unsigned s, const struct ref_segment *m, uint64_t *rising, uint64_t *constant)
{
    if (m->speed <= s) {
        *rising = 0;
        *constant = m->steps;
        return;
    }
    uint64_t squares = (uint64_t)m->speed * m->speed - (uint64_t)s * s; /* 2 a d_a */
    uint64_t twice = 2ul * m->acceleration;
    *rising = is_triangle(s, m) ? m->steps / 2 : squares / twice;
    *constant = is_triangle(s, m) ? m->steps / 2 : m->steps - (squares + twice - 1) / twice;
}

static void tick_rising(mpz_t t, unsigned s, const struct ref_segment *m, uint64_t k)
{
    mpz_t x;
    mpz_init(x);
    set_radicand(x, s, m->acceleration, k);
    root_up(t, x);
    mpz_sub_ui(t, t, rate * s);
    mpz_cdiv_q_ui(t, t, m->acceleration);
    mpz_clear(x);
}

static void tick_constant(mpz_t t, unsigned s, const struct ref_segment *m, uint64_t k)
{
    unsigned long v = m->speed, a = m->acceleration;
    mpz_set_ui(t, 2 * a);
    mpz_mul_ui(t, t, k);
    if (v > s) { /* 2av t_a - 2a d_a = 2v(v - s) - (v^2 - s^2) */
        mpz_add_ui(t, t, 2 * v * (v - s));
        mpz_sub_ui(t, t, v * v - (unsigned long)s * s);
    }
    mpz_mul_ui(t, t, rate);
    mpz_cdiv_q_ui(t, t, 2 * a * v);
}

static void tick_falling(mpz_t t, unsigned s, const struct ref_segment *m, uint64_t k)
{
    unsigned long v = m->speed, a = m->acceleration;
    mpz_t x, sum;
    mpz_init(x);
    mpz_init(sum);
    set_radicand(x, s, m->acceleration, m->steps - k);
    mpz_mul_ui(x, x, v * v);
    mpz_sqrt(x, x);
    mpz_set_ui(sum, a);
    mpz_mul_ui(sum, sum, m->steps);
    mpz_add_ui(sum, sum, 2 * v * (v - s) + s * v);
    mpz_sub_ui(sum, sum, v * v - (unsigned long)s * s);
    mpz_mul_ui(sum, sum, rate);
    mpz_sub(sum, sum, x);
    mpz_cdiv_q_ui(t, sum, a * v);
    mpz_clear(x);
    mpz_clear(sum);
}

static void tick_falling_triangle(mpz_t t, unsigned s, const struct ref_segment *m, uint64_t k)
{
    mpz_t x, y, root;
    mpz_init(x);
    mpz_init(y);
    mpz_init(root);
    mpz_set_ui(x, m->acceleration);
    mpz_mul_ui(x, x, m->steps);
    mpz_add_ui(x, x, (unsigned long)s * s);
    mpz_mul_ui(x, x, 4 * rate * rate);
    set_radicand(y, s, m->acceleration, m->steps - k);
    mpz_sqrt(t, x);
    mpz_sqrt(root, y);
    mpz_sub(t, t, root);
    mpz_sub_ui(t, t, 2);
    while (!reaches(t, x, y))
        mpz_add_ui(t, t, 1);
    mpz_sub_ui(t, t, rate * s);
    mpz_cdiv_q_ui(t, t, m->acceleration);
    mpz_clear(x);
    mpz_clear(y);
    mpz_clear(root);
}

uint64_t ref_single_tick(unsigned s, const struct ref_segment *m, uint64_t k)
{
    uint64_t rising, constant;
    mpz_t t;
    mpz_init(t);
    ref_single_phases(s, m, &rising, &constant);
    if (k <= rising)
        tick_rising(t, s, m, k);
    else if (k <= constant)
        tick_constant(t, s, m, k);
    else if (is_triangle(s, m))
        tick_falling_triangle(t, s, m, k);
    else
        tick_falling(t, s, m, k);
    uint64_t tick = mpz_get_ui(t);
    mpz_clear(t);
    return tick;
}

/* ---- Checks of the planning ---------------------------------------------------------------------------------------- */

double ref_limit_at(unsigned start_speed, const struct ref_segment *segment, unsigned segments, double place)
{
    /* Limits are at the borders; from each the square of the speed may grow by 2A a step to both sides. */
    double border_at[REF_SEGMENTS + 1] = {0}, limit[REF_SEGMENTS + 1], best = 1e300;
    unsigned here = 0;
    for (unsigned i = 0; i <= segments; i++) {
        double left = i > 0 ? segment[i - 1].speed : start_speed, right = i < segments ? segment[i].speed : start_speed;
        limit[i] = left < right ? left * left : right * right;
        if (i > 0)
            border_at[i] = border_at[i - 1] + (double)segment[i - 1].steps;
        if (i < segments && place >= border_at[i])
            here = i;
    }
    for (unsigned i = 0; i <= segments; i++) {
        double square = limit[i], low = i <= here ? border_at[i] : place, high = i <= here ? place : border_at[i];
        for (unsigned j = 0; j < segments; j++) { /* what lies of segment j between the border and the place */
            double from = border_at[j] > low ? border_at[j] : low, to = border_at[j + 1] < high ? border_at[j + 1] : high;
            if (to > from)
                square += 2.0 * segment[j].acceleration * (to - from);
        }
        if (square < best)
            best = square;
    }
    double top = (double)segment[here].speed * segment[here].speed;
    return best < top ? best : top;
}

double ref_square_at(const struct ref_track *track, double place)
{
    unsigned i = track->legs - 1;
    while (i > 0 && mpf_cmp_d(track->leg[i].place, place) > 0)
        i--;
    double speed = mpf_get_d(track->leg[i].speed), way = place - mpf_get_d(track->leg[i].place);
    return speed * speed + 2.0 * track->leg[i].slope * way;
}
