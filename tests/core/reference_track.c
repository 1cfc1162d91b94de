/* SPDX-License-Identifier: MIT */
/* reference_track.c: motions as legs of constant acceleration, in numbers of REF_BITS bits (R4-R6, P7). */
#include "reference.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MILLION 1000000ul
#define PULSE_BITS 192    /* enough for one pulse: 2^-192 of 2^45 ticks */
#define SAME_BITS 1000    /* numbers closer than 2^-SAME_BITS are the same */
#define FRACTION_BITS 600 /* a rational number met here has a denominator of fewer bits (is_rational) */

/* Where a plan has got to. */
struct cursor {
    mpf_t time, place, square; /* square of the speed */
};

static void cursor_init(struct cursor *c)
{
    mpf_inits(c->time, c->place, c->square, NULL);
}

static void cursor_clear(struct cursor *c)
{
    mpf_clears(c->time, c->place, c->square, NULL);
}

/* -1, 0, 1 for a below, at, above b */
static int compare(const mpf_t a, const mpf_t b)
{
    mpf_t difference;
    mpf_init(difference);
    mpf_sub(difference, a, b);
    int sign = mpf_sgn(difference);
    mpf_abs(difference, difference);
    mpf_mul_2exp(difference, difference, SAME_BITS);
    if (mpf_cmp_ui(difference, 1) < 0)
        sign = 0;
    mpf_clear(difference);
    return sign;
}

void ref_init(struct ref_track *track)
{
    mpf_set_default_prec(REF_BITS);
    memset(track, 0, sizeof *track);
    for (unsigned i = 0; i <= REF_LEGS; i++)
        mpf_inits(track->leg[i].time, track->leg[i].place, track->leg[i].speed, NULL);
}

void ref_clear(struct ref_track *track)
{
    for (unsigned i = 0; i <= REF_LEGS; i++)
        mpf_clears(track->leg[i].time, track->leg[i].place, track->leg[i].speed, NULL);
}

static void leg_copy(struct ref_leg *leg, const struct ref_leg *from)
{
    mpf_set(leg->time, from->time);
    mpf_set(leg->place, from->place);
    mpf_set(leg->speed, from->speed);
    leg->slope = from->slope;
    leg->replanned = from->replanned;
}

void ref_copy(struct ref_track *track, const struct ref_track *from)
{
    track->start_speed = from->start_speed;
    track->segments = from->segments;
    memcpy(track->segment, from->segment, sizeof track->segment);
    track->steps = from->steps;
    track->legs = from->legs;
    track->edge = from->edge;
    for (unsigned i = 0; i <= track->legs; i++)
        leg_copy(&track->leg[i], &from->leg[i]);
}

/* ---- Planning ----------------------------------------------------------------------------------------------------- */

static uint64_t border(const struct ref_track *track, unsigned segment)
{
    uint64_t sum = 0;
    for (unsigned i = 0; i <= segment; i++)
        sum += track->segment[i].steps;
    return sum;
}

static void set_square(mpf_t square, unsigned speed)
{
    mpf_set_ui(square, (unsigned long)speed * speed);
}

/* The leg list ends at the cursor. */
static void close_legs(struct ref_track *track, const struct cursor *c)
{
    struct ref_leg *end = &track->leg[track->legs];
    mpf_set(end->time, c->time);
    mpf_set(end->place, c->place);
    mpf_sqrt(end->speed, c->square);
    end->slope = 0;
    end->replanned = false;
}

/* Continue to a place with one slope. Going nowhere adds no leg. */
static void go(struct ref_track *track, struct cursor *c, int slope, const mpf_t to)
{
    if (compare(to, c->place) <= 0)
        return;
    if (track->legs == REF_LEGS)
        abort();
    bool replanned = track->leg[track->legs].replanned;
    close_legs(track, c);
    struct ref_leg *leg = &track->leg[track->legs++];
    leg->slope = slope;
    leg->replanned = replanned;
    mpf_t way, speed;
    mpf_inits(way, speed, NULL);
    mpf_sub(way, to, c->place);
    mpf_set_si(speed, 2l * slope);
    mpf_mul(speed, speed, way);
    mpf_add(c->square, c->square, speed);
    if (mpf_sgn(c->square) < 0)
        mpf_set_ui(c->square, 0);
    mpf_sqrt(speed, c->square);
    mpf_add(speed, speed, leg->speed); /* time = way / mean speed */
    mpf_mul_2exp(way, way, 1);
    mpf_div(way, way, speed);
    mpf_add(c->time, c->time, way);
    mpf_set(c->place, to);
    mpf_clears(way, speed, NULL);
    close_legs(track, c);
}

