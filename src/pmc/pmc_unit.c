/* SPDX-License-Identifier: MIT */
/* Power-up, time, requests, and what can be seen. */
#include "pmc_home.h"
#include "pmc_motion.h"
#include "pmc_program.h"
#include "pmc_report.h"
#include "pmc_store.h"
#include "ramp.h"

_Static_assert(sizeof(struct pmc_unit) <= 6144, "two axes take 6 KiB of memory at most");

/* ---- Power-up and RST (AU5) ---------------------------------------------------------------------------------------- */

static void clear_bytes(void *at, size_t size)
{
    for (uint8_t *byte = at; size > 0; size--)
        *byte++ = 0;
}

static void push(struct pmc_axis *axis, unsigned kind, int32_t value)
{
    const bool again = axis->pendings > 0 && axis->pending[axis->pendings - 1].kind == kind;
    if (!again && axis->pendings < PMC_PENDING_MAX)
        axis->pendings++;
    axis->pending[axis->pendings - 1] = (struct pmc_pending){(uint8_t)kind, value};
}

/* As after power-up, with what was stored last. The direction output stays. */
static void clear_axis(struct pmc_unit *unit, struct pmc_axis *axis)
{
    const bool forward = axis->forward;
    const uint8_t inputs = axis->inputs;
    clear_bytes(axis, sizeof *axis);
    axis->forward = forward;
    axis->inputs = inputs;
    axis->motion.ramp.next = PMC_NEVER;
    axis->off[0] = axis->off[1] = PMC_NEVER;
    pmc_store_load(unit, axis);
    axis->speed = (uint16_t)axis->parameters.value[PMC_SPEED1];
}

static void reset_axis(struct pmc_unit *unit, struct pmc_axis *axis)
{
    const unsigned outputs = 3u << PMC_OUTPUT_SHIFT * pmc_index(unit, axis);
    pmc_motion_stop_now(unit, axis);
    pmc_end_program(unit, axis);
    pmc_clear_errors(unit, axis);
    pmc_set_commanded(unit, axis, 0);
    pmc_write_outputs(unit, (uint8_t)(unit->outputs & ~outputs));
    clear_axis(unit, axis);
    if (axis == unit->axis && unit->config.face && unit->config.face->reset)
        unit->config.face->reset(unit);
}

void pmc_init(struct pmc_unit *unit, const struct pmc_config *config, const struct pmc_port *port, void *context)
{
    clear_bytes(unit, sizeof *unit);
    unit->config = *config;
    unit->port = port;
    unit->context = context;
    for (unsigned i = 0; i < unit->config.axes; i++) {
        struct pmc_axis *axis = &unit->axis[i];
        axis->forward = true;
        clear_axis(unit, axis);
        const int32_t flags = axis->parameters.value[PMC_FLAGS];
        axis->run_after = (flags & PMC_FLAG_HOME_FIRST) && (flags & PMC_FLAG_RUN_FIRST);
        if (flags & PMC_FLAG_HOME_FIRST)
            push(axis, PMC_SEARCH, 0);
        else if (flags & PMC_FLAG_RUN_FIRST)
            push(axis, PMC_RUN, 0);
    }
    unit->touched = true;
}

/* ---- Requests ------------------------------------------------------------------------------------------------------ */

static bool is_start(unsigned kind)
{
    return kind == PMC_RUN || kind == PMC_JOG || kind == PMC_MOVE_TO || kind == PMC_MOVE_BY || kind == PMC_SEARCH;
}

/* The start that waits for its slot; NULL: none. */
static const struct pmc_pending *pending_of(const struct pmc_axis *axis, bool (*is_wanted)(unsigned kind))
{
    for (unsigned i = 0; i < axis->pendings; i++)
        if (is_wanted(axis->pending[i].kind))
            return &axis->pending[i];
    return NULL;
}

static bool clears_counter(unsigned kind)
{
    return kind == PMC_CLEAR_COMMANDED || kind == PMC_RESET;
}

static bool is_active(const struct pmc_axis *axis)
{
    return axis->running || axis->phase != 0 || axis->motion.active;
}

