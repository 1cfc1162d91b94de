/* SPDX-License-Identifier: MIT */
#include "arguments.h"

#include <err.h>
#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "text/text.h"

#define SHOWN_MAX 300 /* bytes of an argument with its note */
#define LIST_SIZE 4096u /* bytes of all names of options */
#define COMMON_OPTIONS "help, usage, version, "

static bool parsing; /* argp may end the program now */
static char **arguments; /* of the program; NULL after the last */
static const struct argp *root; /* of its options */

int arguments_printed(void)
{
    errno = 0;
    if (fflush(stdout) == 0 && !ferror(stdout))
        return 0;
    if (errno != 0)
        warn("cannot write to standard output");
    else
        warnx("cannot write to standard output");
    return 1;
}

/* The command line was wrong, which has been reported: name characters in it that cannot be seen. */
static void note_invisible(void)
{
    for (char **argument = arguments; *argument != NULL; argument++) {
        char text[SHOWN_MAX];
        snprintf(text, sizeof text, "%.200s", *argument);
        size_t length = strlen(text);
        invisible_note(text, sizeof text);
        if (text[length] != '\0')
            warnx("`%.*s'%s", (int)length, text, text + length);
    }
}

/* ---- Options that there are not -------------------------------------------------------------------------------------- */

static bool is_end(const struct argp_option *option)
{
    return !option->name && !option->key && !option->doc && !option->group;
}

static bool is_long(const struct argp_option *option)
{
    return option->name && !(option->flags & (OPTION_DOC | OPTION_HIDDEN));
}

/* An option whose name is, or begins with, the `length` bytes at `name`. NULL: there is none. */
static const struct argp_option *find_option(const struct argp *argp, const char *name, size_t length)
{
    const struct argp_option *found = NULL;
    for (const struct argp_option *option = argp->options; option && !is_end(option); option++)
        if (option->name && strncmp(option->name, name, length) == 0 && (!found || strlen(option->name) == length))
            found = option;
    for (const struct argp_child *child = argp->children; !found && child && child->argp; child++)
        found = find_option(child->argp, name, length);
    return found;
}

static size_t list_options(const struct argp *argp, char list[LIST_SIZE], size_t used)
{
    for (const struct argp_option *option = argp->options; option && !is_end(option); option++)
        if (is_long(option) && used < LIST_SIZE)
            used += (size_t)snprintf(list + used, LIST_SIZE - used, "%s, ", option->name);
    for (const struct argp_child *child = argp->children; child && child->argp; child++)
        used = list_options(child->argp, list, used);
    return used;
}

/* Propose the nearest name for the first option that there is not. */
static void propose_option(void)
{
    for (char **argument = arguments + 1; *argument != NULL && strcmp(*argument, "--") != 0; argument++) {
        const char *name = *argument + 2;
        const size_t length = strcspn(name, "=");
        if (strncmp(*argument, "--", 2) != 0)
            continue;
        const struct argp_option *option = find_option(root, name, length);
        if (option) {
            const bool takes_next = option->arg && !(option->flags & OPTION_ARG_OPTIONAL) && name[length] == '\0';
            argument += takes_next && argument[1] != NULL;
            continue;
        }
        char list[LIST_SIZE] = COMMON_OPTIONS, wrong[32];
        list_options(root, list, strlen(list));
        snprintf(wrong, sizeof wrong, "%.*s", (int)length, name);
        if (*nearest_name(wrong, list) != '\0')
            warnx("did you mean `--%s'?", nearest_name(wrong, list));
        return;
    }
}

void arguments_reported(void)
{
    parsing = false;
}

static void at_end(int status, void *unused)
{
    (void)unused;
    if (!parsing)
        return;
    if (status != 0) {
        note_invisible();
        propose_option();
    }
    if (arguments_printed() != 0)
        _exit(1);
}

void arguments_parse(const struct argp *argp, int argc, char **argv, void *input)
{
    static bool registered;
    if (!registered)
        registered = on_exit(at_end, NULL) == 0;
    arguments = argv;
    root = argp;
    parsing = true;
    argp_parse(argp, argc, argv, 0, NULL, input);
    parsing = false;
}
