/* SPDX-License-Identifier: MIT */
/* check.h: what is wrong with programs: everything that a unit refuses, and what it accepts but is probably wrong.
 * docs/CHECK.md has a page for each warning. */
#ifndef RKM04_PROGRAM_TOOLS_CHECK_H
#define RKM04_PROGRAM_TOOLS_CHECK_H

#include <stdint.h>
#include <stdio.h>

#include <rkm04/readings.h>

#include "diagnostic.h"

/* The warnings: constant, name, what it says. The order is that of docs/CHECK.md. */
#define CHECK_TABLE(ROW) \
    ROW(CHECK_MISSING_LABEL, "missing-label", "a jump or call to a label that the program does not have") \
    ROW(CHECK_DUPLICATE_LABEL, "duplicate-label", "a label that occurs more than once") \
    ROW(CHECK_UNUSED_LABEL, "unused-label", "a label that no jump or call uses") \
    ROW(CHECK_LOOP_END, "loop-end", "E where no loop is open") \
    ROW(CHECK_OPEN_LOOP, "open-loop", "L without its E") \
    ROW(CHECK_LOOP_DEPTH, "loop-depth", "more than 8 nested loops") \
    ROW(CHECK_STRAY_RETURN, "stray-return", ". outside a subroutine") \
    ROW(CHECK_RUN_INTO, "run-into", "a subroutine that is also entered without a call") \
    ROW(CHECK_CALL_DEPTH, "call-depth", "more than 6 nested calls") \
    ROW(CHECK_UNREACHABLE, "unreachable", "commands that are never executed") \
    ROW(CHECK_BUSY_LOOP, "busy-loop", "an endless loop without a motion, a dwell or a wait") \
    ROW(CHECK_NO_STEPS, "no-steps", "R before any F, B or G") \
    ROW(CHECK_MOVES_AGAIN, "moves-again", "R after G or H, which move without R") \
    ROW(CHECK_MIXED_DIRECTIONS, "mixed-directions", "Y segments of different directions") \
    ROW(CHECK_TOO_MANY_SEGMENTS, "too-many-segments", "more than ten Y segments") \
    ROW(CHECK_EMPTY_SEGMENT, "empty-segment", "a Y segment without steps") \
    ROW(CHECK_LATE_MARK, "late-mark", "T51 to T58 after the first Y") \
    ROW(CHECK_NO_RAMP, "no-ramp", "V not higher than S: no ramps") \
    ROW(CHECK_SPEED_NOT_REACHED, "speed-not-reached", "a motion too short to reach V") \
    ROW(CHECK_STAND_ALONE, "stand-alone", "K, C75 or a change of speed inside a program") \
    ROW(CHECK_OPEN_BLOCK, "open-block", "[ without ]") \
    ROW(CHECK_MEMORY_FULL, "memory-full", "more than 700 commands") \
    ROW(CHECK_UNUSED_GUARD, "unused-guard", "M or N that no motion uses") \
    ROW(CHECK_USED_GUARD, "used-guard", "M or N that guards only one of the passes of a loop") \
    ROW(CHECK_OUTPUT_STAYS, "output-stays", "an output that is set and never cleared") \
    ROW(CHECK_INPUT_NEVER_COMES, "input-never-comes", "a wait for an input that the plant never sets") \
    ROW(CHECK_VARIABLE_NEVER_SET, "variable-never-set", "a wait for a variable that no motor sets") \
    ROW(CHECK_DEADLOCK, "deadlock", "motors that wait for each other") \
    ROW(CHECK_APOSTROPHE, "apostrophe", "a typographic apostrophe in a call") \
    ROW(CHECK_UNKNOWN_NOLINT, "unknown-nolint", "a nolint comment with an unknown name")

#define CHECK_CONSTANT(constant, name, says) constant,
enum check_warning { CHECK_TABLE(CHECK_CONSTANT) CHECK_WARNINGS };
#undef CHECK_CONSTANT

/* Name of a warning, and what it says. */
const char *check_warning_name(enum check_warning warning);
const char *check_warning_text(enum check_warning warning);

/* The warning of this name; CHECK_WARNINGS: there is none. */
enum check_warning check_warning_named(const char *name, size_t length);

/* All names, "missing-label, duplicate-label, …", for messages. */
const char *check_warning_names(void);

struct check_options {
    uint64_t off;                   /* bit w: warning w is switched off */
    struct rkm04_readings readings; /* of the unit; all 0: as specified */
    const char *plant;              /* YAML text of what the motors move (docs/PLANT.md); NULL: none */
    size_t plant_length;
    const char *plant_name;         /* for messages about it, to `errors` */
    FILE *errors;
};

/* Check sources that belong together: the programs of one unit, each motor's read in order. A single program is one source for
 * motor 1. Everything found is in *found, in order; diagnostics_free() is due in any case. Returns false if out of memory. */
bool check_programs(const struct program_source *sources, size_t count, const struct check_options *options,
                    struct diagnostics *found);

#endif
