/* SPDX-License-Identifier: MIT */
/* log.h: the log of the emulator on stderr. A slow reader, or none, does not hold anything up: a terminal may be
 * stopped with Ctrl-S, a pipe may be full.
 *
 * O_NONBLOCK belongs to the open file, which is shared with the shell and all that it has started; and poll() promises room for
 * one byte in a terminal, not for a line, nor against other writers of a pipe. So a thread of its own writes, and may wait as
 * long as it likes. It is handed lines through a queue; when that is full, lines are dropped and counted, until all that was
 * before them has been read. A file has no reader: it is written to at once. */
#ifndef RKM04_LINE_LOG_H
#define RKM04_LINE_LOG_H

#include <stdint.h>

#define LOG_QUEUE_SIZE (1u << 20) /* bytes: the lines of 256 buses with 16 units each at the start, twice */

/* From now on lines are queued (unless stderr is a file) until log_start_thread(). Without this call they are written at once. */
void log_begin(void);

/* Let a thread write what is in the queue, and what comes later. It inherits the restrictions of the calling thread. */
void log_start_thread(void);

/* Wait until everything is written, but at most `milliseconds`. */
void log_flush(unsigned milliseconds);

/* Before what log_error() reports there is "rkm04 serve: ", or this, which must stay. */
void log_as(const char *head);

/* One line "rkm04 serve: …": why something failed and what to do. No line end in `format`. */
void log_error(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* One line "[seconds] …" with the virtual time `tick` (us). No line end in `format`. */
void log_at(uint64_t tick, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Lines as they are, each with its line end. */
void log_text(const char *text);

#endif
