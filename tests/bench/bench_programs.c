/* SPDX-License-Identifier: MIT */
/* bench_programs [ROUNDS]: what the tools for programs cost: CPU time of a program of 700 commands and of 1000 programs of 60. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "program_tools/program_tools.h"

static uint32_t state = 1;

static uint32_t draw(uint32_t below)
{
    state = state * 1664525u + 1013904223u;
    return (state >> 8) % below;
}

/* Motions, loops, jumps, calls, compound motions: about `count` commands. Returns the length. */
static size_t write_program(char *text, size_t size, unsigned count)
{
    unsigned label = 1;
    size_t at = (size_t)snprintf(text, size, "\\C100 S100\n");
    for (unsigned commands = 2; commands + 30 < count;) {
        switch (draw(6)) {
        case 0:
            at += (size_t)snprintf(text + at, size - at, "V%u A%u F%u R\n", 500 + draw(9000), 500 + draw(50000), 10 + draw(9000));
            commands += 4;
            break;
        case 1:
            at += (size_t)snprintf(text + at, size - at, "L3 F%u R W10 E\n", 10 + draw(9000));
            commands += 5;
            break;
        case 2:
            at += (size_t)snprintf(text + at, size - at, "I01H40 T01 W5 C01\n");
            commands += 4;
            break;
        case 3:
            at += (size_t)snprintf(text + at, size - at, "'%u\n", 41 + draw(3));
            commands++;
            break;
        case 4:
            at += (size_t)snprintf(text + at, size - at, "M05 F500 Y V2000 Y F500 Y V2000 Y R\n");
            commands += 10;
            break;
        default:
            at += label < 40 ? (size_t)snprintf(text + at, size - at, "@%u\n", label++)
                             : (size_t)snprintf(text + at, size - at, "D\n");
            commands++;
            break;
        }
    }
    at += (size_t)snprintf(text + at, size - at, "J40 @41 B100 R . @42 B100 R . @43 F7 R . @40 W1\n");
    return at;
}

static double cpu_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void check(const struct program_source *source)
{
    static const struct check_options options;
    struct diagnostics found;
    check_programs(source, 1, &options, &found);
    diagnostics_free(&found);
}

static void format(const struct program_source *source)
{
    char *text;
    size_t length;
    format_program(source, &text, &length);
    free(text);
}

static void explain(const struct program_source *source)
{
    struct explanations all;
    explain_programs(source, 1, EXPLAIN_ENGLISH, &all);
    explain_free(&all);
}

static void estimate(const struct program_source *source)
{
    static const struct estimate_options options;
    struct estimate found;
    estimate_programs(source, 1, &options, &found);
    estimate_free(&found);
}

/* The least CPU time of all rounds. */
static void measure(const char *name, void (*tool)(const struct program_source *), const struct program_source *source,
                    unsigned times, unsigned rounds)
{
    double least = 1e9;
    for (unsigned round = 0; round < rounds; round++) {
        const double begin = cpu_seconds();
        for (unsigned i = 0; i < times; i++)
            tool(source);
        const double taken = cpu_seconds() - begin;
        least = taken < least ? taken : least;
    }
    printf("{\"what\": \"%s\", \"bytes\": %zu, \"times\": %u, \"ms\": %.3f}\n", name, source->length, times, 1e3 * least);
}

int main(int argc, char **argv)
{
    static char large[32768], small[4096];
    const unsigned rounds = argc > 1 ? (unsigned)strtoul(argv[1], NULL, 10) : 5;
    const struct program_source full = {"full.rks", large, write_program(large, sizeof large, 700), 1};
    const struct program_source few = {"few.rks", small, write_program(small, sizeof small, 60), 1};
    measure("check, 700 commands", check, &full, 1, rounds);
    measure("fmt, 700 commands", format, &full, 1, rounds);
    measure("explain, 700 commands", explain, &full, 1, rounds);
    measure("estimate, 700 commands", estimate, &full, 1, rounds);
    measure("check, 1000 programs of 60 commands", check, &few, 1000, rounds);
    measure("fmt, 1000 programs of 60 commands", format, &few, 1000, rounds);
    return 0;
}
