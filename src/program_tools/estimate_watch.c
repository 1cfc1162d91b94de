/* SPDX-License-Identifier: MIT */
/* estimate_watch.c: what the motors do during an estimate, command by command. */
#include <stdlib.h>
#include <string.h>

#include "estimate_run.h"
#include "text/text.h"

/* ---- Happenings ------------------------------------------------------------------------------------------------------- */

/* The command at a place 1..700 of the memory, which holds the newest 700. */
static size_t index_of(const struct code *code, unsigned place)
{
    const size_t count = code->count - code->first;
    size_t number = place - 1;
    while (number + RKM04_PROGRAM_MAX < count)
        number += RKM04_PROGRAM_MAX;
    return number < count ? code->first + number : code->count;
}

static void note_motion(struct estimate_motor *motor, const struct watch_event *event)
{
    if (event->value) {
        motor->began = motor->in_motion = true;
        motor->moving = motor->index;
        motor->begin = event->tick;
        motor->pulses = 0;
    } else {
        motor->ended = true;
        motor->end = event->tick;
    }
}

static void note_collision(struct estimate_run *run, const struct watch_event *event)
{
    struct estimate *estimate = run->estimate;
    if (event->value == PLANT_FREE)
        return;
    estimate->collisions_all++;
    if (estimate->collision_count == ESTIMATE_COLLISIONS_MAX)
        return;
    struct estimate_collision *grown =
        realloc(estimate->collisions, (estimate->collision_count + 1) * sizeof *estimate->collisions);
    if (grown == NULL) {
        run->no_memory = true;
        return;
    }
    estimate->collisions = grown;
    grown[estimate->collision_count] = (struct estimate_collision){event->tick, event->motor, strdup(event->text)};
    if (grown[estimate->collision_count].text == NULL)
        run->no_memory = true;
    else
        estimate->collision_count++;
}

static void close_motion(struct estimate_run *run, unsigned number);

static void on_event(void *context, const struct watch_event *event)
{
    struct estimate_run *run = context;
    if (event->motor == 0)
        return;
    struct estimate_motor *motor = &run->motor[event->motor - 1];
    run->last = event->tick;
    switch ((enum watch_kind)event->kind) {
    case WATCH_COMMAND:
        motor->index = event->value == 0 ? motor->code.count : index_of(&motor->code, (unsigned)event->value);
        motor->since = event->tick;
        run->commands++;
        break;
    case WATCH_MOTION:
        if (event->value && motor->ended)
            close_motion(run, event->motor);
        note_motion(motor, event);
        break;
    case WATCH_STEP:
        motor->pulses++;
        break;
    case WATCH_PLANT:
        note_collision(run, event);
        break;
    default:
        break;
    }
}

void estimate_watch(struct estimate_run *run)
{
    run->watcher = (struct watcher){.kinds = WATCH_BIT(WATCH_COMMAND) | WATCH_BIT(WATCH_MOTION) | WATCH_BIT(WATCH_PLANT),
                                    .on_event = on_event,
                                    .context = run};
    if (run->options->plant != NULL)
        run->watcher.kinds |= WATCH_BIT(WATCH_STEP); /* limit moves end somewhere */
    sim_watch(&run->sim, &run->watcher);
}

/* ---- Motions ---------------------------------------------------------------------------------------------------------- */

struct estimate_place estimate_place_of(const struct estimate_run *run, unsigned motor, size_t index)
{
    const struct code_command *command = &run->motor[motor - 1].code.commands[index];
    const struct program_source *source = &run->sources[command->source];
    struct text_place place = text_place_begin(source->text, source->length);
    text_place_move(&place, command->offset);
    return (struct estimate_place){motor,      command->source, command->offset, command->length,
                                   place.line, place.column,    command->command};
}

