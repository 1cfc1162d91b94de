/* SPDX-License-Identifier: MIT */
/* test_line_pty.c: who has the pty open. Clients come and go between any two system calls of the emulator, which looks for them
 * meanwhile, and the system takes its time over closing: open(), close(), poll(), read() and the timer are wrapped. The draws are
 * random with a fixed seed.
 * One test alone: CK_RUN_CASE=clients ./test_line_pty */
#include <check.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include "line/line.h"

#define CLIENTS 2
#define NOBODY 65534
#define TURNS 20 /* of the event loop until the line is at rest again */
#define LOOKS 40 /* of the timer, until all is certain */

int __real_open(const char *path, int flags, ...);
int __real_close(int fd);
int __real_poll(struct pollfd *list, nfds_t count, int timeout);
ssize_t __real_read(int fd, void *bytes, size_t room);
int __wrap_open(const char *path, int flags, ...);
int __wrap_close(int fd);
int __wrap_poll(struct pollfd *list, nfds_t count, int timeout);
ssize_t __wrap_read(int fd, void *bytes, size_t room);
int __wrap_timerfd_create(clockid_t clock, int flags);
int __wrap_timerfd_settime(int fd, int flags, const struct itimerspec *spec, struct itimerspec *old);

static struct line_watch watch;
static struct line line;
static int client[CLIENTS]; /* -1: not there */
static unsigned told[LINE_FAILED + 1];
static unsigned busy;       /* clients up to this one act between the calls, once in... */
static unsigned seldom;     /* ...so many calls */
static unsigned lingering;  /* looks at the pty that still find the client that has just closed it */
static bool looking;        /* the timer is on */
static bool exclusive;      /* a client has the pty for itself while it is there */
static uint64_t draws;

static unsigned draw(unsigned below)
{
    draws = draws * 6364136223846793005u + 1442695040888963407u;
    return (unsigned)(draws >> 33) % below;
}

static void on_event(void *context, enum line_event event)
{
    (void)context;
    told[event]++;
}

