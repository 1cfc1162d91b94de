/* SPDX-License-Identifier: MIT */
/* text.c: text of digests, without a C library. */
#include "text.h"

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
