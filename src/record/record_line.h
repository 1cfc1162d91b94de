/* SPDX-License-Identifier: MIT */
/* record_line.h: the lines of a recording about what came in (docs/RECORD.md), each written by a function of its own. */
#ifndef RKM04_RECORD_LINE_H
#define RKM04_RECORD_LINE_H

#include <stdio.h>

#include "sim/sim.h"

#define RECORD_VERSION 1
#define RECORD_SPAN UINT64_C(100000)       /* ticks from digest to digest */
#define RECORD_LINE_MAX (128u << 20)       /* bytes: the head has whole files, of 50 MiB together, perhaps as hexadecimal */
#define RECORD_EMBEDDED_MAX (16u << 20)    /* bytes of a file within a recording, and of the journal */

/* The configuration, flash and plant: `outputs` says whether what goes out will be recorded, too. Returns false if memory is
 * short or a flash image cannot be read. */
bool record_line_head(FILE *out, struct sim *sim, bool outputs);

void record_line_bytes(FILE *out, uint64_t now, uint64_t tick, const uint8_t *bytes, size_t length);
void record_line_purge(FILE *out, uint64_t now);
void record_line_break(FILE *out, uint64_t now, bool on);
void record_line_timed(FILE *out, uint64_t now, bool timed);

/* A command that was executed. Returns false if out of memory. */
bool record_line_command(FILE *out, uint64_t now, const char *method, const json_t *params);

/* "hex":"…" without the name. */
void record_hex(FILE *out, const uint8_t *bytes, size_t length);

#endif
