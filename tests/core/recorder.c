/* SPDX-License-Identifier: MIT */
#include "recorder.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "flash_fake.h"

static void add(struct recorder *recorder, struct record record)
{
    if (recorder->count == recorder->room) {
        size_t room = recorder->room ? 2 * recorder->room : 1024;
        struct record *list = realloc(recorder->list, room * sizeof *list);
        if (!list) {
            fprintf(stderr, "recorder: no memory for %zu records\n", room);
            abort();
        }
        recorder->list = list;
        recorder->room = room;
    }
    recorder->list[recorder->count++] = record;
}

static void on_step(void *context, uint64_t tick, unsigned motor, int32_t position)
{
    add(context, (struct record){.tick = tick, .kind = RECORD_STEP, .motor = motor, .value = position});
}

static void on_direction(void *context, uint64_t tick, unsigned motor, bool forward)
{
    add(context, (struct record){.tick = tick, .kind = RECORD_DIRECTION, .motor = motor, .value = forward});
}

static void on_outputs(void *context, uint64_t tick, uint8_t mask)
{
    add(context, (struct record){.tick = tick, .kind = RECORD_OUTPUTS, .value = mask});
}

static void on_event(void *context, uint64_t tick, unsigned motor, enum rkm04_event what, uint32_t value)
{
    add(context, (struct record){.tick = tick, .kind = RECORD_EVENT, .motor = motor, .what = what, .value = value});
}

static void *flash_of(void *context)
{
    return (void *)((struct recorder *)context)->flash;
}

static int on_read(void *context, unsigned block, unsigned offset, void *data, unsigned length)
{
    void *flash = flash_of(context);
    return flash ? flash_fake_read(flash, block, offset, data, length) : 1;
}

static int on_erase(void *context, unsigned block)
{
    void *flash = flash_of(context);
    return flash ? flash_fake_erase(flash, block) : 1;
}

static int on_program(void *context, unsigned block, unsigned offset, const void *data, unsigned length)
{
    void *flash = flash_of(context);
    return flash ? flash_fake_program(flash, block, offset, data, length) : 1;
}

const struct rkm04_port recorder_port = {
    .step = on_step,
    .direction = on_direction,
    .outputs = on_outputs,
    .event = on_event,
};

const struct rkm04_port recorder_flash_port = {
    .step = on_step,
    .direction = on_direction,
    .outputs = on_outputs,
    .event = on_event,
    .flash_read = on_read,
    .flash_erase = on_erase,
    .flash_program = on_program,
};

void recorder_clear(struct recorder *recorder)
{
    recorder->count = 0;
}

void recorder_free(struct recorder *recorder)
{
    free(recorder->list);
    recorder->list = NULL;
    recorder->count = recorder->room = 0;
}

static bool is_step(const struct record *record, unsigned motor)
{
    return record->kind == RECORD_STEP && record->motor == motor;
}

size_t recorder_steps(const struct recorder *recorder, unsigned motor)
{
    size_t steps = 0;
    for (size_t i = 0; i < recorder->count; i++)
        steps += is_step(&recorder->list[i], motor);
    return steps;
}

uint64_t recorder_step(const struct recorder *recorder, unsigned motor, size_t n)
{
    for (size_t i = 0; i < recorder->count; i++)
        if (is_step(&recorder->list[i], motor) && --n == 0)
            return recorder->list[i].tick;
    return RKM04_NEVER;
}

const struct record *recorder_event(const struct recorder *recorder, unsigned motor, enum rkm04_event what, int64_t value,
                                    size_t n)
{
    for (size_t i = 0; i < recorder->count; i++) {
        const struct record *record = &recorder->list[i];
        if (record->kind == RECORD_EVENT && record->motor == motor && record->what == what && record->value == value && --n == 0)
            return record;
    }
    return NULL;
}

static bool in_order(const struct record *a, const struct record *b)
{
    return a->tick != b->tick ? a->tick < b->tick : a->motor <= b->motor;
}

/* A merge sort from runs of 1 upwards: qsort promises no stability. */
void recorder_sort(struct recorder *recorder)
{
    size_t count = recorder->count;
    struct record *from = recorder->list, *to = malloc((count ? count : 1) * sizeof *to);
    if (!to)
        abort();
    struct record *spare = to;
    for (size_t run = 1; run < count; run *= 2) {
        for (size_t begin = 0; begin < count; begin += 2 * run) {
            size_t middle = begin + run < count ? begin + run : count;
            size_t end = middle + run < count ? middle + run : count;
            size_t a = begin, b = middle;
            for (size_t i = begin; i < end; i++)
                to[i] = a < middle && (b == end || in_order(&from[a], &from[b])) ? from[a++] : from[b++];
        }
        struct record *done = to;
        to = from;
        from = done;
    }
    if (from != recorder->list)
        memcpy(recorder->list, from, count * sizeof *from);
    free(spare);
}
