/* SPDX-License-Identifier: MIT */
#include "server.h"

#include <stdlib.h>
#include <string.h>

#include <rkm04/limits.h>

#include "features.h"
#include "frame.h"

void lsp_begin(struct lsp_server *server, const struct session_options *options, FILE *out)
{
    *server = (struct lsp_server){.session = {.options = *options, .out = out}};
}

void lsp_end(struct lsp_server *server)
{
    for (size_t i = 0; i < server->session.count; i++)
        document_free(server->session.documents[i]);
    server->session.count = 0;
}

/* ---- Beginning and end --------------------------------------------------------------------------------------------------- */

static json_t *initialize(struct lsp_server *server)
{
    enum { SYNC_INCREMENTAL = 2 };
    server->is_initialized = true;
    json_t *sync = json_pack("{s:b, s:i}", "openClose", true, "change", SYNC_INCREMENTAL);
    json_t *can = json_pack("{s:s, s:o, s:b, s:b, s:b, s:b, s:b, s:b, s:{s:b}, s:{s:[s]}, s:{s:b}}", "positionEncoding", "utf-16",
                            "textDocumentSync", sync, "hoverProvider", true, "definitionProvider", true, "referencesProvider",
                            true, "documentHighlightProvider", true, "documentSymbolProvider", true,
                            "documentFormattingProvider", true, "renameProvider", "prepareProvider", true,
                            "completionProvider", "triggerCharacters", "'", "codeLensProvider", "resolveProvider", false);
    return json_pack("{s:o, s:{s:s, s:s}}", "capabilities", can, "serverInfo", "name", "rkm04", "version", RKM04_VERSION);
}

static json_t *shut_down(struct lsp_server *server)
{
    server->is_shut_down = true;
    return json_null();
}

/* ---- Documents ----------------------------------------------------------------------------------------------------------- */

static void open_document(struct session *session, const json_t *params)
{
    const json_t *item = json_object_get(params, "textDocument"), *text = json_object_get(item, "text");
    const char *uri = json_string_value(json_object_get(item, "uri"));
    if (uri == NULL || !json_is_string(text)) {
        session_log(session, "textDocument/didOpen: expected a uri and a text");
        return;
    }
    struct document *document = session_find(session, uri);
    if (document == NULL) {
        if (session->count == SESSION_DOCUMENTS_MAX) {
            session_log(session, "not checked: more than %u documents are open", SESSION_DOCUMENTS_MAX);
            return;
        }
        document = calloc(1, sizeof *document);
        if (document == NULL || (document->uri = strdup(uri)) == NULL) {
            free(document);
            session_log(session, "out of memory");
            return;
        }
        session->documents[session->count++] = document;
    }
    document->version = json_integer_value(json_object_get(item, "version"));
    document->is_unknown = false;
    if (!document_replace(document, 0, document->length, json_string_value(text), json_string_length(text)))
        document_forget(document);
}

/* Make one edit. Returns false if it is none. */
static bool edit_document(struct document *document, const json_t *edit)
{
    const json_t *range = json_object_get(edit, "range"), *text = json_object_get(edit, "text");
    struct document_position start, end;
    size_t from = 0, to = document->length;
    if (!json_is_string(text))
        return false;
    if (range == NULL || json_is_null(range)) {
        document->is_unknown = false;
    } else if (!session_read_position(json_object_get(range, "start"), &start) ||
               !session_read_position(json_object_get(range, "end"), &end)) {
        return false;
    } else if (document->is_unknown) {
        return true;
    } else {
        from = document_offset(document, start);
        to = document_offset(document, end);
    }
    return from <= to && document_replace(document, from, to, json_string_value(text), json_string_length(text));
}

static void change_document(struct session *session, const json_t *params)
{
    const json_t *item = json_object_get(params, "textDocument"), *edits = json_object_get(params, "contentChanges");
    const char *uri = json_string_value(json_object_get(item, "uri"));
    struct document *document = uri == NULL ? NULL : session_find(session, uri);
    if (document == NULL) {
        session_log(session, "textDocument/didChange: the document is not open");
        return;
    }
    const size_t count = json_array_size(edits);
    bool ok = json_is_array(edits) && count <= SESSION_EDITS_MAX;
    document->version = json_integer_value(json_object_get(item, "version"));
    for (size_t i = 0; ok && i < count; i++)
        ok = edit_document(document, json_array_get(edits, i));
    if (!ok) {
        document_forget(document);
        session_log(session, "textDocument/didChange: an edit was not understood, or there are more than %u",
                    SESSION_EDITS_MAX);
    }
}

