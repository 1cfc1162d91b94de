/* SPDX-License-Identifier: MIT */
/* server.h: takes messages of an editor one by one and answers them. Nothing here reads or waits. */
#ifndef RKM04_LSP_SERVER_H
#define RKM04_LSP_SERVER_H

#include "session.h"

struct lsp_server {
    struct session session;
    bool is_initialized, is_shut_down;
    bool has_exited; /* the editor has sent `exit` */
};

/* Answers are written to `out`. */
void lsp_begin(struct lsp_server *server, const struct session_options *options, FILE *out);
void lsp_end(struct lsp_server *server);

/* Take one message, JSON. Whatever it is, the server goes on; a request is answered once. */
void lsp_receive(struct lsp_server *server, const char *text, size_t length);

/* A message was skipped because it was too long: it may have been an edit of any document. */
void lsp_receive_too_long(struct lsp_server *server);

/* Send the diagnostics of one document that has changed, or whose configuration has; those that were edited come first. Returns
 * false if there is none. To be called while no message waits: then a fast typist is not reported on letter by letter, and no
 * message waits for more than one check. */
bool lsp_report_change(struct lsp_server *server);

/* Of all of them. */
void lsp_report_changes(struct lsp_server *server);

#endif
