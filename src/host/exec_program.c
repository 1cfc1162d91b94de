#include "exec_program.h"

#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <rkm04/limits.h>

#define FIRST_ROOM 4096
#define TEXT_MAX ((size_t)64 << 20) /* bytes; more is not a program */

static const struct {
    uint8_t length;
    char bytes[4];
} apostrophes[] = {
    {2, "\xC2\xB4"},     /* U+00B4 */
    {3, "\xE2\x80\x98"}, /* U+2018 */
    {3, "\xE2\x80\x99"}, /* U+2019 */
    {3, "\xE2\x80\x9E"}, /* U+201E */
};

static size_t apostrophe_at(const char *text, size_t left)
{
    for (size_t i = 0; i < sizeof apostrophes / sizeof apostrophes[0]; i++) {
        if (apostrophes[i].length <= left && memcmp(text, apostrophes[i].bytes, apostrophes[i].length) == 0)
            return apostrophes[i].length;
    }
    return 0;
}

size_t exec_text_map(char *text, size_t length)
{
    size_t from = length >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0;
    size_t to = 0;
    while (from < length) {
        size_t n = apostrophe_at(text + from, length - from);
        text[to++] = n > 0 ? '\'' : text[from];
        from += n > 0 ? n : 1;
    }
    return to;
}

/* Read all of `file`. Returns NULL or what went wrong. */
static const char *read_all(struct exec_text *text, FILE *file)
{
    size_t room = 0;
    for (;;) {
        if (text->length == room) {
            if (room >= TEXT_MAX)
                return "too large for a program";
            room = room > 0 ? 2 * room : FIRST_ROOM;
            char *grown = realloc(text->text, room);
            if (grown == NULL)
                return strerror(ENOMEM);
            text->text = grown;
        }
        size_t n = fread(text->text + text->length, 1, room - text->length, file);
        text->length += n;
        if (n == 0)
            return ferror(file) ? strerror(errno) : NULL;
    }
}

bool exec_text_read(struct exec_text *text, const char *path)
{
    bool standard = strcmp(path, "-") == 0;
    *text = (struct exec_text){.name = strdup(standard ? "<stdin>" : path)};
    if (text->name == NULL) {
        fprintf(stderr, "rkm04 exec: %s\n", strerror(errno));
        return false;
    }
    FILE *file = standard ? stdin : fopen(path, "rb");
    const char *wrong = file != NULL ? read_all(text, file) : strerror(errno);
    if (file != NULL && !standard)
        fclose(file);
    if (wrong != NULL) {
        fprintf(stderr, "rkm04 exec: cannot read %s: %s\n", text->name, wrong);
        return false;
    }
    text->length = exec_text_map(text->text, text->length);
    return true;
}

void exec_text_free(struct exec_text *text)
{
    free(text->name);
    free(text->text);
    *text = (struct exec_text){0};
}

bool exec_program_argument(const char *argument, char *motor, const char **path)
{
    size_t digits = strspn(argument, "0123456789");
    *motor = '1';
    *path = argument;
    if (digits == 0 || argument[digits] != '=')
        return true;
    if (digits > 1 || argument[0] > '0' + RKM04_MOTORS)
        return false;
    *motor = argument[0];
    *path = argument + digits + 1;
    return true;
}
