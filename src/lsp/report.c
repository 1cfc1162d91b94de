/* SPDX-License-Identifier: MIT */
/* report.c: what is wrong with a document, as the editor shows it. */
#include <string.h>

#include "features.h"

enum severity { SEVERITY_ERROR = 1, SEVERITY_WARNING = 2 };
enum tag { TAG_UNNECESSARY = 1 };

static json_t *diagnostic_json(struct document *document, const struct diagnostic *one)
{
    const bool unnecessary = strcmp(one->name, check_warning_name(CHECK_UNREACHABLE)) == 0 ||
                             strcmp(one->name, check_warning_name(CHECK_UNUSED_LABEL)) == 0;
    json_t *message = json_sprintf(one->hint != NULL ? "%s\n%s" : "%s", one->message, one->hint);
    json_t *json = json_pack("{s:o, s:i, s:s, s:s, s:o}", "range", session_range_json(document, one->offset, one->length),
                             "severity", one->severity == DIAGNOSTIC_ERROR ? SEVERITY_ERROR : SEVERITY_WARNING, "code",
                             one->name, "source", "rkm04", "message",
                             message != NULL ? message : json_string("the text here is not UTF-8"));
    if (unnecessary)
        json_object_set_new(json, "tags", json_pack("[i]", TAG_UNNECESSARY));
    return json;
}

/* The text is not known: the first place says so. */
static json_t *unknown_json(void)
{
    const struct document_position begin = {0, 0};
    return json_pack("{s:{s:o, s:o}, s:i, s:s, s:s, s:s+}", "range", "start", session_position_json(begin), "end",
                     session_position_json(begin), "severity", SEVERITY_WARNING, "code", "not-checked", "source", "rkm04",
                     "message", "this text is not checked: it is longer than 256 KiB, or an edit of it was not understood; ",
                     "close and open it again when it is shorter");
}

static void send(struct session *session, const char *uri, const json_int_t *version, json_t *list)
{
    json_t *params = json_pack("{s:s, s:o}", "uri", uri, "diagnostics", list);
    if (version != NULL)
        json_object_set_new(params, "version", json_integer(*version));
    session_notify(session, "textDocument/publishDiagnostics", params);
}

void lsp_report(struct session *session, struct document *document)
{
    const struct check_options options = {.off = session->options.off};
    const struct program_source source = document_source(document);
    const json_int_t version = document->version;
    struct diagnostics found;
    json_t *list = json_array();
    if (document->is_unknown) {
        json_array_append_new(list, unknown_json());
    } else {
        if (!check_programs(&source, 1, &options, &found))
            session_log(session, "out of memory");
        for (size_t i = 0; i < found.count; i++)
            json_array_append_new(list, diagnostic_json(document, &found.list[i]));
        diagnostics_free(&found);
    }
    document->has_changed = false;
    send(session, document->uri, &version, list);
}

void lsp_report_none(struct session *session, const char *uri)
{
    send(session, uri, NULL, json_array());
}