bool pmc_is_busy(const struct pmc_unit *unit, unsigned axis)
{
    return is_active(&unit->axis[axis]) || pending_of(&unit->axis[axis], is_start) != NULL;
}

static bool is_in_range(int64_t value, int32_t low, int32_t high)
{
    return value >= low && value <= high;
}

/* Can the request have this value? */
static bool is_legal(unsigned kind, int32_t value)
{
    switch (kind) {
    case PMC_RUN:
        return is_in_range(value, 0, PMC_REGISTERS - 1);
    case PMC_JOG:
        return value != 0;
    case PMC_MOVE_TO:
    case PMC_MOVE_BY:
        return is_in_range(value, PMC_COUNTER_MIN, PMC_COUNTER_MAX);
    case PMC_SET_SPEED:
        return is_in_range(value, 1, PMC_SPEED_MAX);
    default:
        return kind <= PMC_RESET;
    }
}

static bool needs_rest(unsigned kind)
{
    return is_start(kind) || kind == PMC_CLEAR_COMMANDED || kind == PMC_CLEAR_ACTUAL;
}

static bool is_stop(unsigned kind)
{
    return kind == PMC_STOP || kind == PMC_STOP_NOW || kind == PMC_STOP_PROGRAM;
}

/* AL2: without software limits, a target outside the counter's range. */
static bool leaves_counter(const struct pmc_axis *axis, unsigned kind, int32_t value)
{
    const int64_t from = pending_of(axis, clears_counter) ? 0 : axis->commanded;
    return kind == PMC_MOVE_BY && !(axis->parameters.value[PMC_FLAGS] & PMC_FLAG_SOFT_LIMITS) &&
           !is_in_range(from + value, PMC_COUNTER_MIN, PMC_COUNTER_MAX);
}

static enum pmc_answer check_axis(const struct pmc_unit *unit, unsigned i, unsigned kind, int32_t value)
{
    const struct pmc_axis *axis = &unit->axis[i];
    if (needs_rest(kind) && pmc_is_busy(unit, i))
        return PMC_BUSY;
    if (axis->pendings == PMC_PENDING_MAX && kind != PMC_RESET && !is_stop(kind))
        return PMC_BUSY;
    return leaves_counter(axis, kind, value) ? PMC_RANGE : PMC_OK;
}

static unsigned axes_of(const struct pmc_unit *unit, const struct pmc_request *request)
{
    return request->kind == PMC_RESET ? (1u << unit->config.axes) - 1 : request->axes;
}

enum pmc_answer pmc_check(const struct pmc_unit *unit, const struct pmc_request *request)
{
    const unsigned axes = axes_of(unit, request);
    if (axes == 0 || axes >> unit->config.axes != 0)
        return PMC_NO_AXIS;
    for (unsigned i = 0; i < unit->config.axes; i++)
        if ((axes >> i & 1) && !is_legal(request->kind, request->value[i]))
            return PMC_RANGE;
    enum pmc_answer answer = PMC_OK;
    for (unsigned i = 0; i < unit->config.axes; i++) {
        const enum pmc_answer found = axes >> i & 1 ? check_axis(unit, i, request->kind, request->value[i]) : PMC_OK;
        if (found == PMC_BUSY || answer == PMC_OK)
            answer = found;
    }
    return answer;
}

/* Drop a start that has not had its slot. Returns whether there was one. */
static bool drop_start(struct pmc_axis *axis)
{
    const struct pmc_pending *start = pending_of(axis, is_start);
    if (!start)
        return false;
    axis->pendings--;
    for (unsigned i = (unsigned)(start - axis->pending); i < axis->pendings; i++)
        axis->pending[i] = axis->pending[i + 1];
    axis->run_after = false;
    return true;
}

static bool is_run(unsigned kind)
{
    return kind == PMC_RUN;
}

