/* SPDX-License-Identifier: MIT */
/* lsp.h: a language server for programs of the RKM04, as editors use it (Language Server Protocol 3.17); the face of the room.
 *
 *     frame       messages out of a stream of bytes
 *     document    a text as the editor has it: edits, positions in UTF-16
 *     analysis    what is known of a text until its next edit
 *     session     open documents, and what answers are made of
 *     features    the answers: report (diagnostics), navigate (labels), assist (hover, code lens, formatting), complete
 *     server      messages by their names
 *     lsp_main    rkm04 lsp: standard input and output
 *
 * What is said about a program comes from the room program_tools. docs/EDITORS.md. */
#ifndef RKM04_LSP_H
#define RKM04_LSP_H

#include "frame.h"
#include "server.h"

/* argv[0] is the name for messages. Returns the exit status (text/exit_status.h), or ends the program with it. */
int lsp_main(int argc, char **argv);

#endif
