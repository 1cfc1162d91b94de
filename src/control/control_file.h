/* SPDX-License-Identifier: MIT */
/* control_file.h: the control file: one line, "tcp:ADDRESS TOKEN", that lets its owner in at the TCP port of a control socket. */
#ifndef RKM04_CONTROL_FILE_H
#define RKM04_CONTROL_FILE_H

#include "control_place.h"

#define CONTROL_TOKEN_LENGTH 64u /* hexadecimal digits: 32 random bytes of the system */

/* Make a token. Returns false if the system has no random bytes (reported). */
bool control_file_token(char token[CONTROL_TOKEN_LENGTH + 1]);

/* Are they the same? Takes the same time wherever they differ. */
bool control_file_is_token(const char token[CONTROL_TOKEN_LENGTH + 1], const char *text, size_t length);

/* Write the file `path`, readable by its owner alone, at a place that is not claimed. Failures are reported with advice. Returns
 * false if it did not work: then nothing is left. control_place_release() removes it. */
bool control_file_write(struct control_place *place, const char *path, const char *address,
                        const char token[CONTROL_TOKEN_LENGTH + 1]);

#endif