static void accept(struct pmc_axis *axis, unsigned kind, int32_t value)
{
    if (kind == PMC_STOP_PROGRAM) {
        if (!axis->running && !pending_of(axis, is_run))
            return;
        kind = PMC_STOP;
    }
    if (is_stop(kind) && (drop_start(axis) || !is_active(axis)))
        return;
    if (kind == PMC_RESET)
        axis->pendings = 0;
    if (kind == PMC_SET_SPEED)
        axis->speed = (uint16_t)value;
    push(axis, kind, value);
}

enum pmc_answer pmc_request(struct pmc_unit *unit, const struct pmc_request *request)
{
    const enum pmc_answer answer = pmc_check(unit, request);
    if (answer != PMC_OK)
        return answer;
    for (unsigned i = 0; i < unit->config.axes; i++)
        if (axes_of(unit, request) >> i & 1)
            accept(&unit->axis[i], request->kind, request->value[i]);
    unit->touched = true;
    return PMC_OK;
}

/* ---- A slot (AT2) -------------------------------------------------------------------------------------------------- */

/* The inputs of an axis that are active. */
static uint8_t active_inputs(const struct pmc_unit *unit, const struct pmc_axis *axis)
{
    const unsigned levels = unit->inputs >> PMC_INPUT_SHIFT * pmc_index(unit, axis) & (PMC_EMG - 1);
    const unsigned steps = (unsigned)axis->parameters.value[PMC_STEPS], flags = (unsigned)axis->parameters.value[PMC_FLAGS];
    unsigned high = 0; /* those that are active at 1 */
    high |= steps & PMC_LEVEL_NEAR ? PMC_NEAR : 0;
    high |= steps & PMC_LEVEL_HOME ? PMC_HOME : 0;
    high |= steps & PMC_LEVEL_Z ? PMC_Z : 0;
    high |= steps & PMC_LEVEL_IN0 ? PMC_IN0 : 0;
    high |= steps & PMC_LEVEL_IN1 ? PMC_IN1 : 0;
    high |= flags & PMC_FLAG_LIMIT_LEVEL ? PMC_LIMIT_PLUS | PMC_LIMIT_MINUS : 0;
    return (uint8_t)((levels ^ ~high) & (PMC_EMG - 1)) | (uint8_t)(unit->inputs & PMC_EMG);
}

/* Program and search end; the motion goes on. */
static void end_work(struct pmc_unit *unit, struct pmc_axis *axis)
{
    pmc_home_drop(axis);
    pmc_end_program(unit, axis);
}

static void start_manual(struct pmc_unit *unit, struct pmc_axis *axis, const struct pmc_pending *pending)
{
    struct pmc_move move = {.way = pending->value,
                            .speed = axis->speed,
                            .start_speed = (uint16_t)axis->parameters.value[PMC_START_SPEED],
                            .endless = pending->kind == PMC_JOG,
                            .manual = true};
    if (pending->kind == PMC_MOVE_TO) {
        axis->not_homed = !axis->homed;
        move.way -= axis->commanded;
    }
    pmc_motion_move(unit, axis, &move);
}

static void start(struct pmc_unit *unit, struct pmc_axis *axis, const struct pmc_pending *pending)
{
    pmc_clear_errors(unit, axis);
    if (axis->inputs & PMC_EMG)
        pmc_raise(unit, axis, PMC_ERROR_EMG);
    else if (pending->kind == PMC_RUN)
        pmc_program_begin(unit, axis, (uint8_t)pending->value);
    else if (pending->kind == PMC_SEARCH)
        pmc_home_begin(unit, axis);
    else
        start_manual(unit, axis, pending);
}

static void handle_request(struct pmc_unit *unit, struct pmc_axis *axis, const struct pmc_pending *pending)
{
    switch (pending->kind) {
    case PMC_CLEAR_COMMANDED:
        pmc_set_commanded(unit, axis, 0);
        break;
    case PMC_CLEAR_ACTUAL:
        axis->actual = 0;
        break;
    case PMC_SET_SPEED:
        axis->speed = (uint16_t)pending->value;
        pmc_motion_change_speed(unit, axis);
        break;
    case PMC_STOP:
        end_work(unit, axis);
        pmc_motion_stop(unit, axis);
        break;
    case PMC_STOP_NOW:
        end_work(unit, axis);
        pmc_motion_stop_now(unit, axis);
        break;
    case PMC_CLEAR_ERRORS:
        pmc_clear_errors(unit, axis);
        break;
    case PMC_RESET:
        reset_axis(unit, axis);
        break;
    default:
        start(unit, axis, pending);
    }
}

