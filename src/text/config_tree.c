/* SPDX-License-Identifier: MIT */
#include "config_tree.h"

#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <yaml.h>

#include "error_lines.h"
#include "invisible.h"
#include "nearest.h"
#include "number.h"
#include "time_value.h"

#define DEPTH_MAX 32u /* lists and maps within one another; what we read needs less than ten */
#define NODES_MAX 65536u /* values, lists and maps of a text: some 20 MB of memory */
#define KEYS_MAX 256u /* of a map: each new one is compared with all before it */
#define MESSAGE_SIZE 2048u /* of an error message; longer ones are cut */
#define FOUND_SIZE 44u /* of what an error message repeats of a text */

struct config_node {
    struct config_tree *tree;
    struct config_node *next; /* of all nodes, in no order */
    enum config_type type;
    bool quoted;
    size_t line, column;
    size_t key_line, key_column; /* of values of maps */
    char *text; /* CONFIG_TEXT */
    size_t count, room;
    struct config_node **item; /* lists and maps */
    char **key;                /* maps; key[count] is there already, waiting for its value */
    bool waiting;
    size_t pending_line, pending_column; /* of the key that waits */
};

struct config_tree {
    char *name;
    FILE *errors;
    struct error_lines lines; /* in it */
    struct config_node *nodes, *root;
    size_t count; /* of nodes */
};

/* What is open while a text is read. */
struct reader {
    struct config_tree *tree;
    struct config_node *open[DEPTH_MAX];
    size_t depth;
    bool ended;
};

/* ---- Errors --------------------------------------------------------------------------------------------------------- */

static bool report(struct config_tree *tree, size_t line, size_t column, const char *format, va_list arguments)
{
    char text[MESSAGE_SIZE];
    if (!error_lines_add(&tree->lines))
        return false;
    vsnprintf(text, sizeof text, format, arguments);
    invisible_note(text, sizeof text);
    fprintf(tree->errors, "%s:%zu:%zu: error: %s\n", tree->name, line, column, text);
    return false;
}

bool config_error(const struct config_node *node, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    report(node->tree, node->line, node->column, format, arguments);
    va_end(arguments);
    return false;
}

bool config_key_error(const struct config_node *map, size_t at, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    report(map->tree, map->item[at]->key_line, map->item[at]->key_column, format, arguments);
    va_end(arguments);
    return false;
}

__attribute__((format(printf, 3, 4))) static bool error_at(struct config_tree *tree, const yaml_mark_t *mark,
                                                           const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    report(tree, mark->line + 1, mark->column + 1, format, arguments);
    va_end(arguments);
    return false;
}

static bool short_of_memory(const struct config_tree *tree)
{
    fprintf(tree->errors, "%s: error: out of memory\n", tree->name);
    return false;
}

static bool parser_error(struct config_tree *tree, const yaml_parser_t *parser)
{
    if (parser->error == YAML_MEMORY_ERROR)
        return short_of_memory(tree);
    if (parser->error == YAML_READER_ERROR) { /* knows a place in the bytes only; so far the text was read */
        fprintf(tree->errors, "%s:%zu:%zu: error: expected text in UTF-8, found something else at byte %zu (%s)\n", tree->name,
                parser->mark.line + 1, parser->mark.column + 1, parser->problem_offset, parser->problem);
        return false;
    }
    const char *context = parser->context ? parser->context : "while reading";
    return error_at(tree, &parser->problem_mark, "expected YAML: %s %s (line %zu)", parser->problem, context,
                    parser->context ? parser->context_mark.line + 1 : parser->problem_mark.line + 1);
}

/* ---- Building ------------------------------------------------------------------------------------------------------- */

static struct config_node *new_node(struct config_tree *tree, enum config_type type, const yaml_mark_t *mark)
{
    if (tree->count == NODES_MAX) {
        error_at(tree, mark, "expected at most %u values, lists and maps in all", NODES_MAX);
        return NULL;
    }
    struct config_node *node = calloc(1, sizeof *node);
    if (!node) {
        short_of_memory(tree);
        return NULL;
    }
    tree->count++;
    node->tree = tree;
    node->type = type;
    node->line = mark->line + 1;
    node->column = mark->column + 1;
    node->next = tree->nodes;
    tree->nodes = node;
    return node;
}

