/* SPDX-License-Identifier: MIT */
/* getaddrinfo() blocks for as long as a name server takes, and cannot be cancelled: a thread calls it, and is left to itself when
 * the time is over. */
#include "host_address.h"

#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* Shared by who asks and the thread; the last one to need it frees it. */
struct search {
    pthread_mutex_t mutex;
    pthread_cond_t over;
    bool done, abandoned;
    char *host, *port;
    struct addrinfo hints, *found;
    int error, system_error;
};

static void free_search(struct search *search)
{
    if (search->found)
        freeaddrinfo(search->found);
    free(search->host);
    free(search->port);
    pthread_cond_destroy(&search->over);
    pthread_mutex_destroy(&search->mutex);
    free(search);
}

static void *find(void *context)
{
    struct search *search = context;
    struct addrinfo *found = NULL;
    int error = getaddrinfo(search->host, search->port, &search->hints, &found), system_error = errno;
    pthread_mutex_lock(&search->mutex);
    search->found = error == 0 ? found : NULL;
    search->error = error;
    search->system_error = system_error;
    search->done = true;
    bool abandoned = search->abandoned;
    pthread_cond_signal(&search->over);
    pthread_mutex_unlock(&search->mutex);
    if (abandoned)
        free_search(search);
    return NULL;
}

/* NULL: out of memory. */
static struct search *make_search(const char *host, const char *port, const struct addrinfo *hints)
{
    struct search *search = calloc(1, sizeof *search);
    if (!search)
        return NULL;
    pthread_mutex_init(&search->mutex, NULL);
    pthread_cond_init(&search->over, NULL);
    search->hints = *hints;
    search->host = strdup(host);
    search->port = strdup(port);
    if (search->host && search->port)
        return search;
    free_search(search);
    return NULL;
}

/* The thread takes no signals: they are for the one that waits. Returns 0 or an errno. */
static int start_thread(struct search *search)
{
    pthread_t thread;
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    int error = pthread_create(&thread, NULL, find, search);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (error == 0)
        pthread_detach(thread);
    return error;
}

/* Returns true if the search is over in time. */
static bool wait_for(struct search *search, unsigned limit_ms)
{
    struct timespec end;
    int error = 0;
    clock_gettime(CLOCK_MONOTONIC, &end);
    end.tv_sec += limit_ms / 1000;
    end.tv_nsec += (long)(limit_ms % 1000) * 1000000;
    if (end.tv_nsec >= 1000000000) {
        end.tv_nsec -= 1000000000;
        end.tv_sec++;
    }
    pthread_mutex_lock(&search->mutex);
    while (!search->done && error == 0)
        error = pthread_cond_clockwait(&search->over, &search->mutex, CLOCK_MONOTONIC, &end);
    bool done = search->done;
    search->abandoned = !done;
    pthread_mutex_unlock(&search->mutex);
    return done;
}

static const char *text_of(int error, int system_error)
{
    return error == 0 ? NULL : error == EAI_SYSTEM ? strerror(system_error) : gai_strerror(error);
}

const char *host_address_find(const char *host, const char *port, int family, unsigned limit_ms, struct addrinfo **found)
{
    struct addrinfo hints = {.ai_family = family, .ai_socktype = SOCK_STREAM, .ai_flags = AI_NUMERICHOST | AI_NUMERICSERV};
    int error = getaddrinfo(host, port, &hints, found);
    if (error != EAI_NONAME || limit_ms == 0)
        return text_of(error, errno);
    hints.ai_flags = AI_NUMERICSERV;
    struct search *search = make_search(host, port, &hints);
    if (!search)
        return strerror(ENOMEM);
    error = start_thread(search);
    if (error != 0) {
        free_search(search);
        return strerror(error);
    }
    if (!wait_for(search, limit_ms))
        return "the name server does not answer";
    const char *wrong = text_of(search->error, search->system_error);
    *found = search->found;
    search->found = NULL;
    free_search(search);
    return wrong;
}
