/* SPDX-License-Identifier: MIT */
/* rkmctl: the client. Sends one request to a unit, real or virtual, and shows the answer; or asks the emulator itself, on its
 * control socket, what no unit can be asked. This file is its command line. */
#include <argp.h>
#include <err.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <rkm04/limits.h>

#include "client/client.h"
#include "options/options.h"

#define TIMEOUT_MS 1000
#define TIMEOUT_MS_MAX 3600000
#define MESSAGE_MAX_LOWEST 64
#define LINE_NUMBER_MAX 255

/* The C library looks for it: it has to be visible whatever the build hides. */
__attribute__((visibility("default"))) const char *argp_program_version = "rkmctl " RKM04_VERSION;

struct options {
    struct client_request request;
    struct client_job job;
    const char *face;      /* of a PMC; NULL: not given */
    unsigned baud;         /* of its line; 0: not given */
    const char *node;      /* as it was given; NULL: not given */
    bool timed, json;
    const char *file;      /* of the shell's commands; NULL: none */
    const char *command;   /* NULL: none */
    const char **words;    /* after it */
    size_t count;
};

enum {
    KEY_FRAMING = 0x100, KEY_TIMEOUT, KEY_MESSAGE_MAX, KEY_LINE, KEY_LIMIT, KEY_ONCE, KEY_ADVANCE, KEY_ALLOW_OVERFLOW, KEY_FORCE,
    KEY_FACE, KEY_BAUD
};

static const struct argp_option option_table[] = {
    {NULL, 0, NULL, 0, "A unit on the bus:", 1},
    {"port", 'p', "PORT", 0,
     "Serial device, pseudo terminal, or tcp:HOST:PORT (default: RKM04_PORT of the environment, else the bus of your emulator, "
     "if only one is running)", 0},
    {"node", 'n', "NODE", 0,
     "Address of the unit, 1 to 16; 0: all units, which do not answer (default: RKM04_NODE of the environment, else 1)", 0},
    {"motor", 'm', "MOTOR", 0, "Motor 1 to 4; 0: all four (default 1)", 0},
    {"framing", KEY_FRAMING, "NAME", 0, "Framing of the unit: hdlc or plain (default hdlc)", 0},
    {"face", KEY_FACE, "NAME", 0, "pmc: what the unit speaks, ascii (default) or modbus", 0},
    {"baud", KEY_BAUD, "RATE", 0, "pmc: speed of a serial line, 9600 (default), 19200, 38400, 57600 or 115200", 0},
    {"message-max", KEY_MESSAGE_MAX, "BYTES", 0, "Longest message that the unit accepts, 64 to 9216 (default 9216)", 0},
    {"allow-overflow", KEY_ALLOW_OVERFLOW, NULL, 0,
     "set, send: a program that overflows the unit's memory is a warning, not a failure", 0},
    {NULL, 0, NULL, 0, "The emulator:", 2},
    {"control", 'c', "PATH", 0,
     "Its control socket or control file (default: RKM04_CONTROL of the environment, else that of the emulator of RKM04_PORT, "
     "else that of an `rkm04 serve' without --link, else that of your emulator, if only one is running)", 0},
    {"unit", 'u', "UNIT", 0, "The unit, as in 3; 3-2: the second unit with address 3; not needed if there is only one", 0},
    {"line", KEY_LINE, "N", 0, "The bus of an emulator with several, 0 to 255 (default 0)", 0},
    {"limit", KEY_LIMIT, "TIME", 0,
     "How long to wait, advance or listen, in virtual time, as in 10s, 250ms or a number of us", 0},
    {"advance", KEY_ADVANCE, NULL, 0, "wait: with a stepped clock advance time until the condition holds", 0},
    {"force", KEY_FORCE, NULL, 0, "snapshot, trace start: also overwrite a file of another kind", 0},
    {"once", KEY_ONCE, NULL, 0, "watch: print one picture as text", 0},
    {NULL, 0, NULL, 0, "Both:", 3},
    {"timeout", KEY_TIMEOUT, "MS", 0,
     "How long to wait for an answer, 1 to 3600000 ms (default: RKM04_TIMEOUT of the environment, else 1000; emulator: 10000; no "
     "limit for wait, advance and call)", 0},
    {"file", 'f', "FILE", 0, "shell: execute the commands of FILE (- is standard input) and end at the first that fails", 0},
    {"json", 'j', NULL, 0, "Print the answer as JSON", 0},
    {0},
};

