/* SPDX-License-Identifier: MIT */
/* text.h: text of digests, without a C library. */
#ifndef RKM04_TESTS_DIGEST_TEXT_H
#define RKM04_TESTS_DIGEST_TEXT_H

#include <stddef.h>
#include <stdint.h>

/* Append to a zero-terminated text in a buffer of `room` bytes; what has no room is left out. */
void append(char *text, size_t room, const char *more);
void append_number(char *text, size_t room, uint64_t number);
void append_hex(char *text, size_t room, uint64_t number);
size_t text_length(const char *text);

#endif
