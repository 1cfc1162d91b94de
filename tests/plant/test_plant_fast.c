/* SPDX-License-Identifier: MIT */
/* test_plant_fast.c: plants of devices that step faster than a plant can keep in the time between two slots. */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "command/command.h"
#include "core/rig.h"
#include "sim/sim.h"

static struct sim sim;
static char seen[1024];
static uint64_t due[4]; /* tick of the steps to the positions of `wanted` */
static const int32_t wanted[4] = {5000, 5101, 300000, 300011};

static void on_event(void *context, const struct watch_event *event)
{
    size_t length = strlen(seen);
    (void)context;
    if (event->kind == WATCH_INPUTS)
        snprintf(seen + length, sizeof seen - length, "%llu inputs %d\n", (unsigned long long)event->tick, (int)event->value);
    for (unsigned i = 0; event->kind == WATCH_STEP && i < 4; i++)
        if (event->value == wanted[i] && event->motor == 1)
            due[i] = event->tick;
}

static void command(const char *method, const char *params)
{
    struct refusal refusal;
    json_t *json = json_loads(params, 0, NULL), *result = sim_command(&sim, method, json, &refusal);
    ck_assert_msg(result != NULL, "%s %s: %s", method, params, refusal.text);
    json_decref(json);
    json_decref(result);
}

/* 4 000 000 steps/s: both switches are passed within 26 us. Two axes at that speed do not disturb one another. */
START_TEST(switches_are_seen_that_a_fast_axis_passes)
{
    struct watcher watcher = {.kinds = WATCH_BIT(WATCH_STEP) | WATCH_BIT(WATCH_INPUTS), .on_event = on_event};
    struct sim_config config = {
        .device = device_kind_named("pmc-2hs"), .timed = true, .seed = 1, .nodes = {.count = 1, .node = {1}}};
    char expected[200];
    ck_assert_ptr_nonnull(config.device);
    memset(&sim, 0, sizeof sim);
    ck_assert(sim_begin(&sim, &config));
    command("plant.set", "{\"plant\": {\"motors\": {\"2\": {}}, \"switches\": ["
                         "{\"input\": \"x.in0\", \"motor\": 1, \"between\": [5000, 5100]},"
                         "{\"input\": \"x.in1\", \"motor\": 1, \"between\": [300000, 300010]}]}}");
    unsigned first = device_input_named(config.device, "x.in0"), second = device_input_named(config.device, "x.in1");
    sim_watch(&sim, &watcher);
    command("pmc.parameters", "{\"text\": \"[X]\\nmultiplier = 500\\nacceleration = 8000\\n"
                              "[Y]\\nmultiplier = 500\\nacceleration = 8000\\n\"}");
    command("pmc.speed", "{\"x\": 8000, \"y\": 8000}");
    command("pmc.jog", "{\"x\": \"+\", \"y\": \"-\"}");
    sim_advance(&sim, 200000);
    ck_assert_int_gt(sim_axis(&sim, 1, 1).position, 400000);
    snprintf(expected, sizeof expected, "%llu inputs %u\n%llu inputs 0\n%llu inputs %u\n%llu inputs 0\n",
             (unsigned long long)due[0] + 1, 1u << (first - 1u), (unsigned long long)due[1] + 1,
             (unsigned long long)due[2] + 1, 1u << (second - 1u), (unsigned long long)due[3] + 1);
    ck_assert_str_eq(seen, expected);
    int64_t position;
    ck_assert(plant_position(sim.unit[0].plant, 2, &position));
    ck_assert_int_le(labs((long)(position - sim_axis(&sim, 1, 2).position)), 4); /* those of the last us are to come */
    sim_end(&sim);
}
END_TEST

static Suite *plant_fast_suite(void)
{
    Suite *suite = suite_create("plant_fast");
    TCase *all = tcase_create("all");
    tcase_add_test(all, switches_are_seen_that_a_fast_axis_passes);
    suite_add_tcase(suite, all);
    return suite;
}

int main(void)
{
    return rig_run(plant_fast_suite(), "./test_plant_fast");
}
