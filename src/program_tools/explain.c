/* SPDX-License-Identifier: MIT */
#include "explain.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "code.h"
#include "explain_words.h"
#include "flow.h"
#include "source_texts.h"
#include "text/text.h"
#include "token.h"

/* The formats are in a table of words. */
#pragma GCC diagnostic ignored "-Wformat-nonliteral"

#define TEXT_SIZE 320

const char *explain_command(struct rkm04_command command, enum explain_language language, char *text, size_t size)
{
    static const char *const bits[EXPLAIN_LANGUAGES][2] = {{"input", "variable"}, {"vstup", "proměnná"}};
    const char *format = explain_template(command, language);
    const unsigned bit = command.argument & 0xFF;
    if (command.op == 'I')
        snprintf(text, size, format, bits[language][bit >= RKM04_FIRST_VARIABLE], bit, (unsigned)(command.argument >> 8 & 1),
                 (unsigned)(command.argument >> 16));
    else
        snprintf(text, size, format, command.argument);
    return text;
}

const char *explain_kind(uint8_t op, uint32_t low, enum explain_language language, char *text, size_t size)
{
    const char *format = explain_template((struct rkm04_command){op, low}, language);
    size_t at = 0;
    while (*format != '\0' && at + 2 < size) {
        if (*format != '%') {
            text[at++] = *format++;
            continue;
        }
        text[at++] = 'n';
        format += strcspn(format, "uds");
        format += *format != '\0';
    }
    text[at] = '\0';
    return text;
}

/* ---- Parameters in force -------------------------------------------------------------------------------------------- */

struct writer {
    char text[TEXT_SIZE];
    size_t length;
    enum explain_language language;
};

__attribute__((format(printf, 2, 3))) static void append(struct writer *writer, const char *format, ...)
{
    va_list arguments;
    if (writer->length >= sizeof writer->text)
        return;
    va_start(arguments, format);
    int more = vsnprintf(writer->text + writer->length, sizeof writer->text - writer->length, format, arguments);
    va_end(arguments);
    if (more > 0)
        writer->length += (size_t)more;
}

static const char *phrase(const struct writer *writer, enum explain_phrase which)
{
    return explain_phrase(which, writer->language);
}

static const char *direction_words(const struct writer *writer, unsigned directions)
{
    return phrase(writer, directions == FLOW_FORWARD ? PHRASE_FORWARD : directions == FLOW_BACK ? PHRASE_BACK : PHRASE_EITHER);
}

/* S, V and A; what is not known is not printed. */
static void append_speeds(struct writer *writer, const struct flow_state *in, bool only_start)
{
    const char *between = "; ";
    if (in->start_speed != FLOW_UNKNOWN) {
        append(writer, "%sS%" PRId64, between, in->start_speed);
        between = " ";
    }
    if (!only_start && in->speed != FLOW_UNKNOWN) {
        append(writer, "%sV%" PRId64, between, in->speed);
        between = " ";
    }
    if (!only_start && in->acceleration != FLOW_UNKNOWN)
        append(writer, "%sA%" PRId64, between, in->acceleration);
}

static void append_guard(struct writer *writer, char op, unsigned guard)
{
    for (unsigned input = 1; input <= RKM04_INPUTS; input++)
        if (guard == 1u << input) {
            append(writer, ", ");
            append(writer, phrase(writer, PHRASE_GUARD), op, input);
        }
}

static void append_steps(struct writer *writer, const struct flow_state *in, struct rkm04_command command)
{
    int64_t steps;
    bool forward;
    if (flow_state_way(in, command, &steps, &forward)) {
        append(writer, steps == 0 && command.op == 'R' ? "%s" : "%.0s", phrase(writer, PHRASE_NOTHING));
        if (steps != 0 || command.op != 'R')
            append(writer, phrase(writer, PHRASE_STEPS), (long long)steps,
                   phrase(writer, forward ? PHRASE_FORWARD : PHRASE_BACK));
        return;
    }
    if (command.op != 'R')
        return;
    if (in->count != FLOW_UNKNOWN)
        append(writer, phrase(writer, PHRASE_STEPS), (long long)in->count, direction_words(writer, in->direction));
    else
        append(writer, phrase(writer, PHRASE_SOME_STEPS), direction_words(writer, in->direction));
}

static void append_table(struct writer *writer, const struct flow_state *in)
{
    unsigned count = 0;
    unsigned long long steps = 0;
    if (!in->table_known || in->table >> (RKM04_SEGMENTS_MAX + 1) != 0) {
        append(writer, "%s", phrase(writer, PHRASE_SOME_COMPOUND));
        return;
    }
    for (; in->table >> count != 1; count++)
        steps += in->segment[count].steps;
    append(writer, phrase(writer, PHRASE_COMPOUND), count, steps, direction_words(writer, in->table_direction));
}

static void append_motion(struct writer *writer, const struct flow_state *in, struct rkm04_command command)
{
    const size_t before = writer->length;
    append(writer, ": ");
    const size_t colon = writer->length;
    if (command.op == 'R' && in->table != 1)
        append_table(writer, in);
    else if (!code_is_endless(command))
        append_steps(writer, in, command);
    if (writer->length == colon)
        writer->length = before;
    append_speeds(writer, in, command.op == '(' || command.op == ')' || (command.op == 'R' && in->table != 1));
    append_guard(writer, 'M', in->guard_m);
    append_guard(writer, 'N', in->guard_n);
}

