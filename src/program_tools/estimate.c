/* SPDX-License-Identifier: MIT */
#include "estimate.h"

#include <stdlib.h>
#include <string.h>

#include "estimate_run.h"
#include "source_texts.h"

#define DRIFT_TIME_MIN (2 * (uint64_t)RKM04_TICKS_PER_SECOND) /* in which the slowest motion does a step */
#define DRIFT_TIME_MAX (600 * (uint64_t)RKM04_TICKS_PER_SECOND) /* followed, of a program whose rounds end elsewhere on a plant */

const char *estimate_end_name(enum estimate_end end)
{
    static const char *const names[] = {
        [ESTIMATE_DONE] = "done",   [ESTIMATE_STOPPED] = "stopped", [ESTIMATE_WAITS] = "waits",
        [ESTIMATE_ROUND] = "round", [ESTIMATE_ENDLESS] = "endless", [ESTIMATE_LIMIT] = "limit",
    };
    return names[end];
}

/* ---- Begin ---------------------------------------------------------------------------------------------------------- */

static void note_error(void *context, size_t source, const struct rkm04_reader *reader, enum rkm04_read found,
                       struct rkm04_command command)
{
    (void)source, (void)reader, (void)command;
    if (found != RKM04_READ_COMMAND)
        *(bool *)context = true;
}

/* Read the texts of all motors. *refused: one has an error. Returns false if out of memory. */
static bool read_motors(struct estimate_run *run, bool *refused)
{
    for (unsigned number = 1; number <= RKM04_MOTORS; number++) {
        struct estimate_motor *motor = &run->motor[number - 1];
        code_begin(&motor->code, run->sources, run->count);
        for (size_t i = 0; i < run->count; i++)
            if ((run->sources[i].motor == number || run->sources[i].motor == 0) &&
                !code_read(&motor->code, i, run->texts[i], note_error, refused))
                return false;
        motor->row = malloc((motor->code.count + 1) * sizeof *motor->row);
        if (motor->row == NULL)
            return false;
        for (size_t i = 0; i <= motor->code.count; i++)
            motor->row[i] = SIZE_MAX;
        motor->index = motor->moving = motor->code.count;
    }
    return true;
}

static enum estimate_result begin(struct estimate_run *run)
{
    const struct estimate_options *options = run->options;
    const struct rkm04_config settings = {.node = 1, .readings = options->readings};
    struct sim_config config = {.nodes = {.count = 1, .node = {1}}, .device = &rkm04_device};
    bool refused = false;
    run->texts = source_texts_map(run->sources, run->count);
    if (run->texts == NULL || !read_motors(run, &refused))
        return ESTIMATE_NO_MEMORY;
    if (refused)
        return ESTIMATE_REFUSED;
    config.unit = rkm04_device_config(&settings);
    run->repeat = calloc(1, rkm04_device.repeat_size + 1);
    if (!sim_begin(&run->sim, &config) || run->repeat == NULL)
        return ESTIMATE_NO_MEMORY;
    if (options->plant != NULL &&
        !sim_configure_plants(&run->sim, options->plant_name, options->plant, options->plant_length, options->errors))
        return ESTIMATE_NO_PLANT;
    estimate_watch(run);
    for (size_t i = 0; i < run->count; i++) {
        char error[DEVICE_ERROR_SIZE];
        int flag = rkm04_device.set_text(sim_core(&run->sim, 1), run->sources[i].motor, run->texts[i], run->sources[i].length,
                                         error);
        if (flag == 1 || flag == 2)
            return ESTIMATE_REFUSED;
    }
    return ESTIMATE_OK;
}

/* ---- The run ---------------------------------------------------------------------------------------------------------- */

/* Continue to the next slot in which something is due, at most to `limit`. Returns false if nothing ever is. */
static bool leap(struct estimate_run *run, uint64_t limit)
{
    uint64_t end = sim_next_report(&run->sim);
    if (end >= SIM_TIME_MAX) /* a motor continues without end: the state repeats from slot to slot */
        end = sim_next_event(&run->sim);
    if (end >= SIM_TIME_MAX)
        return false;
    end = (end + RKM04_SLOT_TICKS - 1) / RKM04_SLOT_TICKS * RKM04_SLOT_TICKS + 1;
    sim_advance(&run->sim, end < limit ? end : limit);
    estimate_update(run);
    return true;
}

/* The command in which a motor waits, a move to an input among them; code.count: it does not. */
static size_t waiting_in(struct estimate_run *run, unsigned number)
{
    const struct estimate_motor *motor = &run->motor[number - 1];
    const unsigned state = sim_axis(&run->sim, 1, number).state;
    const uint8_t op = motor->index < motor->code.count ? motor->code.commands[motor->index].command.op : 0;
    const bool waits = state == RKM04_WAIT || state == RKM04_BLOCK || (state == RKM04_MOVING && (op == '(' || op == ')'));
    return waits ? motor->index : motor->code.count;
}

