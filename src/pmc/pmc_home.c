/* SPDX-License-Identifier: MIT */
#include "pmc_home.h"

#include "pmc_motion.h"
#include "pmc_report.h"

/* Pulses of a phase, at most (AH6). */
#define PULSES_MAX (INT64_C(1) << 24)

enum phase {
    PHASE_NONE,
    PHASE_NEAR,     /* step 1 */
    PHASE_STEP2,    /* where step 2 begins; also the ramp of step 1 */
    PHASE_AWAY,     /* step 2 (c) */
    PHASE_BACK_OFF, /* step 2 (a) */
    PHASE_SEEK,     /* step 2 (b) */
    PHASE_Z,        /* step 3 */
    PHASE_OFFSET,   /* step 4 */
    PHASE_FOUND     /* all steps are done */
};

/* A phase moves in the direction of its step, or back, until its input is active, or is not. */
static const struct phase_row {
    uint8_t step;  /* 0..3 */
    uint8_t next;  /* phase behind it; also where its step is off */
    uint8_t input; /* 0: it has an end of its own */
    bool back, until_off;
} rows[] = {
    [PHASE_NEAR] = {.step = 0, .next = PHASE_STEP2, .input = PMC_NEAR},
    [PHASE_STEP2] = {.step = 1, .next = PHASE_Z},
    [PHASE_AWAY] = {.step = 1, .next = PHASE_BACK_OFF, .input = PMC_HOME, .back = true},
    [PHASE_BACK_OFF] = {.step = 1, .next = PHASE_SEEK, .input = PMC_HOME, .back = true, .until_off = true},
    [PHASE_SEEK] = {.step = 1, .next = PHASE_Z, .input = PMC_HOME},
    [PHASE_Z] = {.step = 2, .next = PHASE_OFFSET, .input = PMC_Z},
    [PHASE_OFFSET] = {.step = 3, .next = PHASE_FOUND},
    [PHASE_FOUND] = {0},
};

static bool is_forward(const struct pmc_axis *axis, const struct phase_row *row)
{
    return ((axis->parameters.value[PMC_STEPS] & (int32_t)PMC_STEP_PLUS(row->step)) != 0) != row->back;
}

static bool has_reached(const struct pmc_axis *axis, const struct phase_row *row)
{
    return row->input != 0 && ((axis->inputs & row->input) != 0) != row->until_off;
}

static void set_phase(struct pmc_axis *axis, unsigned phase)
{
    axis->phase = (uint8_t)phase;
    axis->begun = false;
}

static void fail(struct pmc_unit *unit, struct pmc_axis *axis)
{
    pmc_motion_stop_now(unit, axis);
    set_phase(axis, PHASE_NONE);
    pmc_raise(unit, axis, PMC_ERROR_HOM);
}

/* A limit switch is in the way of the phase, at its begin or under way (AH3, AH4). */
static void meet_limit(struct pmc_unit *unit, struct pmc_axis *axis)
{
    if (axis->phase == PHASE_NEAR) {
        if (axis->parameters.value[PMC_FLAGS] & PMC_FLAG_SLOW_LIMIT)
            pmc_motion_stop(unit, axis);
        else
            pmc_motion_stop_now(unit, axis);
        set_phase(axis, PHASE_STEP2);
    } else if (axis->phase == PHASE_SEEK && !axis->turned) {
        axis->turned = true;
        pmc_motion_stop_now(unit, axis);
        set_phase(axis, PHASE_AWAY);
    } else {
        fail(unit, axis);
    }
}

/* The motion of step 1 after `near`: its end is near, but a limit that stops at once does so. */
static void watch_ramp(struct pmc_unit *unit, struct pmc_axis *axis)
{
    const bool slow = (axis->parameters.value[PMC_FLAGS] & PMC_FLAG_SLOW_LIMIT) != 0;
    if (!slow && pmc_at_limit(axis, axis->motion.forward))
        pmc_motion_stop_now(unit, axis);
}