static void handle_all(struct pmc_unit *unit, struct pmc_axis *axis)
{
    struct pmc_pending pending[PMC_PENDING_MAX];
    const unsigned pendings = axis->pendings;
    for (unsigned i = 0; i < pendings; i++)
        pending[i] = axis->pending[i];
    axis->pendings = 0;
    for (unsigned i = 0; i < pendings; i++)
        handle_request(unit, axis, &pending[i]);
}

static void turn(struct pmc_unit *unit, struct pmc_axis *axis)
{
    axis->inputs = active_inputs(unit, axis);
    if (axis->inputs & PMC_EMG) {
        pmc_motion_stop_now(unit, axis);
        pmc_home_drop(axis);
        pmc_raise(unit, axis, PMC_ERROR_EMG);
    }
    if (axis->phase == 0)
        pmc_motion_watch(unit, axis);
    handle_all(unit, axis);
    pmc_motion_finish(unit, axis);
    if (axis->phase != 0)
        pmc_home_turn(unit, axis);
    if (axis->run_after && axis->phase == 0) { /* it has ended well: what else ends a search ends this, too */
        axis->run_after = false;
        pmc_program_begin(unit, axis, 0);
    }
    pmc_program_turn(unit, axis);
    pmc_program_end_pulses(unit, axis);
}

/* ---- Time ---------------------------------------------------------------------------------------------------------- */