/* Square of the highest speed at the end of a segment from which every later limit can be met. */
static void set_limit(mpf_t limit, const struct ref_track *track, unsigned segment)
{
    mpf_t candidate, way;
    mpf_inits(candidate, way, NULL);
    mpf_set_ui(limit, UINT64_C(1) << 62);
    for (unsigned m = segment; m < track->segments; m++) {
        const struct ref_segment *s = &track->segment[m];
        if (m > segment) { /* what the fall through segment m adds */
            mpf_set_ui(candidate, 2ul * s->acceleration);
            mpf_mul_ui(candidate, candidate, s->steps);
            mpf_add(way, way, candidate);
        }
        unsigned next = m + 1 < track->segments ? s[1].speed : track->start_speed;
        if (s->steps == REF_ENDLESS)
            break;
        set_square(candidate, s->speed < next ? s->speed : next);
        mpf_add(candidate, candidate, way);
        if (mpf_cmp(candidate, limit) < 0)
            mpf_set(limit, candidate);
    }
    mpf_clears(candidate, way, NULL);
}

/* place + (to - from) / 2a, but not beyond `end` */
static void set_reach(mpf_t place, const mpf_t start, const mpf_t from, const mpf_t to, unsigned a, const mpf_t end)
{
    mpf_t way;
    mpf_init(way);
    mpf_sub(way, to, from);
    mpf_abs(way, way);
    mpf_div_ui(way, way, 2ul * a);
    mpf_add(place, start, way);
    if (mpf_cmp(place, end) > 0)
        mpf_set(place, end);
    mpf_clear(way);
}

/* Fall to the higher of S and V; from S down the speed changes at once (R6). */
static void fall_to_speed(struct ref_track *track, struct cursor *c, unsigned a, const mpf_t top, const mpf_t end)
{
    mpf_t goal, to;
    mpf_inits(goal, to, NULL);
    set_square(goal, track->start_speed);
    if (mpf_cmp(goal, top) < 0)
        mpf_set(goal, top);
    if (compare(c->square, goal) > 0) {
        set_reach(to, c->place, c->square, goal, a, end);
        go(track, c, -(int)a, to);
    }
    if (compare(c->square, goal) <= 0)
        mpf_set(c->square, top);
    mpf_clears(goal, to, NULL);
}

/* Cross the rest of a segment as fast as its V and the limit at its end allow: rise, hold, fall, each perhaps empty. */
static void cross(struct ref_track *track, struct cursor *c, unsigned i, bool changed)
{
    unsigned a = track->segment[i].acceleration;
    mpf_t end, top, limit, rise, fall, here;
    mpf_inits(end, top, limit, rise, fall, here, NULL);
    mpf_set_ui(end, border(track, i));
    set_square(top, track->segment[i].speed);
    set_limit(limit, track, i);
    if (compare(c->square, top) > 0)
        fall_to_speed(track, c, a, top, end);
    mpf_sub(here, end, c->place); /* limit here: at the end, and the fall to it */
    mpf_mul_ui(here, here, 2ul * a);
    mpf_add(here, here, limit);
    if (changed) { /* up to S at once (R6) */
        set_square(rise, track->start_speed);
        if (mpf_cmp(rise, top) > 0)
            mpf_set(rise, top);
        if (mpf_cmp(rise, here) > 0)
            mpf_set(rise, here);
        if (mpf_cmp(c->square, rise) < 0)
            mpf_set(c->square, rise);
    }
    if (compare(c->place, end) < 0) {
        set_reach(rise, c->place, c->square, top, a, end);
        mpf_set(fall, end);
        if (mpf_cmp(limit, top) < 0) {
            mpf_sub(fall, top, limit);
            mpf_div_ui(fall, fall, 2ul * a);
            mpf_sub(fall, end, fall);
        }
        if (compare(rise, fall) > 0) { /* V is not reached: rise and fall meet where here - 2ad = square + 2ad */
            mpf_sub(fall, here, c->square);
            mpf_div_ui(fall, fall, 4ul * a);
            mpf_add(fall, c->place, fall);
            if (mpf_cmp(fall, end) > 0)
                mpf_set(fall, end);
            mpf_set(rise, fall);
        }
        go(track, c, (int)a, rise);
        go(track, c, 0, fall);
        go(track, c, -(int)a, end);
    }
    mpf_clears(end, top, limit, rise, fall, here, NULL);
}

