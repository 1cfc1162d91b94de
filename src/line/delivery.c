/* SPDX-License-Identifier: MIT */
#include "delivery.h"

#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <semaphore.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define STACK_SIZE (128u << 10)

struct delivery {
    int fd;
    bool close_it;
    char *text;
    int error;
    sem_t done;
    atomic_flag left; /* by one of the two who know it: the other one frees it */
};

static void release(struct delivery *delivery)
{
    if (!atomic_flag_test_and_set(&delivery->left))
        return;
    sem_destroy(&delivery->done);
    free(delivery->text);
    free(delivery);
}

int delivery_write(int fd, const char *text, size_t length)
{
    while (length > 0) {
        ssize_t written = write(fd, text, (unsigned)length);
        if (written > 0) {
            text += written;
            length -= (size_t)written;
        } else if (written < 0 && errno == EAGAIN) {
            struct pollfd room = {.fd = fd, .events = POLLOUT};
            (void)poll(&room, 1, -1);
        } else if (written < 0 && errno != EINTR) {
            return errno;
        }
    }
    return 0;
}

bool delivery_thread(void *(*run)(void *context), void *context)
{
    pthread_t thread;
    pthread_attr_t attributes;
    sigset_t all, before;
    pthread_attr_init(&attributes);
    pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
    pthread_attr_setstacksize(&attributes, STACK_SIZE);
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    int error = pthread_create(&thread, &attributes, run, context);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    pthread_attr_destroy(&attributes);
    errno = error;
    return error == 0;
}

struct timespec delivery_deadline(unsigned milliseconds)
{
    struct timespec end;
    clock_gettime(CLOCK_MONOTONIC, &end);
    end.tv_sec += milliseconds / 1000u;
    end.tv_nsec += (long)(milliseconds % 1000u) * 1000000;
    if (end.tv_nsec >= 1000000000) {
        end.tv_sec++;
        end.tv_nsec -= 1000000000;
    }
    return end;
}

static void *deliver(void *context)
{
    struct delivery *delivery = context;
    int error = delivery_write(delivery->fd, delivery->text, strlen(delivery->text));
    if (delivery->close_it && close(delivery->fd) != 0 && error == 0)
        error = errno;
    delivery->error = error == EPIPE || error == EBADF ? 0 : error;
    sem_post(&delivery->done);
    release(delivery);
    return NULL;
}

struct delivery *delivery_begin(int fd, const char *text, bool close_it)
{
    struct delivery *delivery = malloc(sizeof *delivery);
    char *copy = strdup(text);
    if (delivery && copy) {
        *delivery = (struct delivery){.fd = fd, .close_it = close_it, .text = copy, .left = ATOMIC_FLAG_INIT};
        sem_init(&delivery->done, 0, 0);
        if (delivery_thread(deliver, delivery))
            return delivery;
    }
    free(copy);
    free(delivery);
    return NULL;
}

int delivery_wait(struct delivery *delivery, unsigned milliseconds)
{
    struct timespec end = delivery_deadline(milliseconds);
    int error = EINTR;
    while (error == EINTR)
        error = sem_clockwait(&delivery->done, CLOCK_MONOTONIC, &end) == 0 ? 0 : errno;
    error = error == 0 ? delivery->error : 0;
    release(delivery);
    return error;
}
