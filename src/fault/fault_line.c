/* SPDX-License-Identifier: MIT */
/* Faults of bytes and answers: what the hooks of the segment do on a line with faults. */
#include "fault_apply.h"

#include <stdio.h>

const struct fault_answer fault_answer_unchanged = {.end = UINT32_MAX, .wrong_at = UINT32_MAX};

struct name {
    char text[16];
};

/* "the host", "unit 3". */
static struct name name_of(const struct faults *faults, unsigned station)
{
    struct name name = {"the host"};
    if (station > 0)
        snprintf(name.text, sizeof name.text, "unit %s", faults->calls->unit_name(faults->context, station));
    return name;
}

/* ---- Answers -------------------------------------------------------------------------------------------------------- */

static uint64_t on_answer(void *context, unsigned number)
{
    struct faults *faults = context;
    struct fault_answer *answer = &faults->answer[number - 1u];
    const struct fault *fault;
    uint64_t delay = 0;
    *answer = fault_answer_unchanged;
    if ((fault = fault_apply(faults, FAULT_NO_ANSWER, number, 0, 0))) {
        answer->end = 0;
        fault_report(faults, fault, number, "no answer");
        return 0;
    }
    if ((fault = fault_apply(faults, FAULT_DELAY, number, 0, 0))) {
        delay = fault->ticks;
        fault_report(faults, fault, number, "the answer is late by %llu us", (unsigned long long)delay);
    }
    if ((fault = fault_apply(faults, FAULT_CUT, number, 0, 0))) {
        answer->end = fault->number;
        fault_report(faults, fault, number, "the answer ends after %u bytes", (unsigned)fault->number);
    }
    if ((fault = fault_apply(faults, FAULT_WRONG_FCS, number, 0, 0))) {
        segment_kind(faults->segment)->find_check_value(segment_unit(faults->segment, number), &answer->wrong_at, &answer->mask);
        fault_report(faults, fault, number, "the check value of the answer is wrong");
    }
    return delay;
}

/* What the unit has sent as the next byte of its answer. Returns false if nothing of it goes out. */
static bool apply_to_answer(struct fault_answer *answer, uint8_t *byte)
{
    uint32_t at = answer->at++;
    if (at == answer->wrong_at)
        *byte ^= answer->mask;
    return at < answer->end;
}

/* ---- Bytes ---------------------------------------------------------------------------------------------------------- */

/* Does what a unit sends get as far as the line? */
static bool is_connected(const struct faults *faults, unsigned station)
{
    if (station == 0 && fault_find_active(faults, FAULT_UNPLUGGED, 0))
        return false;
    return !fault_find_active(faults, FAULT_CABLE, station);
}

static size_t on_send(void *context, unsigned station, uint8_t byte, uint8_t *bytes)
{
    struct faults *faults = context;
    unsigned direction = station == 0 ? FAULT_TO_UNITS : FAULT_TO_HOST;
    const struct fault *fault;
    size_t length = 0;
    if (station > 0 && !apply_to_answer(&faults->answer[station - 1u], &byte))
        return 0;
    if (!is_connected(faults, station))
        return 0;
    if ((fault = fault_apply(faults, FAULT_DROP, station, direction, 0))) {
        fault_report(faults, fault, station, "%02X of %s is dropped", byte, name_of(faults, station).text);
        return 0;
    }
    if ((fault = fault_apply(faults, FAULT_FLIP, station, direction, 0))) {
        uint8_t flipped = (uint8_t)(byte ^ fault->number);
        fault_report(faults, fault, station, "%02X of %s becomes %02X", byte, name_of(faults, station).text, flipped);
        byte = flipped;
    }
    if ((fault = fault_apply(faults, FAULT_INSERT, station, direction, 0))) {
        bytes[length++] = (uint8_t)fault->number;
        fault_report(faults, fault, station, "%02X comes before %02X of %s", (unsigned)fault->number, byte,
                   name_of(faults, station).text);
    }
    bytes[length++] = byte;
    if ((fault = fault_apply(faults, FAULT_DUPLICATE, station, direction, 0))) {
        bytes[length++] = byte;
        fault_report(faults, fault, station, "%02X of %s comes twice", byte, name_of(faults, station).text);
    }
    return length;
}

static bool on_receiving(void *context, unsigned station, uint32_t senders)
{
    const struct faults *faults = context;
    if (!is_connected(faults, station))
        return false;
    return senders != 1u || is_connected(faults, 0); /* cut while the byte was under way */
}

static bool on_echo(void *context, uint8_t byte)
{
    struct faults *faults = context;
    const struct fault *fault = fault_apply(faults, FAULT_ECHO, 0, 0, 0);
    if (fault)
        fault_report(faults, fault, 0, "the host receives its own %02X", byte);
    return fault != NULL;
}

static void on_processed(void *context, unsigned number)
{
    struct faults *faults = context;
    uint32_t bit = UINT32_C(1) << number;
    if ((faults->dying & bit) == 0)
        return;
    faults->dying &= ~bit;
    faults->calls->power(faults->context, number, false);
}

const struct segment_hooks faults_hooks = {
    .answer = on_answer,
    .send = on_send,
    .is_receiving = on_receiving,
    .has_echo = on_echo,
    .processed = on_processed,
};
