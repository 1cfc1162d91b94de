/* SPDX-License-Identifier: MIT */
/* readings.h: names, values and texts of the readings (specification section 9, rkm04/readings.h): the one table of them. A
 * text is NAME=VALUE,NAME=VALUE; a time is whole ms, written 500 or with its unit (500ms, 1.5s). */
#ifndef RKM04_TEXT_READINGS_H
#define RKM04_TEXT_READINGS_H

#include <jansson.h>
#include <rkm04/readings.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "config_tree.h"

#define READINGS 13u            /* how many there are; `at` below is 0..READINGS-1, in the order of the specification */
#define READINGS_ERROR_SIZE 256 /* bytes of a message */
#define READINGS_TEXT_SIZE 320  /* bytes of a text that names all of them */
#define READINGS_TRIED_MAX 4    /* values of one reading that readings_tried() knows */

/* Of an option that takes readings, for --help. */
#define READINGS_OPTION_HELP \
    "How the units behave where the manual leaves it open, as in hold-exit=latch,speed-change=500ms; `list' lists all readings " \
    "with their values (docs/READINGS.md)"

/* A set of readings: bit `at`. */
typedef uint32_t readings_set;

const char *readings_name(unsigned at);

/* What a value of a reading is called, as in "latch" or "500ms". Returns `text`, or the name. */
const char *readings_value_name(unsigned at, unsigned value, char text[16]);

/* Its value: 0 the default, 1 the other; ms of a time. */
unsigned readings_get(const struct rkm04_readings *readings, unsigned at);
void readings_put(struct rkm04_readings *readings, unsigned at, unsigned value);

/* Values other than the default under which tests are run. Returns how many. */
unsigned readings_tried(unsigned at, unsigned values[READINGS_TRIED_MAX]);

bool readings_same(const struct rkm04_readings *left, const struct rkm04_readings *right);

/* Read NAME=VALUE,NAME=VALUE into *readings and add the names to *named. Returns false and a message for a name or value that
 * does not exist and for a name that is in *named already; then nothing has changed. */
bool readings_read(struct rkm04_readings *readings, readings_set *named, const char *text, char error[READINGS_ERROR_SIZE]);

/* The same from an object as readings_json() makes it. */
bool readings_read_json(struct rkm04_readings *readings, const json_t *json, char error[READINGS_ERROR_SIZE]);

/* The same from a map of a configuration file, {hold-exit: latch}. Errors are reported at their place. */
bool readings_read_map(struct rkm04_readings *readings, readings_set *named, const struct config_node *map);

/* Those that are not at their default, in the order of the table: NAME=VALUE,NAME=VALUE, "" if none. Returns `text`. */
const char *readings_text(const struct rkm04_readings *readings, char text[READINGS_TEXT_SIZE]);

/* The same as an object; times are numbers (ms). New reference; NULL: out of memory. */
json_t *readings_json(const struct rkm04_readings *readings);

/* Print the table for people: names, values (the default first), clauses, what the other value does. */
void readings_list(FILE *out);

#endif
