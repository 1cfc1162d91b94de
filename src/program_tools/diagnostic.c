/* SPDX-License-Identifier: MIT */
#include "diagnostic.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "text/text.h"

static bool make_room(struct diagnostics *all)
{
    if (all->count < all->room)
        return true;
    size_t room = all->room == 0 ? 16 : 2 * all->room;
    struct diagnostic *grown = realloc(all->list, room * sizeof *grown);
    if (grown == NULL)
        return false;
    all->list = grown;
    all->room = room;
    return true;
}

void diagnostics_add(struct diagnostics *all, const struct diagnostic *what, const char *hint, const char *format, ...)
{
    va_list arguments;
    struct diagnostic *added;
    if (what->severity == DIAGNOSTIC_ERROR)
        all->errors++;
    else
        all->warnings++;
    if (all->count == DIAGNOSTICS_MAX)
        return;
    if (!make_room(all)) {
        all->no_memory = true;
        return;
    }
    added = &all->list[all->count];
    *added = *what;
    va_start(arguments, format);
    if (vasprintf(&added->message, format, arguments) < 0)
        added->message = NULL;
    va_end(arguments);
    added->hint = hint == NULL ? NULL : strdup(hint);
    if (added->message == NULL || (hint != NULL && added->hint == NULL)) {
        free(added->message);
        free(added->hint);
        all->no_memory = true;
        return;
    }
    all->count++;
}

static int compare(const void *left, const void *right)
{
    const struct diagnostic *a = left, *b = right;
    if (a->source != b->source)
        return a->source < b->source ? -1 : 1;
    if (a->offset != b->offset)
        return a->offset < b->offset ? -1 : 1;
    if (a->severity != b->severity)
        return a->severity < b->severity ? -1 : 1;
    const int names = strcmp(a->name, b->name);
    return names != 0 ? names : strcmp(a->message, b->message);
}

/* A source for all motors is checked for each: what is the same is reported once. */
static void drop_twins(struct diagnostics *all)
{
    size_t kept = 0;
    for (size_t i = 0; i < all->count; i++) {
        struct diagnostic *one = &all->list[i];
        if (kept > 0 && compare(one, &all->list[kept - 1]) == 0) {
            free(one->message);
            free(one->hint);
            all->errors -= one->severity == DIAGNOSTIC_ERROR;
            all->warnings -= one->severity == DIAGNOSTIC_WARNING;
        } else {
            all->list[kept++] = *one;
        }
    }
    all->count = kept;
}

void diagnostics_arrange(struct diagnostics *all, const struct program_source *sources)
{
    struct text_place place = {0};
    if (all->count > 0)
        qsort(all->list, all->count, sizeof all->list[0], compare);
    drop_twins(all);
    for (size_t i = 0; i < all->count; i++) {
        struct diagnostic *one = &all->list[i];
        if (i == 0 || one->source != one[-1].source)
            place = text_place_begin(sources[one->source].text, sources[one->source].length);
        text_place_move(&place, one->offset);
        one->line = place.line;
        one->column = place.column;
    }
}

void diagnostics_free(struct diagnostics *all)
{
    for (size_t i = 0; i < all->count; i++) {
        free(all->list[i].message);
        free(all->list[i].hint);
    }
    free(all->list);
    *all = (struct diagnostics){0};
}
