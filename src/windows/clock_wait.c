/* SPDX-License-Identifier: MIT */
/* clock_wait.c: waiting until a time of the steady clock, with the functions that know the time of day alone. */
#include <errno.h>
#include <pthread.h>
#include <semaphore.h>

#define NS_PER_SECOND 1000000000

/* The time of day at which the steady clock will have come to *end. */
static struct timespec time_of_day(const struct timespec *end)
{
    struct timespec steady, day;
    clock_gettime(CLOCK_MONOTONIC, &steady);
    clock_gettime(CLOCK_REALTIME, &day);
    int64_t ns = (int64_t)day.tv_nsec + end->tv_nsec - steady.tv_nsec;
    int64_t seconds = (int64_t)day.tv_sec + end->tv_sec - steady.tv_sec;
    for (; ns < 0; ns += NS_PER_SECOND)
        seconds--;
    return (struct timespec){.tv_sec = seconds + ns / NS_PER_SECOND, .tv_nsec = (long)(ns % NS_PER_SECOND)};
}

int pthread_cond_clockwait(pthread_cond_t *condition, pthread_mutex_t *lock, clockid_t clock, const struct timespec *end)
{
    struct timespec day = time_of_day(end);
    (void)clock;
    return pthread_cond_timedwait(condition, lock, &day);
}

int sem_clockwait(sem_t *semaphore, clockid_t clock, const struct timespec *end)
{
    struct timespec day = time_of_day(end);
    (void)clock;
    return sem_timedwait(semaphore, &day);
}
