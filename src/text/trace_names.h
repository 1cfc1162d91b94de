/* SPDX-License-Identifier: MIT */
/* trace_names.h: the endings of names of traces and of logs of the wires, as help texts and messages have them: the one place.
 * The formats themselves are those of trace/trace_format.h and trace/wire_format.h. */
#ifndef RKM04_TEXT_TRACE_NAMES_H
#define RKM04_TEXT_TRACE_NAMES_H

#define TRACE_ENDINGS ".vcd, .csv, .jsonl"
#define WIRE_ENDINGS ".log, .pcapng"
#define TRACE_FILE_EXPECTED "a name that ends with .vcd, .csv or .jsonl"
#define TRACE_HELP "FILE.vcd for GTKWave and PulseView, FILE.csv, FILE.jsonl"
#define TRACE_OR_WIRE_EXPECTED "a FILE that ends with " TRACE_ENDINGS ", " WIRE_ENDINGS

#endif
