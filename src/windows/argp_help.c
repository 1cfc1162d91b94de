/* SPDX-License-Identifier: MIT */
#include "argp_help.h"

#include <ctype.h>
#include <string.h>

#define WIDTH 79
#define TEXT_AT 29 /* column of what options do */

/* Print words from column `at`, further lines from column `from`. */
static void print_words(const char *text, size_t length, unsigned at, unsigned from)
{
    const char *stop = text + length;
    while (text < stop) {
        const char *word = text;
        while (text < stop && *text != ' ' && *text != '\n')
            text++;
        unsigned size = (unsigned)(text - word);
        if (at + size > WIDTH && at > from) {
            printf("\n%*s", (int)from, "");
            at = from;
        }
        printf("%.*s", (int)size, word);
        at += size;
        while (text < stop && (*text == ' ' || *text == '\n')) {
            if (*text == '\n') {
                printf("\n%*s", (int)from, "");
                at = from;
            } else if (text + 1 < stop && at + 1 < WIDTH) {
                putchar(' ');
                at++;
            }
            text++;
        }
    }
    putchar('\n');
}

/* Texts of a program have lines of their own. */
static void print_text(const char *text, size_t length)
{
    while (length > 0) {
        const char *end = memchr(text, '\n', length);
        size_t line = end ? (size_t)(end - text) : length;
        print_words(text, line, 0, 0);
        text += end ? line + 1 : line;
        length -= end ? line + 1 : line;
    }
}

static void print_option(const struct argp_option *option)
{
    char head[160];
    bool optional = option->flags & OPTION_ARG_OPTIONAL, letter = option->key > ' ' && option->key < 127;
    if (option->flags & OPTION_DOC)
        snprintf(head, sizeof head, "  %s", option->name);
    else
        snprintf(head, sizeof head, letter ? "  -%c, --%s%s%s%s" : "%6.0d--%s%s%s%s", letter ? option->key : 0, option->name,
                 !option->arg ? "" : optional ? "[=" : "=", option->arg ? option->arg : "", option->arg && optional ? "]" : "");
    unsigned at = (unsigned)strlen(head);
    printf("%s", head);
    unsigned gap = at + 1 < TEXT_AT ? TEXT_AT - at : 3;
    printf("%*s", (int)gap, "");
    print_words(option->doc ? option->doc : "", option->doc ? strlen(option->doc) : 0, at + gap, TEXT_AT);
}

static bool is_end(const struct argp_option *option)
{
    return !option->name && !option->key && !option->doc && !option->group;
}

static void print_group(const struct argp_option *option, int wanted)
{
    int group = 0;
    for (; option && !is_end(option); option++) {
        group = option->group ? option->group : group;
        if (group != wanted || option->flags & OPTION_HIDDEN)
            continue;
        if (!option->name)
            printf("\n %s\n", option->doc);
        else
            print_option(option);
    }
}

/* The lines of what follows the options are forms of the command, one each. */
static void print_forms(const char *name, const char *forms)
{
    const char *head = "Usage:";
    do {
        int length = forms ? (int)strcspn(forms, "\n") : 0;
        printf("%s %s [OPTION...]%s%.*s\n", head, name, length > 0 ? " " : "", length, length > 0 ? forms : "");
        forms = forms && forms[length] ? forms + length + 1 : NULL;
        head = "  or: ";
    } while (forms);
}

void argp_help_print(const char *name, const struct argp *const *group, unsigned groups, bool usage)
{
    const struct argp *argp = group[0];
    const char *doc = argp->doc ? argp->doc : "", *after = strchr(doc, '\v');
    print_forms(name, argp->args_doc);
    if (usage)
        return;
    print_text(doc, after ? (size_t)(after - doc) : strlen(doc));
    putchar('\n');
    for (int number = 0; number <= 9; number++)
        for (unsigned at = 0; at < groups; at++)
            print_group(group[at]->options, number);
    printf("  -?, --help                 Give this help list\n      --usage                Give a short usage message\n");
    if (argp_program_version)
        printf("      --version              Print program version\n");
    if (after) {
        putchar('\n');
        print_text(after + 1, strlen(after + 1));
    }
}
