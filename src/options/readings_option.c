/* SPDX-License-Identifier: MIT */
#include "readings_option.h"

#include <stdlib.h>
#include <string.h>

void readings_option_read(struct rkm04_readings *readings, readings_set *named, const char *text, struct argp_state *state)
{
    char error[READINGS_ERROR_SIZE];
    if (strcmp(text, "list") == 0) {
        readings_list(stdout);
        exit(fflush(stdout) == 0 ? 0 : 1);
    }
    if (!readings_read(readings, named, text, error))
        argp_error(state, "--readings: %s", error);
}
