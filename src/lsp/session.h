/* SPDX-License-Identifier: MIT */
/* session.h: the open documents of an editor, and what requests and answers are made of. */
#ifndef RKM04_LSP_SESSION_H
#define RKM04_LSP_SESSION_H

#include <jansson.h>
#include <stdio.h>

#include "document.h"

#define SESSION_DOCUMENTS_MAX 200u /* open at a time; further ones are not checked */
#define SESSION_EDITS_MAX 10000u   /* of one message */

enum refusal_code {
    REFUSED_JSON = -32700,
    REFUSED_REQUEST = -32600,
    REFUSED_METHOD = -32601,
    REFUSED_PARAMS = -32602,
    REFUSED_INTERNAL = -32603,
    REFUSED_EARLY = -32002, /* before initialize */
    REFUSED_FAILED = -32803
};

struct session_refusal {
    int code; /* 0: not refused */
    char text[160];
};

struct session_options {
    enum explain_language language;
    uint64_t off; /* bit w: warning w is switched off */
};

struct session {
    struct session_options options;
    struct document *documents[SESSION_DOCUMENTS_MAX];
    size_t count;
    FILE *out;
};

/* Returns NULL. The text is printf-like. */
json_t *session_refuse(struct session_refusal *refusal, int code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* The open document of this URI; NULL: it is not open. */
struct document *session_find(const struct session *session, const char *uri);

/* The document of params.textDocument.uri, its commands read. Returns NULL, and refuses, if there is none or it is not open. */
struct document *session_document(const struct session *session, const json_t *params, struct session_refusal *refusal);

/* Read {line, character}. Returns false if it is none. */
bool session_read_position(const json_t *json, struct document_position *position);

/* The offset of params.position in a document. Returns false, and refuses, if it is missing. */
bool session_offset(const struct document *document, const json_t *params, size_t *offset, struct session_refusal *refusal);

/* New references. */
json_t *session_position_json(struct document_position position);
json_t *session_range_json(struct document *document, size_t offset, size_t length);

/* Send a message, a new reference, which is released. */
void session_send(struct session *session, json_t *message);

/* Send a notification. `params`: a new reference. */
void session_notify(struct session *session, const char *method, json_t *params);

/* Send a message for the editor's log. printf-like. */
void session_log(struct session *session, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
