/* SPDX-License-Identifier: MIT */
#include "frame.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define DIGITS_MAX 15u /* of a Content-Length */

bool frame_add(struct frame_reader *frames, const char *bytes, size_t length)
{
    if (frames->taken > 0) {
        frames->length -= frames->taken;
        memmove(frames->bytes, frames->bytes + frames->taken, frames->length);
        frames->taken = 0;
    }
    const size_t skipped = frames->skip < length ? frames->skip : length;
    frames->skip -= skipped;
    bytes += skipped;
    length -= skipped;
    if (length == 0)
        return true;
    if (frames->length + length > frames->room) {
        const size_t room = 2 * (frames->length + length);
        char *grown = realloc(frames->bytes, room);
        if (grown == NULL)
            return false;
        frames->bytes = grown;
        frames->room = room;
    }
    memcpy(frames->bytes + frames->length, bytes, length);
    frames->length += length;
    return true;
}

/* The value of a header line if it is Content-Length. */
static bool read_length(const char *line, size_t length, size_t *value)
{
    static const char name[] = "Content-Length:";
    const size_t begin = sizeof name - 1;
    size_t at = begin, digits = 0;
    if (length < begin || strncasecmp(line, name, begin) != 0)
        return false;
    while (at < length && line[at] == ' ')
        at++;
    for (*value = 0; at < length && line[at] >= '0' && line[at] <= '9' && digits < DIGITS_MAX; at++, digits++)
        *value = 10 * *value + (size_t)(line[at] - '0');
    return digits > 0 && at == length;
}

/* Read the header at `text`. Returns its bytes, 0: it is not complete. *value: the length, SIZE_MAX: it has none. */
static size_t read_header(const char *text, size_t length, size_t *value)
{
    size_t begin = 0;
    *value = SIZE_MAX;
    for (;;) {
        const char *end = memmem(text + begin, length - begin, "\r\n", 2);
        if (end == NULL)
            return 0;
        const size_t line = (size_t)(end - (text + begin));
        size_t found;
        if (line == 0)
            return begin + 2;
        if (read_length(text + begin, line, &found))
            *value = found;
        begin += line + 2;
    }
}

enum frame_found frame_next(struct frame_reader *frames, const char **text, size_t *length)
{
    const char *begin = frames->bytes + frames->taken;
    const size_t left = frames->length - frames->taken;
    size_t value;
    if (left == 0)
        return FRAME_NONE;
    const size_t header = read_header(begin, left < FRAME_HEADER_MAX ? left : FRAME_HEADER_MAX, &value);
    if (header == 0)
        return left < FRAME_HEADER_MAX ? FRAME_NONE : FRAME_BROKEN;
    if (value == SIZE_MAX)
        return FRAME_BROKEN;
    if (value > FRAME_LENGTH_MAX) {
        const size_t there = value < left - header ? value : left - header;
        frames->taken += header + there;
        frames->skip = value - there;
        return FRAME_TOO_LONG;
    }
    if (value > left - header)
        return FRAME_NONE;
    *text = begin + header;
    *length = value;
    frames->taken += header + value;
    return FRAME_MESSAGE;
}

void frame_end(struct frame_reader *frames)
{
    free(frames->bytes);
    *frames = (struct frame_reader){0};
}
