/* SPDX-License-Identifier: MIT */
/* check_nolint.c: comments that switch warnings off: {nolint NAME ...} for its line, or for the next line with commands where
 * none precedes it; {nolint-file NAME ...} for the whole text. */
#include <stdlib.h>
#include <string.h>

#include "check_inside.h"
#include "options/options.h"

struct nolint {
    size_t source, from, to; /* offsets of what it covers */
    uint64_t off;            /* bit w: warning w */
};

static size_t line_begin(const struct program_source *source, size_t at)
{
    const char *newline = at > 0 ? memrchr(source->text, '\n', at) : NULL;
    return newline == NULL ? 0 : (size_t)(newline - source->text) + 1;
}

static size_t line_end(const struct program_source *source, size_t at)
{
    const char *end = at < source->length ? memchr(source->text + at, '\n', source->length - at) : NULL;
    return end == NULL ? source->length : (size_t)(end - source->text);
}

/* Offset of the first command after a comment; the end of the text if there is none. */
static size_t next_command(const struct code *code, const struct code_comment *comment)
{
    size_t low = 0, high = code->count;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        const struct code_command *at = &code->commands[middle];
        if (at->source < comment->source || (at->source == comment->source && at->offset < comment->offset))
            low = middle + 1;
        else
            high = middle;
    }
    return low < code->count && code->commands[low].source == comment->source ? code->commands[low].offset
                                                                              : code->sources[comment->source].length;
}

static uint64_t read_names(struct check *check, const struct code_comment *comment, size_t at)
{
    const char *text = check->sources[comment->source].text + comment->offset;
    uint64_t off = 0;
    while (at < comment->length - 1) {
        size_t length = 0;
        while (at + length < comment->length - 1 && (unsigned char)text[at + length] > ' ' && text[at + length] != ',')
            length++;
        const enum check_warning warning = check_warning_named(text + at, length);
        if (warning < CHECK_WARNINGS) {
            off |= UINT64_C(1) << warning;
        } else if (length > 0) {
            char name[64];
            const size_t kept = length < sizeof name ? length : sizeof name - 1;
            memcpy(name, text + at, kept);
            name[kept] = '\0';
            const struct diagnostic place = {.source = comment->source, .offset = comment->offset + at, .length = length};
            const bool is_kept = check->found->count < DIAGNOSTICS_MAX; /* a search for the nearest name takes long */
            check_warn_at(check, place, CHECK_UNKNOWN_NOLINT, NULL, "unknown warning `%s'%s", name,
                          is_kept ? nearest_hint(name, check_warning_names()) : "");
        }
        at += length + 1;
    }
    return off;
}

/* Is the comment about warnings? Then *off has them, and *whole_file whether it is for all of the text. */
static bool read_comment(struct check *check, const struct code_comment *comment, uint64_t *off, bool *whole_file)
{
    static const char word[] = "nolint", file[] = "-file";
    const char *text = check->sources[comment->source].text + comment->offset;
    size_t at = 1;
    while (at < comment->length && (unsigned char)text[at] <= ' ')
        at++;
    if (comment->length - at < sizeof word || memcmp(text + at, word, sizeof word - 1) != 0)
        return false;
    at += sizeof word - 1;
    *whole_file = comment->length - at > sizeof file - 1 && memcmp(text + at, file, sizeof file - 1) == 0;
    at += *whole_file ? sizeof file - 1 : 0;
    if ((unsigned char)text[at] > ' ' && text[at] != '}')
        return false;
    *off = read_names(check, comment, at + 1);
    return true;
}

static void drop_covered(struct diagnostics *found, const struct nolint *nolint)
{
    size_t kept = 0;
    for (size_t i = 0; i < found->count; i++) {
        struct diagnostic *one = &found->list[i];
        const bool is_near = one->source == nolint->source && one->offset >= nolint->from && one->offset <= nolint->to;
        const enum check_warning warning = is_near ? check_warning_named(one->name, strlen(one->name)) : CHECK_WARNINGS;
        if (warning < CHECK_WARNINGS && (nolint->off >> warning & 1)) {
            free(one->message);
            free(one->hint);
            found->warnings--;
        } else {
            found->list[kept++] = *one;
        }
    }
    found->count = kept;
}

static void apply_comment(struct check *check, const struct code *code, const struct code_comment *comment)
{
    const struct program_source *source = &check->sources[comment->source];
    struct nolint nolint = {.source = comment->source, .to = source->length};
    bool whole_file;
    if (!read_comment(check, comment, &nolint.off, &whole_file))
        return;
    if (!whole_file) {
        nolint.from = line_begin(source, comment->offset);
        nolint.to = line_end(source, comment->after ? comment->offset : next_command(code, comment));
    }
    if (nolint.off != 0)
        drop_covered(check->found, &nolint);
}

void check_nolint(struct check *check)
{
    for (size_t m = 0; m < check->motor_count; m++) {
        const struct code *code = &check->motors[m].code;
        for (size_t i = 0; i < code->comment_count; i++)
            apply_comment(check, code, &code->comments[i]);
    }
}