static bool grow(struct config_node *node)
{
    if (node->count < node->room)
        return true;
    size_t room = node->room ? 2 * node->room : 8;
    struct config_node **item = realloc(node->item, room * sizeof *item);
    if (!item)
        return short_of_memory(node->tree);
    node->item = item;
    if (node->type == CONFIG_MAP) {
        char **key = realloc(node->key, room * sizeof *key);
        if (!key)
            return short_of_memory(node->tree);
        node->key = key;
    }
    node->room = room;
    return true;
}

/* Put a node at the present place of the text. */
static bool put(struct reader *reader, struct config_node *node)
{
    if (reader->depth == 0) {
        reader->tree->root = node;
        return true;
    }
    struct config_node *into = reader->open[reader->depth - 1];
    if (!grow(into))
        return false;
    node->key_line = into->pending_line;
    node->key_column = into->pending_column;
    into->item[into->count++] = node;
    into->waiting = false;
    return true;
}

static bool expects_key(const struct reader *reader)
{
    if (reader->depth == 0)
        return false;
    const struct config_node *into = reader->open[reader->depth - 1];
    return into->type == CONFIG_MAP && !into->waiting;
}

static char *copy_text(const struct reader *reader, const yaml_event_t *event)
{
    const char *value = (const char *)event->data.scalar.value;
    size_t length = event->data.scalar.length;
    if (memchr(value, '\0', length)) {
        error_at(reader->tree, &event->start_mark, "expected text without the character 0");
        return NULL;
    }
    char *copy = strdup(value);
    if (!copy)
        short_of_memory(reader->tree);
    return copy;
}

static bool read_key(struct reader *reader, const yaml_event_t *event)
{
    struct config_node *map = reader->open[reader->depth - 1];
    const char *key = (const char *)event->data.scalar.value;
    for (size_t i = 0; i < map->count; i++)
        if (strcmp(map->key[i], key) == 0)
            return error_at(reader->tree, &event->start_mark, "expected each key once, found \"%s\" again (first in line %zu)",
                            key, map->item[i]->key_line);
    if (map->count >= KEYS_MAX)
        return error_at(reader->tree, &event->start_mark, "expected at most %u keys", KEYS_MAX);
    if (!grow(map))
        return false;
    map->pending_line = event->start_mark.line + 1;
    map->pending_column = event->start_mark.column + 1;
    map->key[map->count] = copy_text(reader, event);
    map->waiting = map->key[map->count] != NULL;
    return map->waiting;
}

static bool read_scalar(struct reader *reader, const yaml_event_t *event)
{
    if (event->data.scalar.anchor || event->data.scalar.tag)
        return error_at(reader->tree, &event->start_mark,
                        "expected no anchors and no tags (quote a text that begins with & or !)");
    if (expects_key(reader))
        return read_key(reader, event);
    struct config_node *node = new_node(reader->tree, CONFIG_TEXT, &event->start_mark);
    if (!node)
        return false;
    node->quoted = event->data.scalar.style != YAML_PLAIN_SCALAR_STYLE;
    node->text = copy_text(reader, event);
    return node->text && put(reader, node);
}

static bool read_begin(struct reader *reader, const yaml_event_t *event)
{
    bool list = event->type == YAML_SEQUENCE_START_EVENT;
    bool marked = list ? event->data.sequence_start.anchor || event->data.sequence_start.tag
                       : event->data.mapping_start.anchor || event->data.mapping_start.tag;
    if (marked)
        return error_at(reader->tree, &event->start_mark, "expected no anchors and no tags");
    if (expects_key(reader))
        return error_at(reader->tree, &event->start_mark, "expected a word as key");
    if (reader->depth == DEPTH_MAX)
        return error_at(reader->tree, &event->start_mark, "expected at most %u levels of lists and maps", DEPTH_MAX);
    struct config_node *node = new_node(reader->tree, list ? CONFIG_LIST : CONFIG_MAP, &event->start_mark);
    if (!node || !put(reader, node))
        return false;
    reader->open[reader->depth++] = node;
    return true;
}

