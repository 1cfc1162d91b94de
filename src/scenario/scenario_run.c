/* SPDX-License-Identifier: MIT */
/* A scenario runs: time, stimuli, what must hold always. */
#include <inttypes.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "record/record.h"
#include "scenario_running.h"

#define LOOK_EVERY 256u /* turns of time between two questions whether the run is to end */

/* ---- Failing -------------------------------------------------------------------------------------------------------- */

char *running_text(const char *format, ...)
{
    char *text;
    va_list list;
    va_start(list, format);
    if (vasprintf(&text, format, list) < 0)
        text = NULL;
    va_end(list);
    return text;
}

static bool end_run(struct running *running, enum scenario_end end, uint64_t tick)
{
    running->over = true;
    running->end = end;
    running->result->tick = tick;
    return false;
}

bool running_no_memory(struct running *running)
{
    return end_run(running, SCENARIO_NO_MEMORY, sim_now(running->sim));
}

static bool failed_at(struct running *running, const struct config_node *node, const char *label, uint64_t tick, char *expected,
                      char *seen)
{
    struct scenario_result *result = running->result;
    result->expected = expected;
    result->seen = seen;
    if (expected == NULL || seen == NULL)
        return running_no_memory(running);
    result->line = config_line(node);
    result->column = config_column(node);
    result->label = label != NULL ? strdup(label) : NULL;
    return end_run(running, SCENARIO_FAILED, tick);
}

bool running_failed(struct running *running, const struct scenario_step *step, uint64_t tick, char *expected, char *seen)
{
    return failed_at(running, step->node, step->label, tick, expected, seen);
}

/* ---- Watching ------------------------------------------------------------------------------------------------------- */

static void on_event(void *context, const struct watch_event *event)
{
    struct running *running = context;
    uint32_t bit = (UINT32_C(1) << event->motor) >> 1;
    uint32_t *forward = &running->forward[event->unit - 1u];
    struct pulse_count *count = event->motor > 0 ? &running->count[event->unit - 1u][event->motor - 1u] : NULL;
    if (event->kind == WATCH_POWER) {
        *forward = 0;
    } else if (event->kind == WATCH_DIRECTION) {
        *forward = event->value > 0 ? *forward | bit : *forward & ~bit;
    } else if (event->kind == WATCH_STEP) {
        *(*forward & bit ? &count->forward : &count->back) += 1;
    } else if (event->value != 0 && !running->fault.there) {
        running->fault = (struct running_fault){
            true, event->tick, event->unit, event->motor, (unsigned)event->value,
        };
    }
}

static void start_watching(struct running *running)
{
    running->watcher = (struct watcher){.kinds = WATCH_BIT(WATCH_FAULT), .on_event = on_event, .context = running};
    if (running->scenario->count_pulses)
        running->watcher.kinds |= WATCH_BIT(WATCH_STEP) | WATCH_BIT(WATCH_DIRECTION) | WATCH_BIT(WATCH_POWER);
    sim_watch(running->sim, &running->watcher);
}

static bool check_faults(struct running *running)
{
    const struct running_fault *fault = &running->fault;
    if (!fault->there || running->scenario->allow_faults)
        return true;
    const char *unit = running->sim->unit[fault->unit - 1u].name;
    const char *name = sim_device(running->sim)->fault_name(fault->fault);
    if (fault->motor == 0)
        return running_failed(running, running->step, fault->tick, running_text("no unit in fault"),
                              running_text("unit %s in fault: %s", unit, name));
    return running_failed(running, running->step, fault->tick, running_text("no motor in fault"),
                          running_text("unit %s motor %u in fault: %s at command %u", unit, fault->motor, name,
                                       (unsigned)sim_axis(running->sim, fault->unit, fault->motor).index));
}

/* ---- What must hold always ------------------------------------------------------------------------------------------ */

static size_t always_count(const struct running *running)
{
    return running->always != NULL ? json_array_size(running->scenario->always) : 0;
}

