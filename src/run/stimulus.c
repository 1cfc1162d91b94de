/* SPDX-License-Identifier: MIT */
#include "stimulus.h"

#include <stdlib.h>
#include <string.h>

#include <rkm04/limits.h>

#include "text/text.h"

#define FOUND_MAX 32 /* characters of a wrong word shown in a message */

struct parser {
    struct stimuli *stimuli;
    const struct device_kind *device;
    size_t room;
    const char *name;
    FILE *errors;
    int error_count;
    const char *line; /* the present line, without its end */
    size_t length, at;
    size_t number;
    uint8_t *free_byte; /* in stimuli->bytes */
};

struct word {
    const char *text;
    size_t length;
    size_t at; /* in the line */
};

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

static void skip_blanks(struct parser *p)
{
    while (p->at < p->length && is_blank(p->line[p->at]))
        p->at++;
}

static struct word next_word(struct parser *p)
{
    skip_blanks(p);
    struct word word = {p->line + p->at, 0, p->at};
    while (p->at < p->length && !is_blank(p->line[p->at]))
        p->at++;
    word.length = p->at - word.at;
    return word;
}

static bool word_is(struct word word, const char *text)
{
    return word.length == strlen(text) && memcmp(word.text, text, word.length) == 0;
}

/* Report what was expected at the word, or `offset` characters into it. Returns false. */
static bool report_expected(struct parser *p, struct word word, size_t offset, const char *what)
{
    char found[FOUND_MAX + 1], shown[FOUND_MAX + 100];
    size_t n = word.length < FOUND_MAX ? word.length : FOUND_MAX;
    while (n > 0 && n < word.length && ((unsigned char)word.text[n] & 0xC0) == 0x80)
        n--; /* not inside a UTF-8 character */
    for (size_t i = 0; i < n; i++)
        found[i] = (unsigned char)word.text[i] < ' ' || word.text[i] == 0x7F ? '?' : word.text[i];
    found[n] = '\0';
    fprintf(p->errors, "%s:%zu:%zu: error: expected %s, found ", p->name, p->number, word.at + offset + 1, what);
    snprintf(shown, sizeof shown, word.length == 0 ? "the end of the line" : "'%s%s'", found, n < word.length ? "..." : "");
    invisible_note(shown, sizeof shown);
    fprintf(p->errors, "%s\n", shown);
    p->error_count++;
    return false;
}

/* Nothing but a comment may follow. */
static bool read_end(struct parser *p)
{
    struct word word = next_word(p);
    if (word.length > 0 && word.text[0] != '#')
        return report_expected(p, word, 0, "the end of the line");
    return true;
}

/* A number of one or two digits from `low` to `high`. */
static bool read_small(struct word word, unsigned low, unsigned high, uint8_t *number)
{
    unsigned value = 0;
    for (size_t i = 0; i < word.length; i++) {
        if (word.text[i] < '0' || word.text[i] > '9' || word.length > 2)
            return false;
        value = value * 10 + (unsigned)(word.text[i] - '0');
    }
    *number = (uint8_t)value;
    return word.length > 0 && value >= low && value <= high;
}

static bool read_input(struct parser *p, struct stimulus *s)
{
    char what[DEVICE_ERROR_SIZE + 16u], names[DEVICE_ERROR_SIZE], name[DEVICE_BIT_NAME_SIZE];
    struct word word = next_word(p);
    s->kind = STIMULUS_INPUT;
    snprintf(name, sizeof name, "%.*s", (int)word.length, word.text);
    s->input = word.length < sizeof name ? (uint8_t)device_input_named(p->device, name) : 0;
    if (p->device->input_names || p->device->inputs == 0)
        snprintf(what, sizeof what, "an input %s", device_input_names(p->device, names));
    else
        snprintf(what, sizeof what, "an input 01 to %02u", p->device->inputs);
    if (s->input == 0)
        return report_expected(p, word, 0, what);
    word = next_word(p);
    if (!word_is(word, "0") && !word_is(word, "1"))
        return report_expected(p, word, 0, "0 or 1");
    s->level = word.text[0] == '1';
    return read_end(p);
}

static bool read_set(struct parser *p, struct stimulus *s)
{
    char what[40];
    struct word word = next_word(p);
    snprintf(what, sizeof what, "a motor 1 to %u, or 0 for all", p->device->axes);
    if (!read_small(word, 0, p->device->axes, &s->motor) || (word.length > 1 && word.text[0] == '0'))
        return report_expected(p, word, 0, what);
    s->kind = STIMULUS_SET;
    skip_blanks(p);
    size_t end = p->length;
    while (end > p->at && is_blank(p->line[end - 1]))
        end--;
    if (end == p->at)
        return report_expected(p, next_word(p), 0, "a program text");
    s->data = p->free_byte;
    s->length = end - p->at;
    s->column = p->at + 1;
    memcpy(p->free_byte, p->line + p->at, s->length);
    p->free_byte += s->length;
    return true;
}

