/* SPDX-License-Identifier: MIT */
/* coverage.h: what a client has exercised out of all that there is: messages, motors, commands, flags, faults. Pure but for
 * coverage_write(). What there is a kind of device says (struct device_coverage). One coverage serves any number of units. */
#ifndef RKM04_DEVICE_COVERAGE_H
#define RKM04_DEVICE_COVERAGE_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#define COVERAGE_ITEMS_MAX 192
#define COVERAGE_NAME_MAX 48

enum coverage_group {
    COVERAGE_MESSAGES, /* each, of each the motors; broadcast */
    COVERAGE_MOTORS,   /* in whatever message */
    COVERAGE_COMMANDS, /* each in each of its forms, in a text that the unit took */
    COVERAGE_FLAGS,    /* of answers to programs */
    COVERAGE_ERRORS,   /* other errors reported in answers */
    COVERAGE_FAULTS,   /* of programs */
    COVERAGE_GROUPS
};

/* Where a command has to be for an item to count. */
enum coverage_place { COVERAGE_ANYWHERE, COVERAGE_ALONE, COVERAGE_INSIDE };

struct coverage_item {
    uint8_t group;     /* enum coverage_group */
    uint8_t place;     /* commands: enum coverage_place */
    uint8_t level;     /* I: 0 = L, 1 = H */
    uint32_t key;      /* commands: the character; others: what distinguishes the items of the group */
    int64_t low, high; /* commands: of the argument; I: of the bit */
    uint64_t count;    /* how often */
    char name[COVERAGE_NAME_MAX];
};

struct coverage {
    size_t items;
    struct coverage_item item[COVERAGE_ITEMS_MAX];
};

/* For kinds: put an item on the list; the name is printed into it. Returns it, for the caller to fill in further. */
__attribute__((format(printf, 4, 5))) struct coverage_item *coverage_add(struct coverage *coverage, enum coverage_group group,
                                                                        uint32_t key, const char *name, ...);

/* For kinds: the items of this group and key have been exercised once more. */
void coverage_count(struct coverage *coverage, enum coverage_group group, uint32_t key);

/* Items of a group that have been exercised, and all of it; group COVERAGE_GROUPS: of everything. */
struct coverage_sum {
    unsigned covered, total;
};
struct coverage_sum coverage_sum(const struct coverage *coverage, enum coverage_group group);

/* Per cent of all items, 0.0..100.0 in tenths, rounded down, as the report shows it: 100 only if nothing is missing. */
double coverage_percent(const struct coverage *coverage);

/* "messages", "motors", … */
const char *coverage_group_name(enum coverage_group group);

/* The report for people. */
void coverage_print(const struct coverage *coverage, FILE *out);

/* The report as an object: covered, total, percent, and groups, a list of {group, covered, total, items}; items is a list of
 * {name, count}. Returns a new reference, or NULL if out of memory. */
json_t *coverage_json(const struct coverage *coverage);

/* The files of a report. */
struct coverage_files {
    FILE *text, *json; /* NULL: none */
    char *text_name, *json_name;
};

/* Open `file` for the text and `file` + ".json" for the JSON; if `file` ends in ".json" only that, for the JSON. What is in them
 * stays until coverage_write(). `flags`: of output_file.h. Failures are reported (log.h). Returns false if it did not work;
 * coverage_close() is due in either case. */
bool coverage_open(struct coverage_files *files, const char *file, unsigned flags);

/* Write the report and close. Failures are reported. Returns false if anything could not be written. */
bool coverage_write(const struct coverage *coverage, struct coverage_files *files);

/* Close what is open, unwritten. */
void coverage_close(struct coverage_files *files);

#endif
