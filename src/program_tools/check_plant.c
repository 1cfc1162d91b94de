/* SPDX-License-Identifier: MIT */
/* check_plant.c: waits for inputs that the plant drives and that never come, found by running the programs with it. */
#include "check_inside.h"
#include "estimate.h"

static void report(struct check *check, const struct estimate_wait *wait)
{
    const struct estimate_place *place = &wait->place;
    const struct diagnostic where = {.source = place->source, .offset = place->offset, .length = place->length};
    const char *verb = place->command.op == 'O' ? "come" : place->command.op == 'Z' ? "go" : "stop the motor";
    check_warn_at(check, where, CHECK_INPUT_NEVER_COMES, NULL, "input %02u does not %s on this plant: motor %u waits for ever",
                  (unsigned)place->command.argument, verb, place->motor);
}

bool check_plant(struct check *check)
{
    const struct check_options *options = check->options;
    const struct estimate_options run = {.readings = options->readings,
                                         .pass_inputs = true,
                                         .plant = options->plant,
                                         .plant_length = options->plant_length,
                                         .plant_name = options->plant_name,
                                         .errors = options->errors};
    struct estimate estimate;
    if (options->plant == NULL || check->found->errors > 0)
        return true;
    const enum estimate_result result = estimate_programs(check->sources, check->count, &run, &estimate);
    check->found->bad_plant = result == ESTIMATE_NO_PLANT;
    for (size_t i = 0; result == ESTIMATE_OK && i < estimate.wait_count; i++)
        if (estimate.waits[i].driven)
            report(check, &estimate.waits[i]);
    estimate_free(&estimate);
    return result != ESTIMATE_NO_MEMORY;
}
