/* SPDX-License-Identifier: MIT */
/* The parameters and the answers of the methods advance and wait. */
#include <inttypes.h>
#include <stdlib.h>

#include "condition.h"

#define HOUR UINT64_C(3600000000) /* ticks */

static struct condition *read_condition(struct sim *sim, const json_t *params, struct refusal *refusal)
{
    const json_t *until = json_object_get(params, "until");
    if (until)
        return condition_read(sim, until, refusal);
    refuse(refusal, REFUSED_PARAMS, "until: missing: expected a condition, as in {\"motor\": 1, \"state\": \"idle\"}");
    return NULL;
}

static uint64_t end_after(const struct sim *sim, uint64_t ticks)
{
    uint64_t now = sim_now(sim);
    return now > SIM_TIME_MAX || ticks > SIM_TIME_MAX - now ? SIM_TIME_MAX : now + ticks;
}

bool until_read_wait(struct until *until, struct sim *sim, const json_t *params, struct refusal *refusal)
{
    static const char *const names[] = {"until", "limit", NULL};
    uint64_t limit = DEVICE_NEVER;
    if (!params_known(params, names, refusal) ||
        (json_object_get(params, "limit") && !param_time(params, "limit", 0, &limit, refusal)))
        return false;
    *until = (struct until){read_condition(sim, params, refusal), end_after(sim, limit)};
    return until->condition != NULL;
}

bool until_read_advance(struct until *until, struct sim *sim, const json_t *params, struct refusal *refusal)
{
    static const char *const names[] = {"ticks", "until", "limit", NULL};
    bool has_condition = json_object_get(params, "until") != NULL, has_ticks = json_object_get(params, "ticks") != NULL;
    uint64_t left = SIM_TIME_MAX - sim_now(sim), ticks;
    if (!params_known(params, names, refusal))
        return false;
    if (has_condition == has_ticks || (has_ticks && json_object_get(params, "limit"))) {
        refuse(refusal, REFUSED_PARAMS, "expected either ticks, a time, or until, a condition, with limit, a time");
        return false;
    }
    if (!param_time(params, has_ticks ? "ticks" : "limit", has_ticks ? DEVICE_NEVER : HOUR, &ticks, refusal))
        return false;
    *until = (struct until){has_condition ? read_condition(sim, params, refusal) : NULL, end_after(sim, ticks)};
    if (has_condition && !until->condition)
        return false;
    if (left > 0 && (has_condition || ticks <= left))
        return true;
    condition_free(until->condition);
    refuse(refusal, REFUSED_STATE, "virtual time ends at %" PRIu64 " us: expected at most %" PRIu64 " us more", SIM_TIME_MAX,
           left);
    return false;
}

json_t *until_answer(const struct sim *sim, struct condition *condition, bool holds)
{
    json_t *answer = json_pack("{s:I}", "t_us", (json_int_t)sim_now(sim));
    if (!answer || !condition)
        return answer;
    json_object_set_new(answer, "holds", json_boolean(holds));
    if (!holds) {
        char *text = condition_text(condition);
        json_object_set_new(answer, "text", json_string(text ? text : ""));
        free(text);
    }
    return answer;
}