/* While it moves. */
static void watch_phase(struct pmc_unit *unit, struct pmc_axis *axis)
{
    const struct phase_row *row = &rows[axis->phase];
    if (!axis->begun) {
        watch_ramp(unit, axis);
    } else if (has_reached(axis, row)) {
        if (axis->phase == PHASE_NEAR)
            pmc_motion_stop(unit, axis);
        else
            pmc_motion_stop_now(unit, axis);
        set_phase(axis, row->next);
    } else if (pmc_at_limit(axis, axis->motion.forward)) {
        meet_limit(unit, axis);
    }
}

static void begin_motion(struct pmc_unit *unit, struct pmc_axis *axis, const struct phase_row *row)
{
    const int32_t *value = axis->parameters.value;
    const bool fast = row->step == 0 || row->step == 3;
    struct pmc_move move = {.way = row->input != 0 ? PULSES_MAX : value[PMC_HOME_OFFSET],
                            .speed = (uint16_t)value[fast ? PMC_HOME_HIGH : PMC_HOME_LOW]};
    move.start_speed = fast ? (uint16_t)value[PMC_START_SPEED] : move.speed;
    if (!is_forward(axis, row))
        move.way = -move.way;
    pmc_motion_begin(unit, axis, &move);
    axis->begun = true;
}

/* Nothing moves: begin the phase, or pass it over. */
static void begin_phase(struct pmc_unit *unit, struct pmc_axis *axis)
{
    const struct phase_row *row = &rows[axis->phase];
    const bool at_limit = pmc_at_limit(axis, is_forward(axis, row));
    if (!(axis->parameters.value[PMC_STEPS] & (int32_t)PMC_STEP_ON(row->step))) {
        set_phase(axis, row->next);
    } else if (axis->phase == PHASE_STEP2) {
        axis->turned = at_limit && !(axis->inputs & PMC_HOME);
        set_phase(axis, axis->turned ? PHASE_AWAY : PHASE_BACK_OFF);
    } else if (has_reached(axis, row)) {
        if (axis->phase == PHASE_Z)
            fail(unit, axis);
        else
            set_phase(axis, row->next);
    } else if (axis->phase == PHASE_OFFSET && axis->parameters.value[PMC_HOME_OFFSET] == 0) {
        set_phase(axis, row->next);
    } else if (at_limit) {
        meet_limit(unit, axis);
    } else {
        begin_motion(unit, axis, row);
    }
}

static void finish(struct pmc_unit *unit, struct pmc_axis *axis)
{
    set_phase(axis, PHASE_NONE);
    axis->homed = true;
    if (axis->parameters.value[PMC_FLAGS] & PMC_FLAG_CLEAR_AT_HOME) {
        pmc_set_commanded(unit, axis, 0);
        axis->actual = 0;
    }
}

void pmc_home_turn(struct pmc_unit *unit, struct pmc_axis *axis)
{
    if (axis->motion.moving)
        watch_phase(unit, axis);
    pmc_motion_finish(unit, axis);
    while (axis->phase != PHASE_NONE && !axis->motion.active) {
        if (axis->begun && axis->phase != PHASE_OFFSET)
            fail(unit, axis); /* PULSES_MAX */
        else if (axis->begun)
            set_phase(axis, PHASE_FOUND);
        else if (axis->phase == PHASE_FOUND)
            finish(unit, axis);
        else
            begin_phase(unit, axis);
    }
}

void pmc_home_begin(struct pmc_unit *unit, struct pmc_axis *axis)
{
    const int32_t all = (int32_t)(PMC_STEP_ON(0) | PMC_STEP_ON(1) | PMC_STEP_ON(2) | PMC_STEP_ON(3));
    axis->homed = false;
    set_phase(axis, PHASE_NEAR);
    if (!(axis->parameters.value[PMC_STEPS] & all))
        fail(unit, axis);
    else
        pmc_home_turn(unit, axis);
}

void pmc_home_drop(struct pmc_axis *axis)
{
    set_phase(axis, PHASE_NONE);
}
