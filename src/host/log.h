/* SPDX-License-Identifier: MIT */
/* log.h: what the emulator tells on stderr. */
#ifndef RKM04_HOST_LOG_H
#define RKM04_HOST_LOG_H

#include <stdint.h>

/* One line "rkm04 serve: …": why something failed and what to do. No line end in `format`. */
void log_error(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* One line "[seconds] …" with the virtual time `tick` (us). No line end in `format`. */
void log_at(uint64_t tick, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
