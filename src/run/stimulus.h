/* SPDX-License-Identifier: MIT */
/* stimulus.h: what comes to a unit from outside in a run of `rkm04 exec`, a line each:
 *
 *     TIME di NN 0|1        input, from 01
 *     TIME set M TEXT       text for motor M, 0 for all, to the end of the line
 *     TIME message HEX      any message of the device
 *     # comment
 *
 * TIME as in time_value.h. The lines may be in any order; those of one time act in the order of the file. */
#ifndef RKM04_RUN_STIMULUS_H
#define RKM04_RUN_STIMULUS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "device/device.h"

enum stimulus_kind { STIMULUS_INPUT, STIMULUS_SET, STIMULUS_MESSAGE };

struct stimulus {
    uint64_t tick;
    enum stimulus_kind kind;
    uint8_t input;       /* STIMULUS_INPUT: from 1 */
    bool level;
    uint8_t motor;       /* STIMULUS_SET: 0: all */
    const uint8_t *data; /* the text, or the bytes of the message */
    size_t length;
    size_t line, column; /* of the data in the file, from 1 */
};

struct stimuli {
    struct stimulus *list; /* by tick */
    size_t count;
    uint8_t *bytes;        /* what `data` points into */
};

/* Read the text of a stimulus file for a device. Wrong lines are reported on `errors` as NAME:LINE:COLUMN: error: expected …,
 * one line an error. Returns the number of errors, or -1 if out of memory; stimuli is to be freed in any case. */
int stimuli_read(struct stimuli *stimuli, const struct device_kind *device, const char *name, const char *text, size_t length,
                 FILE *errors);

void stimuli_free(struct stimuli *stimuli);

#endif
