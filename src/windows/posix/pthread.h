/* SPDX-License-Identifier: MIT */
#ifndef RKM04_WINDOWS_PTHREAD_H
#define RKM04_WINDOWS_PTHREAD_H

#include_next <pthread.h>

/* Threads get no signals here. */
#define sigset_t unsigned
#define sigfillset(set) ((void)(*(set) = 0))
#undef pthread_sigmask
#define pthread_sigmask(how, set, before) ((void)(set), (void)(before))

int pthread_cond_clockwait(pthread_cond_t *condition, pthread_mutex_t *lock, clockid_t clock, const struct timespec *end);

#endif
