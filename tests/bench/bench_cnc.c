/* SPDX-License-Identifier: MIT */
/* bench_cnc.c: what a cycle of the CNC872's core costs. Prints one JSON object a line; every time is CPU time, the median of some
 * runs.
 *
 *     bench_cnc [--quick] [NAME]...
 *
 * one: one axis moves, no PLC program. sixteen: sixteen axes move. plc: they move, and a PLC program of 500 instructions runs. */
#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "cnc872/cnc872.h"

#define RUNS 7u
#define INSTRUCTIONS 500u
#define CYCLES_PER_SECOND 1000.0

static struct cnc cnc;
static struct cnc_config config;
static struct cnc_nc_program program;
static struct cnc_plc_program plc;
static struct cnc_nc_block blocks[4];
static int64_t values[64];
static uint64_t cycles = 200000;

static _Noreturn void fail(const char *what)
{
    fprintf(stderr, "bench_cnc: %s\n", what);
    exit(1);
}

static void report(void *context, const struct cnc_text_error *error)
{
    (void)context;
    fail(error->text);
}

static double now_ns(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

/* CONFIG.xml and NC program of some axes that move for longer than a run takes. */
static void set_axes(unsigned axes)
{
    char xml[2000] = "<ChannelConfig>", nc[400] = "G1 F1000";
    for (unsigned axis = 0; axis < axes; axis++) {
        const char *name = cnc_axis_names[axis];
        snprintf(xml + strlen(xml), sizeof xml - strlen(xml), "<Axis Name=\"%s\"/>", name);
        snprintf(nc + strlen(nc), sizeof nc - strlen(nc), axis < 3 ? " %s200000" : " A%s=200000", name);
    }
    strcat(xml, "</ChannelConfig>");
    program.blocks = blocks;
    program.block_room = sizeof blocks / sizeof blocks[0];
    program.values = values;
    program.value_room = sizeof values / sizeof values[0];
    if (!cnc_config_read(xml, strlen(xml), &config, report, NULL) ||
        !cnc_nc_read(nc, strlen(nc), &config, &program, report, NULL))
        fail("a text is refused");
}

/* A program of 500 instructions of all kinds, all of which are run in each cycle. */
static void set_plc(void)
{
    static const char *const group[] = {"LDR PO_OSXPI", "LA MPXPI", "WR A", "LOD DIFCIT_X[2]", "ABS DWRD", "AD N",
                                        "GE CNST.100", "FL1 1,B", "LOD POSITION_POS5_EX[1]", "STO Q"};
    static char text[20000];
    char *at = text + sprintf(text, "DATA\nA BIT 0\nB BIT 0\nN DD 7\nQ DQ 0\nDATA_END\nMODULE_MAIN\n");
    for (unsigned i = 0; i < INSTRUCTIONS - 1; i++)
        at += sprintf(at, "%s\n", group[i % (sizeof group / sizeof group[0])]);
    at += sprintf(at, "MODULE_MAIN_END\n");
    if (!cnc_translate_plc(text, (size_t)(at - text), &plc, report, NULL) || plc.length != INSTRUCTIONS)
        fail("a PLC program is refused");
}

static double run(bool with_plc)
{
    const struct cnc_setup setup = {.config = &config, .program = &program, .plc = with_plc ? &plc : NULL};
    cnc_begin(&cnc, &setup);
    if (cnc_start(&cnc) != CNC_OK)
        fail("the start is refused");
    const double from = now_ns();
    cnc_advance(&cnc, cycles * CNC_TICKS_PER_T);
    const double took = now_ns() - from;
    if (cnc.move.v == 0)
        fail("nothing moves");
    return took / (double)cycles;
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void measure(const char *name, unsigned axes, bool with_plc, unsigned runs)
{
    double ns[RUNS];
    set_axes(axes);
    set_plc();
    for (unsigned i = 0; i < runs; i++)
        ns[i] = run(with_plc);
    qsort(ns, runs, sizeof ns[0], by_size);
    printf("{\"bench\":\"cnc_%s\",\"axes\":%u,\"instructions\":%u,\"cycles\":%" PRIu64, name, axes,
           with_plc ? INSTRUCTIONS : 0, cycles);
    printf(",\"us_per_cycle\":%.3f,\"simulated_s_per_s\":%.0f}\n", ns[runs / 2] / 1000, 1e9 / (ns[runs / 2] * CYCLES_PER_SECOND));
}

int main(int argc, char **argv)
{
    static const struct {
        const char *name;
        unsigned axes;
        bool with_plc;
    } works[] = {{"one", 1, false}, {"sixteen", 16, false}, {"plc", 16, true}};
    const bool quick = argc > 1 && strcmp(argv[1], "--quick") == 0;
    if (quick)
        cycles = 2000;
    for (unsigned i = 0; i < sizeof works / sizeof works[0]; i++) {
        bool wanted = argc == 1 + quick;
        for (int j = 1 + quick; j < argc; j++)
            wanted = wanted || strcmp(argv[j], works[i].name) == 0;
        if (wanted)
            measure(works[i].name, works[i].axes, works[i].with_plc, quick ? 1 : RUNS);
    }
    return 0;
}