static void come(unsigned who)
{
    client[who] = __real_open(line.path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    ck_assert_msg(client[who] >= 0, "%s", strerror(errno));
    if (exclusive)
        ck_assert_int_eq(ioctl(client[who], TIOCEXCL), 0);
}

static void go(unsigned who)
{
    if (exclusive)
        ck_assert_int_eq(ioctl(client[who], TIOCNXCL), 0);
    __real_close(client[who]);
    client[who] = -1;
    lingering = draw(3);
}

static void come_or_go(unsigned who)
{
    if (client[who] < 0)
        come(who);
    else
        go(who);
}

/* Before and after a call of the emulator. */
static void let_clients_act(void)
{
    for (unsigned who = 0; who < busy; who++)
        while (draw(seldom) == 0)
            come_or_go(who);
}

int __wrap_open(const char *path, int flags, ...)
{
    va_list list;
    va_start(list, flags);
    let_clients_act();
    int fd = __real_open(path, flags, va_arg(list, unsigned));
    va_end(list);
    let_clients_act();
    return fd;
}

int __wrap_close(int fd)
{
    let_clients_act();
    int result = __real_close(fd);
    let_clients_act();
    return result;
}

int __wrap_poll(struct pollfd *list, nfds_t count, int timeout)
{
    let_clients_act();
    int result = __real_poll(list, count, timeout);
    if (list->fd == line.fd && (list->revents & POLLHUP) && lingering > 0) {
        lingering--;
        result = list->revents = 0;
    }
    let_clients_act();
    return result;
}

ssize_t __wrap_read(int fd, void *bytes, size_t room)
{
    let_clients_act();
    ssize_t result = __real_read(fd, bytes, room);
    let_clients_act();
    return result;
}

int __wrap_timerfd_create(clockid_t clock, int flags)
{
    (void)clock, (void)flags;
    return eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
}

int __wrap_timerfd_settime(int fd, int flags, const struct itimerspec *spec, struct itimerspec *old)
{
    (void)fd, (void)flags, (void)old;
    looking = spec->it_value.tv_nsec > 0;
    return 0;
}

/* As an ordinary user: root is not kept out by a client that has the pty for itself. */
static void begin(uint64_t seed)
{
    if (geteuid() == 0)
        ck_assert_int_eq(setresuid(NOBODY, NOBODY, NOBODY), 0);
    exclusive = looking = false;
    lingering = 0;
    draws = seed;
    busy = 0;
    memset(told, 0, sizeof told);
    for (unsigned i = 0; i < CLIENTS; i++)
        client[i] = -1;
    ck_assert(line_watch_open(&watch) && line_pty_open(&line, &watch, on_event, NULL));
}

static void end(void)
{
    busy = 0;
    for (unsigned i = 0; i < CLIENTS; i++)
        if (client[i] >= 0)
            go(i);
    line_close(&line);
    line_watch_close(&watch);
}

/* No client comes or goes any more: the emulator has followed when the loop has nothing more to do. */
static void come_to_rest(void)
{
    struct pollfd readable = {.fd = watch.fd, .events = POLLIN};
    busy = 0;
    for (unsigned turns = 0; __real_poll(&readable, 1, 0) > 0; turns++) {
        ck_assert_msg(turns < TURNS, "the loop never comes to rest");
        line_watch_update(&watch);
    }
}

/* The timer goes off until it is turned off. */
static void become_certain(void)
{
    come_to_rest();
    for (unsigned looks = 0; looking; looks++) {
        ck_assert_msg(looks < LOOKS, "looking for ever");
        eventfd_write(watch.timer, 1);
        come_to_rest();
    }
}

/* So many clients come and go while the emulator follows them. */
static void storm(unsigned clients)
{
    seldom = 2 + draw(12);
    for (unsigned turns = draw(5); turns-- > 0;) {
        busy = clients;
        let_clients_act();
        line_watch_update(&watch);
        if (looking && draw(2))
            eventfd_write(watch.timer, 1);
    }
    come_to_rest();
}

/* A client that opened the pty in the moment in which the emulator did is known when it sends. */
static void send_request(void)
{
    if (line.clients == 0)
        line_pty_recount(&line);
    come_to_rest();
}

START_TEST(one_client_that_comes_and_goes_is_never_two)
{
    begin((uint64_t)_i);
    exclusive = _i % 2;
    for (unsigned i = 0; i < 200; i++) {
        storm(1);
        ck_assert_msg(told[LINE_SHARED] == 0, "round %u: another client, but there is one alone", i);
        if (client[0] >= 0)
            send_request();
        if (draw(2))
            become_certain();
        else
            continue;
        ck_assert_msg(line.clients == (client[0] >= 0), "round %u: %u clients", i, line.clients);
    }
    ck_assert_uint_gt(told[LINE_ATTACHED], 50);
    end();
}
END_TEST

START_TEST(a_second_client_is_told_whatever_was_before)
{
    begin((uint64_t)_i);
    for (unsigned i = 0; i < 100; i++) {
        storm(1 + draw(CLIENTS));
        if (client[1] >= 0)
            go(1);
        if (client[0] < 0)
            come(0);
        send_request();
        become_certain();
        ck_assert_uint_gt(line.clients, 0);
        unsigned before = told[LINE_SHARED];
        come(1);
        come_to_rest();
        ck_assert_msg(told[LINE_SHARED] == before + 1, "round %u: the second client is not told", i);
    }
    end();
}
END_TEST

/* A client stays; another one comes and goes. It must not be taken for gone. */
START_TEST(a_client_that_stays_is_not_lost_beside_one_that_comes_and_goes)
{
    begin((uint64_t)_i);
    come(1);
    come_to_rest();
    for (unsigned i = 0; i < 200; i++) {
        storm(1);
        ck_assert_msg(line.clients > 0, "round %u", i);
    }
    end();
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("line_pty");
    TCase *clients = tcase_create("clients");
    tcase_set_timeout(clients, 100);
    tcase_add_loop_test(clients, one_client_that_comes_and_goes_is_never_two, 0, 8);
    tcase_add_loop_test(clients, a_second_client_is_told_whatever_was_before, 0, 4);
    tcase_add_loop_test(clients, a_client_that_stays_is_not_lost_beside_one_that_comes_and_goes, 0, 4);
    suite_add_tcase(suite, clients);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed > 0;
}
