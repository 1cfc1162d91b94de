/* SPDX-License-Identifier: MIT */
#include <check.h>
#include <string.h>

#include "core/rig.h"
#include "text/text.h"

#define NAMES "low, high, state, di.set, readings"

START_TEST(near_word_is_proposed_and_another_one_is_not)
{
    static const char *const pairs[][2] = {
        {"lo", "; did you mean `low'?"},          {"lwo", "; did you mean `low'?"}, {"hihg", "; did you mean `high'?"},
        {"stat", "; did you mean `state'?"},      {"di.sett", "; did you mean `di.set'?"},
        {"redings", "; did you mean `readings'?"}, {"reedingz", "; did you mean `readings'?"},
        {"top", ""}, {"lot", "; did you mean `low'?"}, {"hop", ""}, {"l", ""}, {"", ""}, {"framing", ""},
    };
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++)
        ck_assert_msg(strcmp(nearest_hint(pairs[i][0], NAMES), pairs[i][1]) == 0, "%s%s", pairs[i][0],
                      nearest_hint(pairs[i][0], NAMES));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("nearest");
    TCase *all = tcase_create("all");
    tcase_add_test(all, near_word_is_proposed_and_another_one_is_not);
    suite_add_tcase(suite, all);
    return rig_run(suite, "./test_nearest");
}
