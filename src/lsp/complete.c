/* SPDX-License-Identifier: MIT */
/* complete.c: what may be written at a place: commands with their ranges, numbers that mean something, labels that the program
 * has, names of warnings in a nolint comment. */
#include <stdlib.h>
#include <string.h>

#include "features.h"
#include "text/text.h"

#define VALUES_MAX 100u /* of a command are offered one by one; of a command with more, none */
#define TEXT_SIZE 200u

enum kind { KIND_KEYWORD = 14, KIND_VALUE = 12, KIND_REFERENCE = 18 };

struct completion {
    struct document *document;
    enum explain_language language;
    const char *mapped;
    size_t begin, at; /* what is replaced: digits or a word before the cursor; the cursor */
    json_t *list;
};

static void add(const struct completion *completion, const char *label, enum kind kind, const char *detail)
{
    char sorted[8];
    snprintf(sorted, sizeof sorted, "%06zu", json_array_size(completion->list));
    json_array_append_new(
        completion->list,
        json_pack("{s:s, s:i, s:s, s:s, s:{s:o, s:s}}", "label", label, "kind", (int)kind, "detail", detail, "sortText", sorted,
                  "textEdit", "range",
                  session_range_json(completion->document, completion->begin, completion->at - completion->begin), "newText",
                  label));
}

/* ---- Commands ------------------------------------------------------------------------------------------------------------ */

/* "1..16000", "1..8, 40..58, 80..95"; "" for a command without a number. */
static void print_ranges(FILE *out, const struct rkm04_range *ranges, int count)
{
    for (int i = 0; i < count; i++) {
        fprintf(out, i > 0 ? ", %d" : " (%d", (int)ranges[i].low);
        if (ranges[i].high > ranges[i].low)
            fprintf(out, "..%d", (int)ranges[i].high);
    }
    if (count > 0)
        fputc(')', out);
}

static void add_commands(const struct completion *completion)
{
    static const char commands[] = "\\FBRGHVASWTCOZLEJI@'.YMNUX()D=[]";
    for (const char *command = commands; *command != '\0'; command++) {
        struct rkm04_range ranges[RKM04_RANGES_MAX];
        enum rkm04_form form;
        char text[TEXT_SIZE] = "", kind[TEXT_SIZE / 2], label[] = {*command, '\0'};
        const int count = rkm04_form_of((uint8_t)*command, &form, ranges);
        FILE *out = fmemopen(text, sizeof text - 1, "w");
        if (out == NULL)
            return;
        fputs(explain_kind((uint8_t)*command, count > 0 && ranges[0].low >= 0 ? (uint32_t)ranges[0].low : 0,
                           completion->language, kind, sizeof kind),
              out);
        print_ranges(out, ranges, count);
        fclose(out);
        add(completion, label, KIND_KEYWORD, text);
    }
}

/* ---- Numbers ------------------------------------------------------------------------------------------------------------- */

static void add_value(const struct completion *completion, uint8_t op, uint32_t value, bool two_digits)
{
    char label[12], text[TEXT_SIZE];
    snprintf(label, sizeof label, two_digits ? "%02u" : "%u", value);
    explain_command((struct rkm04_command){op, value}, completion->language, text, sizeof text);
    add(completion, label, KIND_VALUE, text);
}

static void add_labels(const struct completion *completion)
{
    bool has[RKM04_LABELS + 1] = {false};
    const struct analysis *analysis = &completion->document->analysis;
    for (size_t i = 0; i < analysis->count; i++)
        if (analysis->commands[i].command.op == '@')
            has[analysis->commands[i].command.argument] = true;
    for (unsigned label = 1; label <= RKM04_LABELS; label++)
        if (has[label]) {
            char text[12];
            snprintf(text, sizeof text, "%u", label);
            add(completion, text, KIND_REFERENCE, "");
        }
}

/* The numbers of a command with few: inputs, outputs, variables, functions. */
static void add_values(const struct completion *completion, uint8_t op)
{
    struct rkm04_range ranges[RKM04_RANGES_MAX];
    enum rkm04_form form;
    unsigned values = 0;
    int count = rkm04_form_of(op, &form, ranges);
    if (count < 0 || form == RKM04_FORM_NONE || form == RKM04_FORM_SIGNED)
        return;
    if (form == RKM04_FORM_ABSOLUTE) {
        add(completion, "+", KIND_VALUE, "");
        add(completion, "-", KIND_VALUE, "");
        return;
    }
    count = form == RKM04_FORM_JUMP_IF ? 2 : count; /* the bit; the label is another place */
    for (int i = 0; i < count; i++)
        values += (unsigned)(ranges[i].high - ranges[i].low) + 1;
    for (int i = 0; values <= VALUES_MAX && op != '@' && i < count; i++)
        for (int32_t value = ranges[i].low; value <= ranges[i].high; value++)
            add_value(completion, form == RKM04_FORM_JUMP_IF ? 'O' : op, (uint32_t)value, true);
}

