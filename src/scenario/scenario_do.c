/* SPDX-License-Identifier: MIT */
/* The steps of a scenario. */
#include <inttypes.h>
#include <stdlib.h>

#include "condition/condition.h"
#include "scenario_running.h"

#define TIME_FORMAT "%" PRIu64 ".%06" PRIu64 " s"
#define TIME_OF(ticks) (ticks) / US_PER_SECOND, (ticks) % US_PER_SECOND

/* "TEXT within 5.000000 s"; takes `text` over. */
static char *add_time(char *text, const char *word, uint64_t ticks)
{
    char *whole = text != NULL ? running_text("%s %s " TIME_FORMAT, text, word, TIME_OF(ticks)) : NULL;
    free(text);
    return whole;
}

static bool run_until(struct running *running, uint64_t tick)
{
    while (!running->over && sim_now(running->sim) < tick)
        running_advance(running, tick, NULL);
    return !running->over;
}

/* ---- Conditions ----------------------------------------------------------------------------------------------------- */

static struct condition *arm_condition(struct running *running, const struct scenario_step *step)
{
    struct refusal refusal;
    struct condition *condition = condition_read(running->sim, step->json, &refusal);
    if (condition == NULL)
        running_no_memory(running);
    else
        condition_arm(condition);
    return condition;
}

static bool check_wait(struct running *running, const struct scenario_step *step, struct condition *condition, uint64_t begin)
{
    uint64_t now = sim_now(running->sim);
    if (!condition_holds(condition))
        return running_failed(running, step, now, add_time(condition_wanted_text(condition), "within", step->within),
                              condition_found_text(condition));
    if (now - begin < step->not_before)
        return running_failed(running, step, now, add_time(condition_wanted_text(condition), "not before", step->not_before),
                              add_time(condition_found_text(condition), "after", now - begin));
    return true;
}

static bool do_wait(struct running *running, const struct scenario_step *step)
{
    uint64_t begin = sim_now(running->sim);
    struct condition *condition = arm_condition(running, step);
    while (!running->over && !condition_holds(condition) && sim_now(running->sim) < begin + step->within)
        running_advance(running, begin + step->within, condition);
    bool ok = !running->over && check_wait(running, step, condition, begin);
    condition_free(condition);
    return ok;
}

static bool do_expect(struct running *running, const struct scenario_step *step)
{
    struct condition *condition = arm_condition(running, step);
    if (!running->over && !condition_holds(condition))
        running_failed(running, step, sim_now(running->sim), condition_wanted_text(condition), condition_found_text(condition));
    condition_free(condition);
    return !running->over;
}

static bool do_stays(struct running *running, const struct scenario_step *step)
{
    uint64_t end = sim_now(running->sim) + step->time;
    struct condition *condition = arm_condition(running, step);
    while (!running->over) {
        uint64_t now = sim_now(running->sim);
        if (!condition_holds(condition))
            running_failed(running, step, now, add_time(condition_wanted_text(condition), "all the time for", step->time),
                           condition_found_text(condition));
        else if (now >= end)
            break;
        else
            running_advance(running, end, condition);
    }
    condition_free(condition);
    return !running->over;
}

/* ---- Pulses --------------------------------------------------------------------------------------------------------- */

static bool within_bounds(const struct scenario_bounds *bounds, int64_t count)
{
    for (unsigned i = 0; i < bounds->count; i++) {
        if (!term_compares(count, (enum term_relation)bounds->bound[i].relation, bounds->bound[i].value))
            return false;
    }
    return true;
}

static void print_bounds(FILE *out, const struct scenario_bounds *bounds, const char *what)
{
    for (unsigned i = 0; i < bounds->count; i++)
        fprintf(out, ", %s %s %" PRId64, what, term_relation_name((enum term_relation)bounds->bound[i].relation),
                bounds->bound[i].value);
}

