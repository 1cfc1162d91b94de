/* SPDX-License-Identifier: MIT */
/* bench_pmc.c: what a pulse of the PMC's core costs. Prints one JSON object a line; every time is CPU time, the median of some
 * runs.
 *
 *     bench_pmc [--quick | --once] [NAME]...
 *
 * constant, ramp: the same pulses as those works of bench.c, on two axes. top: 4 000 000 pulses/s on both. instructions.sh counts
 * instructions. */
#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "pmc/pmc.h"

#define RUNS 7u
#define SECOND ((uint64_t)PMC_TICKS_PER_SECOND)
#define STAMPS (UINT32_C(1) << 16) /* a ring: it stays in the cache as what a host drains at once does */

static struct pmc_unit unit;
static uint64_t stamp[STAMPS], pulses;
static bool quick;
static unsigned runs = RUNS;

/* One time stamp a pulse, nothing else. */
static void sink_steps(void *context, unsigned axis, const uint64_t *tick, size_t count, int32_t position, bool forward)
{
    (void)context, (void)axis, (void)position, (void)forward;
    const size_t at = pulses % (STAMPS / 2);
    memcpy(stamp + at, tick, count * sizeof *tick);
    pulses += count;
}

static const struct pmc_port port = {.steps = sink_steps};

static _Noreturn void fail(const char *what)
{
    fprintf(stderr, "bench_pmc: %s\n", what);
    exit(1);
}

static double now_ns(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

/* Power up both axes with a multiplier, rates, start speed and V1. */
static void power_up(int32_t m, int32_t rate, int32_t start_speed, int32_t speed)
{
    const struct pmc_config config = {.axes = 2};
    const int32_t value[] = {m, rate, start_speed, speed, 0x0103};
    const enum pmc_parameter which[] = {PMC_MULTIPLIER, PMC_ACCELERATION, PMC_START_SPEED, PMC_SPEED1, PMC_FLAGS};
    pmc_init(&unit, &config, &port, NULL);
    for (unsigned axis = 0; axis < PMC_AXES; axis++)
        for (unsigned i = 0; i < 5; i++)
            if (pmc_set_parameter(&unit, axis, which[i], value[i]) != PMC_OK)
                fail("a parameter was refused");
    pulses = 0;
}

static void start(enum pmc_request_kind kind, int32_t value)
{
    const struct pmc_request request = {.kind = (uint8_t)kind, .axes = 3, .value = {value, value}};
    if (pmc_request(&unit, &request) != PMC_OK)
        fail("a request was refused");
}

/* `times` moves of `way` pulses, by a program; to its end, a second at a time. */
static double run_moves(unsigned times, int32_t way)
{
    power_up(2, 80, 50, 8000);
    const struct pmc_command program[] = {{.op = PMC_REP, .argument = (uint8_t)times},
                                          {.op = PMC_INC, .value = 10 * way, .speed = 1},
                                          {.op = PMC_RPE},
                                          {.op = PMC_END}};
    unit.config.passes = true;
    for (unsigned axis = 0; axis < PMC_AXES; axis++)
        for (unsigned i = 0; i < 4; i++)
            if (pmc_set_command(&unit, axis, i, &program[i]) != PMC_OK)
                fail("a command was refused");
    start(PMC_RUN, 0);
    const double from = now_ns();
    do {
        pmc_advance(&unit, SECOND);
    } while (pmc_is_busy(&unit, 0) || pmc_is_busy(&unit, 1));
    const double took = now_ns() - from;
    if (pulses != UINT64_C(2) * times * (uint64_t)way)
        fail("not as many pulses as there should be");
    return took;
}

static double run_constant(void)
{
    return run_moves(1, quick ? 20000 : 1000000);
}

static double run_ramp(void)
{
    return run_moves(quick ? 2 : 80, 12500);
}

/* Two axes at 4 000 000 pulses/s for some seconds, a second at a time. */
static double run_top(void)
{
    power_up(500, 8000, 8000, 8000);
    start(PMC_SET_SPEED, 8000);
    start(PMC_JOG, 1);
    pmc_advance(&unit, PMC_SLOT_TICKS + 1);
    pulses = 0;
    const double from = now_ns();
    for (unsigned i = 0; i < (quick ? 1 : 5); i++)
        pmc_advance(&unit, SECOND);
    if (pulses != UINT64_C(8000000) * (quick ? 1 : 5))
        fail("two axes at 4 000 000 pulses/s do not give 8 000 000 pulses a second");
    return now_ns() - from;
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void measure(const char *name, double (*run)(void))
{
    double ns[RUNS];
    for (unsigned i = 0; i < runs; i++)
        ns[i] = run();
    qsort(ns, runs, sizeof ns[0], by_size);
    const double middle = ns[runs / 2], simulated = (double)pmc_now(&unit) / (double)SECOND;
    printf("{\"bench\":\"pmc_%s\",\"axes\":2,\"pulses\":%" PRIu64 ",\"ns_per_pulse\":%.2f,\"simulated_s_per_s\":%.0f}\n", name,
           pulses, middle / (double)pulses, simulated * 1e9 / middle);
}

int main(int argc, char **argv)
{
    static const struct {
        const char *name;
        double (*run)(void);
    } works[] = {{"constant", run_constant}, {"ramp", run_ramp}, {"top", run_top}};
    int first = 1;
    if (argc > 1 && (strcmp(argv[1], "--quick") == 0 || strcmp(argv[1], "--once") == 0)) {
        quick = argv[1][2] == 'q';
        runs = 1;
        first++;
    }
    for (unsigned i = 0; i < sizeof works / sizeof works[0]; i++) {
        bool wanted = first == argc;
        for (int j = first; j < argc; j++)
            wanted = wanted || strcmp(argv[j], works[i].name) == 0;
        if (wanted)
            measure(works[i].name, works[i].run);
    }
    return 0;
}