void ref_plan(struct ref_track *track, unsigned start_speed, const struct ref_segment *segment, unsigned segments)
{
    track->start_speed = start_speed;
    track->segments = segments;
    memmove(track->segment, segment, segments * sizeof *segment);
    track->steps = border(track, segments - 1);
    track->legs = 0;
    track->leg[0].replanned = false;
    track->edge = REF_EDGE_NONE;
    struct cursor c;
    cursor_init(&c);
    set_square(c.square, segment->speed < start_speed ? segment->speed : start_speed);
    mpf_t limit, gain; /* the start, too, must leave time to brake */
    mpf_inits(limit, gain, NULL);
    set_limit(limit, track, 0);
    mpf_set_ui(gain, 2ul * segment->acceleration);
    mpf_mul_ui(gain, gain, segment->steps);
    mpf_add(limit, limit, gain);
    if (mpf_cmp(c.square, limit) > 0)
        mpf_set(c.square, limit);
    for (unsigned i = 0; i < segments; i++)
        cross(track, &c, i, false);
    mpf_clears(limit, gain, NULL);
    cursor_clear(&c);
}

/* ---- Looking at a track ------------------------------------------------------------------------------------------- */

/* Index of the leg at this time; at a corner the later one. `legs` after the end. */
static unsigned leg_at(const struct ref_track *track, const mpf_t time)
{
    unsigned i = track->legs;
    while (i > 0 && compare(track->leg[i].time, time) > 0)
        i--;
    return i;
}

/* Time, place and square of the speed at a tick. Returns the leg. */
static unsigned state_at(const struct ref_track *track, uint64_t tick, struct cursor *c)
{
    mpf_t way;
    mpf_init(way);
    mpf_set_ui(c->time, tick);
    mpf_div_ui(c->time, c->time, MILLION);
    unsigned i = leg_at(track, c->time);
    const struct ref_leg *leg = &track->leg[i];
    mpf_sub(way, c->time, leg->time);
    mpf_mul_ui(c->square, way, (unsigned long)abs(leg->slope)); /* change of speed */
    if (leg->slope < 0)
        mpf_neg(c->square, c->square);
    mpf_div_2exp(c->place, c->square, 1); /* mean speed */
    mpf_add(c->place, c->place, leg->speed);
    mpf_mul(c->place, c->place, way);
    mpf_add(c->place, c->place, leg->place);
    mpf_add(c->square, c->square, leg->speed);
    mpf_mul(c->square, c->square, c->square);
    mpf_clear(way);
    return i;
}

uint64_t ref_tick(const struct ref_track *track, uint64_t k)
{
    unsigned i = track->legs - 1;
    while (i > 0 && mpf_cmp_ui(track->leg[i].place, k) >= 0)
        i--;
    const struct ref_leg *leg = &track->leg[i];
    mpf_t way, speed, root;
    mpf_init2(way, PULSE_BITS);
    mpf_init2(speed, PULSE_BITS);
    mpf_init2(root, PULSE_BITS);
    mpf_ui_sub(way, k, leg->place);
    mpf_mul_2exp(way, way, 1);
    mpf_set(speed, leg->speed);
    mpf_mul(root, speed, speed); /* T = T0 + 2d / (v + sqrt(v^2 + 2ad)) */
    mpf_t change;
    mpf_init2(change, PULSE_BITS);
    mpf_mul_ui(change, way, (unsigned long)abs(leg->slope));
    if (leg->slope < 0)
        mpf_sub(root, root, change);
    else
        mpf_add(root, root, change);
    if (mpf_sgn(root) < 0)
        mpf_set_ui(root, 0);
    mpf_sqrt(root, root);
    mpf_add(root, root, speed);
    mpf_div(way, way, root);
    mpf_add(way, way, leg->time);
    mpf_mul_ui(way, way, MILLION);
    mpf_set_ui(change, 1); /* a time that is a whole tick stays it */
    mpf_div_2exp(change, change, PULSE_BITS / 2);
    mpf_sub(way, way, change);
    mpf_ceil(way, way);
    uint64_t tick = mpf_get_ui(way);
    mpf_clears(way, speed, root, change, NULL);
    return tick;
}

uint64_t ref_steps_at(const struct ref_track *track, uint64_t tick)
{
    struct cursor c;
    cursor_init(&c);
    state_at(track, tick, &c);
    mpf_t same;
    mpf_init_set_ui(same, 1);
    mpf_div_2exp(same, same, SAME_BITS);
    mpf_add(c.place, c.place, same);
    uint64_t steps = mpf_get_ui(c.place);
    mpf_clear(same);
    cursor_clear(&c);
    return steps < track->steps ? steps : track->steps;
}