/* The row of a command that moves. Returns NULL if out of memory. */
static struct estimate_motion *row_of(struct estimate_run *run, unsigned number, size_t index)
{
    struct estimate *estimate = run->estimate;
    size_t *row = &run->motor[number - 1].row[index];
    if (*row != SIZE_MAX)
        return &estimate->motions[*row];
    if (estimate->motion_count == run->motion_room) {
        const size_t room = run->motion_room == 0 ? 16 : 2 * run->motion_room;
        struct estimate_motion *grown = realloc(estimate->motions, room * sizeof *grown);
        if (grown == NULL) {
            run->no_memory = true;
            return NULL;
        }
        estimate->motions = grown;
        run->motion_room = room;
    }
    *row = estimate->motion_count++;
    estimate->motions[*row] = (struct estimate_motion){.place = estimate_place_of(run, number, index)};
    return &estimate->motions[*row];
}

static uint32_t peak_of(const struct estimate_motor *motor)
{
    uint32_t peak = 0;
    for (size_t i = 0; i < motor->point_count; i++)
        peak = motor->points[i].speed > peak ? motor->points[i].speed : peak;
    return peak;
}

/* What is known of the present motion goes into its row. */
static void update_row(struct estimate_motion *row, const struct estimate_motor *motor)
{
    const uint32_t peak = peak_of(motor);
    row->peak = peak > row->peak ? peak : row->peak;
    row->point_count = motor->point_count;
    memcpy(row->points, motor->points, sizeof row->points);
    row->endless = motor->point_count > 0 && motor->points[motor->point_count - 1].speed != 0;
}

/* A motion has ended: its steps are the pulses, or what was planned last. */
static void close_motion(struct estimate_run *run, unsigned number)
{
    struct estimate_motor *motor = &run->motor[number - 1];
    motor->ended = motor->in_motion = false;
    if (motor->moving >= motor->code.count)
        return;
    struct estimate_motion *row = row_of(run, number, motor->moving);
    if (row == NULL)
        return;
    uint64_t steps = motor->pulses;
    if (!(run->watcher.kinds & WATCH_BIT(WATCH_STEP)) && motor->point_count > 0)
        steps = motor->points[motor->point_count - 1].step;
    const uint64_t duration = motor->end - motor->begin;
    if (row->times > 0 && (row->steps != steps || row->duration != duration))
        row->varies = true;
    row->times++;
    row->steps = steps;
    row->duration = duration;
    row->all_steps += steps;
    row->all_duration += duration;
    run->estimate->steps[number - 1] += steps;
    update_row(row, motor);
    row->endless = false;
    motor->point_count = 0;
}

/* Ask for the break points of a motion that has begun, or whose speed has another course now. */
static void ask_points(struct estimate_run *run, unsigned number)
{
    struct estimate_motor *motor = &run->motor[number - 1];
    const uint8_t message[] = {6, (uint8_t)('0' + number)};
    uint8_t answer[1024];
    const size_t length =
        sim_device(&run->sim)->exchange(sim_core(&run->sim, 1), message, sizeof message, answer, sizeof answer);
    motor->point_count = planner_read(answer, length < sizeof answer ? length : sizeof answer, motor->points);
    const uint32_t peak = peak_of(motor);
    if (peak > run->estimate->peak)
        run->estimate->peak = peak;
    struct estimate_motion *row = motor->moving < motor->code.count ? row_of(run, number, motor->moving) : NULL;
    if (row != NULL)
        update_row(row, motor);
}

void estimate_update(struct estimate_run *run)
{
    for (unsigned number = 1; number <= RKM04_MOTORS; number++) {
        struct estimate_motor *motor = &run->motor[number - 1];
        if (motor->ended && motor->end >= motor->begin)
            close_motion(run, number);
        if (!motor->in_motion)
            continue;
        const bool stopping = sim_axis(&run->sim, 1, number).stopping;
        if (motor->began || stopping != motor->stopping)
            ask_points(run, number);
        motor->began = false;
        motor->stopping = stopping;
    }
}
