#include "serve_options.h"

#include <argp.h>
#include <jansson.h>
#include <stdlib.h>
#include <string.h>

#include <rkm04/link.h>

#define LATENCY_MAX 2000 /* ms (C4) */
#define VERSION_TEXT_MAX 255
#define NODE_EXPECTED "a number from 1 to 16, as set with switch S1"

enum key {
    KEY_NODE = 'n',
    KEY_LINK = 'l',
    KEY_PORT = 'p',
    KEY_FRAMING = 256,
    KEY_FLASH,
    KEY_BAUD,
    KEY_CLOCK,
    KEY_VERSION_TEXT,
    KEY_LATENCY
};

static const struct argp_option table[] = {
    {NULL, 0, NULL, 0, "The unit:", 1},
    {"node", KEY_NODE, "N", 0, "Address of the unit (DNode), 1 to 16; default 1", 0},
    {"flash", KEY_FLASH, "FILE", 0,
     "Flash image; made if it is not there. Without it stored programs live as long as the emulator", 0},
    {"version-text", KEY_VERSION_TEXT, "TEXT", 0,
     "What the unit answers to Version, up to 255 characters; default " RKM04_VERSION_TEXT, 0},
    {"speed-change-latency", KEY_LATENCY, "MS", 0,
     "How long the unit takes to obey a V during a motion, 0 to 2000 ms; default 0", 0},
    {NULL, 0, NULL, 0, "The line:", 2},
    {"link", KEY_LINK, "PATH", 0,
     "Name of the symbolic link to the pty; default $XDG_RUNTIME_DIR/rkm04/bus0, else rkm04-UID/bus0 in the temporary "
     "directory", 0},
    {"port", KEY_PORT, "DEVICE", 0, "Use this serial device or pty instead of a pty of our own", 0},
    {"framing", KEY_FRAMING, "NAME", 0, "hdlc (default) or plain", 0},
    {"baud", KEY_BAUD, "RATE", 0, "19200 (default): each byte takes its 520.8 us, both ways; 0: bytes take no time", 0},
    {NULL, 0, NULL, 0, "Time:", 3},
    {"clock", KEY_CLOCK, "CLOCK", 0,
     "real (default); xN: N times as fast, 0.001 to 10000; max: as real, but what is due comes at once, bytes first, without "
     "waiting for its time", 0},
    {0},
};

static const char doc[] =
    "Serve one virtual RKM04 on a serial line until SIGINT or SIGTERM.\v"
    "When everything is ready one line appears on stdout: READY {\"pty\":...,\"link\":...,\"node\":...}. Logs go to stderr, "
    "with the unit's own time in seconds.\n"
    "\n"
    "Examples:\n"
    "  rkm04 serve\n"
    "  rkm04 serve --node 3 --flash unit3.flash --link ~/rkm04-3\n"
    "  rkm04 serve --port /dev/ttyUSB0 --framing plain\n"
    "  rkm04 serve --clock x20 --baud 0\n"
    "\n"
    "Exit status: 0 ended by a signal, 1 failure at run time, 2 usage.";

/* A whole number up to `high`, digits only. Returns -1 if it is none. */
static long read_number(const char *text, long high)
{
    long value = 0;
    if (!*text)
        return -1;
    for (; *text; text++) {
        if (*text < '0' || *text > '9')
            return -1;
        value = value * 10 + (*text - '0');
        if (value > high)
            return -1;
    }
    return value;
}

static void set_framing(struct serve_options *options, const char *text, struct argp_state *state)
{
    options->config.framing = rkm04_framing_named(text);
    if (options->config.framing)
        return;
    char names[128] = "";
    for (size_t i = 0; rkm04_framings[i]; i++) {
        if (i > 0)
            strncat(names, rkm04_framings[i + 1] ? ", " : " or ", sizeof names - strlen(names) - 1);
        strncat(names, rkm04_framings[i]->name, sizeof names - strlen(names) - 1);
    }
    argp_error(state, "--framing: `%s' is unknown: expected %s", text, names);
}

static void set_number(struct serve_options *options, int key, const char *text, struct argp_state *state)
{
    long value;
    switch (key) {
    case KEY_NODE:
        value = read_number(text, RKM04_NODE_MAX);
        if (value < 1)
            argp_error(state, "--node: `%s' is not a node: expected " NODE_EXPECTED, text);
        options->config.node = (uint8_t)value;
        break;
    case KEY_LATENCY:
        value = read_number(text, LATENCY_MAX);
        if (value < 0)
            argp_error(state, "--speed-change-latency: `%s' is wrong: expected a number of ms from 0 to %d", text, LATENCY_MAX);
        options->config.speed_change_latency = (uint16_t)value;
        break;
    default:
        value = read_number(text, 19200);
        if (value != 0 && value != 19200)
            argp_error(state, "--baud: `%s' is wrong: expected 19200, the rate of the unit, or 0 for no pacing", text);
        options->baud = (unsigned)value;
    }
}

/* A path, which has to fit the READY line. */
static const char *read_path(const char *name, const char *text, struct argp_state *state)
{
    json_t *string = json_string(text);
    if (!*text)
        argp_error(state, "--%s: expected a path, found nothing", name);
    if (!string)
        argp_error(state, "--%s: the path is not valid UTF-8, which the READY line needs", name);
    json_decref(string);
    return text;
}

static error_t read_option(int key, char *text, struct argp_state *state)
{
    struct serve_options *options = state->input;
    switch (key) {
    case KEY_NODE:
    case KEY_LATENCY:
    case KEY_BAUD:
        set_number(options, key, text, state);
        return 0;
    case KEY_FRAMING:
        set_framing(options, text, state);
        return 0;
    case KEY_LINK:
        options->link = read_path("link", text, state);
        return 0;
    case KEY_PORT:
        options->port = read_path("port", text, state);
        return 0;
    case KEY_FLASH:
        options->flash = read_path("flash", text, state);
        return 0;
    case KEY_CLOCK:
        options->clock_text = text;
        if (!virtual_clock_read(&options->clock, text))
            argp_error(state, "--clock: `%s' is wrong: expected " VIRTUAL_CLOCK_EXPECTED, text);
        return 0;
    case KEY_VERSION_TEXT:
        options->config.version_text = text;
        if (strlen(text) > VERSION_TEXT_MAX)
            argp_error(state, "--version-text: %zu characters: expected at most %d", strlen(text), VERSION_TEXT_MAX);
        return 0;
    case ARGP_KEY_ARG:
        argp_error(state, "`%s': expected options only", text);
        return 0;
    case ARGP_KEY_END:
        if (options->port && options->link)
            argp_error(state, "--link names the emulator's own pty: expected either --link or --port");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

void serve_options_read(struct serve_options *options, int argc, char **argv)
{
    static const struct argp argp = {.options = table, .parser = read_option, .doc = doc};
    *options = (struct serve_options){
        .config = {.node = 1, .framing = &rkm04_hdlc, .version_text = RKM04_VERSION_TEXT},
        .clock_text = "real",
        .baud = 19200,
    };
    virtual_clock_read(&options->clock, "real");
    argp_parse(&argp, argc, argv, 0, NULL, options);
}
