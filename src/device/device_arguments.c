/* SPDX-License-Identifier: MIT */
/* The device on a command line: --device NAME, --device-option NAME=VALUE, and those options of kinds that have a name of their
 * own there. Which device it is may be said after its options, so all of them are read at the end. */
#include <argp.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "device.h"
#include "file/file.h"
#include "text/text.h"

#define ROWS_MAX 96u     /* of --help */
#define NAME_SIZE 96u    /* bytes of a name in --help */
#define FIRST_ROOM 65536u /* bytes for a file */
#define GROUP_UNITS 1
#define GROUP_BUS 2
#define GROUP_DEVICES 6  /* that of the first kind */

enum { KEY_DEVICE = 0x1000, KEY_OPTION, KEY_FIRST }; /* KEY_FIRST + n: row n of `switches` */

/* ---- The table -------------------------------------------------------------------------------------------------------- */

/* What argp gets: it keeps pointers. */
static struct {
    struct argp_option row[ROWS_MAX + 1u];
    const char *switches[ROWS_MAX]; /* name of the option with the key KEY_FIRST + its place */
    char name[ROWS_MAX][NAME_SIZE]; /* of rows that are no switches; of heads */
    unsigned rows, names;
    struct argp argp;
} help;

static void add_row(const char *name, int key, const char *argument, int flags, const char *text, int group)
{
    if (help.rows < ROWS_MAX)
        help.row[help.rows++] = (struct argp_option){name, key, argument, flags, text, group};
}

static const char *keep_name(const char *format, const char *first, const char *second)
{
    char *name = help.name[help.names < ROWS_MAX - 1u ? help.names++ : ROWS_MAX - 1u];
    snprintf(name, NAME_SIZE, format, first, second);
    return name;
}

static bool is_offered(const struct device_arguments *arguments, const struct device_option *option)
{
    return (option->flags & arguments->without) == 0 && (!arguments->own || strcmp(arguments->own, option->name) != 0);
}

static void add_switch(const struct device_option *option)
{
    for (unsigned at = 0; at < help.rows; at++)
        if (help.switches[at] && strcmp(help.switches[at], option->name) == 0)
            return; /* of two kinds: the first one explains it */
    help.switches[help.rows] = option->name;
    add_row(option->name, KEY_FIRST + (int)help.rows, option->argument, 0, option->help,
            option->flags & DEVICE_OPTION_BUS ? GROUP_BUS : GROUP_UNITS);
}

/* `group`: of its own options, so that they stand below their head. */
static void add_kind(const struct device_arguments *arguments, const struct device_kind *kind, int group)
{
    bool has_head = false;
    for (const struct device_option *option = kind->options; option && option->name; option++) {
        if (!is_offered(arguments, option))
            continue;
        if (option->flags & DEVICE_OPTION_SWITCH) {
            add_switch(option);
            continue;
        }
        if (!has_head)
            add_row(NULL, 0, NULL, 0, keep_name("Options of the device %s (%s):", kind->name, "--device-option NAME=VALUE"),
                    group);
        has_head = true;
        add_row(keep_name("%s=%s", option->name, option->argument), 0, NULL, OPTION_DOC | OPTION_NO_USAGE, option->help,
                group);
    }
}

static error_t parse(int key, char *text, struct argp_state *state);

const struct argp *device_arguments_argp(struct device_arguments *arguments)
{
    const struct device_kind *kind;
    help.rows = help.names = 0;
    memset(help.switches, 0, sizeof help.switches);
    add_row("device", KEY_DEVICE, "NAME", 0, "What the units are: one of those that `rkm04 devices' lists; default rkm04",
            GROUP_UNITS);
    add_row("device-option", KEY_OPTION, "NAME=VALUE", 0,
            "A setting of the device; may be given several times. `rkm04 devices --json' lists those of each device",
            GROUP_UNITS);
    for (unsigned at = 0; (kind = device_kind_at(at)); at++)
        add_kind(arguments, kind, GROUP_DEVICES + (int)at);
    help.row[help.rows] = (struct argp_option){0};
    help.argp = (struct argp){.options = help.row, .parser = parse};
    arguments->kind = device_kind_at(0);
    return &help.argp;
}

/* ---- Reading ---------------------------------------------------------------------------------------------------------- */

/* Read up to `most` bytes and one more; *text is to be freed. Returns an errno. */
static int read_up_to(FILE *file, size_t most, char **text, size_t *length)
{
    for (size_t room = FIRST_ROOM;; room *= 2u) {
        room = room < most + 2u ? room : most + 2u;
        char *grown = realloc(*text, room);
        if (!grown)
            return ENOMEM;
        *text = grown;
        *length += fread(*text + *length, 1, room - 1u - *length, file);
        if (ferror(file))
            return errno;
        if (*length < room - 1u || *length > most)
            return 0;
    }
}

/* Read a whole file. Returns a text to be freed, or NULL and the reason. */
static char *read_text(const char *path, size_t most, size_t *length, char why[DEVICE_ERROR_SIZE])
{
    FILE *file = fopen(path, "re");
    char *text = NULL;
    *length = 0;
    const int error = file ? read_up_to(file, most, &text, length) : errno;
    *why = '\0';
    if (error != 0)
        snprintf(why, DEVICE_ERROR_SIZE, "%s", strerror(error));
    else if (*length > most)
        snprintf(why, DEVICE_ERROR_SIZE, "it is longer than %zu MiB", most >> 20);
    else if (memchr(text, '\0', *length))
        snprintf(why, DEVICE_ERROR_SIZE, "expected text without the character 0");
    else if (!output_file_spare(path))
        snprintf(why, DEVICE_ERROR_SIZE, "%s", strerror(ENOMEM));
    else
        text[*length] = '\0';
    if (file)
        fclose(file);
    if (*why == '\0')
        return text;
    free(text);
    return NULL;
}