static uint32_t driven_inputs(struct estimate_run *run)
{
    return run->sim.unit[0].plant == NULL ? 0 : plant_mask(run->sim.unit[0].plant);
}

/* Let the inputs come for which motors wait. Returns whether there are any. */
static bool pass_inputs(struct estimate_run *run)
{
    uint32_t mask = run->sim.unit[0].di, changed = 0;
    for (unsigned number = 1; number <= RKM04_MOTORS; number++) {
        const struct code *code = &run->motor[number - 1].code;
        const size_t index = waiting_in(run, number);
        if (index >= code->count)
            continue;
        const struct rkm04_command command = code->commands[index].command;
        if ((command.op != 'O' && command.op != 'Z') || command.argument > RKM04_INPUTS)
            continue;
        const uint32_t bit = UINT32_C(1) << (command.argument - 1);
        if ((driven_inputs(run) | changed) & bit)
            continue;
        mask = command.op == 'O' ? mask | bit : mask & ~bit;
        changed |= bit;
    }
    if (changed == 0)
        return false;
    run->estimate->assumed |= changed;
    sim_set_di(&run->sim, 1, mask);
    return true;
}

static void run_for(struct estimate_run *run, uint64_t period)
{
    const uint64_t end = sim_now(&run->sim) + period;
    bool more = true;
    while (more && sim_now(&run->sim) < end)
        more = leap(run, end);
}

static void note_positions(struct estimate_run *run, int64_t positions[RKM04_MOTORS])
{
    for (unsigned i = 0; i < RKM04_MOTORS; i++)
        if (!plant_position(run->sim.unit[0].plant, i + 1, &positions[i]))
            positions[i] = 0;
}

/* The state of the unit repeats. Does the plant continue anyway, to a switch or a stop? */
static bool drifts(struct estimate_run *run, uint64_t period)
{
    int64_t before[RKM04_MOTORS], after[RKM04_MOTORS];
    if (run->sim.unit[0].plant == NULL)
        return false;
    run->drift_from = run->drift_from == 0 ? sim_now(&run->sim) : run->drift_from;
    note_positions(run, before);
    run_for(run, (DRIFT_TIME_MIN + period - 1) / period * period);
    note_positions(run, after);
    if (memcmp(before, after, sizeof before) == 0 || sim_now(&run->sim) - run->drift_from > DRIFT_TIME_MAX)
        return false;
    memset(run->repeat, 0, rkm04_device.repeat_size);
    return true;
}

/* Returns the us after which the state repeats, 0: it has come to an end. */
static uint64_t run_to_the_end(struct estimate_run *run)
{
    const uint32_t most = run->options->commands_max > 0 ? run->options->commands_max : ESTIMATE_COMMANDS_MAX;
    while (run->commands < most && !run->no_memory && !sim_time_is_over(&run->sim)) {
        if (!leap(run, SIM_TIME_MAX)) {
            if (run->options->pass_inputs && pass_inputs(run))
                continue;
            return 0;
        }
        uint64_t period = rkm04_device.find_repeat(run->repeat, sim_core(&run->sim, 1));
        if (period > 0 && !drifts(run, period))
            return period;
    }
    run->estimate->end = ESTIMATE_LIMIT;
    return 0;
}

/* ---- A round of an endless loop ----------------------------------------------------------------------------------------- */

/* Do one more round, and let the motions have what they do in it; those before the round stay. Where no command is executed it is
 * no round but an endless motion. Returns false if out of memory. */
static bool run_round(struct estimate_run *run, uint64_t period)
{
    struct estimate *estimate = run->estimate;
    const size_t count = estimate->motion_count;
    const uint64_t commands = run->commands;
    struct estimate_motion *before = malloc((count + 1) * sizeof *before);
    uint64_t steps[RKM04_MOTORS];
    if (before == NULL)
        return false;
    if (count > 0)
        memcpy(before, estimate->motions, count * sizeof *before);
    memcpy(steps, estimate->steps, sizeof steps);
    memset(estimate->steps, 0, sizeof estimate->steps);
    for (size_t i = 0; i < count; i++) {
        estimate->motions[i].times = estimate->motions[i].all_steps = estimate->motions[i].all_duration = 0;
        estimate->motions[i].varies = false;
    }
    run_for(run, period);
    for (size_t i = 0; i < estimate->motion_count; i++) {
        estimate->motions[i].in_round = estimate->motions[i].times > 0;
        if (i < count && estimate->motions[i].times == 0)
            estimate->motions[i] = before[i];
    }
    free(before);
    estimate->end = run->commands > commands ? ESTIMATE_ROUND : ESTIMATE_ENDLESS;
    if (estimate->end == ESTIMATE_ENDLESS)
        memcpy(estimate->steps, steps, sizeof steps);
    else
        estimate->round = period;
    return true;
}

