/* SPDX-License-Identifier: MIT */
/* report.c: what is wrong with a document, as the editor shows it. */
#include <stdlib.h>
#include <string.h>
#include <strings.h>

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

/* Bytes of a URI up to the name of its file. */
static size_t folder_length(const char *uri)
{
    const char *slash = strrchr(uri, '/');
    return slash == NULL ? 0 : (size_t)(slash + 1 - uri);
}

static bool has_end(const char *uri, const char *end)
{
    const size_t length = strlen(uri);
    return length >= strlen(end) && strcasecmp(uri + length - strlen(end), end) == 0;
}

/* Are both in the same folder, the one a configuration and the other an NC program of a CNC872? */
static bool is_machine_of(const struct document *machine, const struct document *program)
{
    const size_t length = folder_length(program->uri);
    return has_end(machine->uri, ".xml") && has_end(program->uri, ".nc") && folder_length(machine->uri) == length &&
           strncmp(machine->uri, program->uri, length) == 0;
}

static bool check_text(const struct document *document, struct cnc_config *machine, struct diagnostics *found)
{
    struct program_source source = document_source(document);
    source.name = document->uri;
    return check_cnc(&source, machine, found);
}

/* What a configuration says is kept for the NC programs beside it. */
static void keep_machine(struct document *document, const struct cnc_config *machine)
{
    free(document->machine);
    document->machine = malloc(sizeof *machine);
    if (document->machine != NULL)
        *document->machine = *machine;
}

/* A text of a CNC872; an NC program with the configuration that is open beside it, if that has no errors. */
static bool check_cnc_document(const struct session *session, struct document *document, struct diagnostics *found)
{
    const struct document *beside = NULL;
    struct cnc_config machine;
    for (size_t i = 0; i < session->count; i++)
        if (is_machine_of(session->documents[i], document) && !session->documents[i]->is_unknown)
            beside = session->documents[i];
    cnc_config_clear(&machine);
    if (beside != NULL && beside->machine != NULL)
        machine = *beside->machine;
    const bool ok = check_text(document, &machine, found);
    if (ok && found->errors == 0 && has_end(document->uri, ".xml"))
        keep_machine(document, &machine);
    return ok;
}

static bool check_document(const struct session *session, struct document *document, struct diagnostics *found)
{
    const struct check_options options = {.off = session->options.off};
    const struct program_source source = document_source(document);
    if (check_cnc_takes(document->uri))
        return check_cnc_document(session, document, found);
    return check_programs(&source, 1, &options, found);
}

/* The NC programs of a configuration may be wrong or right now. */
static void mark_programs(struct session *session, const struct document *machine)
{
    for (size_t i = 0; i < session->count; i++)
        if (is_machine_of(machine, session->documents[i]))
            session->documents[i]->is_stale = true;
}

void lsp_report(struct session *session, struct document *document)
{
    const json_int_t version = document->version;
    struct diagnostics found;
    json_t *list = json_array();
    if (document->is_unknown) {
        json_array_append_new(list, unknown_json());
    } else {
        if (!check_document(session, document, &found))
            session_log(session, "out of memory");
        for (size_t i = 0; i < found.count; i++)
            json_array_append_new(list, diagnostic_json(document, &found.list[i]));
        diagnostics_free(&found);
    }
    if (document->has_changed)
        mark_programs(session, document);
    document->has_changed = document->is_stale = false;
    send(session, document->uri, &version, list);
}

void lsp_report_none(struct session *session, const struct document *document)
{
    send(session, document->uri, NULL, json_array());
    mark_programs(session, document);
}
