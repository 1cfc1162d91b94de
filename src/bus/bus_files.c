/* SPDX-License-Identifier: MIT */
#include "bus_files.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "file/file.h"
#include "line/line.h"

/* The name for this line; NULL: too long (reported). */
static const char *path_of(unsigned number, const char *pattern, char path[PATH_MAX])
{
    if (name_expand(pattern, NULL, number, path))
        return path;
    log_error("%s: the path is too long", pattern);
    return NULL;
}

/* Report why a file could not be written; `error` is an errno. Returns true if it could. */
static bool check_written(const char *path, int error)
{
    if (error != 0)
        log_error("cannot write %s: %s", path, strerror(error));
    return error == 0;
}

static bool report_error(char *error)
{
    log_error("%s", error ? error : "out of memory");
    free(error);
    return false;
}

static bool reserve(const struct bus_options *options, unsigned number, const char *pattern, const struct output_kind *kind)
{
    char path[PATH_MAX], *why;
    if (!path_of(number, pattern, path))
        return false;
    if (output_file_reserve(path, kind, options->output_flags, &why))
        return true;
    log_error("cannot write %s: %s", path, why ? why : strerror(ENOMEM));
    free(why);
    return false;
}

bool bus_files_reserve(const struct bus_options *options, unsigned number)
{
    if (options->record && !reserve(options, number, options->record, &output_recording))
        return false;
    for (unsigned i = 0; i < BUS_FILES_MAX && options->trace[i]; i++)
        if (!reserve(options, number, options->trace[i], trace_file_kind(trace_file_format(options->trace[i]))))
            return false;
    for (unsigned i = 0; i < BUS_FILES_MAX && options->wire[i]; i++)
        if (!reserve(options, number, options->wire[i], wire_file_kind(options->wire[i])))
            return false;
    return true;
}

static bool begin_record(struct bus_files *files)
{
    char path[PATH_MAX], *why;
    if (!files->options->record)
        return true;
    if (!path_of(files->number, files->options->record, path))
        return false;
    files->record_stream = output_file_open(path, &output_recording, files->options->output_flags, &why);
    if (!files->record_stream) {
        log_error("cannot write %s: %s", path, why ? why : strerror(ENOMEM));
        free(why);
        return false;
    }
    files->record = record_begin(files->sim, files->record_stream);
    return files->record || report_error(NULL);
}

bool bus_files_begin(struct bus_files *files, const struct bus_options *options, unsigned number, struct sim *sim)
{
    files->options = options;
    files->number = number;
    files->sim = sim;
    char path[PATH_MAX], *error = NULL;
    if (!begin_record(files))
        return false;
    for (unsigned i = 0; i < BUS_FILES_MAX && options->trace[i]; i++) {
        if (!path_of(files->number, options->trace[i], path))
            return false;
        files->trace[i] = trace_file_begin(files->sim, path, options->output_flags, &error);
        if (!files->trace[i])
            return report_error(error);
    }
    for (unsigned i = 0; i < BUS_FILES_MAX && options->wire[i]; i++) {
        if (!path_of(files->number, options->wire[i], path))
            return false;
        files->wire[i] = wire_file_begin(files->sim, path, options->output_flags, &error);
        if (!files->wire[i])
            return report_error(error);
    }
    return true;
}

void bus_files_flush(struct bus_files *files)
{
    const struct bus_options *options = files->options;
    for (unsigned i = 0; i < BUS_FILES_MAX; i++) {
        if (files->trace[i] && trace_file_failed(files->trace[i]) != 0) {
            check_written(options->trace[i], trace_file_end(files->trace[i]));
            files->trace[i] = NULL;
            files->failed = true;
        }
        if (files->wire[i] && wire_file_failed(files->wire[i]) != 0) {
            check_written(options->wire[i], wire_file_end(files->wire[i]));
            files->wire[i] = NULL;
            files->failed = true;
        }
        if (files->trace[i])
            trace_file_flush(files->trace[i]);
    }
    if (files->record && record_failed(files->record) != 0) {
        check_written(options->record, record_end(files->record));
        output_file_close(files->record_stream); /* what is wrong with it is reported */
        files->record = NULL;
        files->record_stream = NULL;
        files->failed = true;
    }
}

bool bus_files_end(struct bus_files *files)
{
    const struct bus_options *options = files->options;
    bool ok = !files->failed;
    for (unsigned i = 0; i < BUS_FILES_MAX; i++) {
        if (files->trace[i])
            ok = check_written(options->trace[i], trace_file_end(files->trace[i])) && ok;
        if (files->wire[i])
            ok = check_written(options->wire[i], wire_file_end(files->wire[i])) && ok;
        files->trace[i] = NULL;
        files->wire[i] = NULL;
    }
    if (files->record)
        ok = check_written(options->record, record_end(files->record)) && ok;
    if (files->record_stream && output_file_close(files->record_stream) != 0)
        ok = check_written(options->record, errno);
    files->record = NULL;
    files->record_stream = NULL;
    return ok;
}
