/* rkmctl: the client. Sends one request to a unit, real or virtual, and shows the answer. This file is its command line. */
#include <argp.h>
#include <err.h>
#include <errno.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <rkm04/limits.h>

#include "client_answer.h"
#include "client_link.h"
#include "client_port.h"
#include "client_send.h"

#define TIMEOUT_MS 1000
#define TIMEOUT_MS_MAX 3600000
#define MESSAGE_MAX_LOWEST 64

const char *argp_program_version = "rkmctl " RKM04_VERSION;

/* ---- Sub-commands ------------------------------------------------------------------------------------------------- */

enum operand { NO_OPERAND, TEXT_OPERAND, FILE_OPERAND, HEX_OPERAND };
enum motors { NO_MOTOR, ANY_MOTOR, ONE_MOTOR };

static const struct subcommand {
    const char *name;
    enum operand operand;
    enum motors motors;
    uint8_t number; /* of the message, for those without operand */
    enum exit_status (*show)(const struct client_answer *answer);
} subcommands[] = {
    {"version", NO_OPERAND, NO_MOTOR, 1, client_show_version},
    {"set", TEXT_OPERAND, ANY_MOTOR, 2, NULL},
    {"send", FILE_OPERAND, ANY_MOTOR, 2, NULL},
    {"store", NO_OPERAND, ANY_MOTOR, 3, client_show_store},
    {"position", NO_OPERAND, ANY_MOTOR, 4, client_show_position},
    {"command", NO_OPERAND, ONE_MOTOR, 5, client_show_command},
    {"table", NO_OPERAND, ONE_MOTOR, 6, client_show_table},
    {"progress", NO_OPERAND, ONE_MOTOR, 7, client_show_progress},
    {"raw", HEX_OPERAND, NO_MOTOR, 0, client_show_raw},
};

#define SUBCOMMAND_LIST "version, set, send, store, position, command, table, progress or raw"

struct options {
    const char *port;
    const struct rkm04_framing *framing;
    unsigned node, motor, timeout_ms, message_max;
    bool json;
    const struct subcommand *subcommand;
    const char *operand; /* TEXT or FILE; NULL: not given yet */
    uint8_t raw[CLIENT_MESSAGE_MAX];
    size_t raw_length;
};

/* ---- Command line ------------------------------------------------------------------------------------------------- */

enum { KEY_FRAMING = 0x100, KEY_TIMEOUT, KEY_MESSAGE_MAX };

static const struct argp_option option_table[] = {
    {"port", 'p', "PORT", 0, "Serial device, pseudo terminal, or tcp:HOST:PORT", 0},
    {"node", 'n', "NODE", 0, "Address of the unit, 1 to 16; 0: all units, which do not answer (default 1)", 0},
    {"motor", 'm', "MOTOR", 0, "Motor 1 to 4; 0: all four (default 1)", 0},
    {"framing", KEY_FRAMING, "NAME", 0, "hdlc or plain, as the unit has it (default hdlc)", 0},
    {"timeout", KEY_TIMEOUT, "MS", 0, "How long to wait for an answer, 1 to 3600000 ms (default 1000)", 0},
    {"message-max", KEY_MESSAGE_MAX, "BYTES", 0, "Longest message the unit takes, 64 to 9216 (default 9216)", 0},
    {"json", 'j', NULL, 0, "Print the answer as JSON", 0},
    {0},
};

static const char arguments[] = "version|store|position|command|table|progress\nset TEXT\nsend FILE\nraw HEX";

static const char doc[] =
    "Send one request to an RKM04, real or virtual, and show the answer."
    "\v"
    "Commands:\n"
    "  version      the unit's version text\n"
    "  set TEXT     send a program text in one message; it begins to run\n"
    "  send FILE    check and send a program file, - is standard input\n"
    "  store        write the program in memory to flash\n"
    "  position     position counter; with -m 0 of all motors\n"
    "  command      the program in memory\n"
    "  table        break points of the present motion: (step;speed)\n"
    "  progress     steps done in the present motion; place of the present command\n"
    "  raw HEX      send these bytes as a message, show those of the answer\n"
    "\n"
    "Examples:\n"
    "  rkmctl -p /dev/ttyUSB0 version\n"
    "  rkmctl -p $XDG_RUNTIME_DIR/rkm04/bus0 set '\\ C100 S100 V1000 A2000 F5000 R'\n"
    "  rkmctl -p tcp:localhost:4001 -n 3 -m 2 send drill.rks\n"
    "  rkmctl -p /dev/ttyUSB0 -m 0 --json position\n"
    "  rkmctl -p /dev/ttyUSB0 raw 04 31\n"
    "\n"
    "Exit status: 0 well; 1 failure (the text was refused, the flash not written, the port cannot be used); 2 wrong usage; "
    "3 no answer in time.";