static const char arguments[] =
    "version|store|position|command|table|progress\nset TEXT\nsend FILE\nraw HEX\n"
    "pmc COMMAND [...]\nstate|watch|reset|shutdown\ndi [N=LEVEL...]\nwait CONDITION\nadvance TIME|CONDITION\nevents [KIND...]\n"
    "snapshot|restore NAME|file=PATH\npower on|off\nswitch NODE [reset]\nclock [CLOCK]\nfault [inject KIND|clear] [...]\n"
    "plant [set FILE|none|motor=N ...]\n"
    "cib status|command|di|do|pwm|config [...]\ncnc get|set|cells|start|stop|jog|home|load... [...]\n"
    "trace start FILE\ntrace stop [NUMBER]\ncall METHOD [...]\n"
    "shell\nwindow [OPTION...]";

static const char doc[] =
    "Send one request to an RKM04, real or virtual, and show the answer; or inspect and control an emulator, `rkm04 serve': its "
    "units, inputs, time, faults and plant."
    "\v"
    "Commands to a unit, with --port:\n"
    "  version      the unit's version text\n"
    "  set TEXT     send a program text in one message; the unit executes it\n"
    "  send FILE    check and send a program file, - is standard input\n"
    "  store        write the program in memory to flash\n"
    "  position     position counter; with -m 0 of all motors\n"
    "  command      the program in memory\n"
    "  table        break points of the present motion: (step;speed)\n"
    "  progress     steps done in the present motion; place of the present command\n"
    "  raw HEX      send these bytes as a message, show those of the answer\n"
    "\n"
    "Commands to an emulator, with --control:\n"
    "  state        everything about the unit, or all units\n"
    "  watch        its front panel, live\n"
    "  di           the inputs; with 3=1 5=0 set them\n"
    "  wait         wait until a condition holds; status 3 if not within --limit\n"
    "  advance      advance a stepped clock by a time, or until a condition holds\n"
    "  events       print events, a line each; KIND..., motor=N, count=N\n"
    "  snapshot     save the state of everything, under a NAME or in a file\n"
    "  restore      return to a snapshot\n"
    "  reset        power off and on; flash is kept\n"
    "  power        the power switch\n"
    "  switch       the address switch S1\n"
    "  fault        list injected faults; inject KIND NAME=VALUE...; clear [ID]\n"
    "  plant        the simulated mechanics; set FILE; none; motor=N jammed=true ...\n"
    "  cib          a CIB module: status, command, di, do, pwm, config\n"
    "  cnc          a CNC872: cells, keys of its panel, NC program\n"
    "  clock        show or set it: real, xN, max, stepped\n"
    "  trace        start FILE (" TRACE_ENDINGS ", " WIRE_ENDINGS "), stop [NUMBER]\n"
    "  call         any other METHOD, parameters as JSON or NAME=VALUE...\n"
    "  shutdown     end the emulator\n"
    "\n"
    "Both:\n"
    "  pmc          a PMC-1HS or PMC-2HS: motions, program, parameters\n"
    "  shell        type commands and program text, or take them from -f FILE\n"
    "  window       the service program in a browser: `rkmctl window --help'\n"
    "\n"
    "Conditions: m1.position>=5000, m1.true<0, m1.steps>9, m1.state=idle, m1.idle, m1.led=blink, m1.fault!=none, idle, "
    "powered=1, do3=1, di08=0, var80=1, message=4, master.message, unit.message, dropped, t>=2.5s; prefix u3.: unit 3. "
    "Several conditions must all hold; with `or' between them, one is enough.\n"
    "\n"
    "Examples:\n"
    "  rkmctl -p " CLIENT_PORT_EXAMPLE " version\n"
    "  rkmctl -p tcp:localhost:4001 set \"\\ C100 S100 V1000 A2000 F5000 R\"\n"
    "  rkmctl -p tcp:localhost:4001 -n 3 -m 2 send drill.rks\n"
    "  rkmctl -p " CLIENT_PORT_EXAMPLE " -m 0 --json position\n"
    "  rkmctl -p " CLIENT_PORT_EXAMPLE " raw 04 31\n"
    "  rkmctl watch\n"
    "  rkmctl di 3=1 && rkmctl wait \"m1.position>=5000\" --limit 10s\n"
    "  rkmctl -c bus.control -u 3 fault inject drop direction=to_master count=1\n"
    "\n"
    "`rkmctl COMMAND --help' describes a command.\n"
    "\n"
    "Exit status: 0 success; 1 failure (refused, memory overflowed, flash not written, port or emulator cannot be reached); 2 "
    "wrong usage; 3 no answer, the condition did not hold, or too few events, in time.";

