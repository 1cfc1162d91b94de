/* SPDX-License-Identifier: MIT */
/* Tests of rkm_host.c with Check. Each test has an `rkm04 serve' of its own, on a link in a folder of its own; motions take no
 * time (--clock max). The environment variables RKM04 and RKMCTL name the programs; default: those in PATH. */
#include "rkm_host.h"

#include <check.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static char folder[] = "/tmp/rkm-host-XXXXXX", link_path[64], command[512];
static pid_t server;
static struct rkm_unit unit;

static const char *program(const char *variable, const char *name)
{
    const char *path = getenv(variable);

    return path != NULL ? path : name;
}

/* Start a unit; it closes the pipe of --ready-fd when it is ready. */
static void begin(void)
{
    int ready[2];
    char byte, fd[12];

    strcpy(folder + sizeof folder - 7, "XXXXXX");
    ck_assert_ptr_nonnull(mkdtemp(folder));
    snprintf(link_path, sizeof link_path, "%s/bus", folder);
    ck_assert_int_eq(pipe(ready), 0);
    server = fork();
    ck_assert_int_ge(server, 0);
    if (server == 0) {
        close(ready[0]);
        snprintf(fd, sizeof fd, "%d", ready[1]);
        if (freopen("/dev/null", "w", stdout) == NULL || freopen("/dev/null", "w", stderr) == NULL)
            _exit(127);
        execlp(program("RKM04", "rkm04"), "rkm04", "serve", "--clock", "max", "--link", link_path, "--ready-fd", fd, NULL);
        _exit(127);
    }
    close(ready[1]);
    ck_assert_msg(read(ready[0], &byte, 1) == 1, "rkm04 serve has not become ready");
    close(ready[0]);
    ck_assert_int_eq(rkm_open(&unit, link_path, 1), RKM_OK);
}

static void end(void)
{
    rkm_close(&unit);
    kill(server, SIGTERM);
    waitpid(server, NULL, 0);
    rmdir(folder);
}

/* Do something to the unit: rkmctl ARGUMENTS. */
static void ctl(const char *arguments)
{
    snprintf(command, sizeof command, "'%s' --control '%s.control' %s >/dev/null", program("RKMCTL", "rkmctl"), link_path,
             arguments);
    ck_assert_int_eq(system(command), 0);
}

START_TEST(test_a_motion)
{
    int32_t position = -1;
    bool busy = true;

    ck_assert_int_eq(rkm_set_command(&unit, 1, "V1000 F300 R"), RKM_OK);
    while (busy)
        ck_assert_int_eq(rkm_busy(&unit, 1, &busy), RKM_OK);
    ck_assert_int_eq(rkm_position(&unit, 1, &position), RKM_OK);
    ck_assert_int_eq(position, 300);
}
END_TEST

START_TEST(test_a_text_that_is_refused)
{
    ck_assert_int_eq(rkm_set_command(&unit, 1, "F5x"), RKM_REFUSED);
}
END_TEST

START_TEST(test_a_lost_answer_is_asked_for_again)
{
    int32_t position = -1;

    ctl("fault inject no_answer count=1");
    ck_assert_int_eq(rkm_position(&unit, 1, &position), RKM_OK);
    ck_assert_int_eq(position, 0);
}
END_TEST

START_TEST(test_a_unit_without_power)
{
    int32_t position;

    unit.timeout = 50;
    ctl("power off");
    ck_assert_int_eq(rkm_position(&unit, 1, &position), RKM_NO_ANSWER);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("rkm_host");
    TCase *tests = tcase_create("rkm_host");
    SRunner *runner = srunner_create(suite);

    tcase_add_checked_fixture(tests, begin, end);
    tcase_add_test(tests, test_a_motion);
    tcase_add_test(tests, test_a_text_that_is_refused);
    tcase_add_test(tests, test_a_lost_answer_is_asked_for_again);
    tcase_add_test(tests, test_a_unit_without_power);
    tcase_set_timeout(tests, 60);
    suite_add_tcase(suite, tests);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}
