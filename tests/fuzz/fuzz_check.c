/* SPDX-License-Identifier: MIT */
/* fuzz_check.c: any bytes as a program text, or as those of two motors, with a zero between them. What is found lies in the text,
 * in order; there are errors if and only if the unit would refuse the text; every format can be printed; every command that is
 * read has an explanation. */
#include <string.h>

#include "fuzz.h"
#include "program_tools/program_tools.h"
#include "text/text.h"

/* Does the reader of the unit refuse a text? */
static bool is_refused(const struct program_source *source)
{
    struct rkm04_reader reader;
    struct rkm04_command command;
    enum rkm04_read found;
    char *mapped = malloc(source->length + 1);
    FUZZ_CHECK(mapped != NULL, "memory");
    memcpy(mapped, source->text, source->length);
    size_t length = program_text_map(mapped, source->length);
    rkm04_read_begin(&reader, mapped, length);
    while ((found = rkm04_read(&reader, &command)) == RKM04_READ_COMMAND)
        continue;
    free(mapped);
    return found != RKM04_READ_END;
}

static void check_found(const struct program_source *sources, size_t count, const struct diagnostics *found)
{
    size_t errors = 0;
    for (size_t i = 0; i < found->count; i++) {
        const struct diagnostic *one = &found->list[i];
        FUZZ_CHECK(one->source < count, "source %zu", one->source);
        FUZZ_CHECK(one->offset + one->length <= sources[one->source].length, "%zu + %zu", one->offset, one->length);
        FUZZ_CHECK(one->line >= 1 && one->column >= 1, "%zu:%zu", one->line, one->column);
        FUZZ_CHECK(strchr(one->message, '\n') == NULL, "%s", one->message);
        if (i > 0 && one->source == one[-1].source)
            FUZZ_CHECK(one->offset >= one[-1].offset, "%zu behind %zu", one->offset, one[-1].offset);
        errors += one->severity == DIAGNOSTIC_ERROR;
    }
    bool refused = false;
    for (size_t i = 0; i < count; i++)
        refused = refused || is_refused(&sources[i]);
    FUZZ_CHECK((found->errors > 0) == refused && errors <= found->errors, "%zu errors", found->errors);
}

static void print_all(const struct program_source *sources, const struct diagnostics *found)
{
    static FILE *nowhere;
    if (nowhere == NULL)
        nowhere = fopen("/dev/null", "w");
    for (unsigned format = 0; format < CHECK_FORMATS; format++) {
        struct check_printer printer;
        check_print_begin(&printer, (enum check_format)format, nowhere);
        check_print(&printer, sources, found);
        FUZZ_CHECK(check_print_end(&printer), "format %u", format);
    }
}

/* As many explanations as commands, each of one line and for its place. */
static void check_explanations(const struct program_source *sources, size_t count, enum explain_language language)
{
    struct explanations all;
    FUZZ_CHECK(explain_programs(sources, count, language, &all), "memory");
    for (size_t i = 0; i < all.count; i++) {
        const struct explanation *one = &all.list[i];
        FUZZ_CHECK(one->offset + one->length <= sources[one->source].length, "%zu + %zu", one->offset, one->length);
        FUZZ_CHECK(one->text[0] != '?' && strchr(one->text, '\n') == NULL, "%s", one->text);
        FUZZ_CHECK(explain_at(&all, one->source, one->offset) == one, "not found at %zu", one->offset);
    }
    explain_free(&all);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const struct check_options options;
    const char *text = (const char *)data, *middle = size > 0 ? memchr(text, '\0', size) : NULL;
    const size_t first = middle == NULL ? size : (size_t)(middle - text);
    const struct program_source sources[] = {
        {"a.rks", text, first, 1},
        {"b.rks", text + first, size - first, 2},
    };
    struct diagnostics found;
    const size_t count = middle == NULL ? 1 : 2;
    FUZZ_CHECK(check_programs(sources, count, &options, &found), "memory");
    check_found(sources, count, &found);
    print_all(sources, &found);
    diagnostics_free(&found);
    for (unsigned language = 0; language < EXPLAIN_LANGUAGES; language++)
        check_explanations(sources, count, (enum explain_language)language);
    return 0;
}
