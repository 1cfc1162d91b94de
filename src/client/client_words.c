/* SPDX-License-Identifier: MIT */
#include "client_words.h"

#include <string.h>

static bool is_blank(char c)
{
    return c == ' ' || c == '\t';
}

bool client_words_is_program(const char *line)
{
    while (is_blank(*line))
        line++;
    return *line != '\0' && *line != '#' && !('a' <= *line && *line <= 'z');
}

/* Cut one word off at *from. Returns false if its quote is left open. */
static bool take_word(char **from)
{
    char *to = *from, quote = '\0';
    for (; **from != '\0' && (quote != '\0' || !is_blank(**from)); ++*from) {
        if (quote == '\0' && (**from == '\'' || **from == '"'))
            quote = **from;
        else if (**from == quote)
            quote = '\0';
        else
            *to++ = **from;
    }
    if (**from != '\0')
        ++*from;
    *to = '\0';
    return quote == '\0';
}

int client_words_split(char *line, char *word[CLIENT_WORDS_MAX])
{
    int count = 0;
    for (;;) {
        while (is_blank(*line))
            line++;
        if (*line == '\0' || *line == '#')
            return count;
        if (count == CLIENT_WORDS_MAX)
            return -2;
        word[count++] = line;
        if (!take_word(&line))
            return -1;
    }
}