/* ---- The end ---------------------------------------------------------------------------------------------------------- */

static int compare_motions(const void *left, const void *right)
{
    const struct estimate_place *a = &((const struct estimate_motion *)left)->place;
    const struct estimate_place *b = &((const struct estimate_motion *)right)->place;
    if (a->source != b->source)
        return a->source < b->source ? -1 : 1;
    if (a->offset != b->offset)
        return a->offset < b->offset ? -1 : 1;
    return a->motor < b->motor ? -1 : a->motor > b->motor;
}

static bool is_variable(struct rkm04_command command)
{
    return (command.op == 'O' || command.op == 'Z') && command.argument >= RKM04_FIRST_VARIABLE;
}

static void list_waits(struct estimate_run *run, uint64_t before)
{
    struct estimate *estimate = run->estimate;
    uint64_t earliest = UINT64_MAX;
    for (unsigned number = 1; number <= RKM04_MOTORS; number++) {
        const struct estimate_motor *motor = &run->motor[number - 1];
        const size_t index = waiting_in(run, number);
        if (index >= motor->code.count || motor->since >= before)
            continue;
        const struct rkm04_command command = motor->code.commands[index].command;
        const bool input = strchr("OZ()", command.op) != NULL && command.argument <= RKM04_INPUTS;
        estimate->waits[estimate->wait_count++] = (struct estimate_wait){
            .place = estimate_place_of(run, number, index),
            .since = motor->since,
            .driven = input && (driven_inputs(run) >> (command.argument - 1) & 1) != 0,
        };
        if (!is_variable(command))
            continue;
        if (earliest != UINT64_MAX) { /* the second one, at least */
            const uint64_t later = motor->since > earliest ? motor->since : earliest;
            if (!estimate->deadlock || later < estimate->deadlock_at)
                estimate->deadlock_at = later;
            estimate->deadlock = true;
        }
        earliest = motor->since < earliest ? motor->since : earliest;
    }
}

static void conclude(struct estimate_run *run, uint64_t began_before)
{
    struct estimate *estimate = run->estimate;
    bool stopped = false;
    for (unsigned number = 1; number <= RKM04_MOTORS; number++) {
        const struct device_axis axis = sim_axis(&run->sim, 1, number);
        estimate->position[number - 1] = axis.position;
        stopped = stopped || axis.fault != 0;
    }
    list_waits(run, began_before);
    if (estimate->end == ESTIMATE_DONE)
        estimate->end = stopped ? ESTIMATE_STOPPED : estimate->wait_count > 0 ? ESTIMATE_WAITS : ESTIMATE_DONE;
    if (estimate->motion_count > 0)
        qsort(estimate->motions, estimate->motion_count, sizeof estimate->motions[0], compare_motions);
}

static enum estimate_result run_all(struct estimate_run *run)
{
    const enum estimate_result begun = begin(run);
    if (begun != ESTIMATE_OK)
        return begun;
    const uint64_t period = run_to_the_end(run);
    run->estimate->duration = run->last;
    const uint64_t repeated = sim_now(&run->sim);
    if (period > 0 && !run_round(run, period))
        return ESTIMATE_NO_MEMORY;
    conclude(run, period > 0 ? repeated : UINT64_MAX);
    return run->no_memory ? ESTIMATE_NO_MEMORY : ESTIMATE_OK;
}

enum estimate_result estimate_programs(const struct program_source *sources, size_t count, const struct estimate_options *options,
                                       struct estimate *estimate)
{
    struct estimate_run *run = calloc(1, sizeof *run);
    *estimate = (struct estimate){0};
    if (run == NULL)
        return ESTIMATE_NO_MEMORY;
    run->sources = sources;
    run->count = count;
    run->options = options;
    run->estimate = estimate;
    const enum estimate_result result = run_all(run);
    sim_end(&run->sim);
    for (unsigned i = 0; i < RKM04_MOTORS; i++) {
        code_free(&run->motor[i].code);
        free(run->motor[i].row);
    }
    source_texts_free(run->texts, count);
    free(run->repeat);
    free(run);
    return result;
}

void estimate_free(struct estimate *estimate)
{
    for (size_t i = 0; i < estimate->collision_count; i++)
        free(estimate->collisions[i].text);
    free(estimate->collisions);
    free(estimate->motions);
    *estimate = (struct estimate){0};
}