/* A decimal number low..high; anything else is a usage error. */
static unsigned read_number(const char *what, const char *text, unsigned low, unsigned high)
{
    unsigned number = 0;
    if (!client_usage_number(what, text, low, high, &number))
        exit(STATUS_USAGE);
    return number;
}

static const struct rkm04_framing *read_framing(const struct argp_state *state, const char *name)
{
    const struct rkm04_framing *framing = rkm04_framing_named(name);
    if (framing == NULL)
        argp_error(state, "--framing: expected hdlc or plain, found '%s'", name);
    return framing;
}

/* An option of pmc. */
static error_t parse_pmc_option(int key, char *text, struct argp_state *state)
{
    struct options *options = state->input;
    if (key == KEY_BAUD) {
        options->baud = read_number("--baud", text, 9600, 115200);
        return 0;
    }
    if (key != KEY_FACE)
        return ARGP_ERR_UNKNOWN;
    if (strcmp(text, "ascii") != 0 && strcmp(text, "modbus") != 0)
        argp_error(state, "--face: expected ascii or modbus, found '%s'", text);
    options->face = text;
    return 0;
}

static error_t parse_option(int key, char *text, struct argp_state *state)
{
    struct options *options = state->input;
    switch (key) {
    case 'p':
        options->request.port = text;
        return 0;
    case 'n':
        options->node = text;
        options->request.node = read_number("--node", text, 0, RKM04_NODE_MAX);
        return 0;
    case 'm':
        options->request.motor = read_number("--motor", text, 0, RKM04_MOTORS);
        return 0;
    case KEY_FRAMING:
        options->request.framing = read_framing(state, text);
        return 0;
    case KEY_MESSAGE_MAX:
        options->request.message_max = read_number("--message-max", text, MESSAGE_MAX_LOWEST, CLIENT_MESSAGE_MAX);
        return 0;
    case 'c':
        options->job.path = text;
        return 0;
    case 'u':
        options->job.unit = text;
        return 0;
    case KEY_LINE:
        options->job.line = (int)read_number("--line", text, 0, LINE_NUMBER_MAX);
        return 0;
    case KEY_LIMIT:
        options->job.limit = text;
        return 0;
    case KEY_ADVANCE:
        options->job.advance = true;
        return 0;
    case KEY_ALLOW_OVERFLOW:
        options->request.allow_overflow = true;
        return 0;
    case KEY_FORCE:
        options->job.force = true;
        return 0;
    case KEY_ONCE:
        options->job.once = true;
        return 0;
    case KEY_TIMEOUT:
        options->timed = true;
        options->request.timeout_ms = read_number("--timeout", text, 1, TIMEOUT_MS_MAX);
        return 0;
    case 'f': options->file = text; return 0;
    case 'j': options->json = true; return 0;
    case ARGP_KEY_ARG:
        if (options->command == NULL)
            options->command = text;
        else
            options->words[options->count++] = text;
        return 0;
    default:
        return parse_pmc_option(key, text, state);
    }
}

/* How long an answer of a unit on the line is waited for, in ms. */
static unsigned answer_time(const struct options *options)
{
    const char *usual = getenv("RKM04_TIMEOUT");
    return options->timed || usual == NULL || usual[0] == '\0' ? options->request.timeout_ms
                                                               : read_number("RKM04_TIMEOUT", usual, 1, TIMEOUT_MS_MAX);
}

/* A command to a unit on the line. */
static enum exit_status do_request(struct options *options)
{
    struct client_request *request = &options->request;
    const struct client_job *job = &options->job;
    if (job->path != NULL || job->unit != NULL || job->line >= 0 || job->limit != NULL || job->once || job->advance ||
        job->force)
        return client_usage("%s is sent to a unit on the bus: expected --port, --node and --motor", options->command);
    const char *node = getenv("RKM04_NODE");
    if (options->node == NULL && node != NULL && node[0] != '\0')
        request->node = read_number("RKM04_NODE", node, 0, RKM04_NODE_MAX);
    request->timeout_ms = answer_time(options);
    request->json = options->json;
    request->words = options->words;
    request->count = options->count;
    return client_request(request, options->command);
}

/* A command to the emulator. */
static enum exit_status do_job(struct options *options)
{
    struct client_job *job = &options->job;
    if (options->request.port != NULL)
        return client_usage("%s is sent to the emulator: expected --control instead of --port", options->command);
    if (options->request.allow_overflow)
        return client_usage("--allow-overflow is for set and send");
    if (job->unit == NULL)
        job->unit = options->node;
    job->json = options->json;
    job->timeout_ms = options->timed ? (int)options->request.timeout_ms : 0;
    job->words = options->words;
    job->count = options->count;
    return client_control(job, options->command);
}