/* What file_guess() finds in the files of an option; NULL: nothing. */
static const char *expected_of(const char *option)
{
    return strcmp(option, "config") == 0 ? "a configuration" : strcmp(option, "plc") == 0 ? "a PLC program" : NULL;
}

static void read_file(struct device_arguments *arguments, unsigned at, const struct device_option *option,
                      const struct argp_state *state)
{
    size_t length;
    char why[DEVICE_ERROR_SIZE];
    const char *path = arguments->value[at];
    arguments->text[at] = read_text(path, device_option_file_max(option), &length, why);
    if (!arguments->text[at])
        argp_failure(state, 1, 0, "cannot read %s: %s", path, why);
    else if (!option->read_file(&arguments->config, path, arguments->text[at], length, stderr)) {
        file_guess_note(state->name, path, expected_of(option->name), arguments->text[at], length);
        exit(argp_err_exit_status);
    }
}

/* The options of a kind, for messages: "rate, program". */
static void list_options(const struct device_arguments *arguments, char list[DEVICE_ERROR_SIZE])
{
    size_t length = 0;
    list[0] = '\0';
    for (const struct device_option *option = arguments->kind->options; option && option->name; option++)
        if ((option->flags & arguments->without) == 0 && length < DEVICE_ERROR_SIZE)
            length += (size_t)snprintf(list + length, DEVICE_ERROR_SIZE - length, length > 0 ? ", %s" : "%s", option->name);
}

static void read_value(struct device_arguments *arguments, unsigned at, const struct argp_state *state)
{
    const char *name = arguments->name[at], *value = arguments->value[at];
    const struct device_option *option = device_option_named(arguments->kind, name);
    char text[DEVICE_ERROR_SIZE];
    if (!option || (option->flags & arguments->without) != 0) {
        list_options(arguments, text);
        argp_error(state, "--%s: the device %s has no such option: expected %s%s", name, arguments->kind->name,
                   *text ? text : "none", nearest_hint(name, text));
    } else if (option->list && strcmp(value, "list") == 0) {
        option->list(stdout);
        exit(fflush(stdout) == 0 ? 0 : 1);
    } else if (option->read_file) {
        read_file(arguments, at, option, state);
    } else if (!option->read(&arguments->config, value, text)) {
        argp_error(state, "--%s%s: %s", option->flags & DEVICE_OPTION_SWITCH ? "" : "device-option ", name, text);
    }
}

/* In the order of the options of the kind: what one value needs may come from another. Names that are none come first. */
static void read_values(struct device_arguments *arguments, const struct argp_state *state)
{
    for (unsigned at = 0; at < arguments->count; at++)
        if (!device_option_named(arguments->kind, arguments->name[at]))
            read_value(arguments, at, state);
    for (const struct device_option *option = arguments->kind->options; option && option->name; option++)
        for (unsigned at = 0; at < arguments->count; at++)
            if (strcmp(arguments->name[at], option->name) == 0)
                read_value(arguments, at, state);
}

void device_arguments_add(struct device_arguments *arguments, const char *name, const char *value, struct argp_state *state)
{
    if (arguments->count == DEVICE_ARGUMENTS_MAX) {
        argp_error(state, "expected at most %u options of the device", DEVICE_ARGUMENTS_MAX);
        return;
    }
    arguments->name[arguments->count] = name;
    arguments->value[arguments->count++] = value;
}

/* NAME=VALUE is cut in two in place. */
static void add_pair(struct device_arguments *arguments, char *text, struct argp_state *state)
{
    char *equals = strchr(text, '=');
    if (!equals || equals == text) {
        argp_error(state, "--device-option: `%s' is wrong: expected NAME=VALUE", text);
        return;
    }
    *equals = '\0';
    device_arguments_add(arguments, text, equals + 1, state);
}

static void choose_kind(struct device_arguments *arguments, const char *name, const struct argp_state *state)
{
    char names[DEVICE_ERROR_SIZE];
    arguments->kind = device_kind_named(name);
    if (!arguments->kind)
        argp_error(state, "--device: `%s' is unknown: expected one that `rkm04 devices' lists%s", name,
                   nearest_hint(name, device_kind_names(names)));
}

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct device_arguments *arguments = state->input;
    if (key == KEY_DEVICE)
        choose_kind(arguments, text, state);
    else if (key == KEY_OPTION)
        add_pair(arguments, text, state);
    else if (key >= KEY_FIRST && key < KEY_FIRST + (int)help.rows)
        device_arguments_add(arguments, help.switches[key - KEY_FIRST], text, state);
    else if (key == ARGP_KEY_END)
        read_values(arguments, state);
    else
        return ARGP_ERR_UNKNOWN;
    return 0;
}

void device_arguments_free(struct device_arguments *arguments)
{
    for (unsigned at = 0; at < arguments->count; at++)
        free(arguments->text[at]);
    arguments->count = 0;
}

void device_arguments_check_backup(const struct device_kind *kind, bool has_flash, const struct argp_state *state)
{
    if (!kind->flash_name || strcmp(kind->flash_name, "backup") != 0)
        argp_error(state, "--backup: the device %s has no backup memory%s", kind->name,
                   has_flash && kind->flash_blocks > 0 ? ": expected --flash" : "");
}
