/* SPDX-License-Identifier: MIT */
/* argp.c: parsing a command line. All options come first, wherever they stand, then the arguments, then the end. */
#include <argp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "argp_help.h"

#define GROUPS_MAX 4 /* a command line and its children */
#define KEY_HELP (-2)
#define KEY_USAGE (-3)

error_t argp_err_exit_status = 64;

static const struct argp_option common[] = {{"help", KEY_HELP, NULL, 0, "Give this help list", -1},
                                            {"usage", KEY_USAGE, NULL, 0, "Give a short usage message", 0},
                                            {0}};

struct parser {
    const struct argp *group[GROUPS_MAX];
    void *input[GROUPS_MAX], *child_inputs[GROUPS_MAX];
    unsigned groups;
    struct argp_state state;
};

_Noreturn static void end(int status)
{
    windows_exit_status = status;
    exit(status);
}

static void report(const struct argp_state *state, int error, const char *format, va_list values)
{
    fprintf(stderr, "%s: ", state->name);
    vfprintf(stderr, format, values);
    if (error != 0)
        fprintf(stderr, ": %s", strerror(error));
    fputc('\n', stderr);
}

void argp_error(const struct argp_state *state, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    report(state, 0, format, values);
    va_end(values);
    fprintf(stderr, "Try `%s --help' or `%s --usage' for more information.\n", state->name, state->name);
    end(argp_err_exit_status);
}

void argp_failure(const struct argp_state *state, int status, int error, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    report(state, error, format, values);
    va_end(values);
    if (status != 0)
        end(status);
}

/* ---- Which option it is --------------------------------------------------------------------------------------------- */

static bool is_option(const struct argp_option *option)
{
    return option->name && !(option->flags & OPTION_DOC);
}

static bool is_end(const struct argp_option *option)
{
    return !option->name && !option->key && !option->doc && !option->group;
}

/* The option of this name, or the only one that begins so. NULL: none, or several. `*at`: whose it is. */
static const struct argp_option *find_long(const struct parser *parser, const char *name, size_t length, unsigned *at)
{
    const struct argp_option *found = NULL;
    bool several = false;
    for (unsigned group = 0; group <= parser->groups; group++) {
        const struct argp_option *option = group < parser->groups ? parser->group[group]->options : common;
        for (; option && !is_end(option); option++) {
            if (!is_option(option) || strncmp(option->name, name, length) != 0)
                continue;
            bool whole = strlen(option->name) == length;
            several = several || (found && found->key != option->key);
            if (!found || whole) {
                found = option;
                *at = group;
            }
            if (whole)
                return found;
        }
    }
    return several ? NULL : found;
}

static const struct argp_option *find_short(const struct parser *parser, char letter, unsigned *at)
{
    static const struct argp_option help = {"help", KEY_HELP, NULL, 0, NULL, 0};
    if (letter == '?')
        return &help;
    for (*at = 0; *at < parser->groups; ++*at)
        for (const struct argp_option *option = parser->group[*at]->options; option && !is_end(option); option++)
            if (is_option(option) && option->key == letter)
                return option;
    return NULL;
}

static void take(struct parser *parser, const struct argp_option *option, unsigned at, char *value)
{
    if (option->key == KEY_HELP || option->key == KEY_USAGE) {
        argp_help_print(parser->state.name, parser->group, parser->groups, option->key == KEY_USAGE);
        end(0);
    }
    parser->state.input = parser->input[at];
    parser->group[at]->parser(option->key, value, &parser->state);
}

/* --NAME, --NAME=VALUE, --NAME VALUE. Returns how many words that was. */
static int read_long(struct parser *parser, char **words)
{
    char *name = words[0] + 2, *equals = strchr(name, '='), *value = equals ? equals + 1 : NULL;
    size_t length = equals ? (size_t)(equals - name) : strlen(name);
    unsigned at = 0;
    if (length == strlen("version") && strncmp(name, "version", length) == 0 && argp_program_version) {
        puts(argp_program_version);
        end(0);
    }
    const struct argp_option *option = find_long(parser, name, length, &at);
    if (!option)
        argp_error(&parser->state, "unrecognized option '--%.*s'", (int)length, name);
    else if (!option->arg && value)
        argp_error(&parser->state, "option '--%s' doesn't allow an argument", option->name);
    bool next = option && option->arg && !value && !(option->flags & OPTION_ARG_OPTIONAL);
    if (next && !words[1])
        argp_error(&parser->state, "option '--%s' requires an argument", option->name);
    take(parser, option, at, next ? words[1] : value);
    return next ? 2 : 1;
}

