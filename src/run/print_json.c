/* SPDX-License-Identifier: MIT */
#include "print_json.h"

#include <stdio.h>
#include <stdlib.h>

#include "options/options.h"
#include "text/text.h"

int print_json_list(json_t *list, const char *command)
{
    char *text = json_dumps(list, JSON_INDENT(2));
    json_decref(list);
    if (!text) {
        fprintf(stderr, "%s: out of memory\n", command);
        return STATUS_FAILURE;
    }
    puts(text);
    free(text);
    return arguments_printed();
}