/* ---- The place ----------------------------------------------------------------------------------------------------------- */

/* The comment around the cursor, one that is not closed among them. Returns whether there is one. */
static bool find_comment(const struct completion *completion, size_t length, size_t *begin)
{
    struct token_reader tokens;
    token_begin(&tokens, completion->mapped, length);
    for (struct token token = token_next(&tokens); token.kind != TOKEN_END && token.offset < completion->at;
         token = token_next(&tokens)) {
        const bool open = token.kind == TOKEN_ERROR && completion->mapped[token.offset] == '{';
        *begin = token.offset;
        if (open || (token.kind == TOKEN_COMMENT && completion->at < token.offset + token.length))
            return true;
    }
    return false;
}

static void complete_comment(struct completion *completion, size_t begin)
{
    static const char *const words[] = {"{nolint ", "{nolint-file "};
    while (completion->begin > begin && strchr(" {,\r\n\t", completion->mapped[completion->begin - 1]) == NULL)
        completion->begin--;
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        if (completion->begin >= begin + strlen(words[i]) &&
            strncmp(completion->mapped + begin, words[i], strlen(words[i])) == 0) {
            for (unsigned warning = 0; warning < CHECK_WARNINGS; warning++)
                add(completion, check_warning_name((enum check_warning)warning), KIND_VALUE,
                    check_warning_text((enum check_warning)warning));
            return;
        }
}

static bool is_digit(char character)
{
    return character >= '0' && character <= '9';
}

static size_t skip_back(const char *text, size_t at, bool digits)
{
    while (at > 0 && (digits ? is_digit(text[at - 1]) : (unsigned char)text[at - 1] <= ' '))
        at--;
    return at;
}

/* Is the character at `at` the H or L of a jump `I01H`? */
static bool is_level(const char *text, size_t at)
{
    const size_t end = skip_back(text, at, false), begin = skip_back(text, end, true), op = skip_back(text, begin, false);
    return (text[at] == 'H' || text[at] == 'L') && begin < end && op > 0 && text[op - 1] == 'I';
}

/* H and L after the number of an I. */
static void add_levels(struct completion *completion)
{
    completion->begin = completion->at;
    add(completion, "H", KIND_VALUE, "is 1");
    add(completion, "L", KIND_VALUE, "is 0");
}

static void complete_program(struct completion *completion)
{
    struct rkm04_range ranges[RKM04_RANGES_MAX];
    enum rkm04_form form;
    const char *text = completion->mapped;
    completion->begin = skip_back(text, completion->at, true);
    const size_t before = skip_back(text, completion->begin, false);
    const bool has_digits = completion->begin < completion->at;
    const char op = before == 0 ? '\0' : text[before - 1];
    if (before > 0 && (op == 'J' || op == '\'' || is_level(text, before - 1))) {
        add_labels(completion);
    } else if (before > 0 && rkm04_form_of((uint8_t)op, &form, ranges) > 0) {
        add_values(completion, (uint8_t)op);
        if (op == 'I' && has_digits)
            add_levels(completion);
    } else if (!has_digits) {
        add_commands(completion);
    }
    if (has_digits && json_array_size(completion->list) == 0) {
        completion->begin = completion->at; /* after a number */
        add_commands(completion);
    }
}

json_t *lsp_complete(struct session *session, const json_t *params, struct session_refusal *refusal)
{
    size_t comment;
    struct completion completion = {.language = session->options.language};
    completion.document = session_document(session, params, refusal);
    if (completion.document == NULL || !session_offset(completion.document, params, &completion.at, refusal))
        return NULL;
    completion.mapped = completion.document->analysis.mapped;
    completion.begin = completion.at;
    completion.list = json_array();
    if (find_comment(&completion, completion.document->length, &comment))
        complete_comment(&completion, comment);
    else
        complete_program(&completion);
    return json_pack("{s:b, s:o}", "isIncomplete", true, "items", completion.list);
}
