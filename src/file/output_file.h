/* SPDX-License-Identifier: MIT */
/* output_file.h: one rule for all files that a process writes. It never writes to a file that it also reads or writes otherwise,
 * compared by device and inode, so by whatever name; and a file that is there is overwritten only if it is of the kind to be
 * written (output_kind.h), or by force. Devices, and pipes where they are allowed, are written to as they are. */
#ifndef RKM04_FILE_OUTPUT_FILE_H
#define RKM04_FILE_OUTPUT_FILE_H

#include <stdbool.h>
#include <stdio.h>

#include "output_kind.h"

enum output_flag {
    OUTPUT_FORCE = 1,     /* overwrite a file of another kind, too */
    OUTPUT_MAY_WAIT = 2,  /* pipes are allowed, which may make the caller wait for a reader */
    OUTPUT_KEEP = 4,      /* leave what is in the file until output_file_empty() */
    OUTPUT_REQUESTED = 8, /* by a control client, whose message names its way to force */
};

/* Open `path` for writing from its beginning, making it if it is not there. To be called when all inputs are read and valid.
 * `flags`: of enum output_flag. The stream is to be closed by output_file_close().
 * Returns NULL if it did not work; *why is the reason for a message then, to be freed, NULL if out of memory. */
FILE *output_file_open(const char *path, const struct output_kind *kind, unsigned flags, char **why);

/* Open `path` for an output_file_open() to come, of the same `path` and `kind`, which then cannot refuse it; what is in it stays.
 * So several files are checked before the first of them changes. Returns false if it did not work; *why as above. */
bool output_file_reserve(const char *path, const struct output_kind *kind, unsigned flags, char **why);

/* What was to be written is refused: remove the files that were made for it, and give reserved ones back. */
void output_files_undo(void);

/* Drop what is in a file opened with OUTPUT_KEEP. Returns false if it did not work; errno says why. */
bool output_file_empty(FILE *file);

/* Close it. Returns 0, or EOF if anything could not be written; errno says why, EIO if that was before. */
int output_file_close(FILE *file);

/* Replace the regular file `path`, or make it: what `write` writes takes its place in one step, and only if `write` returned true
 * (else errno says why not). It is written to a file of its own next to it, of a name that was free; if the process is killed
 * meanwhile that may be left. A file that was read may be replaced. Returns false if it did not work: then nothing is
 * changed; *why as above. */
bool output_file_replace(const char *path, const struct output_kind *kind, unsigned flags,
                         bool (*write)(void *context, FILE *out), void *context, char **why);

/* Never write to this file from now on. `path`: "-" for standard input. What is not there and what is no regular file does not
 * count. Returns false if out of memory. */
bool output_file_spare(const char *path);

/* The regular file open at `fd` is written by its owner: as output_file_open() without the kind. output_file_release() comes
 * before it is closed. Returns false if it is used otherwise; *why as above. */
bool output_file_claim(int fd, const char *path, char **why);
void output_file_release(int fd);

/* The claimed file was made by its owner: output_files_undo() removes it. */
void output_file_made(int fd);

#endif
