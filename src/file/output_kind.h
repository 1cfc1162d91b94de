/* SPDX-License-Identifier: MIT */
/* output_kind.h: the kinds of files that are written, and how they are recognised by their first bytes. Pure. */
#ifndef RKM04_FILE_OUTPUT_KIND_H
#define RKM04_FILE_OUTPUT_KIND_H

#include <stdbool.h>
#include <stddef.h>

/* A kind shows in the first bytes of a file, at most so many. */
#define OUTPUT_KIND_BYTES 1024u

enum output_kind {
    OUTPUT_CSV,           /* --trace */
    OUTPUT_VCD,
    OUTPUT_JSONL,
    OUTPUT_WIRE_LOG,      /* --wire */
    OUTPUT_PCAPNG,
    OUTPUT_RECORDING,     /* --record, `snapshot` with `file`, what `rkm04 test` keeps of a failure */
    OUTPUT_JUNIT,         /* --junit */
    OUTPUT_COVERAGE,      /* --coverage, the text */
    OUTPUT_COVERAGE_JSON,
    OUTPUT_KINDS
};

/* "a CSV trace", … */
const char *output_kind_name(enum output_kind kind);

/* Can a file that begins with these bytes be of that kind? `length`: those of the whole file, at most OUTPUT_KIND_BYTES. An empty
 * file is of every kind, and one whose writing was cut within what identifies it is still of its kind. */
bool output_kind_is(enum output_kind kind, const char *bytes, size_t length);

#endif
