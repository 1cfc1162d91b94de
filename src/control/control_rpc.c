/* SPDX-License-Identifier: MIT */
#include "control_rpc.h"

#include <stdlib.h>
#include <string.h>

/* ---- Requests ------------------------------------------------------------------------------------------------------- */

/* How deep are nested lists and objects? Checked beforehand: reading them takes stack. */
static unsigned depth_of(const char *line, size_t length)
{
    unsigned depth = 0, deepest = 0;
    bool text = false;
    for (size_t i = 0; i < length; i++) {
        if (text) {
            if (line[i] == '\\')
                i++;
            else if (line[i] == '"')
                text = false;
        } else if (line[i] == '"') {
            text = true;
        } else if (line[i] == '{' || line[i] == '[') {
            if (++depth > deepest)
                deepest = depth;
        } else if ((line[i] == '}' || line[i] == ']') && depth > 0) {
            depth--;
        }
    }
    return deepest;
}

static bool parse(struct rpc_request *request, const char *line, size_t length, struct refusal *refusal)
{
    json_error_t error;
    if (depth_of(line, length) > RPC_DEPTH) {
        refuse(refusal, RPC_NO_REQUEST, "too deep: expected at most %u nested lists and objects", RPC_DEPTH);
        return false;
    }
    request->json = json_loadb(line, length, JSON_REJECT_DUPLICATES | JSON_DECODE_ANY, &error);
    if (request->json)
        return true;
    if (json_error_code(&error) == json_error_out_of_memory)
        refuse(refusal, REFUSED_MEMORY, "out of memory");
    else
        refuse(refusal, RPC_NO_JSON, "invalid JSON at character %d: %.200s", error.column > 0 ? error.column : 1, error.text);
    return false;
}

/* The id, which must be a string, a number or null; JSON null if it is something else. */
static bool read_id(struct rpc_request *request, struct refusal *refusal)
{
    const json_t *id = json_object_get(request->json, "id");
    if (!id)
        return true;
    if (json_is_string(id) || json_is_number(id) || json_is_null(id)) {
        request->id = id;
        return true;
    }
    refuse(refusal, RPC_NO_REQUEST, "id: expected a string, a number or null");
    return false;
}

static bool read_line(struct rpc_request *request, unsigned lines, struct refusal *refusal)
{
    const json_t *line = json_object_get(request->params, "line");
    if (!line)
        return true;
    if (!json_is_integer(line) || json_integer_value(line) < 0 || json_integer_value(line) >= (json_int_t)lines) {
        refuse(refusal, REFUSED_PARAMS, "line: expected a whole number from 0 to %u", lines - 1u);
        return false;
    }
    request->line = (unsigned)json_integer_value(line);
    request->line_given = true;
    return json_object_del(request->params, "line") == 0;
}

static bool read_params(struct rpc_request *request, unsigned lines, struct refusal *refusal)
{
    request->params = json_object_get(request->json, "params");
    if (!request->params) {
        request->params = json_object();
        if (json_object_set_new(request->json, "params", request->params) != 0) {
            request->params = NULL;
            refuse(refusal, REFUSED_MEMORY, "out of memory");
            return false;
        }
    }
    if (!json_is_object(request->params)) {
        refuse(refusal, REFUSED_PARAMS, "params: expected an object, as in {\"unit\": 1}");
        return false;
    }
    return read_line(request, lines, refusal);
}

bool rpc_read(struct rpc_request *request, const char *line, size_t length, unsigned lines, struct refusal *refusal)
{
    *request = (struct rpc_request){.id = json_null()};
    if (!parse(request, line, length, refusal))
        return false;
    if (!json_is_object(request->json)) {
        refuse(refusal, RPC_NO_REQUEST, json_is_array(request->json) ? "batches are not supported: expected one object per line"
                                                                     : "expected an object");
        return false;
    }
    if (!read_id(request, refusal))
        return false;
    const json_t *version = json_object_get(request->json, "jsonrpc"), *method = json_object_get(request->json, "method");
    if (!json_is_string(version) || strcmp(json_string_value(version), "2.0") != 0) {
        refuse(refusal, RPC_NO_REQUEST, "jsonrpc: expected \"2.0\"");
        return false;
    }
    request->method = json_string_value(method);
    if (!request->method) {
        refuse(refusal, RPC_NO_REQUEST, "method: expected a string");
        return false;
    }
    request->id = json_object_get(request->json, "id");
    return read_params(request, lines, refusal);
}

void rpc_end(struct rpc_request *request)
{
    json_decref(request->json);
    *request = (struct rpc_request){0};
}

/* ---- Answers -------------------------------------------------------------------------------------------------------- */

/* Takes the reference. */
static char *line_of(json_t *object)
{
    char *text = object ? json_dumps(object, JSON_COMPACT | JSON_ENCODE_ANY) : NULL;
    json_decref(object);
    size_t length = text ? strlen(text) : 0;
    char *line = text ? realloc(text, length + 2) : NULL;
    if (!line) {
        free(text);
        return NULL;
    }
    memcpy(line + length, "\n", 2);
    return line;
}

char *rpc_result(const json_t *id, json_t *result)
{
    return line_of(json_pack("{s:s, s:O, s:o}", "jsonrpc", "2.0", "id", id, "result", result));
}

char *rpc_error(const json_t *id, const struct refusal *refusal)
{
    /* A name out of the request may have been cut in the middle of a character. */
    size_t length = strlen(refusal->text);
    json_t *text = json_stringn(refusal->text, length);
    while (!text && length > 0)
        text = json_stringn(refusal->text, --length);
    return line_of(json_pack("{s:s, s:O, s:{s:i, s:o}}", "jsonrpc", "2.0", "id", id, "error", "code", refusal->code, "message",
                             text));
}

char *rpc_notification(const char *method, json_t *params)
{
    return line_of(json_pack("{s:s, s:s, s:o}", "jsonrpc", "2.0", "method", method, "params", params));
}
