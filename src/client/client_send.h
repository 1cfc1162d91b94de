/* SPDX-License-Identifier: MIT */
/* client_send.h: programs to the unit, message 2 Set Command (manual 5.3.2, 4.3). */
#ifndef RKM04_CLIENT_SEND_H
#define RKM04_CLIENT_SEND_H

#include <stdbool.h>
#include <stddef.h>

#include "client_answer.h"
#include "client_link.h"

struct client_send {
    struct client *client;
    char motor;         /* '0'..'4' */
    size_t message_max; /* bytes the unit takes in one message, 64..CLIENT_MESSAGE_MAX */
    bool json, allow_overflow;
};

/* Send one text, mapped, in one message, as it is: the unit judges it. Reports what it refuses on stderr.
 * Returns the exit status. */
enum exit_status client_send_text(const struct client_send *send, const char *text);

/* Send a program file ("-": standard input). It is checked first and not sent if the unit would refuse it; it is cut if it
 * does not fit one message (client_cut.h). Errors are reported as FILE:LINE:COLUMN: error: … Returns the exit status. */
enum exit_status client_send_file(const struct client_send *send, const char *path);

#endif
