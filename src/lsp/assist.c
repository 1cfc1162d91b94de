/* SPDX-License-Identifier: MIT */
/* assist.c: what a command does, how long a program takes, the canonical layout. */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "features.h"

#define TEXT_SIZE 1024u

/* ---- Words of an estimate ------------------------------------------------------------------------------------------------ */

/* "250 ms", "24.5 s" */
static void print_duration(FILE *out, uint64_t us)
{
    if (us < 1000000)
        fprintf(out, "%" PRIu64 " ms", (us + 500) / 1000);
    else
        fprintf(out, "%" PRIu64 ".%" PRIu64 " s", (us + 50000) / 1000000, (us + 50000) / 100000 % 10);
}

/* "18 000 steps" */
static void print_steps(FILE *out, uint64_t steps)
{
    char digits[24];
    const int length = snprintf(digits, sizeof digits, "%" PRIu64, steps);
    for (int i = 0; i < length; i++)
        fprintf(out, "%s%c", i > 0 && (length - i) % 3 == 0 ? " " : "", digits[i]);
    fputs(steps == 1 ? " step" : " steps", out);
}

static void print_wait(FILE *out, const struct estimate *estimate, enum explain_language language)
{
    char text[160];
    if (estimate->wait_count == 0)
        return;
    const struct estimate_place *place = &estimate->waits[0].place;
    fprintf(out, "; then in line %zu: %s", place->line, explain_command(place->command, language, text, sizeof text));
}

/* The whole in a few words. */
static void print_lens(FILE *out, const struct estimate *estimate, enum explain_language language)
{
    const char *between = "; inputs come at once: ";
    if (estimate->end == ESTIMATE_LIMIT) {
        fprintf(out, "takes longer than the first %u commands, ", ANALYSIS_COMMANDS_MAX);
    } else {
        fputs(estimate->end == ESTIMATE_ROUND ? "a round takes " : "runs ", out);
    }
    print_duration(out, estimate->end == ESTIMATE_ROUND ? estimate->round : estimate->duration);
    fputs(", ", out);
    print_steps(out, estimate->steps[0]);
    if (estimate->end == ESTIMATE_ENDLESS && estimate->wait_count == 0)
        fputs("; then moves without an end", out);
    if (estimate->end == ESTIMATE_STOPPED)
        fputs("; then stops with a fault", out);
    print_wait(out, estimate, language);
    for (unsigned input = 0; input < RKM04_INPUTS; input++)
        if (estimate->assumed >> input & 1) {
            fprintf(out, "%s%02u", between, input + 1);
            between = ", ";
        }
}

json_t *lsp_list_lenses(struct session *session, const json_t *params, struct session_refusal *refusal)
{
    struct document *document = session_document(session, params, refusal);
    char text[TEXT_SIZE] = "";
    if (document == NULL)
        return NULL;
    struct analysis *analysis = &document->analysis;
    const struct program_source source = document_source(document);
    json_t *list = json_array();
    if (!analysis_estimate(analysis, &source) || analysis->estimated != ESTIMATE_OK || analysis->count == 0)
        return list;
    FILE *out = fmemopen(text, sizeof text - 1, "w");
    if (out == NULL)
        return list;
    print_lens(out, &analysis->estimate, session->options.language);
    fclose(out);
    json_array_append_new(list, json_pack("{s:o, s:{s:s, s:s}}", "range",
                                          session_range_json(document, analysis->commands[0].offset,
                                                             analysis->commands[0].length),
                                          "command", "title", text, "command", ""));
    return list;
}

/* ---- Hover --------------------------------------------------------------------------------------------------------------- */

