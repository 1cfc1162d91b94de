/* SPDX-License-Identifier: MIT */
#include "pmc_rig.h"

#include <stdlib.h>
#include <string.h>

struct pmc_unit unit;
struct flash_fake flash;
size_t pulses[PMC_AXES];
uint64_t *pulse[PMC_AXES];
int32_t reported[PMC_AXES];
struct happening happening[HAPPENINGS_MAX];
size_t happenings;

/* The switches of an axis, and how many of its pulses they have seen. */
static struct plant {
    struct rig_switch sw[RIG_SWITCHES];
    bool on[RIG_SWITCHES];
    int32_t position;
    size_t switches, seen;
} plant[PMC_AXES];
static uint16_t levels;
static bool forward[PMC_AXES];
static uint8_t *directions[PMC_AXES]; /* of each pulse */

/* ---- Reports: a failing assertion of Check is quick, one that holds is not ---- */

static void on_steps(void *context, unsigned axis, const uint64_t *tick, size_t count, int32_t position, bool is_forward)
{
    if (context != &flash || pulses[axis] + count > PULSES_MAX || is_forward != forward[axis])
        ck_abort_msg("wrong context or direction, or too many pulses");
    for (size_t i = 0; i < count; i++) {
        if (pulses[axis] > 0 && tick[i] <= pulse[axis][pulses[axis] - 1])
            ck_abort_msg("pulses out of order");
        directions[axis][pulses[axis]] = is_forward;
        pulse[axis][pulses[axis]++] = tick[i];
    }
    reported[axis] = position + (is_forward ? (int32_t)count - 1 : 1 - (int32_t)count);
    if (reported[axis] < PMC_COUNTER_MIN || reported[axis] > PMC_COUNTER_MAX)
        ck_abort_msg("the counter wraps within a block");
}

static void note(uint64_t tick, enum happening_kind kind, unsigned axis, unsigned what, uint32_t value)
{
    if (happenings < HAPPENINGS_MAX)
        happening[happenings++] = (struct happening){tick, kind, axis, what, value};
}

static void on_direction(void *context, uint64_t tick, unsigned axis, bool is_forward)
{
    (void)context;
    forward[axis] = is_forward;
    note(tick, HAPPENED_DIRECTION, axis, 0, is_forward);
}

static void on_outputs(void *context, uint64_t tick, uint8_t mask)
{
    (void)context;
    note(tick, HAPPENED_OUTPUTS, 0, 0, mask);
}

static void on_event(void *context, uint64_t tick, unsigned axis, enum pmc_event what, uint32_t value)
{
    (void)context;
    note(tick, HAPPENED_EVENT, axis, what, value);
}

static const struct pmc_port port = {
    .steps = on_steps,
    .direction = on_direction,
    .outputs = on_outputs,
    .event = on_event,
    .flash_read = flash_fake_read,
    .flash_erase = flash_fake_erase,
    .flash_program = flash_fake_program,
};

/* ---- Switches ---- */

static bool is_inside(const struct rig_switch *sw, int32_t position, int32_t wider)
{
    return (sw->from == -RIG_FAR || position >= sw->from - wider) && (sw->to == RIG_FAR || position <= sw->to + wider);
}

static void follow(struct plant *axis)
{
    for (size_t i = 0; i < axis->switches; i++)
        axis->on[i] = is_inside(&axis->sw[i], axis->position, axis->on[i] ? axis->sw[i].hysteresis : 0);
}

/* Let the switches follow the pulses made so far, and the inputs the switches. */
static void update_inputs(void)
{
    uint16_t mask = levels;
    for (unsigned i = 0; i < PMC_AXES; i++) {
        for (; plant[i].seen < pulses[i]; plant[i].seen++) {
            plant[i].position += directions[i][plant[i].seen] ? 1 : -1;
            follow(&plant[i]);
        }
        for (size_t s = 0; s < plant[i].switches; s++)
            if (plant[i].on[s])
                mask |= (uint16_t)((unsigned)plant[i].sw[s].input << PMC_INPUT_SHIFT * i);
    }
    pmc_set_inputs(&unit, mask);
}

