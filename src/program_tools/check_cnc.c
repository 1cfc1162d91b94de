/* SPDX-License-Identifier: MIT */
#include "check_cnc.h"
#include "check_cnc_names.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum text_kind { TEXT_CONFIG, TEXT_NC, TEXT_PLC, TEXT_KINDS };

struct checking {
    const struct program_source *source;
    struct diagnostics *found;
    enum text_kind kind;
};

static const struct {
    const char *end, *name;
} kinds[] = {{".xml", "config-error"}, {".nc", "nc-error"}, {".plc", "plc-error"}};

static enum text_kind kind_of(const char *name)
{
    const size_t length = strlen(name);
    unsigned kind = 0;
    while (kind < TEXT_KINDS && (length < strlen(kinds[kind].end) ||
                                 strcasecmp(name + length - strlen(kinds[kind].end), kinds[kind].end) != 0))
        kind++;
    return (enum text_kind)kind;
}

bool check_cnc_takes(const char *name)
{
    return kind_of(name) != TEXT_KINDS;
}

/* Bytes of the word that begins at `text`: an address of an NC program with its number, a word of a PLC program, a name or a
 * value of a configuration; 0 at the end of a line. */
static size_t word_length(enum text_kind kind, const char *text, size_t rest)
{
    static const char *const ends[] = {[TEXT_CONFIG] = " \t\r\n<>=\"'/", [TEXT_PLC] = " \t\r\n;,"};
    size_t length = rest > 0 && strchr("\r\n", text[0]) == NULL;
    if (kind == TEXT_CONFIG && length > 0 && length < rest && text[0] == '<')
        length += text[1] == '/';
    while (length > 0 && length < rest && text[length] != '\0' &&
           (kind == TEXT_NC ? strchr("0123456789.+-=", text[length]) != NULL || ((unsigned char)text[length] & 0xC0) == 0x80
                            : strchr(ends[kind], text[length]) == NULL))
        length++;
    return length;
}

static void take_error(void *context, const struct cnc_text_error *error)
{
    const struct checking *checking = context;
    const char *text = checking->source->text, *at = text, *end = text + checking->source->length, *next;
    for (uint32_t line = 1; line < error->line && (next = memchr(at, '\n', (size_t)(end - at))) != NULL; line++)
        at = next + 1;
    const size_t column = error->column - 1;
    const size_t offset = (size_t)(at - text) + (column < (size_t)(end - at) ? column : (size_t)(end - at));
    const struct diagnostic one = {.offset = offset,
                                   .length = word_length(checking->kind, text + offset, (size_t)(end - text) - offset),
                                   .severity = DIAGNOSTIC_ERROR,
                                   .name = kinds[checking->kind].name};
    diagnostics_add(checking->found, &one, check_cnc_hint(checking->source, error->text), "%s", error->text);
}

/* Room for a program of `blocks` and `values`; both pointers are to be freed. */
static bool make_room(struct cnc_nc_program *program, uint32_t blocks, uint32_t values)
{
    *program = (struct cnc_nc_program){.block_room = blocks, .value_room = values};
    program->blocks = malloc(((size_t)blocks + 1) * sizeof *program->blocks);
    program->values = malloc(((size_t)values + 1) * sizeof *program->values);
    return program->blocks != NULL && program->values != NULL;
}

static bool check_nc(const struct program_source *source, const struct cnc_config *machine, struct checking *checking)
{
    struct cnc_nc_program program;
    uint32_t blocks, values;
    cnc_nc_measure(source->text, source->length, &blocks, &values);
    const bool is_room = make_room(&program, blocks, values);
    if (is_room)
        cnc_nc_read(source->text, source->length, machine, &program, take_error, checking);
    free(program.blocks);
    free(program.values);
    return is_room;
}

static bool check_plc(const struct program_source *source, struct checking *checking)
{
    struct cnc_plc_program *program = malloc(sizeof *program);
    if (program != NULL)
        cnc_translate_plc(source->text, source->length, program, take_error, checking);
    const bool is_room = program != NULL;
    free(program);
    return is_room;
}

bool check_cnc(const struct program_source *source, struct cnc_config *machine, struct diagnostics *found)
{
    const enum text_kind kind = kind_of(source->name);
    struct checking checking = {source, found, kind == TEXT_KINDS ? TEXT_CONFIG : kind};
    bool ok = true;
    *found = (struct diagnostics){0};
    if (kind == TEXT_PLC)
        ok = check_plc(source, &checking);
    else if (kind == TEXT_NC)
        ok = check_nc(source, machine, &checking);
    else
        cnc_config_read(source->text, source->length, machine, take_error, &checking);
    diagnostics_arrange(found, source);
    return ok && !found->no_memory;
}
