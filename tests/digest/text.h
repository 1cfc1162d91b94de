/* SPDX-License-Identifier: MIT */
/* text.h: digests and their text, without a C library. */
#ifndef RKM04_TESTS_DIGEST_TEXT_H
#define RKM04_TESTS_DIGEST_TEXT_H

#include <stddef.h>
#include <stdint.h>

/* Append to a zero-terminated text in a buffer of `room` bytes; what has no room is left out. */
void append(char *text, size_t room, const char *more);
void append_number(char *text, size_t room, uint64_t number);
void append_hex(char *text, size_t room, uint64_t number);
size_t text_length(const char *text);

/* Whole numbers only, so that the order of bytes in memory does not matter. */
static inline void mix(uint64_t *digest, uint64_t word)
{
    *digest = (*digest ^ word) * UINT64_C(0x9E3779B97F4A7C15);
    *digest ^= *digest >> 32;
}

/* Say "NAME DIGEST COUNT". */
void digest_line(void (*say)(const char *line), const char *name, uint64_t digest, uint64_t count);

#endif
