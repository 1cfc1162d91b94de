/* SPDX-License-Identifier: MIT */
#include "program_text.h"

#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FIRST_ROOM 4096
#define TEXT_MAX ((size_t)32 << 20) /* bytes; more is not a program */

static const struct {
    uint8_t length;
    char bytes[4];
} apostrophes[] = {
    {2, "\xC2\xB4"},     /* U+00B4 */
    {3, "\xE2\x80\x98"}, /* U+2018 */
    {3, "\xE2\x80\x99"}, /* U+2019 */
    {3, "\xE2\x80\x9E"}, /* U+201E */
};

/* Bytes of the apostrophe that is here, 0 if there is none. */
static size_t apostrophe_at(const char *text, size_t left)
{
    for (size_t i = 0; i < sizeof apostrophes / sizeof apostrophes[0]; i++) {
        if (apostrophes[i].length <= left && memcmp(text, apostrophes[i].bytes, apostrophes[i].length) == 0)
            return apostrophes[i].length;
    }
    return 0;
}

size_t program_text_map(char *text, size_t length)
{
    size_t from = length >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0;
    size_t to = 0;
    while (from < length) {
        size_t bytes = apostrophe_at(text + from, length - from);
        text[to++] = bytes > 0 ? '\'' : text[from];
        from += bytes > 0 ? bytes : 1;
    }
    return to;
}

/* Read all of `file`. Returns NULL or what went wrong. */
static const char *read_all(struct program_text *text, FILE *file)
{
    for (size_t room = FIRST_ROOM; room <= TEXT_MAX; room *= 2) {
        char *grown = realloc(text->text, room);
        if (grown == NULL)
            return strerror(ENOMEM);
        text->text = grown;
        text->length += fread(text->text + text->length, 1, room - text->length, file);
        if (ferror(file))
            return strerror(errno);
        if (text->length < room)
            return NULL;
    }
    return "too long for a program";
}

bool program_text_map_in_place(char *text, size_t length)
{
    bool any = false;
    if (length >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0)
        memset(text, ' ', 3);
    for (size_t at = 0; at < length; at++) {
        size_t bytes = apostrophe_at(text + at, length - at);
        if (bytes == 0)
            continue;
        any = true;
        text[at] = '\'';
        memset(text + at + 1, ' ', bytes - 1);
        at += bytes - 1;
    }
    return any;
}

const char *program_text_read_raw(struct program_text *text, const char *path)
{
    *text = (struct program_text){0};
    if (strcmp(path, "-") == 0)
        return read_all(text, stdin);
    FILE *file = fopen(path, "rb");
    if (file == NULL)
        return strerror(errno);
    const char *wrong = read_all(text, file);
    fclose(file);
    return wrong;
}

const char *program_text_read(struct program_text *text, const char *path)
{
    const char *wrong = program_text_read_raw(text, path);
    text->length = program_text_map(text->text, text->length);
    return wrong;
}

void program_text_free(struct program_text *text)
{
    free(text->text);
    *text = (struct program_text){0};
}