static uint64_t earlier(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

/* A tick in whose slot, or behind it, an axis has its turn, if nothing comes in: while it moves, one before its motion ends. */
static uint64_t wake_of(const struct pmc_axis *axis)
{
    const struct pmc_motion *motion = &axis->motion;
    uint64_t wake = earlier(axis->off[0], axis->off[1]);
    if (motion->moving)
        wake = earlier(wake, ramp_quiet_until(&motion->ramp));
    else if (motion->active)
        wake = earlier(wake, motion->over);
    else if (axis->running)
        wake = earlier(wake, axis->due);
    return wake;
}

#define LAST_SLOT (PMC_NEVER - PMC_SLOT_TICKS) /* what lies behind it never comes */

static uint64_t next_slot(const struct pmc_unit *unit)
{
    uint64_t wake = unit->touched ? unit->now : PMC_NEVER;
    for (unsigned i = 0; i < unit->config.axes; i++)
        wake = earlier(wake, wake_of(&unit->axis[i]));
    wake = wake > unit->now ? wake : unit->now;
    return wake > LAST_SLOT ? PMC_NEVER : pmc_slot_at(wake);
}

static uint64_t next_act(const struct pmc_unit *unit)
{
    const struct pmc_face *face = unit->config.face;
    return face && face->due ? face->due(unit) : PMC_NEVER;
}

/* Must the next slot look at the axis though nothing changes? What emg or a limit switch has to do there is not done in this one
 * where its error has been cleared, or the axis is free of a search, or in the ramp of its step 1, since. */
static bool has_more_to_see(const struct pmc_axis *axis)
{
    const bool forward = axis->motion.forward, limited = axis->motion.moving && pmc_at_limit(axis, forward);
    const unsigned error = forward ? PMC_ERROR_HL_PLUS : PMC_ERROR_HL_MINUS;
    return ((axis->inputs & PMC_EMG) && !(axis->errors & PMC_ERROR_EMG)) ||
           (limited && (axis->phase != 0 || !(axis->errors & error)));
}

static void do_slot(struct pmc_unit *unit)
{
    unit->touched = false;
    for (unsigned i = 0; i < unit->config.axes; i++) {
        turn(unit, &unit->axis[i]);
        unit->touched = unit->touched || has_more_to_see(&unit->axis[i]);
    }
}

static void run_axes(struct pmc_unit *unit, uint64_t limit)
{
    for (unsigned i = 0; i < unit->config.axes; i++)
        pmc_motion_run(unit, &unit->axis[i], limit);
}

void pmc_advance(struct pmc_unit *unit, uint64_t ticks)
{
    const uint64_t end = unit->now > PMC_NEVER - ticks ? PMC_NEVER : unit->now + ticks;
    while (unit->now < end) {
        const uint64_t slot = next_slot(unit), act = next_act(unit);
        if (act < end && act <= slot) {
            if (act > unit->now)
                run_axes(unit, act - 1);
            unit->now = act;
            unit->config.face->act(unit);
            continue;
        }
        const bool reached = slot < end;
        run_axes(unit, reached ? slot : end - 1);
        if (reached) {
            unit->now = slot;
            do_slot(unit);
        }
        unit->now = reached ? slot + 1 : end;
    }
}

uint64_t pmc_now(const struct pmc_unit *unit)
{
    return unit->now;
}

static uint64_t next_of_all(const struct pmc_unit *unit, bool seen)
{
    uint64_t next = earlier(next_slot(unit), next_act(unit));
    for (unsigned i = 0; i < unit->config.axes; i++) {
        const struct pmc_motion *motion = &unit->axis[i].motion;
        if (motion->moving)
            next = earlier(next, seen ? motion->ramp.next : ramp_quiet_pulses(&motion->ramp, UINT32_MAX));
    }
    if (next > LAST_SLOT)
        return PMC_NEVER;
    return next < unit->now ? unit->now : next;
}

uint64_t pmc_next_event(const struct pmc_unit *unit)
{
    return next_of_all(unit, true);
}

uint64_t pmc_next_report(const struct pmc_unit *unit)
{
    return next_of_all(unit, unit->port->steps != NULL);
}

void pmc_set_inputs(struct pmc_unit *unit, uint16_t levels)
{
    unit->touched = unit->touched || unit->inputs != levels;
    unit->inputs = levels;
}

/* ---- Parameters and program (AP6) ---------------------------------------------------------------------------------- */

static enum pmc_answer check_rest(const struct pmc_unit *unit, unsigned axis)
{
    if (axis >= unit->config.axes)
        return PMC_NO_AXIS;
    return pmc_is_busy(unit, axis) ? PMC_BUSY : PMC_OK;
}

enum pmc_answer pmc_set_parameter(struct pmc_unit *unit, unsigned axis, enum pmc_parameter which, int32_t value)
{
    const enum pmc_answer answer = check_rest(unit, axis);
    if (answer == PMC_OK && !pmc_parameter_put(&unit->axis[axis].parameters, which, value))
        return PMC_RANGE;
    unit->touched = true; /* levels of inputs */
    return answer;
}

enum pmc_answer pmc_set_parameters(struct pmc_unit *unit, unsigned axis, const struct pmc_parameters *parameters)
{
    const enum pmc_answer answer = check_rest(unit, axis);
    if (answer == PMC_OK)
        unit->axis[axis].parameters = *parameters;
    unit->touched = true;
    return answer;
}

enum pmc_answer pmc_set_command(struct pmc_unit *unit, unsigned axis, unsigned reg, const struct pmc_command *command)
{
    const enum pmc_answer answer = check_rest(unit, axis);
    if (answer != PMC_OK)
        return answer;
    if (reg >= PMC_REGISTERS || !pmc_command_valid(command))
        return PMC_RANGE;
    unit->axis[axis].program[reg] = *command;
    return PMC_OK;
}

enum pmc_answer pmc_set_program(struct pmc_unit *unit, unsigned axis, const struct pmc_command program[PMC_REGISTERS])
{
    const enum pmc_answer answer = check_rest(unit, axis);
    for (unsigned i = 0; i < PMC_REGISTERS && answer == PMC_OK; i++)
        unit->axis[axis].program[i] = program[i];
    return answer;
}

enum pmc_answer pmc_store(struct pmc_unit *unit, unsigned axis)
{
    const enum pmc_answer answer = check_rest(unit, axis);
    if (answer == PMC_OK && !pmc_store_save(unit, &unit->axis[axis]))
        return PMC_STORE_FAILED;
    return answer;
}

enum pmc_answer pmc_register_position(struct pmc_unit *unit, unsigned axis, unsigned reg)
{
    const enum pmc_answer answer = check_rest(unit, axis);
    if (answer != PMC_OK)
        return answer;
    const int64_t tenths = pmc_tenths_of(&unit->axis[axis].parameters, unit->axis[axis].commanded);
    const struct pmc_command command = {.op = PMC_ABS, .value = (int32_t)tenths, .speed = 1};
    return tenths == command.value ? pmc_set_command(unit, axis, reg, &command) : PMC_RANGE;
}

/* ---- What can be seen ---------------------------------------------------------------------------------------------- */

static enum pmc_state state_of(const struct pmc_axis *axis)
{
    const struct pmc_pending *waiting = pending_of(axis, is_start);
    if (axis->phase != 0 || (waiting && waiting->kind == PMC_SEARCH))
        return PMC_SEARCHING;
    if (axis->running || (waiting && waiting->kind == PMC_RUN))
        return PMC_PROGRAM;
    return axis->motion.active || waiting ? PMC_MANUAL : PMC_IDLE;
}

/* INR: the sum of 1 moving, 2 program, 4 search; what waits for its slot counts. */
static uint8_t driving_of(const struct pmc_axis *axis)
{
    static const uint8_t of_state[] = {[PMC_IDLE] = 0, [PMC_MANUAL] = 1, [PMC_PROGRAM] = 2, [PMC_SEARCHING] = 4};
    return of_state[state_of(axis)] | (axis->motion.active ? 1 : 0) | (axis->running ? 2 : 0);
}

void pmc_axis_state(const struct pmc_unit *unit, unsigned number, struct pmc_axis_state *state)
{
    const struct pmc_axis *axis = &unit->axis[number];
    const struct pmc_motion *motion = &axis->motion;
    *state = (struct pmc_axis_state){
        .commanded = axis->commanded,
        .actual = axis->actual,
        .made = motion->active ? motion->made : 0,
        .state = state_of(axis),
        .driving = driving_of(axis),
        .reg = (int16_t)(axis->executing ? axis->reg : -1),
        .errors = axis->errors,
        .inputs = axis->inputs,
        .outputs = unit->outputs >> PMC_OUTPUT_SHIFT * number & 3,
        .homed = axis->homed,
        .not_homed = axis->not_homed,
        .moving = motion->moving,
        .stopping = motion->moving && motion->stopping,
        .forward = axis->forward,
        .endless = motion->moving && motion->endless,
        .repetitions = axis->repetitions,
        .fifth = axis->speed,
    };
    if (motion->moving) {
        struct rkm04_fixed y, w;
        ramp_state_at(&motion->ramp, unit->now, &y, &w);
        state->speed = (uint32_t)(w.whole / ramp_speed_unit(&motion->ramp));
    }
}

bool pmc_emergency(const struct pmc_unit *unit)
{
    return (unit->axis[0].inputs & PMC_EMG) != 0;
}

uint16_t pmc_inputs(const struct pmc_unit *unit)
{
    return unit->inputs;
}

uint8_t pmc_outputs(const struct pmc_unit *unit)
{
    return unit->outputs;
}

unsigned pmc_pulse_ticks(const struct pmc_unit *unit, unsigned axis)
{
    const uint32_t speed = (uint32_t)unit->axis[axis].parameters.value[PMC_MULTIPLIER] * unit->axis[axis].motion.top;
    if (speed <= PMC_TICKS_PER_SECOND / 2 / PMC_PULSE_TICKS) /* or none has come yet */
        return PMC_PULSE_TICKS;
    return PMC_TICKS_PER_SECOND / 2 / speed; /* at least 1: no speed is higher than half the ticks */
}