/* A decimal number low..high; anything else is a usage error. */
static unsigned take_number(const struct argp_state *state, const char *what, const char *text, unsigned low, unsigned high)
{
    char *end;
    errno = 0;
    unsigned long number = strtoul(text, &end, 10);
    if (text[strspn(text, "0123456789")] != '\0' || end == text || errno != 0 || number < low || number > high)
        argp_error(state, "%s: expected a number %u to %u, found '%s'", what, low, high, text);
    return (unsigned)number;
}

static const struct rkm04_framing *take_framing(const struct argp_state *state, const char *name)
{
    const struct rkm04_framing *framing = rkm04_framing_named(name);
    if (framing == NULL)
        argp_error(state, "--framing: expected hdlc or plain, found '%s'", name);
    return framing;
}

static const struct subcommand *take_subcommand(const struct argp_state *state, const char *name)
{
    for (size_t i = 0; i < sizeof subcommands / sizeof subcommands[0]; i++) {
        if (strcmp(subcommands[i].name, name) == 0)
            return &subcommands[i];
    }
    argp_error(state, "expected " SUBCOMMAND_LIST ", found '%s'", name);
    return NULL;
}

static int hex_digit(char c)
{
    return '0' <= c && c <= '9' ? c - '0' : 'a' <= c && c <= 'f' ? c - 'a' + 10 : 'A' <= c && c <= 'F' ? c - 'A' + 10 : -1;
}

/* Bytes of two digits each, blanks between them. */
static void take_hex(const struct argp_state *state, struct options *options, const char *text)
{
    for (; *text != '\0'; text++) {
        if (*text == ' ')
            continue;
        int high = hex_digit(text[0]), low = high >= 0 ? hex_digit(text[1]) : -1;
        if (low < 0)
            argp_error(state, "raw: expected bytes of two hexadecimal digits, like 04 31, found '%s'", text);
        if (options->raw_length == sizeof options->raw)
            argp_error(state, "raw: a message has up to %zu bytes", sizeof options->raw);
        options->raw[options->raw_length++] = (uint8_t)(high << 4 | low);
        text++;
    }
}

static void take_argument(const struct argp_state *state, struct options *options, const char *text)
{
    if (options->subcommand == NULL)
        options->subcommand = take_subcommand(state, text);
    else if (options->subcommand->operand == HEX_OPERAND)
        take_hex(state, options, text);
    else if (options->subcommand->operand == NO_OPERAND)
        argp_error(state, "%s takes no argument, found '%s'", options->subcommand->name, text);
    else if (options->operand != NULL)
        argp_error(state, "%s takes one argument: put it in quotes", options->subcommand->name);
    else
        options->operand = text;
}

static void check(const struct argp_state *state, const struct options *options)
{
    static const char *const operands[] = {[TEXT_OPERAND] = "a TEXT", [FILE_OPERAND] = "a FILE", [HEX_OPERAND] = "HEX bytes"};
    const struct subcommand *subcommand = options->subcommand;
    if (subcommand == NULL)
        argp_error(state, "no command: expected " SUBCOMMAND_LIST);
    bool missing = subcommand->operand == HEX_OPERAND ? options->raw_length == 0 : options->operand == NULL;
    if (subcommand->operand != NO_OPERAND && missing)
        argp_error(state, "%s needs %s", subcommand->name, operands[subcommand->operand]);
    if (options->port == NULL)
        argp_error(state, "no port: expected -p PORT, a serial device, a pseudo terminal or tcp:HOST:PORT");
    if (!client_port_valid(options->port))
        argp_error(state, "--port: expected tcp:HOST:PORT, like tcp:localhost:4001, found '%s'", options->port);
    if (subcommand->motors == ONE_MOTOR && options->motor == 0)
        argp_error(state, "%s can be asked of one motor only: -m 1 to 4", subcommand->name);
}

