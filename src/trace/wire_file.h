/* SPDX-License-Identifier: MIT */
/* wire_file.h: a file that takes down what passes on the wires: FILE.log for people, FILE.pcapng for Wireshark. The name chooses
 * the format. docs/WIRE.md describes both. */
#ifndef RKM04_TRACE_WIRE_FILE_H
#define RKM04_TRACE_WIRE_FILE_H

#include "file/file.h"
#include "sim/sim.h"

#define WIRE_FILE_EXPECTED "a name that ends with .log or .pcapng"

struct wire_file;

/* Does the name end with one of WIRE_FILE_EXPECTED? */
bool wire_file_named(const char *path);

/* The kind of file that it makes; `path`: so named. */
const struct output_kind *wire_file_kind(const char *path);

/* Open `path`, with `flags` of output_file_open(), and begin to watch. Returns NULL if it did not work; *error is what to say
 * then ("cannot write FILE: …"), to be freed, or NULL if out of memory. */
struct wire_file *wire_file_begin(struct sim *sim, const char *path, unsigned flags, char **error);

/* 0, or the errno with which writing has failed. Nothing is written after the first failure. */
int wire_file_failed(const struct wire_file *file);

/* Take down what is incomplete, and close. Returns 0 or the errno of the first failure. */
int wire_file_end(struct wire_file *file);

#endif
