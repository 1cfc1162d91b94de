/* SPDX-License-Identifier: MIT */
/* client_answer.h: the unit's answers (specification section 3), for people or as JSON on stdout. */
#ifndef RKM04_CLIENT_ANSWER_H
#define RKM04_CLIENT_ANSWER_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "text/text.h"

struct client_answer {
    const uint8_t *bytes; /* the whole message */
    size_t length;
    char motor; /* asked for, '0'..'4' */
    bool json;
};

/* Print a JSON object in one line on stdout and release it. NULL: out of memory, reported. Returns the exit status. */
enum exit_status client_print_json(json_t *object);

/* Bytes of a unit as a JSON string; those above 7F stand for the characters of that number. Returns NULL without memory. */
json_t *client_json_text(const uint8_t *bytes, size_t length);

/* Print "motor 1: " or "all motors: ". */
void client_print_motor(char motor);

/* Show the answer to one kind of message. Each returns the exit status; a message that does not have the form of such an
 * answer is reported on stderr and is a failure. */
enum exit_status client_show_version(const struct client_answer *answer);
enum exit_status client_show_store(const struct client_answer *answer);
enum exit_status client_show_position(const struct client_answer *answer);
enum exit_status client_show_command(const struct client_answer *answer);
enum exit_status client_show_table(const struct client_answer *answer);
enum exit_status client_show_progress(const struct client_answer *answer);
enum exit_status client_show_raw(const struct client_answer *answer);

#endif
