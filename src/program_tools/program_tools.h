/* SPDX-License-Identifier: MIT */
/* program_tools.h: programs of the RKM04 as a language: what is wrong with them, how they are laid
 * out, what they do, how long they take; the face of the room.
 *
 *     diagnostic    errors and warnings with their places
 *     check         find them: check_programs()
 *     check_cnc     the same of texts of a CNC872
 *     check_print   print them as text, JSON, SARIF, for GitHub, as gcc does
 *     format        the canonical layout of a text
 *     explain       a program in words; explain_at() for a place
 *     estimate      durations, steps, speeds; estimate_print prints them
 *     token         a text as commands, comments and errors, read by the core's reader
 *     *_main        rkm04 check, fmt, explain, estimate
 *
 * Inside:
 *     source_texts  texts as the unit takes them
 *     code          the program of a motor as commands with their places
 *     flow          which command may follow which, and what holds there
 *     planner       break points of motions, asked of the core
 *     estimate_*    the run of an estimate
 *     explain_words the words of each language
 *     check_*       the warnings, a file for each kind
 *     tool_files, text_diff, text_replace    files of a command line
 *
 * Texts are those of files: byte order mark and typographic apostrophes are understood, and offsets count in the text as given.
 * Nothing here reads files or knows command lines, but for the mains. */
#ifndef RKM04_PROGRAM_TOOLS_H
#define RKM04_PROGRAM_TOOLS_H

#include "check.h"
#include "check_cnc.h"
#include "check_print.h"
#include "diagnostic.h"
#include "estimate.h"
#include "estimate_print.h"
#include "explain.h"
#include "format.h"
#include "token.h"

/* argv[0] is the name for messages ("rkm04 check"). Each returns the exit status (text/exit_status.h), or ends the program with
 * it. */
int check_main(int argc, char **argv);
int fmt_main(int argc, char **argv);
int explain_main(int argc, char **argv);
int estimate_main(int argc, char **argv);

struct argp_state;

/* Read a value of the option --no-warn, NAME,...: bit w of *off is set for warning w. What is wrong ends the program with a usage
 * error. */
void no_warn_option_read(uint64_t *off, const char *text, struct argp_state *state);

#endif
