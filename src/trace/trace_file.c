/* SPDX-License-Identifier: MIT */
#include "trace_writer.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "file/file.h"

static const struct trace_writer *const writers[TRACE_FORMATS] = {
    TRACE_FORMATS_LIST(TRACE_FORMAT_ROW)
};

/* ---- Writing -------------------------------------------------------------------------------------------------------- */

static void write_out(struct trace_file *file, const char *text, size_t length)
{
    if (file->error != 0 || length == 0)
        return;
    errno = 0;
    if (fwrite(text, 1, length, file->out) != length)
        file->error = errno != 0 ? errno : EIO;
}

void trace_empty(struct trace_file *file)
{
    write_out(file, file->buffer, file->length);
    file->length = 0;
}

void trace_put(struct trace_file *file, const char *text, size_t length)
{
    if (length > TRACE_BUFFER) {
        trace_empty(file);
        write_out(file, text, length);
        return;
    }
    char *at = trace_room(file, length);
    memcpy(at, text, length);
    trace_wrote(file, at + length);
}

int trace_file_failed(const struct trace_file *file)
{
    return file->error;
}

void trace_file_flush(struct trace_file *file)
{
    trace_empty(file);
    errno = 0;
    if (fflush(file->out) != 0 && file->error == 0)
        file->error = errno != 0 ? errno : EIO;
}

/* ---- Begin and end -------------------------------------------------------------------------------------------------- */

enum trace_format trace_file_format(const char *path)
{
    size_t length = strlen(path);
    for (unsigned format = 0; format < TRACE_FORMATS; format++) {
        size_t suffix = strlen(writers[format]->suffix);
        if (length > suffix && path[length - suffix - 1u] != '/' && strcmp(path + length - suffix, writers[format]->suffix) == 0)
            return (enum trace_format)format;
    }
    return TRACE_FORMATS;
}

const struct output_kind *trace_file_kind(enum trace_format format)
{
    return &writers[format]->kind;
}

bool trace_file_named(const char *path)
{
    return trace_file_format(path) != TRACE_FORMATS;
}

/* Watchers that come now do not see what has happened before, also in the present tick. */
static void deliver_past_events(struct sim *sim)
{
    watch_deliver(&sim->watch, sim_now(sim) + 1u);
}

struct trace_file *trace_file_begin_on(struct sim *sim, FILE *out, enum trace_format format)
{
    const struct trace_writer *writer = writers[format];
    struct trace_file *file = malloc(sizeof *file);
    void *state = calloc(1, writer->state > 0 ? writer->state : 1u);
    if (!file || !state) {
        free(file);
        free(state);
        return NULL;
    }
    file->sim = sim;
    file->writer = writer;
    file->watcher = (struct watcher){.kinds = writer->kinds, .on_event = writer->on_event, .context = file};
    file->out = out;
    file->owned = false;
    file->error = 0;
    file->state = state;
    file->length = 0;
    deliver_past_events(sim);
    writer->begin(file);
    sim_watch(sim, &file->watcher);
    return file;
}

static void set_error(char **error, const char *format, const char *path, const char *why)
{
    if (asprintf(error, format, path, why) < 0)
        *error = NULL;
}

struct trace_file *trace_file_begin(struct sim *sim, const char *path, unsigned flags, char **error)
{
    char *why;
    enum trace_format format = trace_file_format(path);
    *error = NULL;
    if (format == TRACE_FORMATS) {
        set_error(error, "%s: expected %s", path, TRACE_FILE_EXPECTED);
        return NULL;
    }
    FILE *out = output_file_open(path, &writers[format]->kind, flags, &why);
    if (!out) {
        set_error(error, "cannot write %s: %s", path, why ? why : strerror(ENOMEM));
        free(why);
        return NULL;
    }
    setvbuf(out, NULL, _IONBF, 0); /* gathered in a buffer already */
    struct trace_file *file = trace_file_begin_on(sim, out, format);
    if (file)
        file->owned = true;
    else
        output_file_close(out);
    return file;
}

int trace_file_end(struct trace_file *file)
{
    deliver_past_events(file->sim);
    sim_unwatch(file->sim, &file->watcher);
    file->writer->end(file);
    trace_file_flush(file);
    int error = file->error;
    errno = 0;
    if (file->owned && output_file_close(file->out) != 0 && error == 0)
        error = errno != 0 ? errno : EIO;
    free(file->state);
    free(file);
    return error;
}
