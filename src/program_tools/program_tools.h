/* SPDX-License-Identifier: MIT */
/* program_tools.h: programs of the RKM04 as a language: what is wrong with them, how they are laid
 * out; the face of the room.
 *
 *     diagnostic    errors and warnings with their places
 *     check         find them: check_programs()
 *     check_print   print them as text, JSON, SARIF, for GitHub, as gcc does
 *     format        the canonical layout of a text
 *     check_main, fmt_main    rkm04 check, rkm04 fmt
 *
 * Inside:
 *     token         a text as commands, comments and errors, read by the core's reader
 *     code          the program of a motor as commands with their places
 *     flow          which command may follow which, and what holds there
 *     planner       break points of motions, asked of the core
 *     check_*       the warnings, a file for each kind
 *     tool_files, text_diff, text_replace    files of a command line
 *
 * Texts are those of files: byte order mark and typographic apostrophes are understood, and offsets count in the text as given.
 * Nothing here reads files or knows command lines, but for the mains. */
#ifndef RKM04_PROGRAM_TOOLS_H
#define RKM04_PROGRAM_TOOLS_H

#include "check.h"
#include "check_print.h"
#include "diagnostic.h"
#include "format.h"

/* argv[0] is the name for messages ("rkm04 check"). Each returns the exit status (text/exit_status.h), or ends the program with
 * it. */
int check_main(int argc, char **argv);
int fmt_main(int argc, char **argv);

#endif
