/* SPDX-License-Identifier: MIT */
#include "pwm.h"

static unsigned place_of(unsigned output)
{
    return output < 4 ? output / 2 : 2;
}

void pwm_reset(struct cib_unit *unit)
{
    for (unsigned i = 0; i < CIB_OUTPUTS; i++)
        unit->pwm[i] = (struct cib_pwm){.from = unit->since};
}

/* The last beginning of a period at or before `tick`. */
static uint64_t period_begin(const struct cib_unit *unit, unsigned output, uint64_t tick)
{
    return tick - (tick - unit->since) % unit->setup.period[place_of(output)];
}

void pwm_write(struct cib_unit *unit, unsigned output, uint16_t duty)
{
    struct cib_pwm *pwm = &unit->pwm[output];
    uint64_t begin = period_begin(unit, output, unit->now);
    if (begin < unit->now)
        begin += unit->setup.period[place_of(output)];
    if (pwm->from < unit->now) /* else the present duty has not counted yet */
        pwm->before = pwm->duty;
    pwm->from = begin;
    pwm->duty = duty;
}

/* Ticks of the pulse in the period that begins at `begin` (BW2). */
static uint32_t pulse_at(const struct cib_unit *unit, unsigned output, uint64_t begin)
{
    const struct cib_pwm *pwm = &unit->pwm[output];
    const uint64_t duty = begin >= pwm->from ? pwm->duty : pwm->before;
    return (uint32_t)((unit->setup.period[place_of(output)] * duty + CIB_DUTY_MAX / 2) / CIB_DUTY_MAX);
}

/* Is the pulse on during the tick in front of `tick`? */
static bool is_pulse(const struct cib_unit *unit, unsigned output, uint64_t tick)
{
    if (tick <= unit->since)
        return false;
    const uint64_t begin = period_begin(unit, output, tick - 1);
    return tick - 1 - begin < pulse_at(unit, output, begin);
}

uint8_t pwm_levels(const struct cib_unit *unit, uint64_t tick)
{
    unsigned levels = 0;
    for (unsigned i = 0; i < CIB_OUTPUTS; i++)
        levels |= (unsigned)is_pulse(unit, i, tick) << i;
    return (uint8_t)(levels ^ ~(unsigned)unit->setup.active);
}

/* The same of one output. An edge is where a period or its pulse begins or ends; after the period in which a new duty counts
 * first each is like the other. */
static uint64_t next_edge(const struct cib_unit *unit, unsigned output, uint64_t tick)
{
    uint64_t begin = period_begin(unit, output, tick);
    for (unsigned i = 0; i < 3; i++) {
        const uint64_t edge[] = {begin, begin + pulse_at(unit, output, begin)};
        for (unsigned j = 0; j < 2; j++)
            if (edge[j] >= tick && is_pulse(unit, output, edge[j]) != is_pulse(unit, output, edge[j] + 1))
                return edge[j];
        begin += unit->setup.period[place_of(output)];
    }
    return CIB_NEVER;
}

uint64_t pwm_next_edge(const struct cib_unit *unit, uint64_t tick)
{
    uint64_t next = CIB_NEVER;
    for (unsigned i = 0; i < CIB_OUTPUTS; i++) {
        if (unit->setup.use[place_of(i)] != CIB_USE_PWM)
            continue;
        const uint64_t edge = next_edge(unit, i, tick);
        next = edge < next ? edge : next;
    }
    return next;
}
