/* SPDX-License-Identifier: MIT */
/* bench_programs [ROUNDS]: what the tools for programs cost: CPU time of a program of 700 commands and of 1000 programs of 60,
 * and of what an editor asks for when a character is typed into the large one. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "lsp/lsp.h"
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

/* ---- An editor ------------------------------------------------------------------------------------------------------------ */

static struct lsp_server server;
static FILE *nowhere;

static void send(json_t *message)
{
    char *text = json_dumps(message, 0);
    lsp_receive(&server, text, strlen(text));
    free(text);
    json_decref(message);
}

static void open_document(const struct program_source *source)
{
    static const struct session_options options;
    nowhere = fopen("/dev/null", "w");
    lsp_begin(&server, &options, nowhere);
    send(json_pack("{s:i, s:s, s:{}}", "id", 1, "method", "initialize", "params"));
    send(json_pack("{s:s, s:{s:{s:s, s:i, s:s%}}}", "method", "textDocument/didOpen", "params", "textDocument", "uri", "p",
                   "version", 1, "text", source->text, source->length));
    lsp_report_changes(&server);
}

static void edit(const char *text, int from, int to)
{
    const int line = 100;
    send(json_pack("{s:s, s:{s:{s:s, s:i}, s:[{s:{s:{s:i, s:i}, s:{s:i, s:i}}, s:s}]}}", "method", "textDocument/didChange",
                   "params", "textDocument", "uri", "p", "version", 2, "contentChanges", "range", "start", "line", line,
                   "character", from, "end", "line", line, "character", to, "text", text));
    lsp_report_changes(&server);
}

static void ask(const char *method)
{
    send(json_pack("{s:i, s:s, s:{s:{s:s}, s:{s:i, s:i}}}", "id", 2, "method", method, "params", "textDocument", "uri", "p",
                   "position", "line", 100, "character", 1));
}

/* A character and its diagnostics; it goes again, so two. */
static void type_two(const struct program_source *source)
{
    (void)source;
    edit("D", 0, 0);
    edit("", 0, 1);
}

/* The same with all that an editor asks for then. */
static void type_and_ask(const struct program_source *source)
{
    static const char *const methods[] = {"textDocument/completion", "textDocument/codeLens", "textDocument/documentSymbol",
                                          "textDocument/documentHighlight", "textDocument/hover"};
    (void)source;
    edit("D", 0, 0);
    for (size_t i = 0; i < sizeof methods / sizeof methods[0]; i++)
        ask(methods[i]);
    edit("", 0, 1);
}

int main(int argc, char **argv)
{
    static char large[32768], small[4096];
    const unsigned rounds = argc > 1 ? (unsigned)strtoul(argv[1], NULL, 10) : 5;
    const struct program_source full = {"full.rks", large, write_program(large, sizeof large, 700), 1};
    static const char loops[] = "L255 L255 L255 F3 R E E E";
    const struct program_source endless = {"endless.rks", loops, sizeof loops - 1, 1};
    const struct program_source few = {"few.rks", small, write_program(small, sizeof small, 60), 1};
    measure("check, 700 commands", check, &full, 1, rounds);
    measure("fmt, 700 commands", format, &full, 1, rounds);
    measure("explain, 700 commands", explain, &full, 1, rounds);
    measure("estimate, 700 commands", estimate, &full, 1, rounds);
    open_document(&full);
    measure("lsp, 2 characters, 700 commands", type_two, &full, 1, rounds);
    measure("lsp, 2 characters and 5 requests, 700 commands", type_and_ask, &full, 1, rounds);
    lsp_end(&server);
    open_document(&endless);
    measure("lsp, the same, a program too long for an estimate", type_and_ask, &endless, 1, rounds);
    lsp_end(&server);
    fclose(nowhere);
    measure("check, 1000 programs of 60 commands", check, &few, 1000, rounds);
    measure("fmt, 1000 programs of 60 commands", format, &few, 1000, rounds);
    return 0;
}
