/* SPDX-License-Identifier: MIT */
/* test_control_socket.c: the file of the control socket: whose it is, and what is never touched.
 * One test case alone: CK_RUN_CASE=socket ./test_control_socket */
#include <check.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include "control/control_socket.h"

static char folder[64], path[96], lock_path[112], other[96];
static struct control_socket ours;

static void setup(void)
{
    strcpy(folder, "/tmp/rkm04-control-XXXXXX");
    ck_assert_ptr_nonnull(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/control", folder);
    snprintf(lock_path, sizeof lock_path, "%s.lock", path);
    snprintf(other, sizeof other, "%s/other", folder);
    ours.lock = ours.fd = -1;
}

static void teardown(void)
{
    char command[80];
    control_socket_release(&ours);
    snprintf(command, sizeof command, "rm -rf %s", folder);
    ck_assert_int_eq(system(command), 0);
}

static bool exists(const char *name)
{
    struct stat found;
    return lstat(name, &found) == 0;
}

static bool can_connect(void)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    int fd = socket(AF_UNIX, SOCK_STREAM, 0);
    strcpy(address.sun_path, path);
    bool ok = connect(fd, (const struct sockaddr *)&address, sizeof address) == 0;
    close(fd);
    return ok;
}

/* Another emulator has made the socket and been killed. */
static void leave_stale(void)
{
    pid_t child = fork();
    if (child == 0) {
        struct control_socket socket;
        bool ok = control_socket_open(&socket, path) && listen(socket.fd, 1) == 0;
        raise(ok ? SIGKILL : SIGTERM);
        _exit(1);
    }
    int status;
    ck_assert_int_eq(waitpid(child, &status, 0), child);
    ck_assert(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
    ck_assert(exists(path));
}

START_TEST(the_socket_is_for_its_owner_alone)
{
    struct stat found;
    mode_t mask = umask(0);
    ck_assert(control_socket_open(&ours, path));
    ck_assert_int_eq(umask(mask), 0); /* it is as it was */
    ck_assert_int_eq(stat(path, &found), 0);
    ck_assert(S_ISSOCK(found.st_mode));
    ck_assert_int_eq(found.st_mode & 07777, 0600);
    ck_assert_int_eq(stat(lock_path, &found), 0);
    ck_assert_int_eq(found.st_mode & 07777, 0600);
}
END_TEST

START_TEST(it_is_removed_at_the_end)
{
    ck_assert(control_socket_open(&ours, path));
    ck_assert_int_eq(listen(ours.fd, 1), 0);
    ck_assert(can_connect());
    control_socket_release(&ours);
    ck_assert(!exists(path));
    ck_assert(!exists(lock_path));
}
END_TEST

START_TEST(one_that_a_killed_emulator_left_is_replaced)
{
    leave_stale();
    ck_assert(!can_connect());
    ck_assert(control_socket_open(&ours, path));
    ck_assert_int_eq(listen(ours.fd, 1), 0);
    ck_assert(can_connect());
}
END_TEST

START_TEST(one_that_is_in_use_is_left_alone)
{
    struct control_socket second;
    ck_assert(control_socket_open(&ours, path));
    ck_assert_int_eq(listen(ours.fd, 1), 0);
    ck_assert(!control_socket_open(&second, path));
    control_socket_release(&second); /* does nothing */
    ck_assert(can_connect());
    ck_assert(exists(lock_path));
}
END_TEST

static void make_file(void)
{
    int fd = open(path, O_CREAT | O_WRONLY, 0600);
    ck_assert_int_ge(fd, 0);
    close(fd);
}

static void make_folder(void)
{
    ck_assert_int_eq(mkdir(path, 0700), 0);
}

static void make_link(void)
{
    ck_assert_int_eq(symlink(other, path), 0);
}

/* Of another program, and dead. */
static void make_socket(void)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    int fd = socket(AF_UNIX, SOCK_STREAM, 0);
    strcpy(address.sun_path, path);
    ck_assert_int_eq(bind(fd, (const struct sockaddr *)&address, sizeof address), 0);
    close(fd);
}

static void (*const strangers[])(void) = {make_file, make_folder, make_link, make_socket};

START_TEST(what_is_not_ours_is_never_removed)
{
    struct stat before, after;
    strangers[_i]();
    ck_assert_int_eq(lstat(path, &before), 0);
    ck_assert(!control_socket_open(&ours, path));
    ck_assert_int_eq(lstat(path, &after), 0);
    ck_assert(before.st_ino == after.st_ino && before.st_mode == after.st_mode);
    ck_assert(!exists(other));
    ck_assert(!exists(lock_path));
}
END_TEST

