/* SPDX-License-Identifier: MIT */
/* test_control_socket.c: the control socket and the control file: whose they are, and what is never touched.
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

#include "control/control_file.h"
#include "control/control_socket.h"

static char folder[64], path[96], lock_path[112], other[96];
static struct opened {
    struct control_place place;
    int fd; /* of a socket */
} ours;
static char token[CONTROL_TOKEN_LENGTH + 1];

static bool open_socket(struct opened *opened, const char *name)
{
    opened->fd = control_socket_open(&opened->place, name);
    return opened->fd >= 0;
}

static bool write_file(struct opened *opened, const char *name)
{
    opened->fd = -1;
    return control_file_write(&opened->place, name, "127.0.0.1:4711", token);
}

/* Both keep to the same rules: a socket that listens, and a file. */
static bool (*const makers[])(struct opened *opened, const char *name) = {open_socket, write_file};

static void setup(void)
{
    strcpy(folder, "/tmp/rkm04-control-XXXXXX");
    ck_assert_ptr_nonnull(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/control", folder);
    snprintf(lock_path, sizeof lock_path, "%s.lock", path);
    snprintf(other, sizeof other, "%s/other", folder);
    ours.place.lock = ours.fd = -1;
    ck_assert(control_file_token(token));
}

static void teardown(void)
{
    char command[80];
    control_place_release(&ours.place);
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
static void leave_stale(int maker)
{
    pid_t child = fork();
    if (child == 0) {
        struct opened left;
        bool ok = makers[maker](&left, path) && (left.fd < 0 || listen(left.fd, 1) == 0);
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
    ck_assert(open_socket(&ours, path));
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
    ck_assert(open_socket(&ours, path));
    ck_assert_int_eq(listen(ours.fd, 1), 0);
    ck_assert(can_connect());
    control_place_release(&ours.place);
    ck_assert(!exists(path));
    ck_assert(!exists(lock_path));
}
END_TEST

START_TEST(one_that_a_killed_emulator_left_is_replaced)
{
    leave_stale(_i);
    ck_assert(!can_connect());
    ck_assert(open_socket(&ours, path));
    ck_assert_int_eq(listen(ours.fd, 1), 0);
    ck_assert(can_connect());
}
END_TEST

START_TEST(one_that_is_in_use_is_left_alone)
{
    struct opened second;
    ck_assert(open_socket(&ours, path));
    ck_assert_int_eq(listen(ours.fd, 1), 0);
    ck_assert(!open_socket(&second, path));
    control_place_release(&second.place); /* does nothing */
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
    strangers[_i % 4]();
    ck_assert_int_eq(lstat(path, &before), 0);
    ck_assert(!makers[_i / 4](&ours, path));
    ck_assert_int_eq(lstat(path, &after), 0);
    ck_assert(before.st_ino == after.st_ino && before.st_mode == after.st_mode);
    ck_assert(!exists(other));
    ck_assert(!exists(lock_path));
}
END_TEST

START_TEST(what_took_the_place_of_a_stale_one_is_never_removed)
{
    struct stat before, after;
    leave_stale(_i / 4);
    ck_assert_int_eq(rename(path, other), 0); /* keeps its number in use */
    strangers[_i % 4]();
    ck_assert_int_eq(lstat(path, &before), 0);
    ck_assert(!makers[_i / 4](&ours, path));
    ck_assert_int_eq(lstat(path, &after), 0);
    ck_assert(before.st_ino == after.st_ino && before.st_mode == after.st_mode);
}
END_TEST

START_TEST(what_took_the_place_of_ours_is_not_removed_at_the_end)
{
    ck_assert(makers[_i / 4](&ours, path));
    ck_assert_int_eq(rename(path, other), 0);
    strangers[_i % 4]();
    control_place_release(&ours.place);
    ck_assert(exists(path));
}
END_TEST

/* The folder has been cleaned, and another emulator has taken the place. */
START_TEST(a_successor_keeps_its_lock_file_and_socket)
{
    struct opened before;
    ck_assert(open_socket(&before, path));
    ck_assert_int_eq(unlink(path), 0);
    ck_assert_int_eq(unlink(lock_path), 0);
    ck_assert(open_socket(&ours, path));
    ck_assert_int_eq(listen(ours.fd, 1), 0);
    control_place_release(&before.place);
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
    ck_assert(!open_socket(&ours, path));
    ck_assert(exists(lock_path));
    ck_assert(!exists(path));
}
END_TEST

START_TEST(no_link_is_followed_to_the_lock)
{
    ck_assert_int_eq(symlink(other, lock_path), 0);
    ck_assert(!open_socket(&ours, path));
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
    ck_assert(open_socket(&ours, deep));
    ck_assert_int_eq(stat(deep, &found), 0);
    ck_assert_int_eq(found.st_mode & 07777, 0600);
    control_place_release(&ours.place);
    ck_assert(!exists(deep));
}
END_TEST

START_TEST(a_name_that_is_too_long_is_refused)
{
    char longest[256];
    snprintf(longest, sizeof longest, "%s/%0120d", folder, 0);
    ck_assert(!open_socket(&ours, longest));
    ck_assert(!exists(longest));
    ck_assert(!open_socket(&ours, ""));
}
END_TEST

START_TEST(a_folder_that_is_not_there_is_refused)
{
    ck_assert(!open_socket(&ours, "/nonexistent/control"));
}
END_TEST

START_TEST(the_file_is_for_its_owner_alone_and_has_address_and_token)
{
    struct stat found;
    char line[200] = "", wanted[200];
    mode_t mask = umask(0);
    ck_assert(write_file(&ours, path));
    umask(mask);
    ck_assert_int_eq(lstat(path, &found), 0);
    ck_assert(S_ISREG(found.st_mode));
    ck_assert_int_eq(found.st_mode & 07777, 0600);
    FILE *file = fopen(path, "r");
    ck_assert_ptr_nonnull(fgets(line, sizeof line, file));
    fclose(file);
    snprintf(wanted, sizeof wanted, "tcp:127.0.0.1:4711 %s\n", token);
    ck_assert_str_eq(line, wanted);
}
END_TEST

START_TEST(the_file_is_removed_at_the_end_and_not_made_twice)
{
    struct opened second;
    ck_assert(write_file(&ours, path));
    ck_assert(!write_file(&second, path));
    ck_assert(!open_socket(&second, path));
    ck_assert(exists(path) && exists(lock_path));
    control_place_release(&ours.place);
    ck_assert(!exists(path) && !exists(lock_path));
}
END_TEST

START_TEST(a_file_that_a_killed_emulator_left_is_replaced_by_a_file)
{
    leave_stale(1);
    ck_assert(write_file(&ours, path));
    ck_assert(exists(path));
}
END_TEST

START_TEST(each_token_is_another_one_of_64_digits)
{
    char next[CONTROL_TOKEN_LENGTH + 1];
    ck_assert_uint_eq(strlen(token), 64);
    ck_assert_uint_eq(strspn(token, "0123456789abcdef"), 64);
    ck_assert(control_file_token(next));
    ck_assert_str_ne(token, next);
}
END_TEST

START_TEST(a_token_that_differs_anywhere_is_another_one)
{
    char wrong[CONTROL_TOKEN_LENGTH + 1];
    ck_assert(control_file_is_token(token, token, 64));
    for (size_t at = 0; at < 64; at++) {
        strcpy(wrong, token);
        wrong[at] ^= 1;
        ck_assert(!control_file_is_token(token, wrong, 64));
        ck_assert(!control_file_is_token(token, token, at));
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("control_socket");
    TCase *tests = tcase_create("socket");
    tcase_add_checked_fixture(tests, setup, teardown);
    tcase_add_test(tests, the_socket_is_for_its_owner_alone);
    tcase_add_test(tests, it_is_removed_at_the_end);
    tcase_add_loop_test(tests, one_that_a_killed_emulator_left_is_replaced, 0, 2);
    tcase_add_test(tests, one_that_is_in_use_is_left_alone);
    tcase_add_loop_test(tests, what_is_not_ours_is_never_removed, 0, 8);
    tcase_add_loop_test(tests, what_took_the_place_of_a_stale_one_is_never_removed, 0, 8);
    tcase_add_loop_test(tests, what_took_the_place_of_ours_is_not_removed_at_the_end, 0, 8);
    tcase_add_test(tests, a_successor_keeps_its_lock_file_and_socket);
    tcase_add_test(tests, a_lock_file_of_somebody_else_is_left_alone);
    tcase_add_test(tests, no_link_is_followed_to_the_lock);
    tcase_add_test(tests, a_path_may_be_longer_than_the_address_of_a_socket);
    tcase_add_test(tests, a_name_that_is_too_long_is_refused);
    tcase_add_test(tests, a_folder_that_is_not_there_is_refused);
    tcase_add_test(tests, the_file_is_for_its_owner_alone_and_has_address_and_token);
    tcase_add_test(tests, the_file_is_removed_at_the_end_and_not_made_twice);
    tcase_add_test(tests, a_file_that_a_killed_emulator_left_is_replaced_by_a_file);
    tcase_add_test(tests, each_token_is_another_one_of_64_digits);
    tcase_add_test(tests, a_token_that_differs_anywhere_is_another_one);
    suite_add_tcase(suite, tests);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}
