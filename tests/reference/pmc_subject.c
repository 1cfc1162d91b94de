/* SPDX-License-Identifier: MIT */
/* pmc_subject.c: a PMC that does what pmc.py says. A line of input is a command; all numbers are decimal:
 *
 *     begin PASSES                                    power up
 *     set AXIS PARAMETER VALUE
 *     reg AXIS REG OP VALUE MS SPEED ARGUMENT NUMBER WAIT
 *     plant AXIS POSITION COUNT                       and COUNT times INPUT FROM TO HYSTERESIS (2 147 483 647: without end)
 *     inputs TICK LEVELS
 *     ask TICK KIND AXES X Y
 *     run TICK                                        until then, and until nothing is busy any more
 *     want AXIS K                                     the tick of pulse K, from 1
 *     end
 *
 * Output: what was wanted; ERRORS POSITION TRUE HOMED PULSES SLOT of each axis, SLOT being the one in which it last became free;
 * SLOT AXIS REG of each register executed; SLOT OUTPUTS; an empty line. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pmc/pmc_rig.h"
#include "subject_input.h"

#define WANTS_MAX 4096u

static struct pmc_config config = {.axes = 2};
static struct {
    unsigned axis;
    size_t k;
} want[WANTS_MAX];
static unsigned wants;
static uint64_t free_in[PMC_AXES]; /* slot */

static void read_or_die(bool is_read)
{
    if (!is_read) {
        fputs("pmc_subject: unexpected input\n", stderr);
        exit(1);
    }
}

static void run_until_free(uint64_t tick)
{
    while (pmc_now(&unit) < tick || pmc_is_busy(&unit, 0) || pmc_is_busy(&unit, 1)) {
        const uint64_t slot = (pmc_now(&unit) + SLOT - 1) / SLOT;
        bool busy[PMC_AXES];
        for (unsigned i = 0; i < PMC_AXES; i++)
            busy[i] = pmc_is_busy(&unit, i);
        run_through_slot(slot);
        for (unsigned i = 0; i < PMC_AXES; i++)
            if (busy[i] && !pmc_is_busy(&unit, i))
                free_in[i] = slot;
    }
}

static void end(void)
{
    for (unsigned i = 0; i < wants; i++)
        printf("%" PRIu64 "\n", want[i].k <= pulses[want[i].axis] ? pulse[want[i].axis][want[i].k - 1] : 0);
    for (unsigned i = 0; i < PMC_AXES; i++) {
        const struct pmc_axis_state state = axis_state(i);
        printf("%u %" PRId32 " %" PRId32 " %d %zu %" PRIu64 "\n", state.errors, state.commanded, rig_true(i), state.homed,
               pulses[i], free_in[i]);
    }
    for (size_t i = 0; i < happenings; i++)
        if (happening[i].kind == HAPPENED_EVENT && happening[i].what == PMC_EVENT_COMMAND && happening[i].value != 0)
            printf("%" PRIu64 " %u %" PRIu32 "\n", happening[i].tick / SLOT, happening[i].axis, happening[i].value - 1);
        else if (happening[i].kind == HAPPENED_OUTPUTS)
            printf("%" PRIu64 " %" PRIu32 "\n", happening[i].tick / SLOT, happening[i].value);
    puts("");
    fflush(stdout);
}

static void read_plant(void)
{
    unsigned axis, count;
    int32_t position;
    struct rig_switch sw[RIG_SWITCHES];
    read_or_die(scanf("%u %" SCNd32 " %u", &axis, &position, &count) == 3 && count <= RIG_SWITCHES);
    for (unsigned i = 0; i < count; i++) {
        unsigned input;
        read_or_die(scanf("%u %" SCNd32 " %" SCNd32 " %" SCNd32, &input, &sw[i].from, &sw[i].to, &sw[i].hysteresis) == 4);
        sw[i].input = (uint8_t)input;
    }
    rig_plant(axis, position, sw, count);
}

static void read_command(const char *what)
{
    unsigned a, b, c, d, e, f, g;
    int32_t x, y;
    uint64_t tick;
    if (strcmp(what, "begin") == 0) {
        read_or_die(scanf("%u", &a) == 1);
        config.passes = a != 0;
        pmc_rig_begin(&config);
        wants = 0;
        free_in[0] = free_in[1] = 0;
    } else if (strcmp(what, "set") == 0) {
        read_or_die(scanf("%u %u %" SCNd32, &a, &b, &x) == 3);
        set(a, (enum pmc_parameter)b, x);
    } else if (strcmp(what, "reg") == 0) {
        read_or_die(scanf("%u %u %u %" SCNd32 " %u %u %u %u %d", &a, &b, &c, &x, &d, &e, &f, &g, &y) == 9);
        reg(a, b, (struct pmc_command){x, (uint16_t)d, (uint8_t)c, (uint8_t)e, (uint8_t)f, (uint8_t)g, y != 0});
    } else if (strcmp(what, "plant") == 0) {
        read_plant();
    } else if (strcmp(what, "inputs") == 0) {
        read_or_die(scanf("%" SCNu64 " %u", &tick, &a) == 2);
        run_to(tick);
        rig_inputs((uint16_t)a);
    } else if (strcmp(what, "ask") == 0) {
        read_or_die(scanf("%" SCNu64 " %u %u %" SCNd32 " %" SCNd32, &tick, &a, &b, &x, &y) == 5);
        run_to(tick);
        must((enum pmc_request_kind)a, b, x, y);
    } else if (strcmp(what, "run") == 0) {
        read_or_die(scanf("%" SCNu64, &tick) == 1);
        run_until_free(tick);
    } else if (strcmp(what, "want") == 0) {
        read_or_die(wants < WANTS_MAX && scanf("%u %zu", &want[wants].axis, &want[wants].k) == 2);
        wants++;
    } else {
        read_or_die(strcmp(what, "end") == 0);
        end();
    }
}

static void obey_input(void)
{
    char what[8];
    while (scanf("%7s", what) == 1)
        read_command(what);
}

int main(void)
{
    return run_subject("pmc_subject", obey_input);
}