static void close_document(struct session *session, const json_t *params)
{
    const char *uri = json_string_value(json_object_get(json_object_get(params, "textDocument"), "uri"));
    size_t i = 0;
    while (uri != NULL && i < session->count && strcmp(session->documents[i]->uri, uri) != 0)
        i++;
    if (uri == NULL || i == session->count)
        return;
    lsp_report_none(session, session->documents[i]);
    document_free(session->documents[i]);
    session->documents[i] = session->documents[--session->count];
}

/* ---- Messages by name ----------------------------------------------------------------------------------------------------- */

static const struct {
    const char *name;
    json_t *(*answer)(struct session *session, const json_t *params, struct session_refusal *refusal);
} requests[] = {
    {"textDocument/completion", lsp_complete},
    {"textDocument/hover", lsp_hover},
    {"textDocument/definition", lsp_find_definition},
    {"textDocument/references", lsp_find_references},
    {"textDocument/documentHighlight", lsp_highlight},
    {"textDocument/prepareRename", lsp_prepare_rename},
    {"textDocument/rename", lsp_rename},
    {"textDocument/documentSymbol", lsp_list_symbols},
    {"textDocument/formatting", lsp_format},
    {"textDocument/codeLens", lsp_list_lenses},
};

static const struct {
    const char *name;
    void (*take)(struct session *session, const json_t *params);
} notifications[] = {
    {"textDocument/didOpen", open_document},
    {"textDocument/didChange", change_document},
    {"textDocument/didClose", close_document},
};

static json_t *answer_request(struct lsp_server *server, const char *method, const json_t *params,
                              struct session_refusal *refusal)
{
    if (server->is_shut_down)
        return session_refuse(refusal, REFUSED_REQUEST, "the server is shut down");
    if (strcmp(method, "initialize") == 0)
        return server->is_initialized ? session_refuse(refusal, REFUSED_REQUEST, "initialize came before") : initialize(server);
    if (!server->is_initialized)
        return session_refuse(refusal, REFUSED_EARLY, "initialize has to come first");
    if (strcmp(method, "shutdown") == 0)
        return shut_down(server);
    const char *uri = json_string_value(json_object_get(json_object_get(params, "textDocument"), "uri"));
    const bool is_cnc = uri != NULL && check_cnc_takes(uri); /* has diagnostics alone */
    for (size_t i = 0; i < sizeof requests / sizeof requests[0]; i++)
        if (strcmp(method, requests[i].name) == 0)
            return is_cnc ? json_null() : requests[i].answer(&server->session, params, refusal);
    return session_refuse(refusal, REFUSED_METHOD, "there is no method `%.80s'", method);
}

static void take_notification(struct lsp_server *server, const char *method, const json_t *params)
{
    if (strcmp(method, "exit") == 0)
        server->has_exited = true;
    for (size_t i = 0; i < sizeof notifications / sizeof notifications[0]; i++)
        if (server->is_initialized && !server->is_shut_down && strcmp(method, notifications[i].name) == 0)
            notifications[i].take(&server->session, params);
}

/* ---- Messages ------------------------------------------------------------------------------------------------------------- */

/* Send a result, a new reference, or the refusal if it is NULL. `id` may be NULL. */
static void send_answer(struct lsp_server *server, json_t *id, json_t *result, struct session_refusal *refusal)
{
    if (id == NULL)
        id = json_null();
    if (result == NULL && refusal->code == 0)
        session_refuse(refusal, REFUSED_INTERNAL, "no answer could be made");
    json_t *message = json_pack("{s:s, s:O}", "jsonrpc", "2.0", "id", id);
    if (result != NULL) {
        json_object_set_new(message, "result", result);
    } else {
        json_t *text = json_string(refusal->text); /* cut in the middle of a character, it is none */
        json_object_set_new(message, "error", json_pack("{s:i, s:o}", "code", refusal->code, "message",
                                                        text != NULL ? text : json_string("refused")));
    }
    session_send(&server->session, message);
}

