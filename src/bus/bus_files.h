/* SPDX-License-Identifier: MIT */
/* bus_files.h: what is written down about a line: traces, logs of the wires, a record. */
#ifndef RKM04_BUS_FILES_H
#define RKM04_BUS_FILES_H

#include <stdbool.h>
#include <stdio.h>

#include "bus_options.h"
#include "record/record.h"
#include "sim/sim.h"
#include "trace/trace.h"

struct bus_files {
    const struct bus_options *options;
    unsigned number;       /* of the bus */
    struct sim *sim;
    struct trace_file *trace[BUS_FILES_MAX];
    struct wire_file *wire[BUS_FILES_MAX];
    FILE *record_stream;
    struct record *record; /* NULL: none */
    bool failed;           /* one could not be written (reported) */
};

/* See that the files which the options ask for can be written, before anything is changed (output_file_reserve()). Failures are
 * reported. Returns false if one cannot. */
bool bus_files_reserve(const struct bus_options *options, unsigned number);

/* Open what the options ask for, about bus `number`, which is *sim. Failures are reported. Returns false if it did not work. */
bool bus_files_begin(struct bus_files *files, const struct bus_options *options, unsigned number, struct sim *sim);

/* Write out what has gathered, so that little is lost if the process is killed. One that could not be written is reported,
 * once, and given up. */
void bus_files_flush(struct bus_files *files);

/* Close them all. Returns false if one could not be written (reported). */
bool bus_files_end(struct bus_files *files);

#endif
