/* SPDX-License-Identifier: MIT */
/* Takes a line of a PLC text apart: LABEL: NAME argument,argument ;comment */
#include "names.h"
#include "plc_line.h"

static bool is_blank(char letter)
{
    return letter == ' ' || letter == '\t' || letter == '\r';
}

static void skip_blanks(const char **at, const char *end)
{
    while (*at < end && is_blank(**at))
        ++*at;
}

/* The next `mark` that is not in quotes, or the end. */
static const char *find_mark(const char *at, const char *end, char mark)
{
    while (at < end && *at != mark) {
        int64_t value;
        size_t quoted = cnc_quoted_length(at, (size_t)(end - at), &value);
        at += quoted > 0 ? quoted : 1;
    }
    return at;
}

static struct cnc_word without_blanks(const char *begin, const char *end)
{
    skip_blanks(&begin, end);
    while (end > begin && is_blank(end[-1]))
        end--;
    return (struct cnc_word){begin, (size_t)(end - begin)};
}

/* The letters up to a blank or colon. */
static struct cnc_word read_word(const char **at, const char *end)
{
    const char *begin = *at;

    while (*at < end && !is_blank(**at) && **at != ':')
        ++*at;
    return (struct cnc_word){begin, (size_t)(*at - begin)};
}

static void read_arguments(struct cnc_plc_line *line, const char *at, const char *end)
{
    line->arguments = 0;
    skip_blanks(&at, end);
    while (at < end) { /* the last one takes the rest */
        const char *comma = line->arguments + 1 < CNC_ARGUMENTS_MAX ? find_mark(at, end, ',') : end;
        line->argument[line->arguments++] = without_blanks(at, comma);
        if (comma + 1 == end) /* nothing behind the last comma */
            line->argument[line->arguments++] = (struct cnc_word){end, 0};
        at = comma < end ? comma + 1 : end;
    }
}

void cnc_read_plc_line(const char **text, size_t *length, struct cnc_plc_line *line)
{
    const char *at = *text;
    size_t letters = 0;

    while (letters < *length && at[letters] != '\n')
        letters++;
    bool has_more = letters < *length;
    const char *end = find_mark(at, at + letters, ';');

    line->begin = at;
    line->number++;
    line->label = (struct cnc_word){at, 0};
    skip_blanks(&at, end);
    line->name = read_word(&at, end);
    skip_blanks(&at, end);
    if (at < end && *at == ':' && line->name.length > 0) {
        line->label = line->name;
        at++;
        skip_blanks(&at, end);
        line->name = read_word(&at, end);
    }
    read_arguments(line, at, end);
    *text += letters + has_more;
    *length -= letters + has_more;
}
