/* SPDX-License-Identifier: MIT */
/* client_report.h: where messages about a port and its dialogues go: to stderr or, of a thread that asks for it, into a text. */
#ifndef RKM04_CLIENT_REPORT_H
#define RKM04_CLIENT_REPORT_H

#include <stddef.h>

/* From now on put the messages of this thread into text[size], as lines. NULL: to stderr again. */
void client_report_into(char *text, size_t size);

/* A message: with the name of the program in front on stderr. */
void client_report(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Further text that belongs to it, with its own line ends. */
void client_advise(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
