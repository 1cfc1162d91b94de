/* SPDX-License-Identifier: MIT */
/* test_serve_names.c: lists of addresses, and the names that are made of patterns (U4). One case alone:
 * CK_RUN_CASE=CASE ./test_serve_names */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "device/serve_names.h"

/* The list as text, "1 2 5", or "none". */
static const char *nodes(const char *text)
{
    static char out[128];
    struct node_list list;
    out[0] = '\0';
    if (!node_list_read(&list, text))
        return "none";
    for (unsigned i = 0; i < list.count; i++)
        snprintf(out + strlen(out), sizeof out - strlen(out), i > 0 ? " %u" : "%u", list.node[i]);
    return out;
}

START_TEST(U4_a_list_has_addresses_and_ranges_in_their_order)
{
    ck_assert_str_eq(nodes("7"), "7");
    ck_assert_str_eq(nodes("1,2,5-8"), "1 2 5 6 7 8");
    ck_assert_str_eq(nodes("16,1"), "16 1");
    ck_assert_str_eq(nodes("3,3"), "3 3");
    ck_assert_str_eq(nodes("4-4"), "4");
    ck_assert_str_eq(nodes("1-16"), "1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16");
    ck_assert_str_eq(nodes("08"), "8");
}
END_TEST

START_TEST(U4_anything_else_is_no_list)
{
    static const char *const wrong[] = {"",    "0",   "17",  "1,",   ",1",     "1,,2",       "5-3", "1-",
                                        "-1",  "1-17", "1 2", "a",   "1-2-3",  "1-16,1",     "+1",  "4294967297",
                                        "1;2", "1x",  "0-3", "1-0", "1-8,1-9", "99999999999"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        ck_assert_msg(strcmp(nodes(wrong[i]), "none") == 0, "`%s' was read as %s", wrong[i], nodes(wrong[i]));
}
END_TEST

START_TEST(U4_units_of_one_address_have_names_of_their_own)
{
    struct node_list list;
    char name[NODE_NAME_SIZE];
    static const char *const names[] = {"3", "16", "3-2", "3-3", "16-2"};
    ck_assert(node_list_read(&list, "3,16,3,3,16"));
    for (unsigned i = 0; i < list.count; i++) {
        node_list_name(&list, i, name);
        ck_assert_str_eq(name, names[i]);
    }
}
END_TEST

START_TEST(patterns_are_filled_in)
{
    char path[PATH_MAX];
    ck_assert(name_expand("line%l/unit%n.flash", "3-2", 12, path));
    ck_assert_str_eq(path, "line12/unit3-2.flash");
    ck_assert(name_expand("100%%n", "3", 0, path));
    ck_assert_str_eq(path, "100%n");
    ck_assert(name_expand("/nl/plain", "3", 7, path));
    ck_assert_str_eq(path, "/nl/plain");
    ck_assert(name_pattern_has("a%n", 'n') && !name_pattern_has("a%%n", 'n') && !name_pattern_has("n%l", 'n'));
    ck_assert(name_pattern_valid("%n%l%%") && !name_pattern_valid("%x") && !name_pattern_valid("a%"));
}
END_TEST

START_TEST(a_path_that_gets_too_long_is_refused)
{
    static char pattern[PATH_MAX + 1];
    char path[PATH_MAX];
    memset(pattern, 'a', PATH_MAX - 2);
    ck_assert(name_expand(pattern, "3", 0, path));
    memcpy(pattern + PATH_MAX - 3, "%n", 3);
    ck_assert(!name_expand(pattern, "16-2", 0, path));
}
END_TEST

START_TEST(each_line_has_its_own_network_port)
{
    char out[32];
    ck_assert(name_address("4000", 0, out, sizeof out));
    ck_assert_str_eq(out, "4000");
    ck_assert(name_address("127.0.0.1:4000", 15, out, sizeof out));
    ck_assert_str_eq(out, "127.0.0.1:4015");
    ck_assert(name_address("[::1]:0", 15, out, sizeof out));
    ck_assert_str_eq(out, "[::1]:0");
    ck_assert(name_address(":65535", 0, out, sizeof out));
    ck_assert(!name_address(":65535", 1, out, sizeof out));
    ck_assert(!name_address("a-name-that-is-much-too-long.example:4000", 1, out, sizeof out));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("serve_names");
    TCase *names = tcase_create("names");
    tcase_add_test(names, U4_a_list_has_addresses_and_ranges_in_their_order);
    tcase_add_test(names, U4_anything_else_is_no_list);
    tcase_add_test(names, U4_units_of_one_address_have_names_of_their_own);
    tcase_add_test(names, patterns_are_filled_in);
    tcase_add_test(names, a_path_that_gets_too_long_is_refused);
    tcase_add_test(names, each_line_has_its_own_network_port);
    suite_add_tcase(suite, names);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}
