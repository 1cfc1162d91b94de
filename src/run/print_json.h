/* SPDX-License-Identifier: MIT */
/* print_json.h: a list as the output of a command. */
#ifndef RKM04_RUN_PRINT_JSON_H
#define RKM04_RUN_PRINT_JSON_H

#include <jansson.h>

/* Print the value on stdout, indented, and free it. command: "rkm04 devices", for messages. Returns the exit status; errors have
 * been reported. */
int print_json_list(json_t *list, const char *command);

#endif