static int hex_digit(char c)
{
    if (c >= '0' && c <= '9')
        return c - '0';
    if (c >= 'a' && c <= 'f')
        return c - 'a' + 10;
    if (c >= 'A' && c <= 'F')
        return c - 'A' + 10;
    return -1;
}

static bool read_message(struct parser *p, struct stimulus *s)
{
    struct word word = next_word(p);
    s->kind = STIMULUS_MESSAGE;
    if (!p->device->exchange)
        return report_expected(p, word, 0, "no message: the device has no bus that takes one at once");
    s->data = p->free_byte;
    s->column = word.at + 1;
    if (word.length == 0 || word.text[0] == '#')
        return report_expected(p, word, 0, "the bytes of a message in hexadecimal, such as 0431");
    for (; word.length > 0 && word.text[0] != '#'; word = next_word(p)) {
        for (size_t i = 0; i < word.length; i += 2) {
            int high = hex_digit(word.text[i]);
            int low = i + 1 < word.length ? hex_digit(word.text[i + 1]) : -1;
            if (high < 0 || low < 0)
                return report_expected(p, word, high < 0 ? i : i + 1, "two hexadecimal digits a byte");
            if (s->length == p->device->request_max)
                return report_expected(p, word, i, "no more bytes than a request may have");
            p->free_byte[s->length++] = (uint8_t)(high << 4 | low);
        }
    }
    p->free_byte += s->length;
    return true;
}

/* Read the line. Returns true if *s is a stimulus; false for an empty line or an error. */
static bool read_line(struct parser *p, struct stimulus *s)
{
    struct word time = next_word(p);
    if (time.length == 0 || time.text[0] == '#')
        return false;
    size_t wrong;
    const char *form = time_value_read(time.text, time.length, &s->tick, &wrong);
    if (form != NULL)
        return report_expected(p, time, wrong, form);
    s->line = p->number;
    struct word kind = next_word(p);
    if (word_is(kind, "di"))
        return read_input(p, s);
    if (word_is(kind, "set"))
        return read_set(p, s);
    if (word_is(kind, "message"))
        return read_message(p, s);
    return report_expected(p, kind, 0, "di, set or message");
}

static bool append(struct parser *p, const struct stimulus *s)
{
    struct stimuli *stimuli = p->stimuli;
    if (stimuli->count == p->room) {
        size_t room = p->room > 0 ? 2 * p->room : 64;
        struct stimulus *list = realloc(stimuli->list, room * sizeof *list);
        if (list == NULL)
            return false;
        stimuli->list = list;
        p->room = room;
    }
    stimuli->list[stimuli->count++] = *s;
    return true;
}

/* Lines of one time stay in the order of the file. */
static int compare_ticks(const void *left, const void *right)
{
    const struct stimulus *a = left, *b = right;
    if (a->tick != b->tick)
        return a->tick < b->tick ? -1 : 1;
    return (a->line > b->line) - (a->line < b->line);
}

int stimuli_read(struct stimuli *stimuli, const struct device_kind *device, const char *name, const char *text, size_t length,
                 FILE *errors)
{
    struct parser p = {.stimuli = stimuli, .device = device, .name = name, .errors = errors};
    *stimuli = (struct stimuli){0};
    stimuli->bytes = malloc(length + 1); /* what a line holds is never longer than the line */
    if (stimuli->bytes == NULL)
        return -1;
    p.free_byte = stimuli->bytes;
    for (size_t begin = 0; begin < length;) {
        const char *end = memchr(text + begin, '\n', length - begin);
        p.line = text + begin;
        p.length = end != NULL ? (size_t)(end - p.line) : length - begin;
        p.at = 0;
        p.number++;
        struct stimulus s = {0};
        if (read_line(&p, &s) && !append(&p, &s))
            return -1;
        begin += p.length + 1;
    }
    if (stimuli->count > 1)
        qsort(stimuli->list, stimuli->count, sizeof stimuli->list[0], compare_ticks);
    return p.error_count;
}

void stimuli_free(struct stimuli *stimuli)
{
    free(stimuli->list);
    free(stimuli->bytes);
    *stimuli = (struct stimuli){0};
}
