/* SPDX-License-Identifier: MIT */
/* lines.h: a connection of a PLCComS client to CIB modules: lines of text in, lines of text out (docs/CIB.md, BN1-BN6). */
#ifndef RKM04_CIB_FACES_LINES_H
#define RKM04_CIB_FACES_LINES_H

#include "cib/cib.h"
#include "variables.h"

#define CIB_LINE_MAX 1024u          /* bytes of a line */
#define CIB_LINES_PERIOD 100000u    /* ticks between two checks of what has changed (BN5) */

/* Gets what goes to the client. */
struct cib_lines_out {
    void (*put)(void *context, const char *text, size_t length);
    void *context;
};

/* State of a connection: plain data, zero-initialised. */
struct cib_lines {
    uint16_t length;         /* bytes of the line so far */
    bool too_long;           /* the rest of the line is dropped */
    uint8_t command;         /* of variables, the last good one; 0: none (lines.c) */
    uint8_t enabled[(CIB_VARIABLES + 7u) / 8u];
    int32_t told[CIB_VARIABLES];   /* value that the client knows of an enabled variable */
    uint32_t delta[CIB_VARIABLES]; /* how much it has to differ by more than */
    char line[CIB_LINE_MAX + 1u];  /* with CR */
};

/* Bytes of the client at the present tick of the modules. Every line is a request (BC9). */
void cib_lines_receive(struct cib_lines *lines, const struct cib_modules *modules, const uint8_t *bytes, size_t length,
                       const struct cib_lines_out *out);

/* Is a variable enabled, so that cib_lines_report_changes() is due at the end of each tick that is a multiple
 * of CIB_LINES_PERIOD? */
bool cib_lines_watches(const struct cib_lines *lines, const struct cib_modules *modules);

/* Tell the client what has changed. */
void cib_lines_report_changes(struct cib_lines *lines, const struct cib_modules *modules, const struct cib_lines_out *out);

#endif
