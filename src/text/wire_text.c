/* SPDX-License-Identifier: MIT */
#include "wire_text.h"

static const char hex[] = "0123456789ABCDEF";

void wire_text_put(struct wire_text *out, char character)
{
    if (out->length < out->room)
        out->text[out->length++] = character;
}

void wire_text_string(struct wire_text *out, const char *string)
{
    while (*string)
        wire_text_put(out, *string++);
}

void wire_text_number(struct wire_text *out, uint64_t number, unsigned width)
{
    char digits[20];
    unsigned count = 0;
    do {
        digits[count++] = (char)('0' + number % 10u);
        number /= 10u;
    } while (number > 0);
    for (unsigned at = count; at < width; at++)
        wire_text_put(out, ' ');
    while (count > 0)
        wire_text_put(out, digits[--count]);
}

void wire_text_hex(struct wire_text *out, const uint8_t *bytes, size_t length)
{
    for (size_t i = 0; i < length; i++) {
        if (i > 0)
            wire_text_put(out, ' ');
        wire_text_put(out, hex[bytes[i] >> 4]);
        wire_text_put(out, hex[bytes[i] & 0xFu]);
    }
}

void wire_text_bytes(struct wire_text *out, const uint8_t *bytes, size_t length)
{
    for (size_t i = 0; i < length; i++) {
        if (bytes[i] >= ' ' && bytes[i] <= '~') {
            wire_text_put(out, (char)bytes[i]);
            continue;
        }
        wire_text_put(out, '<');
        wire_text_hex(out, &bytes[i], 1);
        wire_text_put(out, '>');
    }
}

const char *wire_text_end(struct wire_text *out)
{
    if (out->room == 0)
        return "";
    if (out->length == out->room)
        out->length--;
    out->text[out->length] = '\0';
    return out->text;
}
