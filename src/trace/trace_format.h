/* SPDX-License-Identifier: MIT */
/* trace_format.h: the formats of traces, each with a file of its own, trace_NAME.c. A new one has a row here and its ending in
 * text/trace_names.h. */
#ifndef RKM04_TRACE_FORMAT_H
#define RKM04_TRACE_FORMAT_H

/* FORMAT(name of the enum, name of the writer) */
#define TRACE_FORMATS_LIST(FORMAT) FORMAT(CSV, csv) FORMAT(VCD, vcd) FORMAT(JSONL, jsonl)

#define TRACE_FORMAT_NUMBER(name, writer) TRACE_##name,
#define TRACE_FORMAT_WRITER(name, writer) extern const struct trace_writer trace_##writer;
#define TRACE_FORMAT_ROW(name, writer) [TRACE_##name] = &trace_##writer,

enum trace_format { TRACE_FORMATS_LIST(TRACE_FORMAT_NUMBER) TRACE_FORMATS };

TRACE_FORMATS_LIST(TRACE_FORMAT_WRITER)

#endif
