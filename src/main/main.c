/* SPDX-License-Identifier: MIT */
/* rkm04: the virtual RKM04. This file chooses the sub-command. */
#include <argp.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

#include <rkm04/limits.h>

#include "lsp/lsp.h"
#include "options/options.h"
#include "program_tools/program_tools.h"
#include "run/run.h"
#include "serve/serve.h"

#define NAMES "serve, exec, check, fmt, explain, estimate, lsp, test, replay, plot, devices or signals"

/* The C library looks for it: it has to be visible whatever the build hides. */
__attribute__((visibility("default"))) const char *argp_program_version = "rkm04 " RKM04_VERSION;

static const char help[] =
    "Usage: rkm04 serve [OPTION...]\n"
    "  or:  rkm04 exec [OPTION...] [M=]FILE...\n"
    "  or:  rkm04 check [OPTION...] [M=]FILE...\n"
    "  or:  rkm04 fmt [OPTION...] FILE...\n"
    "  or:  rkm04 explain [OPTION...] [M=]FILE...\n"
    "  or:  rkm04 estimate [OPTION...] [M=]FILE...\n"
    "  or:  rkm04 lsp [OPTION...]\n"
    "  or:  rkm04 test [OPTION...] SCENARIO...\n"
    "  or:  rkm04 replay [OPTION...] RECORDING\n"
    "  or:  rkm04 plot [OPTION...] [M=]FILE...\n"
    "  or:  rkm04 devices [--json]\n"
    "  or:  rkm04 signals [--json]\n"
    "A virtual RKM04, the unit for four stepper motors on RS485.\n"
    "\n"
    "  serve      units on a bus (pty, serial device or TCP), in real time\n"
    "  exec       run programs in virtual time, as fast as the machine can\n"
    "  check      report errors and probable mistakes in programs\n"
    "  fmt        format programs\n"
    "  explain    describe in words what programs do\n"
    "  estimate   calculate how long programs take, how far and how fast they move\n"
    "  lsp        serve editors: errors, labels, completion while you type\n"
    "  test       run scenarios in virtual time and report which pass\n"
    "  replay     repeat a recording of `serve' or `test' and compare\n"
    "  plot       draw speed and position over time\n"
    "  devices    list the devices that serve and scenarios know\n"
    "  signals    list the cells between CNC system and PLC program of a CNC872\n"
    "\n"
    "      --help      print this help; `rkm04 COMMAND --help' describes a command\n"
    "      --version   print the program's version\n"
    "\n"
    "Examples:\n"
    "  rkm04 serve --node 3 --flash unit3.flash --tcp 4001\n"
    "  rkm04 serve --node 1-16 --tcp 4001\n"
    "  rkm04 exec --trace pulses.vcd program.rks\n"
    "  rkm04 check --werror program.rks\n"
    "  rkm04 test --junit report.xml homing.yaml\n"
    "  rkm04 replay --trace pulses.vcd session.record\n"
    "  rkm04 plot -o drill.svg drill.rks\n"
    "\n"
    "Exit status: 0 success, 1 failure at run time, 2 usage, 3 a scenario has\n"
    "failed, 4 less than --min-coverage of serve, 124 --until of exec reached with a\n"
    "motor still running, or a program that never ends.\n";

static const struct {
    const char *name, *full_name;
    int (*run)(int argc, char **argv);
} subcommands[] = {
    {"serve", "rkm04 serve", serve_main},
    {"exec", "rkm04 exec", exec_main},
    {"check", "rkm04 check", check_main},
    {"fmt", "rkm04 fmt", fmt_main},
    {"explain", "rkm04 explain", explain_main},
    {"estimate", "rkm04 estimate", estimate_main},
    {"lsp", "rkm04 lsp", lsp_main},
    {"test", "rkm04 test", test_main},
    {"replay", "rkm04 replay", replay_main},
    {"plot", "rkm04 plot", plot_main},
    {"devices", "rkm04 devices", devices_main},
    {"signals", "rkm04 signals", signals_main},
};

int main(int argc, char **argv)
{
    process_begin(argv);
    signal(SIGXFSZ, SIG_IGN); /* writing says so, too */
    argp_err_exit_status = STATUS_USAGE;
    if (argc < 2) {
        fputs("rkm04: no sub-command: expected " NAMES "; `rkm04 --help' tells more\n", stderr);
        return STATUS_USAGE;
    }
    static char option_help[] = "--help";
    if (strcmp(argv[1], "help") == 0 && argc > 2) {
        argv[1] = argv[2];
        argv[2] = option_help;
    }
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-?") == 0 || strcmp(argv[1], "help") == 0) {
        fputs(help, stdout);
        return arguments_printed();
    }
    if (strcmp(argv[1], "--version") == 0 || strcmp(argv[1], "-V") == 0) {
        puts(argp_program_version);
        return arguments_printed();
    }
    for (size_t i = 0; i < sizeof subcommands / sizeof subcommands[0]; i++) {
        if (strcmp(argv[1], subcommands[i].name) == 0) {
            char name[32];
            snprintf(name, sizeof name, "%s", subcommands[i].full_name);
            argv[1] = name;
            return subcommands[i].run(argc - 1, argv + 1);
        }
    }
    fprintf(stderr, "rkm04: unknown sub-command `%s': expected " NAMES " (`rkm04 --help' tells more)%s\n", argv[1],
            nearest_hint(argv[1], NAMES ", --help, --version"));
    return STATUS_USAGE;
}
