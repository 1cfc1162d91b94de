/* SPDX-License-Identifier: MIT */
#include "plant.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "plant_model.h"

static size_t size_of(unsigned axes)
{
    return sizeof(struct plant) + axes * sizeof(struct plant_motor);
}

struct plant *plant_new(unsigned axes)
{
    struct plant *plant = calloc(1, size_of(axes));
    if (plant)
        plant->axes = axes;
    for (unsigned at = 0; plant && at < axes; at++) {
        plant->motor[at].low = INT64_MIN;
        plant->motor[at].high = INT64_MAX;
        plant->motor[at].stall.last = DEVICE_NEVER;
        for (uint8_t lead = 0; lead < 4u; lead++)
            plant->motor[at].lead[lead] = (uint8_t)(lead + 1u);
    }
    return plant;
}

void plant_free(struct plant *plant)
{
    free(plant);
}

/* ---- Reports -------------------------------------------------------------------------------------------------------- */

static void drop_report(struct plant *plant)
{
    plant->reports--;
    memmove(&plant->report[0], &plant->report[1], plant->reports * sizeof plant->report[0]);
}

__attribute__((format(printf, 5, 6))) static void report(struct plant *plant, uint64_t tick, unsigned at, enum plant_event news,
                                                         const char *format, ...)
{
    va_list list;
    if (plant->reports == PLANT_REPORTS) /* not taken: the newest ones matter */
        drop_report(plant);
    struct plant_report *entry = &plant->report[plant->reports++];
    *entry = (struct plant_report){.tick = tick, .motor = (uint8_t)(at + 1u), .news = (uint8_t)news};
    va_start(list, format);
    vsnprintf(entry->text, sizeof entry->text, format, list);
    va_end(list);
}

/* Steps begin to be lost, for another reason than before, or count again. */
static void report_hold(struct plant *plant, uint64_t tick, unsigned at, enum plant_hold hold)
{
    const struct plant_motor *motor = &plant->motor[at];
    unsigned number = at + 1u;
    long long position = motor->position;
    switch (hold) {
    case PLANT_MOVES:
        report(plant, tick, at, PLANT_FREE, "motor %u moves again, at %lld, after %llu lost steps", number, position,
               (unsigned long long)motor->lost_since);
        break;
    case PLANT_AT_STOP:
        report(plant, tick, at, PLANT_END_STOP, "motor %u runs against its end stop at %lld", number, position);
        break;
    case PLANT_JAMMED:
        report(plant, tick, at, PLANT_JAM, "motor %u is jammed at %lld", number, position);
        break;
    case PLANT_STALLED:
        report(plant, tick, at, PLANT_STALL, "motor %u stalls at %lld: too fast or too steep for it", number, position);
        break;
    case PLANT_NO_TORQUE:
        report(plant, tick, at, PLANT_FIELD, "motor %u does not turn, at %lld: the field of its coils points away from it",
               number, position);
        break;
    case PLANT_NO_LEAD:
        report(plant, tick, at, PLANT_LEAD, "motor %u does not turn, at %lld: a lead is missing", number, position);
        break;
    }
}

bool plant_take_report(struct plant *plant, struct plant_report *taken)
{
    if (plant->reports == 0)
        return false;
    *taken = plant->report[0];
    drop_report(plant);
    return true;
}

const char *plant_event_name(enum plant_event news)
{
    static const char *const names[] = {
        [PLANT_STALL] = "stall", [PLANT_END_STOP] = "end_stop",   [PLANT_JAM] = "jam",
        [PLANT_FREE] = "free",   [PLANT_LEAD] = "missing_lead", [PLANT_FIELD] = "wrong_field",
    };
    return (unsigned)news < sizeof names / sizeof names[0] ? names[news] : "?";
}

/* ---- Switches ------------------------------------------------------------------------------------------------------- */

static int64_t modulo(int64_t number, int64_t turn)
{
    return (number % turn + turn) % turn;
}

