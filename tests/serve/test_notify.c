/* SPDX-License-Identifier: MIT */
/* test_notify.c: how the emulator says that it is ready (sd_notify(3), --ready-fd).
 * One case alone: CK_RUN_CASE=manager ./test_notify */
#include <check.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "serve/notify.h"

static char folder[] = "/tmp/test_notify.XXXXXX";
static char path[sizeof folder + 16];
static int manager = -1; /* the service manager's socket */

/* Become the service manager: a datagram socket, by a path or (name[0] == 0) without a file. */
static void listen_at(const char *name, size_t length)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    memcpy(address.sun_path, name, length);
    manager = socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    ck_assert_int_ge(manager, 0);
    ck_assert_int_eq(bind(manager, (struct sockaddr *)&address, (socklen_t)(offsetof(struct sockaddr_un, sun_path) + length)), 0);
}

/* The next datagram that came, "" if none did. */
static const char *heard(void)
{
    static char text[2048];
    ssize_t length = recv(manager, text, sizeof text - 1, 0);
    text[length > 0 ? length : 0] = '\0';
    return text;
}

static void start(void)
{
    signal(SIGPIPE, SIG_IGN);
    unsetenv("NOTIFY_SOCKET");
    strcpy(folder + sizeof folder - 7, "XXXXXX");
    ck_assert_ptr_nonnull(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/notify", folder);
}

static void end(void)
{
    if (manager >= 0)
        close(manager);
    manager = -1;
    unlink(path);
    rmdir(folder);
}

/* What comes out of a pipe to its end. */
static const char *drain(int fd)
{
    static char text[256];
    size_t length = 0;
    ssize_t got;
    while ((got = read(fd, text + length, sizeof text - 1 - length)) > 0)
        length += (size_t)got;
    ck_assert_int_eq(got, 0);
    text[length] = '\0';
    close(fd);
    return text;
}

static int read_number(int fd)
{
    char text[16];
    snprintf(text, sizeof text, "%d", fd);
    return notify_fd_read(text);
}

/* What went to stderr while the service manager was notified at this address. */
static const char *complaint_about(const char *address)
{
    int ends[2], before = dup(STDERR_FILENO);
    ck_assert_int_eq(pipe(ends), 0);
    fflush(stderr);
    dup2(ends[1], STDERR_FILENO);
    close(ends[1]);
    setenv("NOTIFY_SOCKET", address, 1);
    bool done = notify_ready(-1, "READY {}", NULL);
    fflush(stderr);
    dup2(before, STDERR_FILENO);
    close(before);
    ck_assert_msg(done, "a manager that cannot be told is no reason to end");
    return drain(ends[0]);
}

/* ---- The service manager ------------------------------------------------------------------------------------------ */

START_TEST(a_manager_at_a_path_is_told_that_the_emulator_is_ready_and_then_that_it_ends)
{
    listen_at(path, strlen(path) + 1);
    setenv("NOTIFY_SOCKET", path, 1);
    ck_assert(notify_ready(-1, "READY {}", NULL));
    ck_assert_str_eq(heard(), "READY=1");
    ck_assert_str_eq(heard(), "");
    notify_stopping();
    ck_assert_str_eq(heard(), "STOPPING=1");
}
END_TEST

START_TEST(a_manager_without_a_file_is_told_too)
{
    char name[sizeof path];
    snprintf(name, sizeof name, "@%s", path + 1);
    name[0] = '\0';
    listen_at(name, strlen(path)); /* no end of string: it would be part of the name */
    name[0] = '@';
    setenv("NOTIFY_SOCKET", name, 1);
    ck_assert(notify_ready(-1, "READY {}", NULL));
    ck_assert_str_eq(heard(), "READY=1");
}
END_TEST

START_TEST(the_status_is_one_line)
{
    listen_at(path, strlen(path) + 1);
    setenv("NOTIFY_SOCKET", path, 1);
    notify_ready(-1, "READY {}", "unit 1 on /dev/pts/5\nERRNO=5");
    ck_assert_str_eq(heard(), "READY=1\nSTATUS=unit 1 on /dev/pts/5");
}
END_TEST

START_TEST(an_endless_status_is_cut_and_the_rest_arrives)
{
    char status[4000];
    memset(status, 'x', sizeof status);
    status[sizeof status - 1] = '\0';
    listen_at(path, strlen(path) + 1);
    setenv("NOTIFY_SOCKET", path, 1);
    notify_ready(-1, "READY {}", status);
    const char *text = heard();
    ck_assert_int_eq(strncmp(text, "READY=1\nSTATUS=xxx", 18), 0);
    ck_assert_uint_lt(strlen(text), sizeof status);
}
END_TEST

START_TEST(without_a_manager_nothing_is_said)
{
    ck_assert_str_eq(complaint_about(""), "");
    unsetenv("NOTIFY_SOCKET");
    ck_assert(notify_ready(-1, "READY {}", NULL));
}
END_TEST

START_TEST(a_manager_that_is_not_there_is_reported_and_survived)
{
    ck_assert_ptr_nonnull(strstr(complaint_about(path), strerror(ENOENT)));
    ck_assert_ptr_nonnull(strstr(complaint_about("@"), "expected a path"));
    ck_assert_ptr_nonnull(strstr(complaint_about("vsock:2:1234"), "expected a path"));
    ck_assert_ptr_nonnull(strstr(complaint_about("relative/notify"), "expected a path"));
}
END_TEST

START_TEST(the_longest_path_is_used_and_a_longer_one_is_reported)
{
    char name[200] = "/";
    const size_t most = sizeof ((struct sockaddr_un *)NULL)->sun_path;
    memset(name + 1, 'n', most - 1); /* one character too long with its end of string */
    ck_assert_ptr_nonnull(strstr(complaint_about(name), "expected a path"));

    char longest[sizeof name] = "";
    snprintf(longest, sizeof longest, "@%s", path + 1);
    memset(longest + strlen(longest), 'n', most - 1 - strlen(longest));
    longest[0] = '\0';
    listen_at(longest, most - 1);
    longest[0] = '@';
    ck_assert_str_eq(complaint_about(longest), "");
    ck_assert_str_eq(heard(), "READY=1");
}
END_TEST

START_TEST(a_manager_that_does_not_listen_does_not_stop_the_emulator)
{
    listen_at(path, strlen(path) + 1);
    setenv("NOTIFY_SOCKET", path, 1);
    unsigned told = 0;
    for (const char *said = ""; !*said && told < 100000; told++)
        said = complaint_about(path);
    ck_assert_uint_lt(told, 100000); /* the socket was full, and we are here */
}
END_TEST

/* ---- A file descriptor -------------------------------------------------------------------------------------------- */

START_TEST(a_parent_reads_the_line_and_then_the_end)
{
    int ends[2];
    ck_assert_int_eq(pipe(ends), 0);
    int fd = read_number(ends[1]);
    ck_assert_int_eq(fd, ends[1]);
    ck_assert(notify_ready(fd, "READY {\"pty\":\"/dev/pts/5\"}\n", NULL));
    ck_assert_str_eq(drain(ends[0]), "READY {\"pty\":\"/dev/pts/5\"}\n");
}
END_TEST

START_TEST(a_socket_serves_as_well_as_a_pipe)
{
    int ends[2];
    ck_assert_int_eq(socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
    ck_assert(notify_ready(read_number(ends[1]), "READY {}\n", NULL));
    ck_assert_str_eq(drain(ends[0]), "READY {}\n");
}
END_TEST

START_TEST(a_manager_and_a_parent_are_both_told)
{
    int ends[2];
    ck_assert_int_eq(pipe(ends), 0);
    listen_at(path, strlen(path) + 1);
    setenv("NOTIFY_SOCKET", path, 1);
    ck_assert(notify_ready(read_number(ends[1]), "READY {}\n", NULL));
    ck_assert_str_eq(drain(ends[0]), "READY {}\n");
    ck_assert_str_eq(heard(), "READY=1");
}
END_TEST

START_TEST(the_descriptor_is_not_passed_on)
{
    int ends[2];
    ck_assert_int_eq(pipe(ends), 0);
    ck_assert_int_eq(fcntl(read_number(ends[1]), F_GETFD), FD_CLOEXEC);
    close(ends[0]);
    close(ends[1]);
}
END_TEST

START_TEST(a_parent_that_is_gone_is_no_failure)
{
    int ends[2];
    ck_assert_int_eq(pipe(ends), 0);
    close(ends[0]);
    ck_assert(notify_ready(read_number(ends[1]), "READY {}\n", NULL));
}
END_TEST

START_TEST(a_parent_that_does_not_read_is_no_failure)
{
    int ends[2];
    ck_assert_int_eq(pipe(ends), 0);
    ck_assert_int_ge(fcntl(ends[1], F_SETPIPE_SZ, 4096), 4096);
    char *text = malloc(100000);
    ck_assert_ptr_nonnull(text);
    memset(text, 'x', 99999);
    text[99999] = '\0';
    ck_assert(notify_ready(read_number(ends[1]), text, NULL));
    free(text);
    close(ends[0]);
}
END_TEST

START_TEST(a_descriptor_that_takes_nothing_is_a_failure)
{
    int fd = open("/dev/full", O_WRONLY);
    ck_assert_int_ge(fd, 0);
    ck_assert(!notify_ready(read_number(fd), "READY {}\n", NULL));
}
END_TEST

START_TEST(a_number_that_is_no_open_descriptor_is_refused)
{
    int ends[2];
    char text[16];
    ck_assert_int_eq(pipe(ends), 0);
    close(ends[0]);
    close(ends[1]);
    ck_assert_int_eq(read_number(ends[1]), -1);
    ck_assert_int_eq(pipe(ends), 0);
    ck_assert_int_eq(read_number(ends[0]), -1); /* can only be read */
    snprintf(text, sizeof text, "%dx", ends[1]);
    ck_assert_int_eq(notify_fd_read(text), -1);
    close(ends[0]);
    close(ends[1]);
    static const char *const wrong[] = {"", "0", "1", "2", "-3", "+3", " 3", "three", "1048576", "99999999999999999999"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        ck_assert_msg(notify_fd_read(wrong[i]) == -1, "'%s' was taken", wrong[i]);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("notify");
    TCase *service = tcase_create("manager");
    tcase_add_checked_fixture(service, start, end);
    tcase_add_test(service, a_manager_at_a_path_is_told_that_the_emulator_is_ready_and_then_that_it_ends);
    tcase_add_test(service, a_manager_without_a_file_is_told_too);
    tcase_add_test(service, the_status_is_one_line);
    tcase_add_test(service, an_endless_status_is_cut_and_the_rest_arrives);
    tcase_add_test(service, without_a_manager_nothing_is_said);
    tcase_add_test(service, a_manager_that_is_not_there_is_reported_and_survived);
    tcase_add_test(service, the_longest_path_is_used_and_a_longer_one_is_reported);
    tcase_add_test(service, a_manager_that_does_not_listen_does_not_stop_the_emulator);
    suite_add_tcase(suite, service);
    TCase *descriptor = tcase_create("descriptor");
    tcase_add_checked_fixture(descriptor, start, end);
    tcase_add_test(descriptor, a_parent_reads_the_line_and_then_the_end);
    tcase_add_test(descriptor, a_socket_serves_as_well_as_a_pipe);
    tcase_add_test(descriptor, a_manager_and_a_parent_are_both_told);
    tcase_add_test(descriptor, the_descriptor_is_not_passed_on);
    tcase_add_test(descriptor, a_parent_that_is_gone_is_no_failure);
    tcase_add_test(descriptor, a_parent_that_does_not_read_is_no_failure);
    tcase_add_test(descriptor, a_descriptor_that_takes_nothing_is_a_failure);
    tcase_add_test(descriptor, a_number_that_is_no_open_descriptor_is_refused);
    suite_add_tcase(suite, descriptor);

    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed > 0)
        printf("One case alone: CK_RUN_CASE=manager|descriptor ./test_notify\n");
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
