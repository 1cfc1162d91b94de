/* SPDX-License-Identifier: MIT */
#include "nearest.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

#define WORD_MAX 24
#define FAR_AWAY 3u /* changes that make it another word */

static size_t least(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* How many letters have to be changed, added, removed, or swapped with the next, to make `a` of `b`. */
static size_t distance(const char *a, size_t a_length, const char *b, size_t b_length)
{
    size_t cost[WORD_MAX + 1][WORD_MAX + 1];
    for (size_t i = 0; i <= a_length; i++)
        cost[i][0] = i;
    for (size_t j = 0; j <= b_length; j++)
        cost[0][j] = j;
    for (size_t i = 1; i <= a_length; i++) {
        for (size_t j = 1; j <= b_length; j++) {
            size_t best = cost[i - 1][j - 1] + (a[i - 1] != b[j - 1]);
            best = least(best, least(cost[i - 1][j], cost[i][j - 1]) + 1);
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                best = least(best, cost[i - 2][j - 2] + 1);
            cost[i][j] = best;
        }
    }
    return cost[a_length][b_length];
}

const char *nearest_name(const char *word, const char *list)
{
    static char nearest_one[WORD_MAX + 1];
    size_t length = strlen(word), nearest = FAR_AWAY;
    nearest_one[0] = '\0';
    for (const char *at = list; length <= WORD_MAX && *at != '\0';) {
        size_t name = strcspn(at, ", ");
        if (name > 0 && name <= WORD_MAX) {
            size_t found = distance(word, length, at, name);
            if (found < nearest && 2u * found <= least(length, name)) { /* "top" is not "low" */
                nearest = found;
                snprintf(nearest_one, sizeof nearest_one, "%.*s", (int)name, at);
            }
        }
        at += name + (at[name] != '\0');
    }
    return nearest_one;
}

const char *nearest_hint(const char *word, const char *list)
{
    static char hint[WORD_MAX + 32];
    const char *name = nearest_name(word, list);
    snprintf(hint, sizeof hint, name[0] != '\0' ? "; did you mean `%s'?" : "%s", name);
    return hint;
}
