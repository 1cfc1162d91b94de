/* SPDX-License-Identifier: MIT */
/* The files that a CNC872 is made from (section 12 to 14). Each different text is read once and kept to the end of the process:
 * units, snapshots and recordings hold it by its address. */
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cnc872_device.h"
#include "text/text.h"

static struct cnc_text *texts[CNC_TEXTS_MAX]; /* all of them, by their numbers */
static size_t texts_size;                     /* bytes of all */
static unsigned texts_count;

struct error_log {
    FILE *out;
    const char *name;
};

static void report(void *context, const struct cnc_text_error *error)
{
    const struct error_log *log = context;
    if (log->out)
        fprintf(log->out, "%s:%u:%u: error: %s\n", log->name, (unsigned)error->line, (unsigned)error->column, error->text);
}

const struct cnc_config *cnc_default_config(void)
{
    static struct cnc_config config;
    static bool is_made;
    if (!is_made)
        cnc_config_clear(&config);
    is_made = true;
    return &config;
}

/* ---- The machine file (NJ4) --------------------------------------------------------------------------------------------- */

static bool read_um(const struct config_node *node, const char *key, bool *has, int64_t *value)
{
    const struct config_node *given = config_get(node, key);
    *has = given != NULL;
    if (!given)
        return true;
    if (!config_integer(given, key, -CNC_POSITION_MAX_MM * INT64_C(1000), CNC_POSITION_MAX_MM * INT64_C(1000), value))
        return false;
    *value *= CNC_U_PER_UM;
    return true;
}

static bool read_switch(const struct config_node *node, const struct cnc_names *names, struct cnc_switch *found)
{
    static const char *const keys[] = {"cell", "axis", "at_least", "at_most", NULL};
    struct cnc_operand operand;
    struct cnc_text_fault fault = {.reason = ""};
    if (config_type(node) != CONFIG_MAP)
        return config_error(node, "expected a switch, as in {cell: KHX0, axis: X, at_least: 100000}");
    const struct config_node *cell = config_get(node, "cell"), *axis = config_get(node, "axis");
    if (!config_keys(node, keys))
        return false;
    if (!cell || config_type(cell) != CONFIG_TEXT)
        return config_error(cell ? cell : node, "expected cell, the name of a bit, as in KHX0");
    const char *name = config_text(cell);
    if (!cnc_parse_operand(name, strlen(name), names, &operand, &fault) || operand.kind != CNC_OPERAND_BIT || !operand.writable)
        return config_error(cell, "expected a bit that may be written, as KHX0, found \"%.40s\"%s", name,
                            cnc_nearest_cell(names, name, &fault));
    const bool is_text = axis && config_type(axis) == CONFIG_TEXT;
    const int number = is_text ? cnc_find_axis(config_text(axis), strlen(config_text(axis))) : -1;
    if (number < 0)
        return config_error(axis ? axis : node, "expected axis, one of X, Y, Z, 4 to 16");
    *found = (struct cnc_switch){.place = operand.place, .axis = (uint8_t)number};
    if (!read_um(node, "at_least", &found->has_at_least, &found->at_least) ||
        !read_um(node, "at_most", &found->has_at_most, &found->at_most))
        return false;
    return found->has_at_least || found->has_at_most || config_error(node, "expected at_least, at_most or both, in um of POS6");
}

static bool read_switches(const struct config_node *root, const struct cnc_names *names, struct cnc_machine_switches *machine)
{
    static const char *const keys[] = {"switches", NULL};
    bool is_right = true;
    const struct config_node *list = config_type(root) == CONFIG_MAP ? config_get(root, "switches") : NULL;
    if (!list || config_type(list) != CONFIG_LIST)
        return config_error(list ? list : root, "expected switches, a list");
    if (!config_keys(root, keys))
        return false;
    if (config_count(list) > CNC_SWITCHES_MAX)
        return config_error(list, "expected at most %u switches", CNC_SWITCHES_MAX);
    machine->list = calloc(config_count(list) + 1u, sizeof *machine->list);
    for (size_t at = 0; machine->list && at < config_count(list); at++)
        is_right = read_switch(config_at(list, at), names, &machine->list[at]) && is_right;
    machine->count = (uint16_t)config_count(list);
    return machine->list && is_right;
}

static bool read_machine(struct cnc_text *text, const char *name, FILE *errors)
{
    char *lines = NULL;
    size_t size;
    FILE *none = errors ? NULL : open_memstream(&lines, &size);
    struct config_tree *tree = config_read(name, text->text, text->length, errors ? errors : none);
    const struct cnc_names *names = text->needs ? &text->needs->plc->names : NULL;
    const bool is_right = tree && read_switches(config_root(tree), names, &text->machine);
    if (tree)
        config_free(tree);
    if (none)
        fclose(none);
    free(lines);
    return is_right;
}

/* ---- Reading ------------------------------------------------------------------------------------------------------------ */

static bool read_config(struct cnc_text *text, struct error_log *log)
{
    struct cnc_config *config = malloc(sizeof *config);
    text->config = config;
    return config && cnc_config_read(text->text, text->length, config, report, log);
}

