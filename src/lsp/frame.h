/* SPDX-License-Identifier: MIT */
/* frame.h: messages out of a stream of bytes: lines `Name: value`, of which Content-Length counts, an empty line, the message. */
#ifndef RKM04_LSP_FRAME_H
#define RKM04_LSP_FRAME_H

#include <stdbool.h>
#include <stddef.h>

#define FRAME_LENGTH_MAX (32u << 20) /* bytes of a message; a longer one is skipped */
#define FRAME_HEADER_MAX 4096u       /* bytes before it */

enum frame_found {
    FRAME_NONE,     /* more bytes are needed */
    FRAME_MESSAGE,
    FRAME_TOO_LONG, /* a message has been skipped */
    FRAME_BROKEN    /* no header: the stream has no messages any more */
};

/* All zero: no bytes yet. */
struct frame_reader {
    char *bytes;
    size_t length, room; /* bytes there, and room for them */
    size_t taken;        /* of them, handed out */
    size_t skip;         /* bytes of a message too long that are still to come */
};

/* Append bytes. Texts of frame_next() are no longer valid. Returns false if out of memory. */
bool frame_add(struct frame_reader *frames, const char *bytes, size_t length);

/* Take the next message. With FRAME_MESSAGE *text has *length bytes. */
enum frame_found frame_next(struct frame_reader *frames, const char **text, size_t *length);

void frame_end(struct frame_reader *frames);

#endif
