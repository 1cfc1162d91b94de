/* SPDX-License-Identifier: MIT */
#ifndef RKM04_WINDOWS_SEMAPHORE_H
#define RKM04_WINDOWS_SEMAPHORE_H

#include <pthread.h>
#include_next <semaphore.h>

int sem_clockwait(sem_t *semaphore, clockid_t clock, const struct timespec *end);

#endif
