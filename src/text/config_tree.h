/* SPDX-License-Identifier: MIT */
/* config_tree.h: configuration files, plants and scenarios: YAML, read by libyaml, which keeps line and column of everything.
 * Scalars are text; who reads them says what they are to be, so `01` is an input and `no` a word. Anchors, aliases and tags are
 * refused, and so are keys given twice. */
#ifndef RKM04_TEXT_CONFIG_TREE_H
#define RKM04_TEXT_CONFIG_TREE_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

struct config_tree;
struct config_node;

/* Read a whole text: one document. Errors go to `errors`, a line each: NAME:LINE:COLUMN: error: expected …. Returns NULL then.
 * `errors` must stay open until config_free(). */
struct config_tree *config_read(const char *name, const char *text, size_t length, FILE *errors);
void config_free(struct config_tree *tree);

/* The outermost node. */
const struct config_node *config_root(const struct config_tree *tree);

enum config_type { CONFIG_TEXT, CONFIG_LIST, CONFIG_MAP };
enum config_type config_type(const struct config_node *node);

/* Of lists and maps: how many; number `at`; of maps: its key, the value of a key (NULL: none). */
size_t config_count(const struct config_node *node);
const struct config_node *config_at(const struct config_node *node, size_t at);
const char *config_key(const struct config_node *node, size_t at);
const struct config_node *config_get(const struct config_node *node, const char *key);

/* Of texts. */
const char *config_text(const struct config_node *node);

/* Line and column from 1. */
size_t config_line(const struct config_node *node);
size_t config_column(const struct config_node *node);

/* Report an error at a node. Always returns false. */
bool config_error(const struct config_node *node, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* The same at key `at` of a map. */
bool config_key_error(const struct config_node *map, size_t at, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* Read what a node is to be. Reported and false if it is something else; `what` names it in the message. */
bool config_integer(const struct config_node *node, const char *what, int64_t low, int64_t high, int64_t *value);
bool config_time(const struct config_node *node, const char *what, uint64_t *ticks); /* time_value.h */
bool config_flag(const struct config_node *node, const char *what, bool *value);     /* true, false, yes, no, on, off, 1, 0 */

/* Are all keys of a map among `names` (ends with NULL)? Reports each that is not. */
bool config_keys(const struct config_node *node, const char *const *names);

/* The node as JSON, for parameters of commands: whole numbers, true, false and null become such, everything else strings;
 * quoted scalars always strings. New reference; NULL: out of memory. */
json_t *config_json(const struct config_node *node);

#endif
