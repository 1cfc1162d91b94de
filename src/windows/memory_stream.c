/* SPDX-License-Identifier: MIT */
/* memory_stream.c: streams in memory. The C library of Windows has none: each is a temporary file, whose bytes are fetched when
 * the stream is flushed or closed. Files are used again, as many streams are short. */
#include <errno.h>
#include <stdbool.h>
#include <windows.h>

#undef fclose
#undef fflush

struct stream {
    FILE *file;
    bool open;
    char **text; /* open_memstream() */
    size_t *length;
    char *bytes; /* fmemopen() for writing; NULL: neither is written back */
    size_t room;
    struct stream *next;
};

static struct stream *streams;
static SRWLOCK lock = SRWLOCK_INIT; /* of the list, and of what is open: Python has several threads */

static struct stream *find(const FILE *file)
{
    AcquireSRWLockShared(&lock);
    struct stream *stream = streams;
    while (stream && !(stream->open && stream->file == file))
        stream = stream->next;
    ReleaseSRWLockShared(&lock);
    return stream;
}

static struct stream *take_free(void)
{
    struct stream *stream = streams;
    while (stream && stream->open)
        stream = stream->next;
    if (!stream) {
        stream = calloc(1, sizeof *stream);
        if (stream && !(stream->file = tmpfile())) {
            free(stream);
            stream = NULL;
        }
        if (!stream)
            return NULL;
        stream->next = streams;
        streams = stream;
    }
    rewind(stream->file);
    *stream = (struct stream){.file = stream->file, .open = true, .next = stream->next};
    return stream;
}

/* A stream on an empty file. Returns NULL if there is none. */
static struct stream *begin(void)
{
    AcquireSRWLockExclusive(&lock);
    struct stream *stream = take_free();
    ReleaseSRWLockExclusive(&lock);
    return stream;
}

/* What has been written. The place for the next byte is behind it. */
static size_t fetch(struct stream *stream, char *to, size_t room)
{
    long end = ftell(stream->file);
    size_t length = end > 0 ? (size_t)end : 0, wanted = length < room ? length : room;
    rewind(stream->file);
    size_t got = fread(to, 1, wanted, stream->file);
    fseek(stream->file, end, SEEK_SET);
    return got;
}

static bool deliver(struct stream *stream)
{
    if (stream->bytes) {
        size_t got = fetch(stream, stream->bytes, stream->room);
        if (got < stream->room)
            stream->bytes[got] = '\0';
        return true;
    }
    if (!stream->text)
        return true;
    long end = ftell(stream->file);
    char *text = end >= 0 ? realloc(*stream->text, (size_t)end + 1) : NULL;
    if (!text) {
        errno = ENOMEM;
        return false;
    }
    *stream->length = fetch(stream, text, (size_t)end);
    text[*stream->length] = '\0';
    *stream->text = text;
    return true;
}

FILE *open_memstream(char **text, size_t *length)
{
    struct stream *stream = begin();
    if (!stream)
        return NULL;
    *text = NULL;
    *length = 0;
    stream->text = text;
    stream->length = length;
    return stream->file;
}

/* For reading ("r") and for writing ("w"). */
FILE *fmemopen(void *bytes, size_t length, const char *mode)
{
    struct stream *stream;
    if (mode[0] == 'r') { /* a file of its own, which ends where the bytes end */
        FILE *file = tmpfile();
        if (file && fwrite(bytes, 1, length, file) == length)
            rewind(file);
        return file;
    }
    stream = begin();
    if (!stream)
        return NULL;
    stream->bytes = bytes;
    stream->room = length;
    return stream->file;
}

int windows_fflush(FILE *file)
{
    struct stream *stream = file ? find(file) : NULL;
    if (stream)
        return deliver(stream) ? 0 : EOF;
    return fflush(file);
}

int windows_fclose(FILE *file)
{
    struct stream *stream = find(file);
    if (!stream)
        return fclose(file);
    bool delivered = deliver(stream);
    AcquireSRWLockExclusive(&lock);
    stream->open = false;
    ReleaseSRWLockExclusive(&lock);
    return delivered ? 0 : EOF;
}
