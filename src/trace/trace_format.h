/* SPDX-License-Identifier: MIT */
/* trace_format.h: the formats of traces, each with a file of its own, trace_NAME.c. A new one has a place in each list here
 * and a row in the table of trace_file.c. */
#ifndef RKM04_TRACE_FORMAT_H
#define RKM04_TRACE_FORMAT_H

#define TRACE_FILE_EXPECTED "a name that ends with .vcd, .csv or .jsonl"

enum trace_format { TRACE_CSV, TRACE_VCD, TRACE_JSONL, TRACE_FORMATS };

extern const struct trace_writer trace_csv, trace_vcd, trace_jsonl;

#endif
