/* SPDX-License-Identifier: MIT */
/* cib_bench.c: pulses of the CIB module's core, for instructions.sh. Prints one JSON object.
 *
 *     cib_bench [--single] NAME        constant, ramp; --single: with the outputs, one by one; otherwise in blocks */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "cib/cib.h"

#define PULSES 100000

static struct cib_unit unit;
static uint64_t stamps[PULSES], pulses, changes;

static void on_steps(void *context, unsigned axis, const uint64_t *tick, size_t count, int32_t position, bool forward)
{
    (void)context, (void)axis, (void)position, (void)forward;
    memcpy(stamps + pulses, tick, count * sizeof *tick);
    pulses += count;
}

static void on_outputs(void *context, uint64_t tick, uint16_t driven)
{
    (void)context, (void)tick, (void)driven;
    changes++;
}

/* Without ramps at 10 000/s, or up from 5/s and down again. */
int main(int argc, char **argv)
{
    static const struct cib_port blocks = {.steps = on_steps}, single = {.steps = on_steps, .outputs = on_outputs};
    struct cib_config config = cib_default_config;
    const bool one_by_one = argc > 1 && strcmp(argv[1], "--single") == 0;
    const uint16_t words[] = {1, 102, PULSES >> 16, PULSES & 0xffff, 10000};
    if (argc < 2 || strcmp(argv[argc - 1], "ramp") != 0)
        config.setup.drive[0].ramps = 0;
    config.setup.drive[0].start_speed = 5;
    config.setup.drive[0].speed_max = 10000;
    cib_begin(&unit, &config, one_by_one ? &single : &blocks, NULL);
    cib_write(&unit, 0x10, words, 5);
    while ((cib_read(&unit, CIB_INPUT_ZONE, 0x11) & CIB_MOVE) != 0)
        cib_advance(&unit, CIB_SLOT_TICKS);
    printf("{\"bench\":\"cib\",\"work\":\"%s\",\"pulses\":%" PRIu64 "}\n", argv[argc - 1], pulses);
    return pulses == PULSES && (!one_by_one || changes == pulses) ? 0 : 1;
}
