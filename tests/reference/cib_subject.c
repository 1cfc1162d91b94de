/* SPDX-License-Identifier: MIT */
/* cib_subject.c: a CIB module that is given the commands of cib.py. A line of input is a word and five numbers:
 *
 *     mode MODE ACC_UNIT IDLE_OFF COMM_TIMEOUT CUT    what `begin` takes besides; advance by CUT ticks at a time, 0: in one
 *     begin START_SPEED SPEED_MAX ACCELERATION_MAX DECELERATION_MAX BRAKE_ERROR    power up
 *     command TICK NUMBER P1 P2 DRIVE                 to drive 0 or 1, the only one that is looked at, in the order of ticks
 *     request TICK 0 0 0 0                            note a request
 *     end TICK 0 0 0 0                                print what is left, and an empty line
 *
 * Printed are `p TICK POSITION OUTPUTS` for each pulse, `s TICK MCSTAT` for each change, `o TICK OUTPUTS` for other changes of
 * the outputs. */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "cib/cib.h"

static struct cib_unit unit;
static struct cib_config config;
static uint16_t sequence;
static uint64_t cut;
static unsigned drive; /* 0 or 1 */
static struct {
    uint64_t tick;
    int32_t position;
} pulse; /* the last one, until its outputs are known */
static bool has_pulse;

static void on_steps(void *context, unsigned axis, const uint64_t *tick, size_t count, int32_t position, bool forward)
{
    (void)context, (void)forward;
    if (axis != drive + 1 || count != 1) /* with outputs, one by one */
        printf("error: %zu pulses of axis %u\n", count, axis);
    pulse.tick = tick[0];
    pulse.position = position;
    has_pulse = true;
}

static void on_outputs(void *context, uint64_t tick, uint16_t driven)
{
    (void)context;
    const unsigned pattern = (unsigned)driven >> 4 * drive;
    if (has_pulse)
        printf("p %" PRIu64 " %" PRId32 " %u\n", pulse.tick, pulse.position, pattern);
    else
        printf("o %" PRIu64 " %u\n", tick, pattern);
    has_pulse = false;
}

static void on_event(void *context, uint64_t tick, unsigned axis, enum cib_event what, uint32_t value)
{
    (void)context;
    if (what == CIB_EVENT_STATUS && axis == drive + 1)
        printf("s %" PRIu64 " %" PRIu32 "\n", tick, value);
}

static const struct cib_port port = {.steps = on_steps, .outputs = on_outputs, .event = on_event};

static void advance_to(uint64_t tick)
{
    while (cib_now(&unit) < tick) {
        const uint64_t left = tick - cib_now(&unit);
        cib_advance(&unit, cut > 0 && cut < left ? cut : left);
    }
}

static void begin(const long long *number)
{
    struct cib_drive_setup *setup = &config.setup.drive[0];
    setup->start_speed = (uint16_t)number[0];
    setup->speed_max = (uint16_t)number[1];
    setup->acceleration_max = (uint16_t)number[2];
    setup->deceleration_max = (uint16_t)number[3];
    config.setup.drive[1] = *setup;
    config.brake_error = (int8_t)number[4];
    sequence = 0;
    cib_begin(&unit, &config, &port, NULL);
}

static void set_mode(const long long *number)
{
    config = cib_default_config;
    config.setup.drive[0].mode = (uint16_t)number[0];
    config.acc_unit = (uint8_t)number[1];
    config.idle_off = (uint32_t)number[2];
    config.comm_timeout = (uint32_t)number[3];
    cut = (uint64_t)number[4];
}

static void command(const long long *number)
{
    const uint32_t p1 = (uint32_t)number[2];
    const uint16_t words[] = {++sequence, (uint16_t)number[1], (uint16_t)(p1 >> 16), (uint16_t)p1, (uint16_t)number[3]};
    drive = (unsigned)number[4];
    if (cib_write(&unit, (uint16_t)(drive == 0 ? 0x10 : 0x20), words, 5) != CIB_DONE)
        puts("error: the registers were not written");
}

int main(void)
{
    char what[16];
    long long n[5];
    while (scanf("%15s %lld %lld %lld %lld %lld", what, n, n + 1, n + 2, n + 3, n + 4) == 6) {
        if (strcmp(what, "mode") == 0) {
            set_mode(n);
        } else if (strcmp(what, "begin") == 0) {
            begin(n);
        } else {
            advance_to((uint64_t)n[0]);
            if (strcmp(what, "command") == 0)
                command(n);
            else if (strcmp(what, "request") == 0)
                cib_note_request(&unit);
            else
                puts("");
            fflush(stdout);
        }
    }
    return 0;
}