/* Is the motor between low - wider and high + wider? */
static bool within(const struct plant_motor *motor, const struct plant_switch *contact, int64_t wider)
{
    if (motor->turn > 0)
        return modulo(motor->position - contact->low + wider, motor->turn) <=
               modulo(contact->high - contact->low, motor->turn) + 2 * wider;
    return (contact->low == INT64_MIN || motor->position >= contact->low - wider) &&
           (contact->high == INT64_MAX || motor->position <= contact->high + wider);
}

void plant_switch_begin(const struct plant *plant, struct plant_switch *contact)
{
    contact->on = contact->contact = within(&plant->motor[contact->motor - 1u], contact, 0);
    contact->next = DEVICE_NEVER;
}

static uint64_t next_random(uint64_t *state)
{
    *state ^= *state << 13; /* xorshift64 */
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return *state;
}

static void plan_bounce(struct plant_switch *contact, uint64_t tick)
{
    uint64_t longest = contact->bounce / 4 + 1;
    contact->next = tick + 1 + next_random(&contact->random) % longest;
    if (contact->next > contact->settled)
        contact->next = contact->settled;
}

/* Its motor has moved. What follows can be seen at `tick`. */
static void switch_follows(const struct plant *plant, struct plant_switch *contact, uint64_t tick)
{
    bool on = within(&plant->motor[contact->motor - 1u], contact, contact->on ? contact->hysteresis : 0);
    if (on == contact->on)
        return;
    contact->on = contact->contact = on;
    contact->settled = tick + contact->bounce;
    contact->next = DEVICE_NEVER;
    if (contact->bounce > 0)
        plan_bounce(contact, tick);
}

static void bounce(struct plant_switch *contact)
{
    uint64_t tick = contact->next;
    contact->next = DEVICE_NEVER;
    contact->contact = tick < contact->settled ? !contact->contact : contact->on;
    if (tick < contact->settled)
        plan_bounce(contact, tick);
}

static void switches_follow(struct plant *plant, unsigned motor, uint64_t tick)
{
    for (unsigned i = 0; i < plant->switches; i++)
        if (plant->contact[i].motor == motor)
            switch_follows(plant, &plant->contact[i], tick);
}

uint32_t plant_contacts(const struct plant *plant)
{
    uint32_t levels = 0;
    for (unsigned i = 0; i < plant->switches; i++) {
        const struct plant_switch *contact = &plant->contact[i];
        if (contact->contact != contact->normally_closed)
            levels |= UINT32_C(1) << (contact->input - 1u);
    }
    return levels;
}

uint32_t plant_mask(const struct plant *plant)
{
    return plant->mask;
}

uint32_t plant_levels(const struct plant *plant)
{
    return plant->levels;
}

/* ---- Motors --------------------------------------------------------------------------------------------------------- */

static bool is_jammed(const struct plant_motor *motor, uint64_t tick)
{
    bool jammed = motor->held;
    for (unsigned i = 0; i < motor->jams; i++)
        jammed = jammed || (tick >= motor->jam[i].from && tick < motor->jam[i].until);
    return jammed;
}

bool plant_is_jammed(const struct plant *plant, unsigned number)
{
    return is_jammed(&plant->motor[number - 1u], plant->now);
}

static bool is_at_stop(const struct plant_motor *motor, bool forward)
{
    return forward ? motor->position >= motor->high : motor->position <= motor->low;
}

/* What becomes of a pulse? */
static enum plant_hold decide_pulse(struct plant_motor *motor, uint64_t tick, bool forward)
{
    bool follows = stall_follows(&motor->stall, tick, forward);
    enum plant_hold hold = motor->no_lead             ? PLANT_NO_LEAD
                           : is_jammed(motor, tick)      ? PLANT_JAMMED
                           : is_at_stop(motor, forward)  ? PLANT_AT_STOP
                           : !follows                 ? PLANT_STALLED
                                                      : PLANT_MOVES;
    if (hold != PLANT_MOVES)
        stall_slips(&motor->stall);
    return hold;
}

