/* SPDX-License-Identifier: MIT */
/* wire_text.h: text of limited length, put together piece by piece. What does not fit is left out. */
#ifndef RKM04_TEXT_WIRE_TEXT_H
#define RKM04_TEXT_WIRE_TEXT_H

#include <stddef.h>
#include <stdint.h>

/* text[0..length) is what there is; without a terminating zero until wire_text_end(). */
struct wire_text {
    char *text;
    size_t length, room;
};

void wire_text_put(struct wire_text *out, char character);
void wire_text_string(struct wire_text *out, const char *string);

/* Decimal, right-aligned with blanks to `width` characters at least. */
void wire_text_number(struct wire_text *out, uint64_t number, unsigned width);

/* "7E 03 00": with blanks between them. */
void wire_text_hex(struct wire_text *out, const uint8_t *bytes, size_t length);

/* Bytes as characters; those that cannot be seen, and those above 7E, as <0A>. */
void wire_text_bytes(struct wire_text *out, const uint8_t *bytes, size_t length);

/* Terminate it: the last character is lost if there is no room for the zero. Returns the text. */
const char *wire_text_end(struct wire_text *out);

#endif
