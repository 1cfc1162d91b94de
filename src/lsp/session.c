/* SPDX-License-Identifier: MIT */
#include "session.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#define LOG_WARNING 2

json_t *session_refuse(struct session_refusal *refusal, int code, const char *format, ...)
{
    va_list arguments;
    refusal->code = code;
    va_start(arguments, format);
    vsnprintf(refusal->text, sizeof refusal->text, format, arguments);
    va_end(arguments);
    return NULL;
}

struct document *session_find(const struct session *session, const char *uri)
{
    for (size_t i = 0; i < session->count; i++)
        if (strcmp(session->documents[i]->uri, uri) == 0)
            return session->documents[i];
    return NULL;
}

struct document *session_document(const struct session *session, const json_t *params, struct session_refusal *refusal)
{
    const char *uri = json_string_value(json_object_get(json_object_get(params, "textDocument"), "uri"));
    if (uri == NULL) {
        session_refuse(refusal, REFUSED_PARAMS, "expected textDocument with a uri");
        return NULL;
    }
    struct document *document = session_find(session, uri);
    if (document == NULL) {
        session_refuse(refusal, REFUSED_PARAMS, "the document is not open");
        return NULL;
    }
    const struct program_source source = document_source(document);
    if (!analysis_read(&document->analysis, &source)) {
        session_refuse(refusal, REFUSED_INTERNAL, "out of memory");
        return NULL;
    }
    return document;
}

bool session_read_position(const json_t *json, struct document_position *position)
{
    const json_t *line = json_object_get(json, "line"), *character = json_object_get(json, "character");
    if (!json_is_integer(line) || !json_is_integer(character) || json_integer_value(line) < 0 ||
        json_integer_value(character) < 0)
        return false;
    *position = (struct document_position){(size_t)json_integer_value(line), (size_t)json_integer_value(character)};
    return true;
}

bool session_offset(const struct document *document, const json_t *params, size_t *offset, struct session_refusal *refusal)
{
    struct document_position position;
    if (!session_read_position(json_object_get(params, "position"), &position)) {
        session_refuse(refusal, REFUSED_PARAMS, "expected a position with line and character");
        return false;
    }
    *offset = document_offset(document, position);
    return true;
}

json_t *session_position_json(struct document_position position)
{
    return json_pack("{s:I, s:I}", "line", (json_int_t)position.line, "character", (json_int_t)position.character);
}

json_t *session_range_json(struct document *document, size_t offset, size_t length)
{
    return json_pack("{s:o, s:o}", "start", session_position_json(document_position(document, offset)), "end",
                     session_position_json(document_position(document, offset + length)));
}

void session_send(struct session *session, json_t *message)
{
    char *text = message == NULL ? NULL : json_dumps(message, JSON_COMPACT);
    if (text != NULL)
        fprintf(session->out, "Content-Length: %zu\r\n\r\n%s", strlen(text), text);
    free(text);
    json_decref(message);
}

void session_notify(struct session *session, const char *method, json_t *params)
{
    session_send(session, json_pack("{s:s, s:s, s:o}", "jsonrpc", "2.0", "method", method, "params", params));
}

void session_log(struct session *session, const char *format, ...)
{
    char text[200];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    session_notify(session, "window/logMessage", json_pack("{s:i, s:s}", "type", LOG_WARNING, "message", text));
}