void rig_plant(unsigned axis, int32_t position, const struct rig_switch *switches, size_t count)
{
    ck_assert_uint_le(count, RIG_SWITCHES);
    plant[axis] = (struct plant){.position = position, .switches = count, .seen = pulses[axis]};
    if (count > 0)
        memcpy(plant[axis].sw, switches, count * sizeof *switches);
    follow(&plant[axis]);
    update_inputs();
}

int32_t rig_true(unsigned axis)
{
    update_inputs();
    return plant[axis].position;
}

void rig_inputs(uint16_t mask)
{
    levels = mask;
    update_inputs();
}

/* ---- Power, requests, time ---- */

void pmc_rig_restart(const struct pmc_config *config)
{
    for (unsigned i = 0; i < PMC_AXES; i++) {
        if (!pulse[i])
            pulse[i] = malloc(PULSES_MAX * sizeof *pulse[i]);
        if (!directions[i])
            directions[i] = malloc(PULSES_MAX);
        ck_assert(pulse[i] && directions[i]);
        pulses[i] = 0;
        reported[i] = 0;
        forward[i] = true;
        plant[i] = (struct plant){0};
    }
    happenings = 0;
    levels = 0;
    pmc_init(&unit, config, &port, &flash);
}

void pmc_rig_begin(const struct pmc_config *config)
{
    flash_fake_init(&flash);
    pmc_rig_restart(config);
}

enum pmc_answer ask(enum pmc_request_kind kind, unsigned axes, int32_t x, int32_t y)
{
    const struct pmc_request request = {.kind = (uint8_t)kind, .axes = (uint8_t)axes, .value = {x, y}};
    return pmc_request(&unit, &request);
}

void must(enum pmc_request_kind kind, unsigned axes, int32_t x, int32_t y)
{
    ck_assert_int_eq(ask(kind, axes, x, y), PMC_OK);
}

void set(unsigned axis, enum pmc_parameter which, int32_t value)
{
    ck_assert_int_eq(pmc_set_parameter(&unit, axis, which, value), PMC_OK);
}

void reg(unsigned axis, unsigned number, struct pmc_command command)
{
    ck_assert_int_eq(pmc_set_command(&unit, axis, number, &command), PMC_OK);
}

void run_to(uint64_t tick)
{
    while (pmc_now(&unit) < tick) {
        const uint64_t slot = (pmc_now(&unit) + SLOT - 1) / SLOT * SLOT, end = pmc_now(&unit) == slot ? slot + 1 : slot;
        update_inputs();
        pmc_advance(&unit, (end < tick ? end : tick) - pmc_now(&unit));
    }
    update_inputs();
}

void run_to_slot(uint64_t number)
{
    run_to(number * SLOT);
}

void run_through_slot(uint64_t number)
{
    run_to(number * SLOT + 1);
}

void run_until_idle(unsigned axis)
{
    for (unsigned slots = 0; pmc_is_busy(&unit, axis); slots++) {
        ck_assert_uint_lt(slots, 60000);
        run_through_slot((pmc_now(&unit) + SLOT - 1) / SLOT);
    }
}

struct pmc_axis_state axis_state(unsigned axis)
{
    struct pmc_axis_state state;
    pmc_axis_state(&unit, axis, &state);
    return state;
}

uint64_t slot_of_reg(unsigned axis, unsigned number, unsigned n)
{
    for (size_t i = 0; i < happenings; i++) {
        const struct happening *one = &happening[i];
        if (one->kind == HAPPENED_EVENT && one->what == PMC_EVENT_COMMAND && one->axis == axis && one->value == number + 1 &&
            n-- == 0)
            return one->tick / SLOT;
    }
    return 0;
}
