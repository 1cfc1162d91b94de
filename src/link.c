/* SPDX-License-Identifier: MIT */
/* link.c: the table of framings. A new framing adds its file and its row here. */
#include <rkm04/link.h>

const struct rkm04_framing *const rkm04_framings[] = {
    &rkm04_hdlc,
    &rkm04_plain,
    NULL,
};

static bool same(const char *a, const char *b)
{
    while (*a != '\0' && *a == *b) {
        a++;
        b++;
    }
    return *a == *b;
}

const struct rkm04_framing *rkm04_framing_named(const char *name)
{
    for (const struct rkm04_framing *const *framing = rkm04_framings; *framing != NULL; framing++) {
        if (same((*framing)->name, name))
            return *framing;
    }
    return NULL;
}
