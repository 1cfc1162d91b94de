/* SPDX-License-Identifier: MIT */
/* lock_file.h: a file beside something that one process holds, a link or a socket: the kernel frees its lock however the holder
 * ends, and its content names the holder and its files. */
#ifndef RKM04_LINE_LOCK_FILE_H
#define RKM04_LINE_LOCK_FILE_H

#include <stdbool.h>
#include <stddef.h>

#define LOCK_RECORD_MAX 128 /* bytes of the text, its end included */

/* Open, making it if it is not there, and lock `path`; its first line goes to `record`. Returns a descriptor; -1: errno says
 * why. EWOULDBLOCK: another process holds it, `record` is its record. EPERM: it is another user's, no file, or has several
 * names. */
int lock_file_take(const char *path, char record[LOCK_RECORD_MAX]);

/* Why it could not be taken, for people. */
const char *lock_file_reason(int error);

/* Write the record: one line. Returns false if it did not work (errno). */
bool lock_file_write(int fd, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Give the lock free and leave the file; *fd becomes -1. */
void lock_file_release(int *fd);

/* Remove the file and give the lock free; *fd becomes -1. */
void lock_file_remove(const char *path, int *fd);

#endif
