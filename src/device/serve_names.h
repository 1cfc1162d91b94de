/* SPDX-License-Identifier: MIT */
/* serve_names.h: which units are on a line, and how they, their files and links are named. Pure. */
#ifndef RKM04_DEVICE_SERVE_NAMES_H
#define RKM04_DEVICE_SERVE_NAMES_H

#include <limits.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <rkm04/limits.h>

#define NODE_LIST_MAX 16u /* units on a line (U4) */
#define NODE_NAME_SIZE 8u

/* The addresses of the units of a line, in the order given. An address may occur more than once, as on a bus on which two
 * switches are set alike. */
struct node_list {
    unsigned count;
    uint8_t node[NODE_LIST_MAX];
};

/* Read addresses from 1 to 16, at most 16 of them: "3", "1,2,5-8". Returns false if they are something else. */
bool node_list_read(struct node_list *list, const char *text);

/* The same for a kind of device with addresses 1..addresses, at most 247. */
bool node_list_read_up_to(struct node_list *list, const char *text, unsigned addresses);

/* The name of unit `at` (from 0): its address, "3"; of the second with the same address "3-2", of the third "3-3". */
void node_list_name(const struct node_list *list, unsigned at, char name[NODE_NAME_SIZE]);

/* Does a pattern name the unit (%n)? the line (%l)? */
bool name_pattern_has(const char *pattern, char what);

/* Is every % of the pattern followed by n, l or %? */
bool name_pattern_valid(const char *pattern);

/* Write the pattern to `path`, %n replaced by `unit`, %l by the number of the line, %% by %. `unit`: NULL if there is no %n.
 * Returns false if it is too long. */
bool name_expand(const char *pattern, const char *unit, unsigned line, char path[PATH_MAX]);

/* The address for line `line` out of the valid `address` of a network port: its port plus `line`, unless that is 0, a free one.
 * Returns false if it is too long, or if there is no such port. */
bool name_address(const char *address, unsigned line, char *out, size_t size);

#endif
