/* SPDX-License-Identifier: MIT */
/* navigate.c: labels: where they are, who goes there, what they are called. */
#include <stdlib.h>
#include <string.h>

#include "features.h"
#include "text/text.h"

#define SYMBOLS_MAX 1000u /* listed of a text */

enum highlight { HIGHLIGHT_READ = 2, HIGHLIGHT_WRITE = 3 };
enum symbol { SYMBOL_FUNCTION = 12, SYMBOL_KEY = 20 };

/* The command with a label at params.position. NULL: there is none, which is no error, or the refusal says why. */
static const struct analysis_command *find_label(const struct session *session, const json_t *params,
                                                 struct document **document, struct session_refusal *refusal)
{
    size_t offset;
    *document = session_document(session, params, refusal);
    if (*document == NULL || !session_offset(*document, params, &offset, refusal))
        return NULL;
    const struct analysis_command *command = analysis_at(&(*document)->analysis, offset);
    return command != NULL && analysis_label(command->command) > 0 ? command : NULL;
}

static bool has_same_label(const struct analysis_command *one, const struct analysis_command *other)
{
    return one->program == other->program && analysis_label(one->command) == analysis_label(other->command);
}

static json_t *location_json(struct document *document, const struct analysis_command *command)
{
    return json_pack("{s:s, s:o}", "uri", document->uri, "range",
                     session_range_json(document, command->offset, command->length));
}

json_t *lsp_find_definition(struct session *session, const json_t *params, struct session_refusal *refusal)
{
    struct document *document;
    const struct analysis_command *from = find_label(session, params, &document, refusal);
    if (from == NULL)
        return refusal->code != 0 ? NULL : json_null();
    const struct analysis_command *to =
        analysis_find_label(&document->analysis, analysis_label(from->command), from->program);
    return to == NULL ? json_null() : location_json(document, to);
}

json_t *lsp_find_references(struct session *session, const json_t *params, struct session_refusal *refusal)
{
    struct document *document;
    const struct analysis_command *from = find_label(session, params, &document, refusal);
    const bool with_declaration =
        json_is_true(json_object_get(json_object_get(params, "context"), "includeDeclaration"));
    if (refusal->code != 0)
        return NULL;
    json_t *list = json_array();
    for (size_t i = 0; from != NULL && i < document->analysis.count; i++) {
        const struct analysis_command *one = &document->analysis.commands[i];
        if (has_same_label(one, from) && (with_declaration || one->command.op != '@'))
            json_array_append_new(list, location_json(document, one));
    }
    return list;
}

json_t *lsp_highlight(struct session *session, const json_t *params, struct session_refusal *refusal)
{
    struct document *document;
    const struct analysis_command *from = find_label(session, params, &document, refusal);
    if (from == NULL)
        return refusal->code != 0 ? NULL : json_null();
    json_t *list = json_array();
    for (size_t i = 0; i < document->analysis.count; i++) {
        const struct analysis_command *one = &document->analysis.commands[i];
        if (has_same_label(one, from))
            json_array_append_new(list, json_pack("{s:o, s:i}", "range", session_range_json(document, one->offset, one->length),
                                                  "kind", one->command.op == '@' ? HIGHLIGHT_WRITE : HIGHLIGHT_READ));
    }
    return list;
}

/* ---- Rename ------------------------------------------------------------------------------------------------------------- */

static json_t *label_range(struct document *document, const struct analysis_command *command)
{
    size_t offset, length;
    analysis_label_place(&document->analysis, command, &offset, &length);
    return session_range_json(document, offset, length);
}

json_t *lsp_prepare_rename(struct session *session, const json_t *params, struct session_refusal *refusal)
{
    struct document *document;
    const struct analysis_command *from = find_label(session, params, &document, refusal);
    if (from == NULL)
        return refusal->code != 0 ? NULL : json_null();
    return json_pack("{s:o, s:o}", "range", label_range(document, from), "placeholder",
                     json_sprintf("%u", analysis_label(from->command)));
}

static bool is_used(const struct analysis *analysis, unsigned label, unsigned program)
{
    size_t i = 0;
    while (i < analysis->count &&
           (analysis->commands[i].program != program || analysis_label(analysis->commands[i].command) != label))
        i++;
    return i < analysis->count;
}