static error_t parse_option(int key, char *text, struct argp_state *state)
{
    struct options *options = state->input;
    switch (key) {
    case 'p':
        options->port = text;
        return 0;
    case 'n':
        options->node = take_number(state, "--node", text, 0, RKM04_NODE_MAX);
        return 0;
    case 'm':
        options->motor = take_number(state, "--motor", text, 0, RKM04_MOTORS);
        return 0;
    case KEY_FRAMING:
        options->framing = take_framing(state, text);
        return 0;
    case KEY_TIMEOUT:
        options->timeout_ms = take_number(state, "--timeout", text, 1, TIMEOUT_MS_MAX);
        return 0;
    case KEY_MESSAGE_MAX:
        options->message_max = take_number(state, "--message-max", text, MESSAGE_MAX_LOWEST, CLIENT_MESSAGE_MAX);
        return 0;
    case 'j':
        options->json = true;
        return 0;
    case ARGP_KEY_ARG:
        take_argument(state, options, text);
        return 0;
    case ARGP_KEY_END:
        check(state, options);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

/* ---- Work --------------------------------------------------------------------------------------------------------- */

static enum exit_status show(const struct options *options, const struct client *client, char motor)
{
    struct client_answer answer = {.bytes = client->answer, .length = client->length, .motor = motor, .json = options->json};
    const struct subcommand *subcommand = options->subcommand;
    if (client->answer[0] == 255 && subcommand->operand != HEX_OPERAND) {
        warnx("the unit does not know message %u (%s)", subcommand->number, subcommand->name);
        return STATUS_FAILURE;
    }
    return subcommand->show(&answer);
}

static enum exit_status ask(const struct options *options, struct client *client, char motor)
{
    const struct subcommand *subcommand = options->subcommand;
    uint8_t question[] = {subcommand->number, (uint8_t)motor};
    bool raw = subcommand->operand == HEX_OPERAND;
    size_t length = raw ? options->raw_length : subcommand->motors == NO_MOTOR ? 1 : 2;
    switch (client_exchange(client, raw ? options->raw : question, length)) {
    case CLIENT_ANSWERED:
        return show(options, client, motor);
    case CLIENT_SENT:
        if (subcommand->show != client_show_store && !raw)
            warnx("note: no unit answers what is sent to all of them");
        return options->json ? client_print_json(json_pack("{s:b}", "broadcast", 1)) : STATUS_WELL;
    case CLIENT_SILENT:
        return STATUS_NO_ANSWER;
    default:
        return STATUS_FAILURE;
    }
}

static enum exit_status run(const struct options *options, struct client *client)
{
    char motor = (char)('0' + options->motor);
    struct client_send sender = {.client = client, .motor = motor, .message_max = options->message_max, .json = options->json};
    switch (options->subcommand->operand) {
    case TEXT_OPERAND:
        return client_send_text(&sender, options->operand);
    case FILE_OPERAND:
        return client_send_file(&sender, options->operand);
    default:
        return ask(options, client, motor);
    }
}

int main(int argc, char **argv)
{
    static const struct argp argp = {.options = option_table, .parser = parse_option, .args_doc = arguments, .doc = doc};
    static struct client client; /* its buffers are large */
    static struct options options = {
        .framing = &rkm04_hdlc, .node = 1, .motor = 1, .timeout_ms = TIMEOUT_MS, .message_max = CLIENT_MESSAGE_MAX};
    argp_err_exit_status = STATUS_USAGE;
    argp_parse(&argp, argc, argv, 0, NULL, &options);
    signal(SIGPIPE, SIG_IGN); /* writing says so, too */

    client.port = options.port;
    client.framing = options.framing;
    client.node = (uint8_t)options.node;
    client.timeout_ms = options.timeout_ms;
    client.fd = client_port_open(options.port, options.timeout_ms);
    if (client.fd < 0)
        return STATUS_FAILURE;
    enum exit_status status = run(&options, &client);
    close(client.fd);
    if (fflush(stdout) != 0 || ferror(stdout)) {
        warn("standard output");
        return STATUS_FAILURE;
    }
    return (int)status;
}
