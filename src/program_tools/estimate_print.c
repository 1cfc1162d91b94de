/* SPDX-License-Identifier: MIT */
#include "estimate_print.h"

#include <inttypes.h>
#include <string.h>

#define SECOND ((uint64_t)RKM04_TICKS_PER_SECOND)
#define SECONDS_FORMAT "%" PRIu64 ".%06" PRIu64 " s"
#define SECONDS(us) (us) / SECOND, (us) % SECOND

/* ---- Words ------------------------------------------------------------------------------------------------------------ */

static uint64_t all_steps(const struct estimate *estimate)
{
    uint64_t steps = 0;
    for (unsigned i = 0; i < RKM04_MOTORS; i++)
        steps += estimate->steps[i];
    return steps;
}

const char *estimate_summary(const struct estimate *estimate, char text[160])
{
    static const char *const ends[] = {
        [ESTIMATE_DONE] = "",
        [ESTIMATE_STOPPED] = ", then stops with a fault",
        [ESTIMATE_WAITS] = ", then waits",
        [ESTIMATE_ROUND] = " a round",
        [ESTIMATE_ENDLESS] = ", then an endless motion",
        [ESTIMATE_LIMIT] = ", and more",
    };
    const uint64_t duration = estimate->end == ESTIMATE_ROUND ? estimate->round : estimate->duration;
    snprintf(text, 160, SECONDS_FORMAT "%s, %" PRIu64 " steps, peak %" PRIu32 " steps/s", SECONDS(duration),
             ends[estimate->end], all_steps(estimate), estimate->peak);
    return text;
}

static const char *command_text(struct rkm04_command command, char text[RKM04_COMMAND_TEXT_MAX + 1])
{
    text[rkm04_format(command, text)] = '\0';
    return text;
}

static void print_place(const struct estimate_place *place, const struct program_source *sources, FILE *out)
{
    char text[RKM04_COMMAND_TEXT_MAX + 1];
    fprintf(out, "%s:%zu:%zu: %s", sources[place->source].name, place->line, place->column, command_text(place->command, text));
}

static void print_motion(const struct estimate_motion *motion, const struct estimate *estimate,
                         const struct program_source *sources, FILE *out)
{
    print_place(&motion->place, sources, out);
    if (sources[motion->place.source].motor == 0)
        fprintf(out, " of motor %u", motion->place.motor);
    if (motion->times > 1)
        fprintf(out, ": %" PRIu64 " times%s, in all %" PRIu64 " steps in " SECONDS_FORMAT, motion->times,
                motion->in_round ? " a round" : "", motion->all_steps, SECONDS(motion->all_duration));
    else if (motion->endless)
        fprintf(out, ": without an end");
    else
        fprintf(out, ": %" PRIu64 " steps in " SECONDS_FORMAT, motion->steps, SECONDS(motion->duration));
    if (motion->times > 1 && !motion->varies)
        fprintf(out, ", each %" PRIu64 " in " SECONDS_FORMAT, motion->steps, SECONDS(motion->duration));
    fprintf(out, ", peak %" PRIu32 " steps/s%s\n", motion->peak,
            estimate->end == ESTIMATE_ROUND && !motion->in_round ? ", before the round" : "");
    if (motion->point_count == 0)
        return;
    fputs("   ", out);
    for (size_t i = 0; i < motion->point_count; i++)
        fprintf(out, " (%" PRIu32 ";%" PRIu32 ")", motion->points[i].step, motion->points[i].speed);
    fputc('\n', out);
}

static void print_wait(const struct estimate_wait *wait, const struct program_source *sources, FILE *out)
{
    print_place(&wait->place, sources, out);
    fprintf(out, ": motor %u waits from " SECONDS_FORMAT " on\n", wait->place.motor, SECONDS(wait->since));
}

static void print_whole(const struct estimate *estimate, FILE *out)
{
    char text[160];
    fprintf(out, "%s\n", estimate_summary(estimate, text));
    for (unsigned i = 0; i < RKM04_MOTORS; i++)
        if (estimate->steps[i] > 0 && (estimate->end == ESTIMATE_ROUND || estimate->end == ESTIMATE_ENDLESS))
            fprintf(out, "motor %u: %" PRIu64 " steps\n", i + 1, estimate->steps[i]);
        else if (estimate->steps[i] > 0)
            fprintf(out, "motor %u: %" PRIu64 " steps, to position %" PRId32 "\n", i + 1, estimate->steps[i],
                    estimate->position[i]);
    for (unsigned i = 0; i < RKM04_INPUTS; i++)
        if (estimate->assumed >> i & 1)
            fprintf(out, "input %02u is set as soon as a motor waits for it\n", i + 1);
    if (estimate->deadlock)
        fprintf(out, "from " SECONDS_FORMAT " on motors wait for each other\n", SECONDS(estimate->deadlock_at));
    if (estimate->end == ESTIMATE_LIMIT)
        fprintf(out, "stopped after %u commands\n", ESTIMATE_COMMANDS_MAX);
}

