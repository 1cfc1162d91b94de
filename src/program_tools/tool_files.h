/* SPDX-License-Identifier: MIT */
/* tool_files.h: the program texts of a command line. */
#ifndef RKM04_PROGRAM_TOOLS_TOOL_FILES_H
#define RKM04_PROGRAM_TOOLS_TOOL_FILES_H

#include <argp.h>
#include <stdbool.h>

#include <rkm04/readings.h>

#include "diagnostic.h"
#include "text/text.h"

struct tool_file {
    const char *path;         /* "-": standard input */
    bool has_motor;           /* it was given as M=FILE */
    struct program_text text;
    struct program_source source; /* once it has been read */
};

struct tool_files {
    struct tool_file *list;
    size_t count;
    bool stdin_taken;
};

/* Room for as many files as there are arguments. Ends the program with status 1 if out of memory. */
void tool_files_begin(struct tool_files *files, int argc);
void tool_files_end(struct tool_files *files);

/* Take an argument [M=]FILE. What is wrong is a usage error. */
void tool_files_add(struct tool_files *files, const char *argument, struct argp_state *state);

/* Read a file. Returns false if that is not possible, which is reported as by `program` ("rkm04 check"). */
bool tool_file_read(struct tool_file *file, const char *program);

/* Report on stderr what a unit with these readings would refuse in sources that belong together. Returns whether there is
 * nothing. */
bool tool_check_errors(const struct program_source *sources, size_t count, const struct rkm04_readings *readings);

/* Give back the text. */
void tool_file_free(struct tool_file *file);

#endif
