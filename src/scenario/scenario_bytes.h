/* SPDX-License-Identifier: MIT */
/* scenario_bytes.h: bytes as people write them in scenarios: pairs of hexadecimal digits and texts in double quotes, '04 "1"'.
 * In what is expected, `..` is any byte and `*` at the end any rest. */
#ifndef RKM04_SCENARIO_BYTES_H
#define RKM04_SCENARIO_BYTES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

struct scenario_bytes {
    size_t length;
    uint8_t *byte;
    bool *any;  /* this one does not matter */
    bool anys;  /* there are such */
    bool rest;  /* any number of bytes may follow */
};

/* Read all of a text. Returns NULL, or a phrase for "expected …"; bytes is to be freed in either case. */
const char *scenario_bytes_read(struct scenario_bytes *bytes, const char *text);
void scenario_bytes_free(struct scenario_bytes *bytes);

/* Are these the bytes? */
bool scenario_bytes_match(const struct scenario_bytes *bytes, const uint8_t *byte, size_t length);

/* Write them in the same notation. */
void scenario_bytes_print(FILE *out, const struct scenario_bytes *bytes);

#endif
