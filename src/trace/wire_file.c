/* SPDX-License-Identifier: MIT */
#include "wire_file.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "file/file.h"
#include "wire_format.h"

struct wire_file {
    struct sim *sim;
    const struct wire_format *format;
    FILE *out;
    int error; /* errno; 0: none so far */
    struct watcher watcher;
    char entry[WIRE_ENTRY_MAX];
};

static const struct wire_format *const formats[] = {&wire_log, &wire_pcapng, NULL};

static const struct wire_format *format_of(const char *path)
{
    size_t length = strlen(path);
    for (const struct wire_format *const *format = formats; *format; format++) {
        size_t suffix = strlen((*format)->suffix);
        if (length > suffix && strcmp(path + length - suffix, (*format)->suffix) == 0)
            return *format;
    }
    return NULL;
}

bool wire_file_named(const char *path)
{
    return format_of(path) != NULL;
}

const struct output_kind *wire_file_kind(const char *path)
{
    return &format_of(path)->kind;
}

void wire_news_words(struct wire_text *out, const struct sim *sim, const struct watch_event *event)
{
    if (event->kind == WATCH_POWER) {
        wire_text_string(out, "unit ");
        wire_text_string(out, sim->unit[event->unit - 1u].name);
        wire_text_string(out, event->value ? ": power on" : ": power off");
    } else {
        wire_text_string(out, "fault ");
        wire_text_number(out, (uint64_t)event->value, 0);
        wire_text_string(out, ": ");
        wire_text_string(out, event->text);
    }
}

/* An entry goes out whole and at once: messages are rare for a machine, and a reader wants to see the last one. */
static void write_entry(struct wire_file *file, const struct wire_text *entry)
{
    if (file->error != 0)
        return;
    errno = 0;
    if (fwrite(entry->text, 1, entry->length, file->out) != entry->length || fflush(file->out) != 0)
        file->error = errno != 0 ? errno : EIO;
}

static struct wire_text begin_entry(struct wire_file *file)
{
    return (struct wire_text){.text = file->entry, .room = sizeof file->entry};
}

static void write_message(struct wire_file *file, const struct wire_message *message)
{
    struct wire_text entry = begin_entry(file);
    file->format->message(&entry, file->sim, message);
    write_entry(file, &entry);
}

static void on_event(void *context, const struct watch_event *event)
{
    struct wire_file *file = context;
    if (file->error != 0)
        return;
    if (event->kind == WATCH_MESSAGE) {
        write_message(file, event->message);
        return;
    }
    struct wire_text entry = begin_entry(file);
    file->format->news(&entry, file->sim, event);
    write_entry(file, &entry);
}

struct wire_file *wire_file_begin(struct sim *sim, const char *path, unsigned flags, char **error)
{
    struct wire_file *file = malloc(sizeof *file);
    const struct wire_format *format = format_of(path);
    char *why = NULL;
    FILE *out = file ? output_file_open(path, &format->kind, flags, &why) : NULL;
    if (!out) {
        if (asprintf(error, "cannot write %s: %s", path, why ? why : strerror(ENOMEM)) < 0)
            *error = NULL;
        free(why);
        free(file);
        return NULL;
    }
    file->sim = sim;
    file->format = format;
    file->out = out;
    file->error = 0;
    struct wire_text entry = begin_entry(file);
    file->format->head(&entry, sim);
    write_entry(file, &entry);
    file->watcher = (struct watcher){
        .kinds = WATCH_BIT(WATCH_MESSAGE) | WATCH_BIT(WATCH_POWER) | WATCH_BIT(WATCH_INJECTED),
        .on_event = on_event,
        .context = file,
    };
    sim_watch(sim, &file->watcher);
    return file;
}

int wire_file_failed(const struct wire_file *file)
{
    return file->error;
}

static void write_rest(struct wire_file *file, bool answer)
{
    struct wire_message *message = wire_monitor_rest(&file->sim->monitor, answer);
    if (message)
        write_message(file, message);
    free(message);
}

int wire_file_end(struct wire_file *file)
{
    sim_unwatch(file->sim, &file->watcher);
    write_rest(file, false);
    write_rest(file, true);
    if (output_file_close(file->out) != 0 && file->error == 0)
        file->error = errno;
    int error = file->error;
    free(file);
    return error;
}
