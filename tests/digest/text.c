/* SPDX-License-Identifier: MIT */
/* text.c: digests and their text, without a C library. */
#include "text.h"

#define LINE_MAX 100

size_t text_length(const char *text)
{
    size_t length = 0;
    while (text[length] != '\0')
        length++;
    return length;
}

void append(char *text, size_t room, const char *more)
{
    size_t at = text_length(text);
    for (; *more != '\0' && at + 1 < room; more++)
        text[at++] = *more;
    text[at] = '\0';
}

void append_number(char *text, size_t room, uint64_t number)
{
    char digits[21];
    size_t at = sizeof digits - 1;
    digits[at] = '\0';
    do {
        digits[--at] = (char)('0' + number % 10);
        number /= 10;
    } while (number > 0);
    append(text, room, digits + at);
}

void append_hex(char *text, size_t room, uint64_t number)
{
    char digits[17];
    digits[16] = '\0';
    for (int i = 15; i >= 0; i--, number >>= 4)
        digits[i] = "0123456789abcdef"[number & 15];
    append(text, room, digits);
}

void digest_line(void (*say)(const char *line), const char *name, uint64_t digest, uint64_t count)
{
    char line[LINE_MAX] = "";
    append(line, sizeof line, name);
    append(line, sizeof line, " ");
    append_hex(line, sizeof line, digest);
    append(line, sizeof line, " ");
    append_number(line, sizeof line, count);
    say(line);
}