static bool check_always(struct running *running)
{
    for (size_t i = 0; i < always_count(running); i++) {
        struct condition *condition = running->always[i];
        char *wanted;
        if (condition_holds(condition))
            continue;
        wanted = condition_wanted_text(condition);
        failed_at(running, config_at(running->scenario->always_node, i), NULL, sim_now(running->sim),
                  wanted != NULL ? running_text("always %s", wanted) : NULL, condition_found_text(condition));
        free(wanted);
        return false;
    }
    return true;
}

/* ---- Stimuli -------------------------------------------------------------------------------------------------------- */

/* Do those that are due. What one does may make another one due. */
static bool do_stimuli(struct running *running)
{
    uint64_t now = sim_now(running->sim);
    for (size_t i = 0; i < running->scenario->stimuli && !running->over; i++) {
        const struct scenario_stimulus *stimulus = &running->scenario->stimulus[i];
        struct running_stimulus *state = &running->stimulus[i];
        struct scenario_step step = stimulus->step;
        if (state->acted)
            continue;
        if (state->due == DEVICE_NEVER && condition_holds(state->when))
            state->due = now + stimulus->after;
        if (state->due > now)
            continue;
        state->acted = true;
        step.at = DEVICE_NEVER; /* now */
        if (running_do_step(running, &step))
            i = SIZE_MAX; /* from the first one again */
    }
    return !running->over;
}

static uint64_t stimuli_next(const struct running *running)
{
    uint64_t next = DEVICE_NEVER;
    for (size_t i = 0; i < running->scenario->stimuli; i++) {
        const struct running_stimulus *state = &running->stimulus[i];
        uint64_t at = state->due;
        if (!state->acted && at == DEVICE_NEVER)
            at = condition_next(state->when);
        if (!state->acted && at < next)
            next = at;
    }
    return next;
}

static bool check_all_acted(struct running *running)
{
    uint64_t now = sim_now(running->sim);
    for (size_t i = 0; i < running->scenario->stimuli; i++) {
        const struct running_stimulus *state = &running->stimulus[i];
        if (state->acted)
            continue;
        char *seen = state->due == DEVICE_NEVER ? condition_found_text(state->when)
                                               : running_text("the last step ended before its time");
        return running_failed(running, &running->scenario->stimulus[i].step, now,
                              running_text("the stimulus to act before the last step ends"), seen);
    }
    return true;
}

/* ---- Time ----------------------------------------------------------------------------------------------------------- */

/* Check everything at the present tick. */
static bool check_all(struct running *running)
{
    if (running->over || !check_faults(running) || !do_stimuli(running) || !check_always(running))
        return false;
    if (running->interrupted != NULL && ++running->turns % LOOK_EVERY == 0 &&
        running->interrupted(running->context, sim_now(running->sim)))
        return end_run(running, SCENARIO_INTERRUPTED, sim_now(running->sim));
    return true;
}

