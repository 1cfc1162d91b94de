/* SPDX-License-Identifier: MIT */
/* invisible.h: characters that look like nothing or like a blank, as they come along when text is copied from a page. */
#ifndef RKM04_TEXT_INVISIBLE_H
#define RKM04_TEXT_INVISIBLE_H

#include <stddef.h>

/* The name of the UTF-8 character of `bytes` bytes at `text`: "a no-break space (U+00A0)". NULL: it can be seen. */
const char *invisible_name(const char *text, size_t bytes);

/* If what a message of up to `size` - 1 bytes repeats of a text has such a character, append which, as far as there is room. */
void invisible_note(char *text, size_t size);

#endif