static char *bounds_text(const struct scenario_pulses *pulses)
{
    char *text = NULL;
    size_t length;
    FILE *out = open_memstream(&text, &length);
    if (out == NULL)
        return NULL;
    fprintf(out, "pulses of motor %u%s", pulses->motor, pulses->since_last ? " since the last check" : "");
    print_bounds(out, &pulses->count, "count");
    print_bounds(out, &pulses->forward, "forward");
    print_bounds(out, &pulses->back, "back");
    fclose(out);
    return text;
}

static bool do_pulses(struct running *running, const struct scenario_step *step)
{
    const struct scenario_pulses *pulses = &step->pulses;
    const struct pulse_count *count = &running->count[step->unit - 1][pulses->motor - 1];
    struct pulse_count *last = &running->last[step->unit - 1][pulses->motor - 1];
    int64_t forward = count->forward - (pulses->since_last ? last->forward : 0);
    int64_t back = count->back - (pulses->since_last ? last->back : 0);
    *last = *count;
    if (within_bounds(&pulses->count, forward + back) && within_bounds(&pulses->forward, forward) &&
        within_bounds(&pulses->back, back))
        return true;
    return running_failed(running, step, sim_now(running->sim), bounds_text(pulses),
                          running_text("%" PRId64 " pulses, %" PRId64 " forward, %" PRId64 " back", forward + back, forward,
                                       back));
}

/* ---- Commands ------------------------------------------------------------------------------------------------------- */

static char *member_text(const char *name, const json_t *value)
{
    char *json = value != NULL ? json_dumps(value, JSON_ENCODE_ANY | JSON_COMPACT) : NULL;
    char *text = running_text("%s %s in the result", name, json != NULL ? json : "missing");
    free(json);
    return text;
}

/* The members of the result that the step names. */
static bool check_result(struct running *running, const struct scenario_step *step, const json_t *result)
{
    const char *name;
    json_t *wanted;
    json_object_foreach(step->result, name, wanted) {
        const json_t *value = json_object_get(result, name);
        if (value == NULL || !json_equal(value, wanted))
            return running_failed(running, step, sim_now(running->sim), member_text(name, wanted), member_text(name, value));
    }
    return true;
}

/* The exchange of a device takes time. */
static json_t *exchange(struct running *running, const struct scenario_step *step, struct refusal *refusal)
{
    struct exchange exchange;
    if (!exchange_begin(&exchange, running->sim, step->json, refusal))
        return NULL;
    json_t *result = run_until(running, exchange.end) ? exchange_answer(&exchange, running->sim, refusal) : NULL;
    exchange_drop(&exchange);
    return result;
}

static bool do_call(struct running *running, const struct scenario_step *step)
{
    struct refusal refusal = {0};
    json_t *result = exchange_is_named(running->sim, step->method)
                         ? exchange(running, step, &refusal)
                         : sim_command(running->sim, step->method, step->json, &refusal);
    bool ok = result != NULL;
    if (ok && !running->over && step->result != NULL)
        check_result(running, step, result);
    json_decref(result);
    if (running->over)
        return false;
    return ok || running_failed(running, step, sim_now(running->sim), running_text("%s to succeed", step->method),
                                running_text("refused: %s", refusal.text));
}

/* ---- The whole ------------------------------------------------------------------------------------------------------ */

static bool do_action(struct running *running, const struct scenario_step *step)
{
    switch ((enum scenario_action)step->action) {
    case ACTION_WAIT:
        return do_wait(running, step);
    case ACTION_EXPECT:
        return do_expect(running, step);
    case ACTION_STAYS:
        return do_stays(running, step);
    case ACTION_ADVANCE:
        return run_until(running, sim_now(running->sim) + step->time);
    case ACTION_PULSES:
        return do_pulses(running, step);
    case ACTION_CALL:
        return do_call(running, step);
    default:
        return running_send(running, step);
    }
}

bool running_do_step(struct running *running, const struct scenario_step *step)
{
    uint64_t now = sim_now(running->sim);
    if (step->at != DEVICE_NEVER && step->at < now)
        return running_failed(running, step, now, running_text("to begin at " TIME_FORMAT, TIME_OF(step->at)),
                              running_text("the step before has just ended"));
    if (step->at != DEVICE_NEVER && !run_until(running, step->at))
        return false;
    return do_action(running, step);
}