static void append_segment(struct writer *writer, const struct flow_state *in)
{
    append(writer, ": ");
    append_steps(writer, in, (struct rkm04_command){.op = 'R'});
    if (in->speed != FLOW_UNKNOWN)
        append(writer, "; V%" PRId64, in->speed);
    if (in->acceleration != FLOW_UNKNOWN)
        append(writer, " A%" PRId64, in->acceleration);
}

/* ---- Programs ------------------------------------------------------------------------------------------------------- */

/* What is known before a command, of all situations in which it is executed. Returns false if it never is. */
static bool state_at(const struct flow *flow, size_t index, struct flow_state *state)
{
    bool any = false;
    if (flow->first_node == NULL)
        return false;
    for (uint32_t node = flow->first_node[index]; node != FLOW_NO_NODE; node = flow->nodes[node].same) {
        if (any)
            flow_state_join(state, &flow->nodes[node].in);
        else
            *state = flow->nodes[node].in;
        any = true;
    }
    return any;
}

static void explain_one(struct writer *writer, const struct flow *flow, size_t index, struct rkm04_command command)
{
    struct flow_state state = flow_state_begin();
    explain_command(command, writer->language, writer->text, sizeof writer->text);
    writer->length = strlen(writer->text);
    if (command.op == '@' && flow->called[command.argument])
        append(writer, ", %s", phrase(writer, PHRASE_SUBROUTINE));
    if (state_at(flow, index, &state)) {
        if (code_is_motion(command))
            append_motion(writer, &state, command);
        else if (command.op == 'Y')
            append_segment(writer, &state);
    } else if (flow->complete && command.op != '\\') {
        append(writer, " (%s)", phrase(writer, PHRASE_NEVER));
    }
}

static bool add(struct explanations *all, struct text_place *place, size_t source, const struct token *token, const char *text)
{
    if (all->count == all->room) {
        const size_t room = all->room == 0 ? 64 : 2 * all->room;
        struct explanation *grown = realloc(all->list, room * sizeof *grown);
        if (grown == NULL)
            return false;
        all->list = grown;
        all->room = room;
    }
    text_place_move(place, token->offset);
    all->list[all->count] =
        (struct explanation){source, token->offset, token->length, place->line, place->column, strdup(text)};
    return all->list[all->count].text != NULL && ++all->count > 0;
}

/* Explain a source whose commands begin at `*index` of the code. */
static bool explain_source(struct explanations *all, const struct code *code, const struct flow *flow, size_t source,
                           const char *text, size_t *index, enum explain_language language)
{
    struct writer writer = {.language = language};
    struct token_reader tokens;
    struct text_place place = text_place_begin(code->sources[source].text, code->sources[source].length);
    token_begin(&tokens, text, code->sources[source].length);
    for (struct token token = token_next(&tokens); token.kind != TOKEN_END; token = token_next(&tokens)) {
        if (token.kind != TOKEN_COMMAND)
            continue;
        if (*index < code->count && code->commands[*index].source == source && code->commands[*index].offset == token.offset)
            explain_one(&writer, flow, (*index)++, token.command);
        else /* K, C75 */
            explain_command(token.command, language, writer.text, sizeof writer.text);
        if (!add(all, &place, source, &token, writer.text))
            return false;
    }
    return true;
}

static bool explain_motor(struct explanations *all, const struct program_source *sources, size_t count, unsigned motor,
                          char *const *texts, enum explain_language language)
{
    struct code code;
    struct flow flow = {.complete = false};
    size_t index = 0;
    bool ok = true;
    code_begin(&code, sources, count);
    for (size_t i = 0; ok && i < count; i++)
        ok = sources[i].motor != motor || code_read(&code, i, texts[i], NULL, NULL);
    ok = ok && flow_begin(&flow, &code, UINT16_MAX);
    for (size_t i = 0; ok && i < count; i++)
        ok = sources[i].motor != motor || explain_source(all, &code, &flow, i, texts[i], &index, language);
    flow_end(&flow);
    code_free(&code);
    return ok;
}

static int compare(const void *left, const void *right)
{
    const struct explanation *a = left, *b = right;
    if (a->source != b->source)
        return a->source < b->source ? -1 : 1;
    return a->offset < b->offset ? -1 : a->offset > b->offset;
}

bool explain_programs(const struct program_source *sources, size_t count, enum explain_language language,
                      struct explanations *all)
{
    char **texts = source_texts_map(sources, count);
    bool ok = texts != NULL;
    *all = (struct explanations){0};
    for (unsigned motor = 0; ok && motor <= RKM04_MOTORS; motor++)
        ok = explain_motor(all, sources, count, motor, texts, language);
    source_texts_free(texts, count);
    if (all->count > 0)
        qsort(all->list, all->count, sizeof all->list[0], compare);
    return ok;
}

void explain_free(struct explanations *all)
{
    for (size_t i = 0; i < all->count; i++)
        free(all->list[i].text);
    free(all->list);
    *all = (struct explanations){0};
}

const struct explanation *explain_at(const struct explanations *all, size_t source, size_t offset)
{
    const struct explanation *touched = NULL;
    for (size_t i = 0; i < all->count; i++) {
        const struct explanation *one = &all->list[i];
        if (one->source != source || offset < one->offset || offset > one->offset + one->length)
            continue;
        if (offset < one->offset + one->length)
            return one;
        touched = one;
    }
    return touched;
}
