/* SPDX-License-Identifier: MIT */
/* trace_file.h: a file that takes down what happens on a line: FILE.vcd for GTKWave and PulseView, FILE.csv, FILE.jsonl. The name
 * chooses the format; docs/TRACES.md describes them. */
#ifndef RKM04_TRACE_FILE_H
#define RKM04_TRACE_FILE_H

#include <stdio.h>

#include "file/file.h"
#include "sim/sim.h"
#include "trace_format.h"

struct trace_file;

/* Does the name end with one of TRACE_FILE_EXPECTED? */
bool trace_file_named(const char *path);

/* The format that a name chooses; TRACE_FORMATS: none. */
enum trace_format trace_file_format(const char *path);

/* The kind of file that it makes; `format`: not TRACE_FORMATS. */
const struct output_kind *trace_file_kind(enum trace_format format);

/* Open `path`, "-" is not allowed, with `flags` of output_file_open(), and begin to watch; what there is now is its beginning.
 * Returns NULL if it did not work; *error is what to say then ("cannot write FILE: …"), to be freed; NULL: out of memory. */
struct trace_file *trace_file_begin(struct sim *sim, const char *path, unsigned flags, char **error);

/* The same on a stream, which stays the caller's. Returns NULL if out of memory. */
struct trace_file *trace_file_begin_on(struct sim *sim, FILE *out, enum trace_format format);

/* 0, or the errno with which writing has failed. Nothing is written after the first failure. */
int trace_file_failed(const struct trace_file *file);

/* Write out what has been gathered up to now, for those who read along. */
void trace_file_flush(struct trace_file *file);

/* Write what is left at the present tick, leave the sim, and close. Returns 0 or the errno of the first failure. */
int trace_file_end(struct trace_file *file);

#endif
