/* SPDX-License-Identifier: MIT */
/* features.h: the answers to requests about a document, and diagnostics.
 *
 * Each takes the parameters of a request and returns its result, a new reference. NULL: the refusal says why, or no memory. */
#ifndef RKM04_LSP_FEATURES_H
#define RKM04_LSP_FEATURES_H

#include "session.h"

/* navigate.c: labels */
json_t *lsp_find_definition(struct session *session, const json_t *params, struct session_refusal *refusal);
json_t *lsp_find_references(struct session *session, const json_t *params, struct session_refusal *refusal);
json_t *lsp_highlight(struct session *session, const json_t *params, struct session_refusal *refusal);
json_t *lsp_prepare_rename(struct session *session, const json_t *params, struct session_refusal *refusal);
json_t *lsp_rename(struct session *session, const json_t *params, struct session_refusal *refusal);
json_t *lsp_list_symbols(struct session *session, const json_t *params, struct session_refusal *refusal);

/* assist.c */
json_t *lsp_hover(struct session *session, const json_t *params, struct session_refusal *refusal);
json_t *lsp_list_lenses(struct session *session, const json_t *params, struct session_refusal *refusal);
json_t *lsp_format(struct session *session, const json_t *params, struct session_refusal *refusal);

/* complete.c */
json_t *lsp_complete(struct session *session, const json_t *params, struct session_refusal *refusal);

/* report.c: send the diagnostics of a document; of one that is closed, none. */
void lsp_report(struct session *session, struct document *document);
void lsp_report_none(struct session *session, const struct document *document);

#endif