static void set_hold(struct plant *plant, uint64_t tick, unsigned at, enum plant_hold hold)
{
    struct plant_motor *motor = &plant->motor[at];
    if (hold != motor->hold)
        report_hold(plant, tick, at, hold);
    if (motor->hold == PLANT_MOVES || hold == PLANT_MOVES)
        motor->lost_since = 0;
    motor->hold = hold;
    if (hold != PLANT_MOVES) {
        motor->lost++;
        motor->lost_since++;
    }
}

static void move_step(struct plant *plant, uint64_t tick, unsigned at, bool forward)
{
    plant->motor[at].position += forward ? 1 : -1;
    switches_follow(plant, at + 1u, tick + 1u);
}

/* The field has changed: the rotor turns to it. */
static void turn_rotor(struct plant *plant, uint64_t tick, unsigned at, unsigned field)
{
    struct plant_motor *motor = &plant->motor[at];
    bool opposite;
    int turn = coils_turn(motor, field, &opposite);
    if (turn == 0 && !opposite)
        return;
    enum plant_hold hold = opposite ? PLANT_NO_TORQUE : decide_pulse(motor, tick, turn > 0);
    set_hold(plant, tick, at, hold);
    if (hold != PLANT_MOVES)
        return;
    motor->angle = (uint8_t)field;
    motor->part = (int8_t)(motor->part + turn);
    for (; motor->part >= motor->eighths; motor->part = (int8_t)(motor->part - motor->eighths))
        move_step(plant, tick, at, true);
    for (; motor->part < 0; motor->part = (int8_t)(motor->part + motor->eighths))
        move_step(plant, tick, at, false);
}

/* Do the first pulse of a motor. */
static void move_axis(struct plant *plant, unsigned at)
{
    struct plant_motor *motor = &plant->motor[at];
    uint64_t tick = motor->pulse[motor->first].tick;
    unsigned what = motor->pulse[motor->first].what;
    motor->first = (motor->first + 1u) % PLANT_PULSES;
    motor->pulses--;
    if (motor->eighths > 0) {
        turn_rotor(plant, tick, at, what);
        return;
    }
    enum plant_hold hold = decide_pulse(motor, tick, what == 1);
    set_hold(plant, tick, at, hold);
    if (hold == PLANT_MOVES)
        move_step(plant, tick, at, what == 1);
}

void plant_queue(struct plant *plant, uint64_t tick, unsigned number, unsigned what)
{
    struct plant_motor *motor = &plant->motor[number - 1u];
    if (motor->pulses == PLANT_PULSES)
        move_axis(plant, number - 1u);
    unsigned last = (motor->first + motor->pulses++) % PLANT_PULSES;
    motor->pulse[last].tick = tick & ((UINT64_C(1) << 56) - 1u);
    motor->pulse[last].what = what & 0xFFu;
}

void plant_step(struct plant *plant, uint64_t tick, unsigned number, bool forward)
{
    if (plant->motor[number - 1u].present)
        plant_queue(plant, tick, number, forward);
}

bool plant_position(const struct plant *plant, unsigned number, int64_t *position)
{
    const struct plant_motor *motor = number >= 1 && number <= plant->axes ? &plant->motor[number - 1u] : NULL;
    if (!motor || !motor->present)
        return false;
    *position = motor->position;
    return true;
}

/* ---- Time ----------------------------------------------------------------------------------------------------------- */

/* The switch that bounces next; NULL: none does. */
static struct plant_switch *next_bounce(struct plant *plant)
{
    struct plant_switch *next = NULL;
    for (unsigned i = 0; i < plant->switches; i++)
        if (plant->contact[i].next != DEVICE_NEVER && (!next || plant->contact[i].next < next->next))
            next = &plant->contact[i];
    return next;
}