/* Read the new label, with or without its @. Returns false, and refuses, if it cannot be taken. */
static bool read_new_label(const struct document *document, const struct analysis_command *from, const json_t *params,
                           unsigned *label, struct session_refusal *refusal)
{
    const char *name = json_string_value(json_object_get(params, "newName"));
    uint64_t number;
    if (name == NULL) {
        session_refuse(refusal, REFUSED_PARAMS, "expected newName");
        return false;
    }
    if (!number_read(name + (name[0] == '@'), 1, RKM04_LABELS, &number)) {
        session_refuse(refusal, REFUSED_FAILED, "expected a label 1..%u, found `%.40s'", RKM04_LABELS, name);
        return false;
    }
    *label = (unsigned)number;
    if (*label != analysis_label(from->command) && is_used(&document->analysis, *label, from->program)) {
        session_refuse(refusal, REFUSED_FAILED, "label %u is used already", *label);
        return false;
    }
    return true;
}

json_t *lsp_rename(struct session *session, const json_t *params, struct session_refusal *refusal)
{
    struct document *document;
    unsigned label;
    const struct analysis_command *from = find_label(session, params, &document, refusal);
    if (refusal->code != 0)
        return NULL;
    if (from == NULL)
        return session_refuse(refusal, REFUSED_FAILED, "there is no label here");
    if (!read_new_label(document, from, params, &label, refusal))
        return NULL;
    json_t *edits = json_array();
    for (size_t i = 0; i < document->analysis.count; i++) {
        const struct analysis_command *one = &document->analysis.commands[i];
        if (has_same_label(one, from))
            json_array_append_new(edits, json_pack("{s:o, s:o}", "range", label_range(document, one), "newText",
                                                   json_sprintf("%u", label)));
    }
    json_t *changes = json_object();
    json_object_set_new(changes, document->uri, edits);
    return json_pack("{s:o}", "changes", changes);
}

/* ---- Symbols ------------------------------------------------------------------------------------------------------------ */

/* Which labels are called, by program and label; NULL: out of memory. */
static bool *find_called(const struct analysis *analysis)
{
    const size_t programs = analysis->count == 0 ? 1 : analysis->commands[analysis->count - 1].program + 1;
    bool *called = calloc(programs, RKM04_LABELS + 1);
    for (size_t i = 0; called != NULL && i < analysis->count; i++) {
        const struct analysis_command *one = &analysis->commands[i];
        if (one->command.op == '\'')
            called[one->program * (RKM04_LABELS + 1) + one->command.argument] = true;
    }
    return called;
}

/* Where the commands of a label end: before the next label, of a subroutine after its last `.` before the next one. */
static size_t end_of(const struct analysis *analysis, size_t from, bool is_subroutine)
{
    size_t end = from, back = from;
    while (end + 1 < analysis->count && analysis->commands[end + 1].command.op != '@' &&
           analysis->commands[end + 1].command.op != '\\') {
        end++;
        if (analysis->commands[end].command.op == '.')
            back = end;
    }
    end = is_subroutine && back > from ? back : end;
    return analysis->commands[end].offset + analysis->commands[end].length;
}

json_t *lsp_list_symbols(struct session *session, const json_t *params, struct session_refusal *refusal)
{
    struct document *document = session_document(session, params, refusal);
    if (document == NULL)
        return NULL;
    struct analysis *analysis = &document->analysis;
    bool *called = find_called(analysis);
    json_t *list = called == NULL ? NULL : json_array();
    for (size_t i = 0; list != NULL && i < analysis->count && json_array_size(list) < SYMBOLS_MAX; i++) {
        const struct analysis_command *one = &analysis->commands[i];
        if (one->command.op != '@')
            continue;
        const bool is_subroutine = called[one->program * (RKM04_LABELS + 1) + one->command.argument];
        const size_t length = end_of(analysis, i, is_subroutine) - one->offset;
        json_array_append_new(
            list, json_pack("{s:o, s:s, s:i, s:o, s:o}", "name", json_sprintf("@%u", one->command.argument), "detail",
                            is_subroutine ? "subroutine" : "label", "kind", is_subroutine ? SYMBOL_FUNCTION : SYMBOL_KEY,
                            "range", session_range_json(document, one->offset, length), "selectionRange",
                            session_range_json(document, one->offset, one->length)));
    }
    free(called);
    return list;
}
