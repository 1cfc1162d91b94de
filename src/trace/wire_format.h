/* SPDX-License-Identifier: MIT */
/* wire_format.h: what the formats of wire_file.h have to do: put what happens into bytes. */
#ifndef RKM04_TRACE_WIRE_FORMAT_H
#define RKM04_TRACE_WIRE_FORMAT_H

#include "file/file.h"
#include "sim/sim.h"
#include "text/text.h"

/* Bytes of the longest entry: a frame in hexadecimal, and in words. */
#define WIRE_ENTRY_MAX 131072u

/* Each function appends to `out`, which has WIRE_ENTRY_MAX bytes of room. */
struct wire_format {
    const char *suffix; /* of the file's name */
    struct output_kind kind;
    void (*head)(struct wire_text *out, const struct sim *sim);
    void (*message)(struct wire_text *out, const struct sim *sim, const struct wire_message *message);
    /* Something else that explains what is seen on the wires: WATCH_POWER, WATCH_INJECTED. */
    void (*news)(struct wire_text *out, const struct sim *sim, const struct watch_event *event);
};

extern const struct wire_format wire_log, wire_pcapng;

/* Such news in words: "unit 3: power off", "fault 2: …". */
void wire_news_words(struct wire_text *out, const struct sim *sim, const struct watch_event *event);

#endif
