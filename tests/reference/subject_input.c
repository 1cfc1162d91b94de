/* SPDX-License-Identifier: MIT */
#include "subject_input.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>

static void (*obey_input)(void);

START_TEST(input)
{
    obey_input();
}
END_TEST

int run_subject(const char *name, void (*obey)(void))
{
    Suite *suite = suite_create(name);
    TCase *only = tcase_create("input");
    obey_input = obey;
    tcase_add_test(only, input);
    suite_add_tcase(suite, only);
    SRunner *runner = srunner_create(suite);
    srunner_set_fork_status(runner, CK_NOFORK);
    srunner_run_all(runner, CK_SILENT);
    const int failed = srunner_ntests_failed(runner);
    TestResult **results = srunner_failures(runner);
    for (int i = 0; i < failed; i++)
        fprintf(stderr, "%s: %s:%d: %s\n", name, tr_lfile(results[i]), tr_lno(results[i]), tr_msg(results[i]));
    free(results);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
