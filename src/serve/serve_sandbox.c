/* SPDX-License-Identifier: MIT */
#include "serve_sandbox.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "line/line.h"
#include "sandbox.h"

/* A name in which %l and %n may be, also in that of the folder. */
static void allow_pattern(struct sandbox *sandbox, const struct bus_options *options, const char *pattern)
{
    char path[PATH_MAX], name[NODE_NAME_SIZE];
    unsigned lines = pattern && name_pattern_has(pattern, 'l') ? options->lines : 1;
    unsigned units = pattern && name_pattern_has(pattern, 'n') ? options->nodes.count : 1;
    for (unsigned line = 0; pattern && line < lines; line++) {
        for (unsigned at = 0; at < units; at++) {
            node_list_name(&options->nodes, at, name);
            if (name_expand(pattern, name, line, path))
                sandbox_allow_beside(sandbox, path);
        }
    }
}

static bool is_same(const struct stat *a, const char *path)
{
    struct stat b;
    return path && stat(path, &b) == 0 && a->st_dev == b.st_dev && a->st_ino == b.st_ino;
}

/* Where control clients mostly want their files; but not everything, and not all that a user has. */
static void allow_working_directory(struct sandbox *sandbox)
{
    struct stat here;
    if (stat(".", &here) == 0 && !is_same(&here, "/") && !is_same(&here, getenv("HOME")))
        sandbox_allow(sandbox, ".");
}

static void report(const char *what)
{
    if (errno != ENOSYS && errno != EOPNOTSUPP)
        log_error("continuing without confinement of %s: %s", what, strerror(errno));
    else
        log_at(0, "this kernel does not confine %s", what);
}

void serve_sandbox_files(const struct bus_options *options, struct bus *const *buses, const char *control)
{
    struct sandbox sandbox;
    if (options->no_sandbox)
        return;
    sandbox_begin(&sandbox);
    allow_pattern(&sandbox, options, options->flash);
    allow_pattern(&sandbox, options, options->record);
    for (unsigned i = 0; i < BUS_FILES_MAX; i++) {
        allow_pattern(&sandbox, options, options->trace[i]);
        allow_pattern(&sandbox, options, options->wire[i]);
    }
    if (options->plant)
        sandbox_allow_beside(&sandbox, options->plant);
    if (options->coverage)
        sandbox_allow_beside(&sandbox, options->coverage);
    if (control)
        sandbox_allow_beside(&sandbox, control);
    for (unsigned i = 0; options->pty && i < options->lines; i++)
        sandbox_allow_beside(&sandbox, buses[i]->ports.pty.link.path);
    if (options->wine)
        sandbox_allow_beside(&sandbox, buses[0]->ports.pty.wine.path);
    for (unsigned i = 0; i < BUS_FOLDERS_MAX && options->folder[i]; i++)
        sandbox_allow(&sandbox, options->folder[i]);
    allow_working_directory(&sandbox);
    if (!sandbox_close_files(&sandbox))
        report("files");
}

void serve_sandbox_calls(const struct bus_options *options)
{
    if (!options->no_sandbox && !sandbox_close_calls())
        report("system calls");
}
