/* SPDX-License-Identifier: MIT */
/* wire_words.h: messages in words, for people. */
#ifndef RKM04_WIRE_WORDS_H
#define RKM04_WIRE_WORDS_H

#include "segment.h"
#include "text/text.h"
#include "wire_message.h"

#define WIRE_WORDS_MAX (4u * WIRE_ANSWER_MAX + 512u) /* characters of the longest description, with names and reasons */

/* What the units are called. */
struct wire_names {
    const char *unit[SEGMENT_UNITS];
    const struct device_framing *framing; /* do answers name their sender? */
    const struct device_words *words;     /* of messages; NULL: bytes */
};

/* A whole message in the words of its device, as in `2 Set Command m1 "\C100 F5000 R"`; without words its bytes. */
void wire_words_message(struct wire_text *out, const struct device_words *words, const uint8_t *message, size_t length,
                        bool answer);

/* Who sends, and to whom: "master > 3", "3 > master", "master > all". Units by their names. */
void wire_words_direction(struct wire_text *out, const struct wire_names *names, const struct wire_message *message);

/* The message in words, then why it was dropped, refused or ignored, and what has happened to it on the wires. */
void wire_words_story(struct wire_text *out, const struct wire_names *names, const struct wire_message *message);

#endif
