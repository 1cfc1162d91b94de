/* SPDX-License-Identifier: MIT */
/* trace_writer.h: what the formats of traces share (trace_file.h). Text is gathered in a buffer; a format asks for room, writes,
 * and says how far it came. */
#ifndef RKM04_TRACE_WRITER_H
#define RKM04_TRACE_WRITER_H

#include "trace_file.h"

#define TRACE_BUFFER 131072u /* characters: more than the longest message makes */

struct trace_writer {
    const char *suffix;      /* of the file's name */
    struct output_kind kind; /* of file */
    uint32_t kinds; /* WATCH_BIT()s of what the format shows */
    size_t state;   /* size of what it remembers, zeroed at the beginning */
    void (*begin)(struct trace_file *file);
    void (*on_event)(void *file, const struct watch_event *event);
    void (*end)(struct trace_file *file);
};

struct trace_file {
    struct sim *sim;
    const struct trace_writer *writer;
    struct watcher watcher;
    FILE *out;
    bool owned; /* `out` is to be closed */
    int error;  /* errno of the first failure; 0: none */
    void *state;
    size_t length;
    char buffer[TRACE_BUFFER];
};

/* Write out what is in the buffer. */
void trace_empty(struct trace_file *file);

/* Where to write up to `room` <= TRACE_BUFFER characters. */
static inline char *trace_room(struct trace_file *file, size_t room)
{
    if (room > TRACE_BUFFER - file->length)
        trace_empty(file);
    return file->buffer + file->length;
}

/* They end at `end`, not included. */
static inline void trace_wrote(struct trace_file *file, const char *end)
{
    file->length = (size_t)(end - file->buffer);
}

/* Text of any length. */
void trace_put(struct trace_file *file, const char *text, size_t length);

#endif
