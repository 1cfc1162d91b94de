/* SPDX-License-Identifier: MIT */
/* time_value.h: times as people write them, "250us", "1500ms", "2.5s", to the tick of 1 us. */
#ifndef RKM04_TEXT_TIME_VALUE_H
#define RKM04_TEXT_TIME_VALUE_H

#include <stddef.h>
#include <stdint.h>

#define US_PER_SECOND 1000000u                     /* virtual time is counted in us: ticks of 1 us */
#define TIME_VALUE_MAX UINT64_C(1000000000000000) /* ticks: 10^9 s */
#define TIME_VALUE_RANGE "0 to 10^15 us (10^9 s)"  /* for messages */

/* Read text[0..length) as a time. Exact or refused: more digits than a tick can show are an error.
 * Returns NULL and sets *ticks (0..TIME_VALUE_MAX), or returns what was expected, a phrase for "expected …", and sets
 * *wrong to the offset of the character that did not fit (may be `length`). */
const char *time_value_read(const char *text, size_t length, uint64_t *ticks, size_t *wrong);

#endif