bool ref_on_final_ramp(const struct ref_track *track, uint64_t tick)
{
    struct cursor c;
    cursor_init(&c);
    unsigned i = state_at(track, tick, &c);
    cursor_clear(&c);
    for (; i < track->legs; i++)
        if (track->leg[i].slope >= 0)
            return false;
    return true;
}

double ref_speed_at(const struct ref_track *track, uint64_t tick)
{
    struct cursor c;
    cursor_init(&c);
    state_at(track, tick, &c);
    mpf_sqrt(c.square, c.square);
    double speed = mpf_get_d(c.square);
    cursor_clear(&c);
    return speed;
}

double ref_place_at(const struct ref_track *track, uint64_t tick)
{
    struct cursor c;
    cursor_init(&c);
    state_at(track, tick, &c);
    double place = mpf_get_d(c.place);
    cursor_clear(&c);
    return place;
}

/* ---- Changes and stops -------------------------------------------------------------------------------------------- */

/* The segment a place lies in; at a border the later one. */
static unsigned segment_at(const struct ref_track *track, const mpf_t place)
{
    mpf_t end;
    mpf_init(end);
    unsigned i = 0;
    for (; i + 1 < track->segments; i++) {
        mpf_set_ui(end, border(track, i));
        if (compare(place, end) < 0)
            break;
    }
    mpf_clear(end);
    return i;
}

/* Forget what was planned for after the cursor, which is in leg i. */
static void cut(struct ref_track *track, unsigned i, const struct cursor *c)
{
    track->legs = compare(c->time, track->leg[i].time) > 0 ? i + 1 : i;
    close_legs(track, c);
    track->leg[track->legs].replanned = true;
}

void ref_change(struct ref_track *track, uint64_t tick, unsigned speed)
{
    if (ref_on_final_ramp(track, tick))
        return;
    struct cursor c;
    cursor_init(&c);
    unsigned leg = state_at(track, tick, &c);
    if (leg < track->legs) {
        cut(track, leg, &c);
        unsigned present = segment_at(track, c.place);
        track->segment[present].speed = speed;
        for (unsigned i = present; i < track->segments; i++)
            cross(track, &c, i, i == present);
    }
    cursor_clear(&c);
}

/* Is x a fraction? Every rational number that a motion can reach has a denominator far below 2^FRACTION_BITS, and its
 * continued fraction then breaks off; that of an irrational number does so only by a chance of 2^-FRACTION_BITS. */
static bool is_rational(const mpf_t x)
{
    mpf_t rest, whole;
    mpz_t q, before, next, digit;
    mpf_inits(rest, whole, NULL);
    mpz_inits(q, before, next, digit, NULL);
    mpf_set(rest, x);
    mpz_set_ui(q, 0);
    mpz_set_ui(before, 1);
    bool rational = false;
    while (mpz_sizeinbase(q, 2) < FRACTION_BITS) {
        mpf_floor(whole, rest);
        mpf_sub(rest, rest, whole);
        mpz_set_f(digit, whole);
        mpz_mul(next, q, digit);
        mpz_add(next, next, before); /* denominators: q' = digit q + q_before, first 0, 1 */
        mpz_set(before, q);
        mpz_set(q, next);
        mpf_mul_2exp(whole, rest, FRACTION_BITS + 20);
        rational = mpf_cmp_ui(whole, 1) < 0;
        if (rational)
            break;
        mpf_ui_div(rest, 1, rest);
    }
    mpf_clears(rest, whole, NULL);
    mpz_clears(q, before, next, digit, NULL);
    return rational;
}

/* The step at which a stop that reaches S at this place ends. */
static uint64_t last_step(const mpf_t place, enum ref_edge *edge)
{
    mpf_t whole, above, same;
    mpf_inits(whole, above, NULL);
    mpf_init_set_ui(same, 1);
    mpf_div_2exp(same, same, SAME_BITS);
    mpf_add(whole, place, same);
    mpf_floor(whole, whole);
    mpf_sub(above, place, whole);
    uint64_t step = mpf_get_ui(whole);
    *edge = REF_EDGE_NONE;
    if (mpf_cmp(above, same) < 0) {
        *edge = REF_EDGE_WHOLE;
    } else {
        mpf_mul_ui(above, above, MILLION);
        if (mpf_cmp_ui(above, 1) < 0)
            *edge = is_rational(place) ? REF_EDGE_RATIONAL : REF_EDGE_IRRATIONAL;
        if (*edge != REF_EDGE_IRRATIONAL)
            step++;
    }
    mpf_clears(whole, above, same, NULL);
    return step;
}

