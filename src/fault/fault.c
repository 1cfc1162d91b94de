/* SPDX-License-Identifier: MIT */
#include "fault_apply.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define SURE 1000000u /* millionths */

const char *fault_kind_name(enum fault_kind kind)
{
    return fault_names[kind];
}

enum fault_kind fault_kind_named(const char *name)
{
    unsigned kind = 0;
    while (kind < FAULT_KINDS && strcmp(fault_names[kind], name) != 0)
        kind++;
    return (enum fault_kind)kind;
}

void fault_report(const struct faults *faults, const struct fault *fault, unsigned unit, const char *format, ...)
{
    char text[192];
    va_list list;
    size_t length = (size_t)snprintf(text, sizeof text, "%s: ", fault_names[fault->kind]);
    va_start(list, format);
    vsnprintf(text + length, sizeof text - length, format, list);
    va_end(list);
    faults->calls->report(faults->context, fault, unit, text);
}

/* ---- Chance --------------------------------------------------------------------------------------------------------- */

/* SplitMix64: any seed is a good one. */
uint64_t faults_random(struct faults *faults)
{
    uint64_t z = faults->random += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

/* An opportunity within the window. Returns whether the fault acts, and counts it. */
static bool use_opportunity(struct faults *faults, struct fault *fault)
{
    if (fault->counted && fault->left == 0)
        return false;
    if (fault->skip > 0) {
        fault->skip--;
        return false;
    }
    if (fault->millionths < SURE && (faults_random(faults) >> 32) * SURE >> 32 >= fault->millionths)
        return false;
    fault->left -= fault->counted;
    fault->acted++;
    return true;
}

struct fault *fault_apply(struct faults *faults, enum fault_kind kind, unsigned unit, unsigned direction, unsigned operation)
{
    const uint64_t now = segment_now(faults->segment);
    struct fault *acting = NULL;
    if ((faults->kinds >> kind & 1u) == 0)
        return NULL;
    for (unsigned i = 0; i < faults->count && !acting; i++) {
        struct fault *fault = &faults->fault[i];
        bool meant = fault->kind == kind && (fault->unit == 0 || fault->unit == unit) &&
                     (direction == 0 || (fault->direction & direction) != 0) &&
                     (operation == 0 || (fault->operations & operation) != 0);
        if (meant && fault->from <= now && now < fault->until && use_opportunity(faults, fault))
            acting = fault;
    }
    return acting;
}

/* ---- Spells --------------------------------------------------------------------------------------------------------- */

static bool has_intervals(const struct fault *fault)
{
    return fault->kind >= FAULT_BREAK;
}

const struct fault *fault_find_active(const struct faults *faults, enum fault_kind kind, unsigned unit)
{
    if ((faults->kinds >> kind & 1u) == 0)
        return NULL;
    for (unsigned i = 0; i < faults->count; i++) {
        const struct fault *fault = &faults->fault[i];
        if (fault->kind == kind && fault->active && fault->unit == unit)
            return fault;
    }
    return NULL;
}

uint32_t faults_hold_inputs(const struct faults *faults, unsigned unit, uint32_t levels)
{
    for (unsigned i = 0; i < faults->count; i++) {
        const struct fault *fault = &faults->fault[i];
        if (fault->kind != FAULT_INPUT || !fault->active || (fault->unit != 0 && fault->unit != unit))
            continue;
        uint32_t bit = UINT32_C(1) << (fault->number - 1u);
        levels = fault->level ? levels | bit : levels & ~bit;
    }
    return levels;
}

static uint64_t later(uint64_t tick, uint64_t ticks)
{
    return ticks >= DEVICE_NEVER - tick ? DEVICE_NEVER : tick + ticks;
}

static uint64_t earlier(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

static void report_begin(const struct faults *faults, const struct fault *fault)
{
    if (fault->kind == FAULT_INPUT)
        fault_report(faults, fault, fault->unit, "input %u is stuck at %d", (unsigned)fault->number, fault->level);
    else if (fault->kind == FAULT_CABLE)
        fault_report(faults, fault, fault->unit, fault->unit > 0 ? "the cable of the unit is cut" : "the cable is cut");
    else
        fault_report(faults, fault, 0, fault->kind == FAULT_BREAK ? "the bus is held at 0" : "the adapter is unplugged");
}

/* Begin and end the intervals of a fault that are due by now. */
static void update_intervals(struct faults *faults, struct fault *fault)
{
    uint64_t now = segment_now(faults->segment);
    if (fault->active && fault->ends <= now) {
        fault->active = false;
        fault_report(faults, fault, fault->unit, "over");
    }
    while (!fault->active && fault->next <= now) {
        uint64_t at = fault->next;
        fault->next = fault->every > 0 ? later(at, fault->every) : DEVICE_NEVER;
        if (fault->next >= fault->until)
            fault->next = DEVICE_NEVER;
        if (!use_opportunity(faults, fault))
            continue;
        if (fault->counted && fault->left == 0)
            fault->next = DEVICE_NEVER;
        fault->ends = earlier(later(at, fault->ticks), fault->until);
        fault->active = fault->ends > now;
        if (fault->active)
            report_begin(faults, fault);
    }
}

/* Give the power back to a unit that has lost it. */
static void restore_power(struct faults *faults, struct fault *fault)
{
    unsigned unit = fault->victim;
    fault->victim = 0;
    fault->ends = DEVICE_NEVER;
    if (faults->segment->unit[unit - 1u].powered)
        return;
    fault_report(faults, fault, unit, "the power is back");
    faults->calls->power(faults->context, unit, true);
}

/* Let the line, the adapter and the inputs be as the intervals in force want them. */
static void apply_intervals(struct faults *faults)
{
    bool unplugged = fault_find_active(faults, FAULT_UNPLUGGED, 0) != NULL;
    bool disturbed = fault_find_active(faults, FAULT_BREAK, 0) != NULL;
    if (disturbed != faults->segment->disturbed)
        segment_disturb(faults->segment, disturbed);
    for (unsigned number = 1; number <= faults->segment->units; number++)
        faults->calls->inputs_changed(faults->context, number);
    if (unplugged == faults->unplugged)
        return;
    faults->unplugged = unplugged;
    if (unplugged)
        segment_purge(faults->segment); /* what the adapter had in its memory is gone with it */
    if (faults->calls->adapter)
        faults->calls->adapter(faults->context, !unplugged);
}

void faults_update(struct faults *faults)
{
    for (unsigned number = 1; number <= faults->segment->units && faults->dying != 0; number++)
        faults_hooks.processed(faults, number);
    for (unsigned i = 0; i < faults->count; i++) {
        struct fault *fault = &faults->fault[i];
        if (has_intervals(fault))
            update_intervals(faults, fault);
        else if (fault->victim != 0 && fault->ends <= segment_now(faults->segment))
            restore_power(faults, fault);
    }
    apply_intervals(faults);
}

uint64_t faults_next(const struct faults *faults)
{
    uint64_t next = faults->dying != 0 ? segment_now(faults->segment) : DEVICE_NEVER;
    for (unsigned i = 0; i < faults->count; i++) {
        const struct fault *fault = &faults->fault[i];
        if (has_intervals(fault))
            next = earlier(next, fault->active ? fault->ends : fault->next);
        else if (fault->victim != 0)
            next = earlier(next, fault->ends);
    }
    return next;
}

static void shift_time(uint64_t *tick, uint64_t shift)
{
    *tick = later(*tick, shift);
}

void faults_shift(struct faults *faults, uint64_t shift)
{
    for (unsigned i = 0; i < faults->count; i++) {
        struct fault *fault = &faults->fault[i];
        shift_time(&fault->from, shift);
        shift_time(&fault->until, shift);
        shift_time(&fault->next, shift);
        shift_time(&fault->ends, shift);
    }
}

void faults_restore(struct faults *faults, const struct faults *snapshot, uint64_t shift)
{
    struct segment *segment = faults->segment;
    const struct fault_calls *calls = faults->calls;
    void *context = faults->context;
    *faults = *snapshot;
    faults->segment = segment;
    faults->calls = calls;
    faults->context = context;
    faults_shift(faults, shift);
}

/* ---- The list ------------------------------------------------------------------------------------------------------- */

void faults_begin(struct faults *faults, uint64_t seed, struct segment *segment, const struct fault_calls *calls, void *context)
{
    *faults = (struct faults){.segment = segment, .calls = calls, .context = context, .random = seed};
    for (unsigned at = 0; at < SEGMENT_UNITS; at++)
        faults->answer[at] = fault_answer_unchanged;
}

bool fault_is_spent(const struct fault *fault, uint64_t now)
{
    bool done = fault->until <= now || (fault->counted && fault->left == 0);
    if (has_intervals(fault))
        return !fault->active && (done || fault->next == DEVICE_NEVER);
    return done && fault->victim == 0;
}

static void remove_at(struct faults *faults, unsigned at)
{
    faults->count--;
    memmove(&faults->fault[at], &faults->fault[at + 1u], (faults->count - at) * sizeof faults->fault[0]);
    faults->kinds = 0;
    for (unsigned i = 0; i < faults->count; i++)
        faults->kinds |= UINT32_C(1) << faults->fault[i].kind;
}

/* Make room for one more, if need be at the cost of the oldest that will not act again. */
static bool make_room(struct faults *faults, uint64_t now)
{
    for (unsigned i = 0; i < faults->count && faults->count == FAULTS_MAX; i++)
        if (fault_is_spent(&faults->fault[i], now))
            remove_at(faults, i);
    return faults->count < FAULTS_MAX;
}

uint32_t faults_add(struct faults *faults, const struct fault *fault)
{
    if (!make_room(faults, segment_now(faults->segment)))
        return 0;
    struct fault *added = &faults->fault[faults->count++];
    *added = *fault;
    added->id = ++faults->last_id;
    added->next = has_intervals(fault) ? fault->from : DEVICE_NEVER;
    added->ends = DEVICE_NEVER;
    added->acted = 0;
    added->victim = 0;
    added->active = false;
    faults->kinds |= UINT32_C(1) << added->kind;
    faults->segment->config.hooks = &faults_hooks;
    uint32_t id = added->id;
    faults_update(faults);
    return id;
}

unsigned faults_remove(struct faults *faults, uint32_t id)
{
    unsigned removed = 0;
    for (unsigned i = faults->count; i-- > 0;) {
        if (id != 0 && faults->fault[i].id != id)
            continue;
        remove_at(faults, i);
        removed++;
    }
    faults_update(faults);
    return removed;
}
