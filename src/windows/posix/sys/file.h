/* SPDX-License-Identifier: MIT */
#ifndef RKM04_WINDOWS_FILE_H
#define RKM04_WINDOWS_FILE_H

#define LOCK_EX 2
#define LOCK_NB 4

/* Lock the file for this descriptor alone, as LOCK_EX | LOCK_NB. It is freed when that is closed. */
int flock(int fd, int how);

#endif