START_TEST(what_took_the_place_of_a_stale_one_is_never_removed)
{
    struct stat before, after;
    leave_stale();
    ck_assert_int_eq(rename(path, other), 0); /* keeps its number in use */
    strangers[_i]();
    ck_assert_int_eq(lstat(path, &before), 0);
    ck_assert(!control_socket_open(&ours, path));
    ck_assert_int_eq(lstat(path, &after), 0);
    ck_assert(before.st_ino == after.st_ino && before.st_mode == after.st_mode);
}
END_TEST

START_TEST(what_took_the_place_of_ours_is_not_removed_at_the_end)
{
    ck_assert(control_socket_open(&ours, path));
    ck_assert_int_eq(rename(path, other), 0);
    strangers[_i]();
    control_socket_release(&ours);
    ck_assert(exists(path));
}
END_TEST

/* Somebody has cleaned the folder, and another emulator has taken the place. */
START_TEST(a_successor_keeps_its_lock_file_and_socket)
{
    struct control_socket before;
    ck_assert(control_socket_open(&before, path));
    ck_assert_int_eq(unlink(path), 0);
    ck_assert_int_eq(unlink(lock_path), 0);
    ck_assert(control_socket_open(&ours, path));
    ck_assert_int_eq(listen(ours.fd, 1), 0);
    control_socket_release(&before);
    close(before.fd);
    ck_assert(exists(lock_path));
    ck_assert(can_connect());
}
END_TEST

START_TEST(a_lock_file_of_somebody_else_is_left_alone)
{
    FILE *file = fopen(lock_path, "w");
    fputs("diary\n", file);
    fclose(file);
    ck_assert(!control_socket_open(&ours, path));
    ck_assert(exists(lock_path));
    ck_assert(!exists(path));
}
END_TEST

START_TEST(no_link_is_followed_to_the_lock)
{
    ck_assert_int_eq(symlink(other, lock_path), 0);
    ck_assert(!control_socket_open(&ours, path));
    ck_assert(!exists(other));
}
END_TEST

START_TEST(a_path_may_be_longer_than_the_address_of_a_socket)
{
    char deep[256];
    struct stat found;
    snprintf(deep, sizeof deep, "%s/%080d", folder, 0);
    ck_assert_int_eq(mkdir(deep, 0700), 0);
    strcat(deep, "/control");
    ck_assert_uint_gt(strlen(deep), 107);
    ck_assert(control_socket_open(&ours, deep));
    ck_assert_int_eq(stat(deep, &found), 0);
    ck_assert_int_eq(found.st_mode & 07777, 0600);
    control_socket_release(&ours);
    ck_assert(!exists(deep));
}
END_TEST

START_TEST(a_name_that_is_too_long_is_refused)
{
    char longest[256];
    snprintf(longest, sizeof longest, "%s/%0120d", folder, 0);
    ck_assert(!control_socket_open(&ours, longest));
    ck_assert(!exists(longest));
    ck_assert(!control_socket_open(&ours, ""));
}
END_TEST

START_TEST(a_folder_that_is_not_there_is_refused)
{
    ck_assert(!control_socket_open(&ours, "/nonexistent/control"));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("control_socket");
    TCase *tests = tcase_create("socket");
    tcase_add_checked_fixture(tests, setup, teardown);
    tcase_add_test(tests, the_socket_is_for_its_owner_alone);
    tcase_add_test(tests, it_is_removed_at_the_end);
    tcase_add_test(tests, one_that_a_killed_emulator_left_is_replaced);
    tcase_add_test(tests, one_that_is_in_use_is_left_alone);
    tcase_add_loop_test(tests, what_is_not_ours_is_never_removed, 0, 4);
    tcase_add_loop_test(tests, what_took_the_place_of_a_stale_one_is_never_removed, 0, 4);
    tcase_add_loop_test(tests, what_took_the_place_of_ours_is_not_removed_at_the_end, 0, 4);
    tcase_add_test(tests, a_successor_keeps_its_lock_file_and_socket);
    tcase_add_test(tests, a_lock_file_of_somebody_else_is_left_alone);
    tcase_add_test(tests, no_link_is_followed_to_the_lock);
    tcase_add_test(tests, a_path_may_be_longer_than_the_address_of_a_socket);
    tcase_add_test(tests, a_name_that_is_too_long_is_refused);
    tcase_add_test(tests, a_folder_that_is_not_there_is_refused);
    suite_add_tcase(suite, tests);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}
