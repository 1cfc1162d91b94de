/* SPDX-License-Identifier: MIT */
#include "invisible.h"

#include <stdio.h>
#include <string.h>

const char *invisible_name(const char *text, size_t bytes)
{
    static const struct {
        const char *bytes, *name;
    } invisible[] = {
        {"\xC2\xA0", "a no-break space (U+00A0)"},
        {"\xC2\xAD", "a soft hyphen (U+00AD)"},
        {"\xE2\x80\x83", "an em space (U+2003)"},
        {"\xE2\x80\x82", "an en space (U+2002)"},
        {"\xE2\x80\x87", "a figure space (U+2007)"},
        {"\xE2\x80\x89", "a thin space (U+2009)"},
        {"\xE2\x80\x8B", "a zero-width space (U+200B)"},
        {"\xE2\x80\x8C", "a zero-width non-joiner (U+200C)"},
        {"\xE2\x80\x8D", "a zero-width joiner (U+200D)"},
        {"\xE2\x80\x8E", "a left-to-right mark (U+200E)"},
        {"\xE2\x80\x8F", "a right-to-left mark (U+200F)"},
        {"\xE2\x80\xA8", "a line separator (U+2028)"},
        {"\xE2\x80\xA9", "a paragraph separator (U+2029)"},
        {"\xE2\x80\xAF", "a narrow no-break space (U+202F)"},
        {"\xE2\x81\xA0", "a word joiner (U+2060)"},
        {"\xE3\x80\x80", "an ideographic space (U+3000)"},
        {"\xEF\xBB\xBF", "a byte order mark (U+FEFF)"},
    };
    for (size_t i = 0; i < sizeof invisible / sizeof invisible[0]; i++)
        if (strlen(invisible[i].bytes) == bytes && memcmp(invisible[i].bytes, text, bytes) == 0)
            return invisible[i].name;
    return NULL;
}

void invisible_note(char *text, size_t size)
{
    size_t length = strlen(text);
    if (strstr(text, "(U+"))
        return; /* it is named already */
    for (size_t at = 0; at < length; at++)
        for (size_t bytes = 2; bytes <= 3 && at + bytes <= length; bytes++) {
            const char *name = invisible_name(text + at, bytes);
            if (!name)
                continue;
            snprintf(text + length, size - length, "; there is %s in it", name);
            return;
        }
}