static void refuse_message(struct lsp_server *server, json_t *id, int code, const char *text)
{
    struct session_refusal refusal;
    session_refuse(&refusal, code, "%s", text);
    send_answer(server, id, NULL, &refusal);
}

static bool is_hex(const char *text, size_t count)
{
    size_t i = 0;
    while (i < count && strchr("0123456789abcdefABCDEF", text[i]) != NULL && text[i] != '\0')
        i++;
    return i == count;
}

/* The code unit of an escape \uXXXX at `text`; 0: there is none. */
static unsigned escaped_unit(const char *text, const char *end)
{
    char digits[5] = "";
    if (end - text < 6 || text[0] != '\\' || text[1] != 'u' || !is_hex(text + 2, 4))
        return 0;
    memcpy(digits, text + 2, 4);
    return (unsigned)strtoul(digits, NULL, 16);
}

/* Editors may send half of a surrogate pair, which is no text: put U+FFFD for it, which is as long, so that positions stay. */
static void mend_surrogates(char *text, size_t length)
{
    char *const end = text + length;
    for (char *at = text; at < end; at++) {
        if (*at != '\\')
            continue;
        const unsigned unit = escaped_unit(at, end);
        if (unit >= 0xD800 && unit <= 0xDBFF && escaped_unit(at + 6, end) >> 10 == 0xDC00 >> 10)
            at += 11;
        else if (unit >= 0xD800 && unit <= 0xDFFF)
            memcpy(at + 2, "fffd", 4);
        else
            at++;
    }
}

static json_t *read_message(const char *text, size_t length)
{
    char *copy = malloc(length + 1);
    json_t *message = NULL;
    if (copy != NULL) {
        memcpy(copy, text, length);
        mend_surrogates(copy, length);
        message = json_loadb(copy, length, JSON_ALLOW_NUL, NULL);
    }
    free(copy);
    return message;
}

/* Any document may be another one now. */
static void forget_documents(struct lsp_server *server)
{
    for (size_t i = 0; i < server->session.count; i++)
        document_forget(server->session.documents[i]);
}

void lsp_receive(struct lsp_server *server, const char *text, size_t length)
{
    struct session_refusal refusal = {0};
    json_t *message = read_message(text, length);
    if (message == NULL) {
        refuse_message(server, NULL, REFUSED_JSON, "the message is not JSON");
        forget_documents(server);
        return;
    }
    json_t *id = json_object_get(message, "id");
    const char *method = json_string_value(json_object_get(message, "method"));
    const json_t *params = json_object_get(message, "params");
    const bool is_answer = json_object_get(message, "result") != NULL || json_object_get(message, "error") != NULL;
    if (method == NULL && !is_answer)
        refuse_message(server, NULL, REFUSED_REQUEST, "expected a message with a method");
    else if (method != NULL && id != NULL && !json_is_integer(id) && !json_is_string(id))
        refuse_message(server, NULL, REFUSED_REQUEST, "expected a number or a string as id");
    else if (method != NULL && id != NULL)
        send_answer(server, id, answer_request(server, method, params, &refusal), &refusal);
    else if (method != NULL)
        take_notification(server, method, params);
    json_decref(message);
}

void lsp_receive_too_long(struct lsp_server *server)
{
    session_log(&server->session, "a message of more than %u bytes was skipped", FRAME_LENGTH_MAX);
    forget_documents(server);
}

/* Texts that were edited come first. NULL: none. */
static struct document *find_unreported(const struct session *session)
{
    struct document *stale = NULL;
    for (size_t i = session->count; i-- > 0;) {
        if (session->documents[i]->has_changed)
            return session->documents[i];
        if (session->documents[i]->is_stale)
            stale = session->documents[i];
    }
    return stale;
}

bool lsp_report_change(struct lsp_server *server)
{
    struct document *document = find_unreported(&server->session);
    if (document != NULL)
        lsp_report(&server->session, document);
    return document != NULL;
}

void lsp_report_changes(struct lsp_server *server)
{
    while (lsp_report_change(server))
        ;
}