static bool read_event(struct reader *reader, const yaml_event_t *event)
{
    switch (event->type) {
    case YAML_SCALAR_EVENT:
        return read_scalar(reader, event);
    case YAML_SEQUENCE_START_EVENT:
    case YAML_MAPPING_START_EVENT:
        return read_begin(reader, event);
    case YAML_SEQUENCE_END_EVENT:
    case YAML_MAPPING_END_EVENT:
        reader->depth--;
        return true;
    case YAML_ALIAS_EVENT:
        return error_at(reader->tree, &event->start_mark, "expected no aliases (quote a text that begins with *)");
    case YAML_DOCUMENT_START_EVENT:
        return !reader->tree->root || error_at(reader->tree, &event->start_mark, "expected one document");
    case YAML_STREAM_END_EVENT:
        reader->ended = true;
        return reader->tree->root || error_at(reader->tree, &event->start_mark, "expected a document, found nothing");
    default:
        return true;
    }
}

static bool read_all(struct config_tree *tree, const char *text, size_t length)
{
    struct reader reader = {.tree = tree};
    yaml_parser_t parser;
    bool ok = true;
    if (!yaml_parser_initialize(&parser))
        return short_of_memory(tree);
    yaml_parser_set_input_string(&parser, (const unsigned char *)text, length);
    while (ok && !reader.ended) {
        yaml_event_t event;
        if (!yaml_parser_parse(&parser, &event)) {
            ok = parser_error(tree, &parser);
            break;
        }
        ok = read_event(&reader, &event);
        yaml_event_delete(&event);
    }
    yaml_parser_delete(&parser);
    return ok;
}

struct config_tree *config_read(const char *name, const char *text, size_t length, FILE *errors)
{
    struct config_tree *tree = calloc(1, sizeof *tree);
    if (tree)
        tree->name = strdup(name);
    if (!tree || !tree->name) {
        fprintf(errors, "%s: error: out of memory\n", name);
        config_free(tree);
        return NULL;
    }
    tree->errors = errors;
    if (!read_all(tree, text, length)) {
        config_free(tree);
        return NULL;
    }
    return tree;
}

static void free_node(struct config_node *node)
{
    size_t keys = node->type == CONFIG_MAP ? node->count + node->waiting : 0;
    for (size_t i = 0; i < keys; i++)
        free(node->key[i]);
    free(node->key);
    free(node->item);
    free(node->text);
    free(node);
}

void config_free(struct config_tree *tree)
{
    if (!tree)
        return;
    error_lines_end(&tree->lines, tree->name, tree->errors);
    while (tree->nodes) {
        struct config_node *node = tree->nodes;
        tree->nodes = node->next;
        free_node(node);
    }
    free(tree->name);
    free(tree);
}

/* ---- Looking -------------------------------------------------------------------------------------------------------- */

const struct config_node *config_root(const struct config_tree *tree)
{
    return tree->root;
}

enum config_type config_type(const struct config_node *node)
{
    return node->type;
}

size_t config_count(const struct config_node *node)
{
    return node->count;
}

const struct config_node *config_at(const struct config_node *node, size_t at)
{
    return at < node->count ? node->item[at] : NULL;
}

const char *config_key(const struct config_node *node, size_t at)
{
    return node->type == CONFIG_MAP && at < node->count ? node->key[at] : NULL;
}

const struct config_node *config_get(const struct config_node *node, const char *key)
{
    for (size_t i = 0; node->type == CONFIG_MAP && i < node->count; i++)
        if (strcmp(node->key[i], key) == 0)
            return node->item[i];
    return NULL;
}

const char *config_text(const struct config_node *node)
{
    return node->text;
}

size_t config_line(const struct config_node *node)
{
    return node->line;
}

size_t config_column(const struct config_node *node)
{
    return node->column;
}

/* ---- Reading what a node is to be ----------------------------------------------------------------------------------- */

/* Read a whole number, nothing else. Returns false if the text is none, or too large. */
static bool whole_number(const char *text, int64_t *value)
{
    return number_read_signed(text, INT64_MIN, INT64_MAX, value);
}

/* What is there, on one line and not too long. */
static const char *found(const struct config_node *node, char buffer[FOUND_SIZE])
{
    if (node->type != CONFIG_TEXT)
        return node->type == CONFIG_LIST ? "a list" : "a map";
    if (*node->text == '\0')
        return "nothing";
    size_t length = strlen(node->text), at = 0;
    for (; at < length && at < FOUND_SIZE - 4; at++)
        buffer[at] = (unsigned char)node->text[at] < 0x20 ? ' ' : node->text[at];
    strcpy(buffer + at, at < length ? "..." : "");
    return buffer;
}