/* -x, -xVALUE, -x VALUE, -xy. Returns how many words that was. */
static int read_short(struct parser *parser, char **words)
{
    for (char *letter = words[0] + 1; *letter; letter++) {
        unsigned at = 0;
        const struct argp_option *option = find_short(parser, *letter, &at);
        if (!option)
            argp_error(&parser->state, "invalid option -- '%c'", *letter);
        if (!option->arg) {
            take(parser, option, at, NULL);
            continue;
        }
        bool optional = option->flags & OPTION_ARG_OPTIONAL, next = !letter[1] && !optional;
        if (next && !words[1])
            argp_error(&parser->state, "option requires an argument -- '%c'", *letter);
        take(parser, option, at, letter[1] ? letter + 1 : next ? words[1] : NULL);
        return next ? 2 : 1;
    }
    return 1;
}

/* ---- The whole ------------------------------------------------------------------------------------------------------ */

static void add_groups(struct parser *parser, const struct argp *argp, void *input)
{
    parser->group[0] = argp;
    parser->input[0] = input;
    parser->groups = 1;
    for (const struct argp_child *child = argp->children; child && child->argp && parser->groups < GROUPS_MAX; child++)
        parser->group[parser->groups++] = child->argp;
}

static void call_all(struct parser *parser, int key)
{
    for (unsigned i = 0; i < parser->groups; i++) {
        unsigned at = key == ARGP_KEY_INIT ? i : parser->groups - 1 - i; /* children end first */
        parser->state.input = parser->input[at];
        if (parser->group[at]->parser)
            parser->group[at]->parser(key, NULL, &parser->state);
        for (unsigned child = 1; key == ARGP_KEY_INIT && at == 0 && child < parser->groups; child++)
            parser->input[child] = parser->child_inputs[child - 1];
    }
}

static void take_argument(struct parser *parser, char *argument)
{
    error_t error = ARGP_ERR_UNKNOWN;
    for (unsigned at = 0; at < parser->groups && error == ARGP_ERR_UNKNOWN; at++) {
        parser->state.input = parser->input[at];
        error = parser->group[at]->parser(ARGP_KEY_ARG, argument, &parser->state);
    }
    parser->state.arg_num++;
    if (error == ARGP_ERR_UNKNOWN)
        argp_error(&parser->state, "Too many arguments");
}

error_t argp_parse(const struct argp *argp, int argc, char **argv, unsigned flags, int *arg_index, void *input)
{
    struct parser parser = {.state = {.root_argp = argp, .argc = argc, .argv = argv, .flags = flags}};
    char **arguments = calloc((size_t)argc + 1, sizeof *arguments), own_name[64];
    int count = 0, length;
    const char *name = windows_name(argv[0], &length);
    snprintf(own_name, sizeof own_name, "%.*s", length, name);
    parser.state.name = own_name;
    bool over = false;
    (void)arg_index;
    if (!arguments)
        return ENOMEM;
    parser.state.child_inputs = parser.child_inputs;
    add_groups(&parser, argp, input);
    call_all(&parser, ARGP_KEY_INIT);
    for (int at = 1; at < argc;) {
        if (over || argv[at][0] != '-' || !argv[at][1])
            arguments[count++] = argv[at++];
        else if (strcmp(argv[at], "--") == 0)
            over = at++ > 0;
        else
            at += argv[at][1] == '-' ? read_long(&parser, argv + at) : read_short(&parser, argv + at);
    }
    for (int i = 0; i < count; i++)
        take_argument(&parser, arguments[i]);
    call_all(&parser, ARGP_KEY_END);
    free(arguments);
    return 0;
}