void estimate_print(const struct estimate *estimate, const struct program_source *sources, FILE *out)
{
    for (size_t i = 0; i < estimate->motion_count; i++)
        print_motion(&estimate->motions[i], estimate, sources, out);
    for (size_t i = 0; i < estimate->wait_count; i++)
        print_wait(&estimate->waits[i], sources, out);
    for (size_t i = 0; i < estimate->collision_count; i++)
        fprintf(out, "at " SECONDS_FORMAT ": %s\n", SECONDS(estimate->collisions[i].at), estimate->collisions[i].text);
    if (estimate->collisions_all > estimate->collision_count)
        fprintf(out, "%" PRIu64 " more are not shown\n", estimate->collisions_all - estimate->collision_count);
    print_whole(estimate, out);
}

/* ---- JSON ------------------------------------------------------------------------------------------------------------- */

static json_t *place_json(const struct estimate_place *place, const struct program_source *sources)
{
    char text[RKM04_COMMAND_TEXT_MAX + 1];
    json_t *name = json_string(sources[place->source].name);
    return json_pack("{s:o, s:I, s:I, s:I, s:I, s:i, s:s}", "file", name != NULL ? name : json_string("?"), "line",
                     (json_int_t)place->line, "column", (json_int_t)place->column, "offset", (json_int_t)place->offset, "length",
                     (json_int_t)place->length, "motor", (int)place->motor, "command", command_text(place->command, text));
}

static json_t *motion_json(const struct estimate_motion *motion, const struct program_source *sources)
{
    json_t *json = place_json(&motion->place, sources), *points = json_array();
    for (size_t i = 0; i < motion->point_count; i++)
        json_array_append_new(points, json_pack("[I, I]", (json_int_t)motion->points[i].step,
                                                (json_int_t)motion->points[i].speed));
    json_t *rest = json_pack("{s:I, s:I, s:I, s:I, s:I, s:I, s:b, s:b, s:b, s:o}", "times", (json_int_t)motion->times, "steps",
                             (json_int_t)motion->steps, "duration_us", (json_int_t)motion->duration, "all_steps",
                             (json_int_t)motion->all_steps, "all_duration_us", (json_int_t)motion->all_duration, "peak",
                             (json_int_t)motion->peak, "in_round", motion->in_round, "varies", motion->varies, "endless",
                             motion->endless, "points", points);
    json_object_update_missing(json, rest);
    json_decref(rest);
    return json;
}

static json_t *wait_json(const struct estimate_wait *wait, const struct program_source *sources)
{
    json_t *json = place_json(&wait->place, sources);
    json_object_set_new(json, "since_us", json_integer((json_int_t)wait->since));
    return json;
}

json_t *estimate_json(const struct estimate *estimate, const struct program_source *sources)
{
    json_t *motions = json_array(), *waits = json_array(), *collisions = json_array(), *motors = json_array();
    for (size_t i = 0; i < estimate->motion_count; i++)
        json_array_append_new(motions, motion_json(&estimate->motions[i], sources));
    for (size_t i = 0; i < estimate->wait_count; i++)
        json_array_append_new(waits, wait_json(&estimate->waits[i], sources));
    for (size_t i = 0; i < estimate->collision_count; i++)
        json_array_append_new(collisions,
                              json_pack("{s:I, s:i, s:s}", "t_us", (json_int_t)estimate->collisions[i].at, "motor",
                                        (int)estimate->collisions[i].motor, "text", estimate->collisions[i].text));
    for (unsigned i = 0; i < RKM04_MOTORS; i++)
        json_array_append_new(motors, json_pack("{s:i, s:I, s:I}", "motor", (int)i + 1, "steps", (json_int_t)estimate->steps[i],
                                                "position", (json_int_t)estimate->position[i]));
    return json_pack("{s:s, s:I, s:I, s:I, s:i, s:o, s:o, s:o, s:o, s:o}", "end", estimate_end_name(estimate->end), "duration_us",
                     (json_int_t)estimate->duration, "round_us", (json_int_t)estimate->round, "peak", (json_int_t)estimate->peak,
                     "assumed_inputs", (int)estimate->assumed, "motors", motors, "motions", motions, "waits", waits, "collisions",
                     collisions, "deadlock_us",
                     estimate->deadlock ? json_integer((json_int_t)estimate->deadlock_at) : json_null());
}
