/* SPDX-License-Identifier: MIT */
#include "wire_words.h"

void wire_words_message(struct wire_text *out, const struct device_words *words, const uint8_t *message, size_t length,
                        bool answer)
{
    if (length == 0)
        wire_text_string(out, "empty message");
    else if (words && words->message)
        words->message(out, message, length, answer);
    else
        wire_text_hex(out, message, length);
}

/* ---- Around a message ----------------------------------------------------------------------------------------------- */

static void put_senders(struct wire_text *out, const struct wire_names *names, uint32_t senders)
{
    bool first = true;
    for (unsigned station = 0; station <= SEGMENT_UNITS; station++) {
        if ((senders >> station & 1u) == 0)
            continue;
        if (!first)
            wire_text_put(out, '+');
        first = false;
        wire_text_string(out, station == 0 ? "master" : names->unit[station - 1u]);
    }
    if (first)
        wire_text_put(out, '?');
}

void wire_words_direction(struct wire_text *out, const struct wire_names *names, const struct wire_message *message)
{
    put_senders(out, names, message->senders);
    if (message->dropped)
        return;
    if (message->answer) {
        bool named = names->framing->link->answer_names_sender && message->dnode != 0;
        wire_text_string(out, " > ");
        if (named)
            wire_text_number(out, message->dnode, 0);
        else
            wire_text_string(out, "master");
        return;
    }
    if (message->snode != 0) {
        wire_text_string(out, " as ");
        wire_text_number(out, message->snode, 0);
    }
    wire_text_string(out, " > ");
    if (message->dnode == 0)
        wire_text_string(out, "all");
    else
        wire_text_number(out, message->dnode, 0);
}

static void put_reason(struct wire_text *out, const char *what, const char *why)
{
    if (!why)
        return;
    wire_text_string(out, "; ");
    wire_text_string(out, what);
    wire_text_string(out, why);
}

void wire_words_story(struct wire_text *out, const struct wire_names *names, const struct wire_message *message)
{
    if (message->dropped) {
        wire_text_string(out, message->fate == WIRE_UNFINISHED ? "" : "dropped: "); /* that may have succeeded */
        wire_text_string(out, message->dropped);
    } else {
        wire_words_message(out, names->words, message->message, message->length, message->answer);
    }
    put_reason(out, "refused: ", message->refused);
    put_reason(out, "ignored: ", message->ignored);
    if (message->lost > 0) {
        wire_text_string(out, "; lost to framing errors: ");
        wire_text_number(out, message->lost, 0);
        wire_text_string(out, message->lost == 1 ? " byte" : " bytes");
    }
    if (message->collided != 0) {
        wire_text_string(out, "; collision: ");
        put_senders(out, names, message->collided);
    }
}
