/* SPDX-License-Identifier: MIT */
#include "analysis.h"

#include <stdlib.h>
#include <string.h>

#include "text/text.h"

static bool add_command(struct analysis *analysis, const struct token *token, unsigned program)
{
    if (analysis->count == analysis->room) {
        const size_t room = analysis->room == 0 ? 64 : 2 * analysis->room;
        struct analysis_command *grown = realloc(analysis->commands, room * sizeof *grown);
        if (grown == NULL)
            return false;
        analysis->commands = grown;
        analysis->room = room;
    }
    analysis->commands[analysis->count++] = (struct analysis_command){token->command, token->offset, token->length, program};
    return true;
}

bool analysis_read(struct analysis *analysis, const struct program_source *source)
{
    struct token_reader tokens;
    unsigned program = 0;
    if (analysis->has_commands)
        return true;
    analysis_clear(analysis);
    analysis->mapped = malloc(source->length + 1);
    if (analysis->mapped == NULL)
        return false;
    if (source->length > 0)
        memcpy(analysis->mapped, source->text, source->length);
    program_text_map_in_place(analysis->mapped, source->length);
    token_begin(&tokens, analysis->mapped, source->length);
    for (struct token token = token_next(&tokens); token.kind != TOKEN_END; token = token_next(&tokens)) {
        if (token.kind != TOKEN_COMMAND)
            continue;
        program += token.command.op == '\\';
        if (!add_command(analysis, &token, program))
            return false;
    }
    analysis->has_commands = true;
    return true;
}

bool analysis_explain(struct analysis *analysis, const struct program_source *source, enum explain_language language)
{
    if (!analysis->has_explanations) {
        explain_free(&analysis->explanations);
        analysis->has_explanations = explain_programs(source, 1, language, &analysis->explanations);
    }
    return analysis->has_explanations;
}

bool analysis_estimate(struct analysis *analysis, const struct program_source *source)
{
    static const struct estimate_options options = {.pass_inputs = true, .commands_max = ANALYSIS_COMMANDS_MAX};
    if (!analysis->has_estimate) {
        estimate_free(&analysis->estimate);
        analysis->estimated = estimate_programs(source, 1, &options, &analysis->estimate);
        analysis->has_estimate = analysis->estimated != ESTIMATE_NO_MEMORY;
    }
    return analysis->has_estimate;
}

void analysis_clear(struct analysis *analysis)
{
    free(analysis->mapped);
    free(analysis->commands);
    explain_free(&analysis->explanations);
    estimate_free(&analysis->estimate);
    *analysis = (struct analysis){0};
}

const struct analysis_command *analysis_at(const struct analysis *analysis, size_t offset)
{
    size_t low = 0, high = analysis->count; /* the first command after the offset */
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (analysis->commands[middle].offset <= offset)
            low = middle + 1;
        else
            high = middle;
    }
    if (low == 0)
        return NULL;
    const struct analysis_command *command = &analysis->commands[low - 1];
    return offset <= command->offset + command->length ? command : NULL;
}

unsigned analysis_label(struct rkm04_command command)
{
    if (command.op == 'I')
        return command.argument >> 16;
    return command.op == '@' || command.op == 'J' || command.op == '\'' ? command.argument : 0;
}

static bool is_digit(char character)
{
    return character >= '0' && character <= '9';
}

void analysis_label_place(const struct analysis *analysis, const struct analysis_command *command, size_t *offset,
                          size_t *length)
{
    size_t end = command->offset + command->length;
    while (end > command->offset && !is_digit(analysis->mapped[end - 1]))
        end--;
    *offset = end;
    while (*offset > command->offset && is_digit(analysis->mapped[*offset - 1]))
        --*offset;
    *length = end - *offset;
}

const struct analysis_command *analysis_find_label(const struct analysis *analysis, unsigned label, unsigned program)
{
    const struct analysis_command *found = NULL; /* the last one counts (C8) */
    for (size_t i = 0; i < analysis->count; i++) {
        const struct analysis_command *one = &analysis->commands[i];
        if (one->program == program && one->command.op == '@' && one->command.argument == label)
            found = one;
    }
    return found;
}

const struct estimate_motion *analysis_motion(const struct analysis *analysis, size_t offset)
{
    for (size_t i = 0; i < analysis->estimate.motion_count; i++)
        if (analysis->estimate.motions[i].place.offset == offset)
            return &analysis->estimate.motions[i];
    return NULL;
}