void ref_stop(struct ref_track *track, uint64_t tick)
{
    track->edge = REF_EDGE_NONE;
    if (ref_on_final_ramp(track, tick))
        return;
    struct cursor c;
    mpf_t to, goal, end;
    cursor_init(&c);
    mpf_inits(to, goal, end, NULL);
    unsigned leg = state_at(track, tick, &c);
    cut(track, leg, &c);
    set_square(goal, track->start_speed);
    for (unsigned i = segment_at(track, c.place); i < track->segments && compare(c.square, goal) > 0; i++) {
        mpf_set_ui(end, border(track, i));
        set_reach(to, c.place, c.square, goal, track->segment[i].acceleration, end);
        go(track, &c, -(int)track->segment[i].acceleration, to);
    }
    uint64_t step = last_step(c.place, &track->edge);
    if (step < track->steps)
        track->steps = step;
    mpf_set_ui(to, track->steps);
    go(track, &c, 0, to);
    close_legs(track, &c);
    mpf_clears(to, goal, end, NULL);
    cursor_clear(&c);
}

bool ref_plan_rest(struct ref_track *track, const struct ref_track *from)
{
    struct ref_segment rest[REF_SEGMENTS];
    unsigned n = 0;
    uint64_t done = from->steps;
    for (unsigned i = 0; i < from->segments; i++) {
        const struct ref_segment *s = &from->segment[i];
        if (s->steps == REF_ENDLESS) {
            rest[n++] = *s;
        } else if (done < s->steps) {
            rest[n] = *s;
            rest[n++].steps -= done;
            done = 0;
        } else {
            done -= s->steps;
        }
    }
    if (n > 0)
        ref_plan(track, from->start_speed, rest, n);
    return n > 0;
}

/* ---- P7 ----------------------------------------------------------------------------------------------------------- */

/* The speed with which the leg before leg i ends. */
static void set_arrival(mpf_t speed, const struct ref_track *track, unsigned i)
{
    const struct ref_leg *before = &track->leg[i - 1];
    mpf_sub(speed, track->leg[i].time, before->time);
    mpf_mul_ui(speed, speed, (unsigned long)abs(before->slope));
    if (before->slope < 0)
        mpf_neg(speed, speed);
    mpf_add(speed, speed, before->speed);
}

/* The points of a table as they gather; equal neighbours merge. */
struct points {
    char text[1024], last[64];
    unsigned count;
};

static void add_point(struct points *points, const struct ref_track *track, const mpf_t place, const mpf_t speed)
{
    char point[64];
    mpf_t same, number;
    mpf_init(number);
    mpf_init_set_ui(same, 1);
    mpf_div_2exp(same, same, SAME_BITS);
    mpf_add(number, place, same);
    uint64_t step = mpf_get_ui(number) + 1;
    mpf_add(number, speed, same);
    snprintf(point, sizeof point, "(%lu;%lu),", (unsigned long)(step < track->steps ? step : track->steps), mpf_get_ui(number));
    mpf_clears(same, number, NULL);
    if (strcmp(point, points->last) == 0)
        return;
    strcpy(points->last, point);
    strncat(points->text, point, sizeof points->text - strlen(points->text) - 1);
    points->count++;
}

/* Where the speed jumps, both speeds are corners. */
void ref_table(const struct ref_track *track, char *text, size_t room)
{
    struct points points = {.count = 0};
    mpf_t arrival;
    mpf_init(arrival);
    for (unsigned i = 0; i < track->legs; i++) {
        const struct ref_leg *leg = &track->leg[i];
        if (i > 0) {
            set_arrival(arrival, track, i);
            bool even = compare(arrival, leg->speed) == 0;
            if (even && leg->slope == leg[-1].slope && !leg->replanned)
                continue;
            if (!even)
                add_point(&points, track, leg->place, arrival);
        }
        add_point(&points, track, leg->place, leg->speed);
    }
    mpf_clear(arrival);
    if (track->steps >= REF_ENDLESS) {
        points.text[strlen(points.text) - 1] = '\0';
        snprintf(text, room, " %u;[%s]", points.count, points.text);
    } else {
        snprintf(text, room, " %u;[%s(%lu;0)]", points.count + 1, points.text, (unsigned long)track->steps);
    }
}