static void print_motion(FILE *out, const struct estimate_motion *motion)
{
    if (motion->endless) {
        fprintf(out, "\n\npeak %" PRIu32 " steps/s", motion->peak);
        return;
    }
    fputs("\n\n", out);
    print_steps(out, motion->steps);
    fprintf(out, " in %" PRIu64 ".%06" PRIu64 " s, peak %" PRIu32 " steps/s", motion->duration / 1000000,
            motion->duration % 1000000, motion->peak);
    if (motion->times > 1)
        fprintf(out, "; %" PRIu64 " times%s%s", motion->times, motion->in_round ? " in a round" : "",
                motion->varies ? ", this is the last one" : "");
    if (motion->point_count == 0)
        return;
    fputs("\n\nbreak points:", out);
    for (size_t i = 0; i < motion->point_count; i++)
        fprintf(out, " (%" PRIu32 ";%" PRIu32 ")", motion->points[i].step, motion->points[i].speed);
}

json_t *lsp_hover(struct session *session, const json_t *params, struct session_refusal *refusal)
{
    size_t offset;
    char text[TEXT_SIZE] = "", command[RKM04_COMMAND_TEXT_MAX + 1];
    struct document *document = session_document(session, params, refusal);
    if (document == NULL || !session_offset(document, params, &offset, refusal))
        return NULL;
    struct analysis *analysis = &document->analysis;
    const struct program_source source = document_source(document);
    const struct analysis_command *at = analysis_at(analysis, offset);
    if (at == NULL)
        return json_null();
    if (!analysis_explain(analysis, &source, session->options.language) || !analysis_estimate(analysis, &source))
        return session_refuse(refusal, REFUSED_INTERNAL, "out of memory");
    const struct explanation *explanation = explain_at(&analysis->explanations, 0, at->offset);
    const struct estimate_motion *motion =
        analysis->estimated == ESTIMATE_OK ? analysis_motion(analysis, at->offset) : NULL;
    FILE *out = fmemopen(text, sizeof text - 1, "w");
    if (out == NULL || explanation == NULL) {
        if (out != NULL)
            fclose(out);
        return json_null();
    }
    command[rkm04_format(at->command, command)] = '\0';
    fprintf(out, "`%s` %s", command, explanation->text);
    if (motion != NULL)
        print_motion(out, motion);
    fclose(out);
    return json_pack("{s:{s:s, s:s}, s:o}", "contents", "kind", "markdown", "value", text, "range",
                     session_range_json(document, at->offset, at->length));
}

/* ---- Layout -------------------------------------------------------------------------------------------------------------- */

/* The edit that makes one text of another: lines at the beginning and the end that are the same are left alone. */
static json_t *edit_json(struct document *document, const char *text, size_t length)
{
    size_t begin = 0, end = 0;
    const size_t least = length < document->length ? length : document->length;
    for (size_t at = 0; at < least && document->text[at] == text[at]; at++)
        if (text[at] == '\n')
            begin = at + 1;
    while (end < least - begin && document->text[document->length - end - 1] == text[length - end - 1])
        end++;
    const char *newline = end == 0 ? NULL : memchr(text + length - end, '\n', end);
    end = newline == NULL ? 0 : (size_t)(text + length - newline) - 1;
    return json_pack("{s:o, s:s%}", "range", session_range_json(document, begin, document->length - end - begin), "newText",
                     text + begin, length - end - begin);
}

/* A text with errors has no layout: its diagnostics say why. */
json_t *lsp_format(struct session *session, const json_t *params, struct session_refusal *refusal)
{
    char *text = NULL;
    size_t length = 0;
    struct document *document = session_document(session, params, refusal);
    if (document == NULL)
        return NULL;
    const struct program_source source = document_source(document);
    const enum format_result result = format_program(&source, &text, &length);
    if (result == FORMAT_NO_MEMORY)
        return session_refuse(refusal, REFUSED_INTERNAL, "out of memory");
    if (result == FORMAT_ERRORS)
        return json_null();
    json_t *list = json_array();
    if (length != source.length || (length > 0 && memcmp(text, source.text, length) != 0))
        json_array_append_new(list, edit_json(document, text, length));
    free(text);
    return list;
}