/* Give back what lies behind `size` bytes. Returns where they are now. */
static void *shrink(void *memory, size_t size)
{
    void *less = realloc(memory, size);
    if (!less)
        return memory;
    return less;
}

static bool read_program(struct cnc_text *text, struct error_log *log)
{
    struct cnc_nc_program *program = calloc(1, sizeof *program);
    text->program = program;
    if (!program)
        return false;
    cnc_nc_measure(text->text, text->length, &program->block_room, &program->value_room);
    program->blocks = calloc(program->block_room + 1u, sizeof *program->blocks);
    program->values = calloc(program->value_room + 1u, sizeof *program->values);
    const struct cnc_config *config = text->needs ? text->needs->config : cnc_default_config();
    if (!program->blocks || !program->values || !cnc_nc_read(text->text, text->length, config, program, report, log))
        return false;
    /* The rooms were those that the text could have needed. */
    program->blocks = shrink(program->blocks, (program->block_count + (size_t)1) * sizeof *program->blocks);
    program->values = shrink(program->values, (program->value_count + (size_t)1) * sizeof *program->values);
    return true;
}

/* Bytes of a PLC program as far as it is used. */
static size_t plc_size(const struct cnc_plc_program *plc)
{
    return offsetof(struct cnc_plc_program, code) + plc->length * sizeof plc->code[0];
}

static bool read_plc(struct cnc_text *text, struct error_log *log)
{
    struct cnc_plc_program *plc = malloc(sizeof *plc);
    text->plc = plc;
    if (!plc || !cnc_translate_plc(text->text, text->length, plc, report, log))
        return false;
    text->plc = shrink(plc, plc_size(plc));
    return true;
}

static void free_text(struct cnc_text *text)
{
    if (text->program) {
        free(text->program->blocks);
        free(text->program->values);
    }
    free((void *)text->config);
    free((void *)text->program);
    free((void *)text->plc);
    free(text->machine.list);
    free((void *)text->text);
    free(text);
}

static struct cnc_text *copy_text(enum cnc_text_kind kind, const struct cnc_text *needs, const char *text, size_t length)
{
    struct cnc_text *copy = calloc(1, sizeof *copy);
    char *own = malloc(length + 1u);
    if (!copy || !own) {
        free(copy);
        free(own);
        return NULL;
    }
    memcpy(own, text, length);
    own[length] = '\0';
    *copy = (struct cnc_text){.kind = kind, .needs = needs, .text = own, .length = length};
    return copy;
}

/* Bytes that a text takes, with what is made from it. */
static size_t size_of(const struct cnc_text *text)
{
    size_t size = sizeof *text + text->length + (text->config ? sizeof *text->config : 0) + (text->plc ? plc_size(text->plc) : 0);
    if (text->program)
        size += text->program->block_count * sizeof *text->program->blocks +
                text->program->value_count * sizeof *text->program->values;
    return size + text->machine.count * sizeof *text->machine.list;
}

static const struct cnc_text *find_text(enum cnc_text_kind kind, const struct cnc_text *needs, const char *text, size_t length)
{
    for (unsigned at = 0; at < texts_count; at++)
        if (texts[at]->kind == kind && texts[at]->needs == needs && texts[at]->length == length &&
            memcmp(texts[at]->text, text, length) == 0)
            return texts[at];
    return NULL;
}

const struct cnc_text *cnc_text_numbered(unsigned number)
{
    return number < texts_count ? texts[number] : NULL;
}

/* One that is right. Nothing that a text is read for gives it back: there is no more room then. */
static const struct cnc_text *keep(struct cnc_text *made, const char *name, FILE *errors)
{
    const size_t size = size_of(made);
    if (size > CNC_TEXTS_BYTES_MAX - texts_size) {
        if (errors)
            fprintf(errors, "%s: error: all texts together take more than %zu MiB: start the emulator again\n", name,
                    CNC_TEXTS_BYTES_MAX >> 20);
        free_text(made);
        return NULL;
    }
    texts_size += size;
    made->number = texts_count;
    texts[texts_count++] = made;
    return made;
}

const struct cnc_text *cnc_text_read(enum cnc_text_kind kind, const struct cnc_text *needs, const char *name, const char *text,
                                     size_t length, FILE *errors)
{
    struct error_log log = {.out = errors, .name = name};
    const struct cnc_text *found = find_text(kind, needs, text, length);
    if (found)
        return found;
    struct cnc_text *made = texts_count < CNC_TEXTS_MAX ? copy_text(kind, needs, text, length) : NULL;
    if (!made) {
        if (errors && texts_count < CNC_TEXTS_MAX)
            fprintf(errors, "%s: error: out of memory\n", name);
        else if (errors)
            fprintf(errors, "%s: error: %u different texts have been read: start the emulator again\n", name, CNC_TEXTS_MAX);
        return NULL;
    }
    const bool is_right = kind == CNC_TEXT_CONFIG ? read_config(made, &log)
                          : kind == CNC_TEXT_NC   ? read_program(made, &log)
                          : kind == CNC_TEXT_PLC  ? read_plc(made, &log)
                                                  : read_machine(made, name, errors);
    if (is_right)
        return keep(made, name, errors);
    free_text(made);
    return NULL;
}
