/* SPDX-License-Identifier: MIT */
/* client_usage.h: what to say to wrong usage. */
#ifndef RKM04_CLIENT_USAGE_H
#define RKM04_CLIENT_USAGE_H

#include <stdbool.h>

#include "client_answer.h"

/* Report what is wrong on stderr, and where to read more. Returns STATUS_USAGE. */
enum exit_status client_usage(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Read a decimal number low..high. Returns false if it is none: reported, with `what` in front. */
bool client_usage_number(const char *what, const char *text, unsigned low, unsigned high, unsigned *number);

#endif
