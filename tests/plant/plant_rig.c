/* SPDX-License-Identifier: MIT */
#include "device/rkm04_device.h"
#include "plant_rig.h"

#include <check.h>
#include <stdlib.h>
#include <string.h>

static void on_event(void *context, const struct watch_event *event)
{
    struct plant_rig *rig = context;
    if (event->kind == WATCH_INPUTS) {
        ck_assert_uint_lt(rig->inputs, RIG_INPUTS);
        rig->input[rig->inputs].tick = event->tick;
        rig->input[rig->inputs++].mask = (uint8_t)event->value;
    } else if (event->kind == WATCH_PLANT) {
        ck_assert_uint_lt(rig->news, RIG_NEWS);
        rig->report[rig->news].tick = event->tick;
        rig->report[rig->news].motor = event->motor;
        rig->report[rig->news].what = (enum plant_event)event->value;
        strcpy(rig->report[rig->news++].text, event->text);
    }
}

bool plant_rig_configure(struct plant_rig *rig, const char *plant)
{
    char *said = NULL;
    size_t length;
    FILE *errors = open_memstream(&said, &length);
    bool ok = sim_configure_plants(&rig->sim, "plant", plant, plant ? strlen(plant) : 0, errors);
    fclose(errors);
    ck_assert_uint_lt(length, sizeof rig->errors);
    strcpy(rig->errors, said);
    free(said);
    ck_assert_msg(ok == (rig->errors[0] == '\0'), "taken: %d, said: %s", ok, rig->errors);
    return ok;
}

bool plant_rig_begin(struct plant_rig *rig, const char *nodes, const char *plant)
{
    struct sim_config config = {.timed = true, .turnaround = SEGMENT_TURNAROUND, .seed = 1};
    memset(rig, 0, sizeof *rig);
    ck_assert(node_list_read(&config.nodes, nodes));
    ck_assert(sim_begin(&rig->sim, &config));
    rig->watcher.kinds = WATCH_BIT(WATCH_INPUTS) | WATCH_BIT(WATCH_PLANT);
    rig->watcher.on_event = on_event;
    rig->watcher.context = rig;
    sim_watch(&rig->sim, &rig->watcher);
    return !plant || plant_rig_configure(rig, plant);
}

void plant_rig_end(struct plant_rig *rig)
{
    sim_unwatch(&rig->sim, &rig->watcher);
    sim_end(&rig->sim);
}

void plant_rig_program(struct plant_rig *rig, unsigned number, char motor, const char *text)
{
    uint8_t character;
    ck_assert_int_eq(rkm04_set_command(rkm04_of(sim_core(&rig->sim, number)), motor, text, strlen(text), &character), 0);
}

void plant_rig_run(struct plant_rig *rig, uint64_t ticks)
{
    sim_advance(&rig->sim, sim_now(&rig->sim) + ticks);
}

int64_t true_position(const struct plant_rig *rig, unsigned motor)
{
    int64_t position;
    ck_assert(rig->sim.unit[0].plant && plant_position(rig->sim.unit[0].plant, motor, &position));
    return position;
}

int32_t counter(struct plant_rig *rig, unsigned motor)
{
    struct rkm04_motor_state state;
    ck_assert(rkm04_motor_state(rkm04_of(sim_core(&rig->sim, 1)), motor, &state));
    return state.position;
}

uint8_t inputs(struct plant_rig *rig)
{
    return rkm04_inputs(rkm04_of(sim_core(&rig->sim, 1)));
}

const char *plant_rig_command(struct plant_rig *rig, const char *method, const char *params)
{
    static char text[4096];
    struct refusal refusal = {0};
    json_t *given = params ? json_loads(params, 0, NULL) : NULL;
    ck_assert(given || !params);
    json_t *result = sim_command(&rig->sim, method, given, &refusal);
    char *dump = result ? json_dumps(result, JSON_COMPACT | JSON_SORT_KEYS) : NULL;
    if (dump)
        snprintf(text, sizeof text, "%s", dump);
    else
        snprintf(text, sizeof text, "%d %s", refusal.code, refusal.text);
    free(dump);
    json_decref(result);
    json_decref(given);
    return text;
}