/* Do the first thing that can be seen before `tick`. A pulse can be seen one tick later. Returns false if there is none. */
static bool apply_next(struct plant *plant, uint64_t tick)
{
    struct plant_switch *contact = next_bounce(plant);
    uint64_t first = contact ? contact->next : DEVICE_NEVER;
    unsigned at = plant->axes;
    for (unsigned i = 0; i < plant->axes; i++) {
        const struct plant_motor *motor = &plant->motor[i];
        if (motor->pulses == 0 || motor->pulse[motor->first].tick + 1u >= first)
            continue;
        first = motor->pulse[motor->first].tick + 1u;
        at = i;
    }
    if (first >= tick) {
        plant->now = tick > plant->now ? tick : plant->now;
        return false;
    }
    if (at < plant->axes)
        move_axis(plant, at);
    else
        bounce(contact);
    plant->now = first;
    return true;
}

bool plant_take_change(struct plant *plant, uint64_t tick, struct plant_change *change)
{
    uint32_t levels;
    do {
        levels = plant_contacts(plant) & plant->mask;
    } while (levels == plant->levels && apply_next(plant, tick));
    if (levels == plant->levels)
        return false;
    uint32_t differ = levels ^ plant->levels;
    unsigned input = 1;
    while ((differ >> (input - 1u) & 1u) == 0)
        input++;
    uint32_t bit = UINT32_C(1) << (input - 1u);
    plant->levels ^= bit;
    *change = (struct plant_change){plant->now, (uint8_t)input, (levels & bit) != 0};
    return true;
}

uint64_t plant_next(const struct plant *plant)
{
    uint64_t next = DEVICE_NEVER;
    for (unsigned i = 0; i < plant->switches; i++)
        if (plant->contact[i].next < next)
            next = plant->contact[i].next;
    return next;
}

static void shift_time(uint64_t *tick, uint64_t shift)
{
    if (*tick != DEVICE_NEVER)
        *tick += shift;
}

static void shift_motor(struct plant_motor *motor, uint64_t shift)
{
    for (unsigned i = 0; i < motor->jams; i++) {
        shift_time(&motor->jam[i].from, shift);
        shift_time(&motor->jam[i].until, shift);
    }
    for (unsigned i = 0; i < PLANT_PULSES; i++)
        motor->pulse[i].tick = (motor->pulse[i].tick + shift) & ((UINT64_C(1) << 56) - 1u);
    shift_time(&motor->stall.last, shift);
    motor->stall.begin += shift;
}

struct plant *plant_copy(const struct plant *plant, uint64_t shift)
{
    struct plant *copy = malloc(size_of(plant->axes));
    if (!copy)
        return NULL;
    memcpy(copy, plant, size_of(plant->axes));
    for (unsigned at = 0; at < copy->axes; at++)
        shift_motor(&copy->motor[at], shift);
    for (unsigned i = 0; i < copy->switches; i++) {
        shift_time(&copy->contact[i].next, shift);
        copy->contact[i].settled += shift;
    }
    for (unsigned i = 0; i < copy->reports; i++)
        copy->report[i].tick += shift;
    copy->now += shift;
    return copy;
}

/* ---- Hands ---------------------------------------------------------------------------------------------------------- */

static struct plant_motor *motor_of(struct plant *plant, unsigned number)
{
    struct plant_motor *motor = plant && number >= 1 && number <= plant->axes ? &plant->motor[number - 1u] : NULL;
    return motor && motor->present ? motor : NULL;
}

bool plant_place(struct plant *plant, uint64_t tick, unsigned number, int64_t position)
{
    struct plant_motor *motor = motor_of(plant, number);
    if (!motor || position < motor->low || position > motor->high)
        return false;
    motor->position = position;
    plant->now = tick;
    switches_follow(plant, number, tick);
    return true;
}

bool plant_jam(struct plant *plant, unsigned number, bool held)
{
    struct plant_motor *motor = motor_of(plant, number);
    if (motor)
        motor->held = held;
    return motor;
}

bool plant_take_lead(struct plant *plant, unsigned number, bool missing)
{
    struct plant_motor *motor = motor_of(plant, number);
    if (motor)
        motor->no_lead = missing;
    return motor;
}