/* A command to a PMC, on its line or in an emulator. */
static enum exit_status do_pmc(struct options *options)
{
    struct client_job *job = &options->job;
    if (job->limit != NULL || job->once || job->advance || job->force || options->request.allow_overflow)
        return client_usage("pmc: expected --port, --face, --node and --baud, or --control and --unit");
    job->timeout_ms = options->timed ? (int)options->request.timeout_ms : 0;
    const struct client_pmc pmc = {
        .port = options->request.port, .face = options->face, .job = job, .node = options->request.node, .baud = options->baud,
        .timeout_ms = answer_time(options), .json = options->json, .words = options->words, .count = options->count};
    return client_pmc(&pmc);
}

static int run_line(int argc, char **argv);

static enum exit_status do_shell(const struct options *options)
{
    const char *node = options->node != NULL ? options->node : getenv("RKM04_NODE");
    const struct client_request *request = &options->request;
    const struct client_job *job = &options->job;
    if (options->count > 0)
        return client_usage("shell takes no argument, found '%s'; a file of commands: -f FILE", options->words[0]);
    const struct client_shell shell = {
        .file = options->file, .port = request->port, .framing = request->framing->name, .message_max = request->message_max,
        .timeout_ms = options->timed ? request->timeout_ms : 0, .control = job->path, .unit = job->unit, .line = job->line,
        .face = options->face, .baud = options->baud, .json = options->json, .motor = request->motor, .has_node = node != NULL,
        .node = node != NULL ? read_number("--node", node, 0, RKM04_NODE_MAX) : 1, .run = run_line};
    return client_shell(&shell);
}

#define COMMAND_NAMES CLIENT_REQUEST_NAMES " for a unit; " CLIENT_CONTROL_NAMES " for an emulator; pmc, shell or window"

static enum exit_status run(struct options *options)
{
    if (options->command == NULL)
        return client_usage("no command: expected " COMMAND_NAMES);
    if (strcmp(options->command, "shell") == 0)
        return do_shell(options);
    if (options->file != NULL)
        return client_usage("-f is for shell");
    if (strcmp(options->command, "window") == 0)
        return client_usage("window is the first word: rkmctl window [OPTION...]");
    if (strcmp(options->command, "pmc") == 0)
        return do_pmc(options);
    if (options->face != NULL || options->baud != 0)
        return client_usage("--face and --baud are for pmc");
    if (client_request_has(options->command))
        return do_request(options);
    if (client_control_has(options->command))
        return do_job(options);
    return client_usage("expected " COMMAND_NAMES ", found '%s'%s", options->command,
                        nearest_hint(options->command, COMMAND_NAMES));
}

/* Do a command line, from its options to the exit status. */
static int run_line(int argc, char **argv)
{
    static const struct argp argp = {.options = option_table, .parser = parse_option, .args_doc = arguments, .doc = doc};
    struct options options = {
        .request = {.framing = &rkm04_hdlc, .node = 1, .motor = 1, .timeout_ms = TIMEOUT_MS, .message_max = CLIENT_MESSAGE_MAX},
        .job = {.line = -1},
    };
    options.words = calloc((size_t)argc + 1, sizeof *options.words);
    if (options.words == NULL)
        err(STATUS_FAILURE, "memory");
    if (client_help_wanted(argc, argv) && arguments_printed() == STATUS_SUCCESS) {
        free(options.words);
        return STATUS_SUCCESS;
    }
    arguments_parse(&argp, argc, argv, &options);
    enum exit_status status = run(&options);
    free(options.words);
    if (fflush(stdout) != 0 || ferror(stdout)) {
        warn("standard output");
        return STATUS_FAILURE;
    }
    return (int)status;
}

int main(int argc, char **argv)
{
    process_begin(argv);
    if (argc > 1 && strcmp(argv[1], "window") == 0)
        return (int)client_window(argv);
    argp_err_exit_status = STATUS_USAGE;
    signal(SIGPIPE, SIG_IGN); /* writing says so, too */
    static char option_help[] = "--help";
    if (argc > 1 && strcmp(argv[1], "help") == 0) { /* help [COMMAND] */
        char *asked[] = {argv[0], argc > 2 ? argv[2] : option_help, argc > 2 ? option_help : NULL, NULL};
        if (client_help_wanted(argc > 2 ? 3 : 2, asked))
            return arguments_printed();
        asked[2] = NULL; /* a word that is no command */
        return run_line(2, asked);
    }
    return run_line(argc, argv);
}
