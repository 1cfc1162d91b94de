/* SPDX-License-Identifier: MIT */
/* output_kind.h: kinds of files that are written, and how they are recognised by their first bytes. Pure. Who writes a kind of
 * file describes it; those that several write are here. */
#ifndef RKM04_FILE_OUTPUT_KIND_H
#define RKM04_FILE_OUTPUT_KIND_H

#include <stdbool.h>
#include <stddef.h>

/* A kind shows in the first bytes of a file, at most so many. */
#define OUTPUT_KIND_BYTES 1024u
#define OUTPUT_BEGINNINGS 4u

/* A file is of a kind if it begins with one of `begins` and, where `holds` is there, has that text among its first bytes: some
 * formats are written by other programs, too, which begin otherwise. */
struct output_kind {
    const char *name;                      /* "a CSV trace" */
    const char *begins[OUTPUT_BEGINNINGS]; /* NULL: no more */
    const char *holds;                     /* NULL: nothing in particular */
    bool is_report;                        /* made for others, too: not for the owner alone */
};

extern const struct output_kind output_recording; /* --record, `snapshot` with `file`, what `rkm04 test` keeps of a failure */
extern const struct output_kind output_junit;     /* --junit */
extern const struct output_kind output_coverage, output_coverage_json; /* --coverage: the text, the same in JSON */

/* Can a file that begins with these bytes be of that kind? `length`: those of the whole file, at most OUTPUT_KIND_BYTES. An empty
 * file is of every kind, and one whose writing was cut within what identifies it is still of its kind. */
bool output_kind_is(const struct output_kind *kind, const char *bytes, size_t length);

#endif