static uint64_t earlier(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

bool running_advance(struct running *running, uint64_t limit, struct condition *condition)
{
    uint64_t now = sim_now(running->sim), quiet = earlier(sim_next_event(running->sim), sim_due(running->sim));
    uint64_t next = now + US_PER_SECOND;
    next = earlier(limit, quiet > next ? quiet : next); /* not longer, so that the run can be interrupted */
    if (sim_time_is_over(running->sim))
        return running_failed(running, running->step, now, running_text("virtual time to continue"),
                              running_text("its end, after %" PRIu64 " s", SIM_TIME_MAX / US_PER_SECOND));
    if (condition != NULL)
        next = earlier(next, condition_next(condition));
    for (size_t i = 0; i < always_count(running); i++)
        next = earlier(next, condition_next(running->always[i]));
    next = earlier(next, stimuli_next(running));
    if (running->host.listening)
        next = earlier(next, earlier(sim_due(running->sim), running_silence_end(running)));
    sim_advance(running->sim, next > now ? next : now + 1);
    running_end_silence(running);
    return check_all(running);
}

/* ---- The whole ------------------------------------------------------------------------------------------------------ */

static struct condition *arm_condition(struct running *running, const json_t *json)
{
    struct refusal refusal;
    struct condition *condition = condition_read(running->sim, json, &refusal);
    if (condition == NULL)
        running_no_memory(running);
    else
        condition_arm(condition);
    return condition;
}

static bool arm_conditions(struct running *running)
{
    const struct scenario *scenario = running->scenario;
    size_t always = json_array_size(scenario->always);
    running->always = calloc(always + 1, sizeof running->always[0]);
    running->stimulus = calloc(scenario->stimuli + 1, sizeof running->stimulus[0]);
    if (running->always == NULL || running->stimulus == NULL)
        return running_no_memory(running);
    for (size_t i = 0; i < always && !running->over; i++)
        running->always[i] = arm_condition(running, json_array_get(scenario->always, i));
    for (size_t i = 0; i < scenario->stimuli && !running->over; i++) {
        running->stimulus[i].due = scenario->stimulus[i].step.at;
        if (scenario->stimulus[i].when != NULL)
            running->stimulus[i].when = arm_condition(running, scenario->stimulus[i].when);
        else
            running->stimulus[i].due += scenario->stimulus[i].after;
    }
    return !running->over;
}

static bool run_steps(struct running *running)
{
    const struct scenario *scenario = running->scenario;
    struct refusal refusal = {0};
    running->step = &scenario->step[0];
    if (!scenario_begin_inputs(scenario, running->sim, &refusal))
        return running_failed(running, running->step, 0, running_text("di to succeed"),
                              running_text("refused: %s", refusal.text));
    if (!arm_conditions(running) || !check_all(running))
        return false;
    for (size_t i = 0; i < scenario->steps; i++) {
        running->step = &scenario->step[i];
        if (!running_do_step(running, running->step) || !check_all(running))
            return false;
    }
    return check_all_acted(running);
}

/* A step that takes long is to end. */
static bool is_interrupted(void *context)
{
    struct running *running = context;
    if (running->interrupted != NULL && running->interrupted(running->context, sim_now(running->sim)))
        end_run(running, SCENARIO_INTERRUPTED, sim_now(running->sim));
    return running->over;
}

static void run_recorded(struct running *running, FILE *out)
{
    struct record *record = out != NULL ? record_begin(running->sim, out) : NULL;
    if (out != NULL && record == NULL) {
        running_no_memory(running);
        return;
    }
    start_watching(running);
    running->sim->interrupted = is_interrupted;
    running->sim->interrupted_context = running;
    if (run_steps(running))
        end_run(running, SCENARIO_PASSED, sim_now(running->sim));
    if (running->sim->watch.short_of_memory)
        running_no_memory(running);
    if (record != NULL)
        running->result->record_error = record_end(record);
}

static void free_all(struct running *running)
{
    for (size_t i = 0; i < always_count(running); i++)
        condition_free(running->always[i]);
    for (size_t i = 0; running->stimulus != NULL && i < running->scenario->stimuli; i++)
        condition_free(running->stimulus[i].when);
    free(running->always);
    free(running->stimulus);
    sim_end(running->sim);
    free(running->sim);
    free(running);
}

/* Where errors go that have been reported when the scenario was read. */
static bool power_up(const struct scenario *scenario, struct sim *sim)
{
    char *said = NULL;
    size_t length;
    FILE *nowhere = open_memstream(&said, &length);
    bool ok = nowhere != NULL && scenario_power_up(scenario, sim, nowhere);
    if (nowhere != NULL)
        fclose(nowhere);
    free(said);
    return ok;
}

enum scenario_end scenario_run(const struct scenario *scenario, FILE *record, bool (*interrupted)(void *context, uint64_t tick),
                               void *context, struct scenario_result *result)
{
    struct running *running = calloc(1, sizeof *running);
    struct sim *sim = calloc(1, sizeof *sim);
    struct scenario own = *scenario;
    *result = (struct scenario_result){0};
    if (running == NULL || sim == NULL) {
        free(running);
        free(sim);
        return SCENARIO_NO_MEMORY;
    }
    own.config.out = running_receive;
    own.config.context = running;
    running->scenario = &own;
    running->sim = sim;
    running->result = result;
    running->interrupted = interrupted;
    running->context = context;
    if (power_up(&own, sim))
        run_recorded(running, record);
    else
        running_no_memory(running);
    enum scenario_end end = running->end;
    free_all(running);
    return end;
}

void scenario_result_free(struct scenario_result *result)
{
    free(result->label);
    free(result->expected);
    free(result->seen);
    *result = (struct scenario_result){0};
}