bool config_integer(const struct config_node *node, const char *what, int64_t low, int64_t high, int64_t *value)
{
    char buffer[FOUND_SIZE];
    int64_t number;
    if (node->type != CONFIG_TEXT || !whole_number(node->text, &number) || number < low || number > high)
        return config_error(node, "expected %s, a whole number %lld..%lld, found %s", what, (long long)low, (long long)high,
                            found(node, buffer));
    *value = number;
    return true;
}

bool config_time(const struct config_node *node, const char *what, uint64_t *ticks)
{
    char buffer[FOUND_SIZE];
    size_t wrong;
    const char *expected = "a time with its unit, such as 250us, 1500ms or 2.5s";
    if (node->type == CONFIG_TEXT)
        expected = time_value_read(node->text, strlen(node->text), ticks, &wrong);
    return !expected || config_error(node, "expected %s, %s, found %s", what, expected, found(node, buffer));
}

bool config_flag(const struct config_node *node, const char *what, bool *value)
{
    char buffer[FOUND_SIZE];
    static const char *const names[] = {"false", "true", "no", "yes", "off", "on", "0", "1"};
    for (size_t i = 0; node->type == CONFIG_TEXT && i < sizeof names / sizeof names[0]; i++) {
        if (strcmp(node->text, names[i]) != 0)
            continue;
        *value = i % 2 == 1;
        return true;
    }
    return config_error(node, "expected %s, true or false, found %s", what, found(node, buffer));
}

/* "a, b or c". */
static void list_names(FILE *out, const char *const *names)
{
    for (size_t i = 0; names[i]; i++)
        fprintf(out, "%s%s", i == 0 ? "" : names[i + 1] ? ", " : " or ", names[i]);
}

/* The name that may be meant, for a message; "" if none is near. */
static const char *hint_for(const char *key, const char *const *names)
{
    char list[MESSAGE_SIZE] = "";
    size_t length = 0;
    for (; *names && length < sizeof list; names++)
        length += (size_t)snprintf(list + length, sizeof list - length, "%s ", *names);
    return nearest_hint(key, list);
}

bool config_keys(const struct config_node *node, const char *const *names)
{
    FILE *errors = node->tree->errors;
    bool ok = true;
    for (size_t i = 0; node->type == CONFIG_MAP && i < node->count; i++) {
        size_t at = 0;
        while (names[at] && strcmp(names[at], node->key[i]) != 0)
            at++;
        if (names[at])
            continue;
        ok = false;
        if (!error_lines_add(&node->tree->lines))
            continue;
        fprintf(errors, "%s:%zu:%zu: error: expected ", node->tree->name, node->item[i]->key_line, node->item[i]->key_column);
        list_names(errors, names);
        char found[MESSAGE_SIZE];
        snprintf(found, sizeof found, "found \"%s\"", node->key[i]);
        size_t length = strlen(found);
        invisible_note(found, sizeof found);
        fprintf(errors, ", %s%s\n", found, found[length] == '\0' ? hint_for(node->key[i], names) : "");
    }
    return ok;
}

/* ---- JSON ----------------------------------------------------------------------------------------------------------- */

static json_t *text_json(const struct config_node *node)
{
    const char *text = node->text;
    const char *digits = text + (*text == '-');
    int64_t number;
    if (node->quoted)
        return json_string(text);
    if (*text == '\0' || strcmp(text, "null") == 0 || strcmp(text, "~") == 0)
        return json_null();
    if (strcmp(text, "true") == 0 || strcmp(text, "false") == 0)
        return json_boolean(*text == 't');
    /* 01 is the name of an input: JSON has no such number */
    bool plain = *text != '+' && (digits[0] != '0' || (digits[1] == '\0' && *text != '-'));
    return plain && whole_number(text, &number) ? json_integer(number) : json_string(text);
}

json_t *config_json(const struct config_node *node)
{
    if (node->type == CONFIG_TEXT)
        return text_json(node);
    json_t *json = node->type == CONFIG_LIST ? json_array() : json_object();
    for (size_t i = 0; json && i < node->count; i++) {
        json_t *item = config_json(node->item[i]); /* no deeper than DEPTH_MAX */
        int failed = node->type == CONFIG_LIST ? json_array_append_new(json, item)
                                               : json_object_set_new(json, node->key[i], item);
        if (failed) {
            json_decref(json);
            json = NULL;
        }
    }
    return json;
}
