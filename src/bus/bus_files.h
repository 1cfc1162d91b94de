/* SPDX-License-Identifier: MIT */
/* bus_files.h: what is written down about a line: traces, logs of the wires, a record. */
#ifndef RKM04_HOST_BUS_FILES_H
#define RKM04_HOST_BUS_FILES_H

#include <stdbool.h>
#include <stdio.h>

#include "record/record.h"
#include "bus_options.h"
#include "trace/trace.h"

struct bus;

struct bus_files {
    struct trace_file *trace[BUS_FILES_MAX];
    struct wire_file *wire[BUS_FILES_MAX];
    FILE *record_stream;
    struct record *record; /* NULL: none */
    bool failed;           /* one could not be written (reported) */
};

/* Open what the options ask for. Failures are reported. Returns false if it did not work. */
bool bus_files_begin(struct bus *bus);

/* Write out what has gathered, so that little is lost if the process is killed. One that could not be written is reported,
 * once, and given up. */
void bus_files_look(struct bus *bus);

/* Close them all. Returns false if one could not be written (reported). */
bool bus_files_end(struct bus *bus);

#endif
