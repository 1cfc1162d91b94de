/* SPDX-License-Identifier: MIT */
/* test_client_condition.c: conditions as one types them into a shell, and the JSON they mean.
 * One test alone: CK_RUN_CASE=several ./test_client_condition */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "client/client_condition.h"

static void assert_means(const char *text, const char *unit, const char *expected)
{
    char wrong[CLIENT_CONDITION_WRONG_SIZE];
    json_t *meant = json_loads(expected, 0, NULL), *found = client_condition(text, unit, wrong);
    ck_assert_ptr_nonnull(meant);
    ck_assert_msg(found != NULL, "'%s' is refused: %s", text, wrong);
    char *dump = json_dumps(found, JSON_COMPACT);
    ck_assert_msg(json_equal(meant, found), "'%s' means %s, expected %s", text, dump, expected);
    free(dump);
    json_decref(found);
    json_decref(meant);
}

/* It is refused, and what is said about it contains `part`. */
static void assert_refused(const char *text, const char *part)
{
    char wrong[CLIENT_CONDITION_WRONG_SIZE];
    json_t *found = client_condition(text, NULL, wrong);
    ck_assert_msg(found == NULL, "'%s' is not refused", text);
    ck_assert_msg(strstr(wrong, part) != NULL, "'%s': '%s' does not say '%s'", text, wrong, part);
}

/* ---- Terms ------------------------------------------------------------------------------------------------------------ */

START_TEST(numbers_of_motors_are_compared)
{
    assert_means("m1.position=5000", NULL, "{\"motor\": 1, \"position\": 5000}");
    assert_means("m1.position==5000", NULL, "{\"motor\": 1, \"position\": 5000}");
    assert_means("m2.position>=-5", NULL, "{\"motor\": 2, \"position\": {\">=\": -5}}");
    assert_means("m3.true<=0", NULL, "{\"motor\": 3, \"true_position\": {\"<=\": 0}}");
    assert_means("m4.true_position!=0", NULL, "{\"motor\": 4, \"true_position\": {\"!=\": 0}}");
    assert_means("m4.steps > 10", NULL, "{\"motor\": 4, \"steps\": {\">\": 10}}");
    assert_means("m16.position>0", NULL, "{\"motor\": 16, \"position\": {\">\": 0}}");
    assert_means("u2.cell.B_POL[0]>=-8", NULL, "{\"cell\": {\"B_POL[0]\": {\">=\": -8}}, \"unit\": \"2\"}");
    assert_means("m4.index<700", NULL, "{\"motor\": 4, \"index\": {\"<\": 700}}");
    assert_means("m1.commands=0", NULL, "{\"motor\": 1, \"commands\": 0}");
}
END_TEST

/* Which words, inputs and variables a device has, the emulator says. */
START_TEST(names_of_states_leds_and_faults_are_those_of_the_device)
{
    assert_means("m1.state=idle", NULL, "{\"motor\": 1, \"state\": \"idle\"}");
    assert_means("m1.led=blink", NULL, "{\"motor\": 1, \"led\": \"blink\"}");
    assert_means("m1.fault=no_label", NULL, "{\"motor\": 1, \"fault\": \"no_label\"}");
    assert_means("m2.led!=off", NULL, "{\"motor\": 2, \"led\": {\"!=\": \"off\"}}");
    assert_means("m2.fault=maximum", NULL, "{\"motor\": 2, \"fault\": \"maximum\"}");
    assert_means("m1.fault=hl-", NULL, "{\"motor\": 1, \"fault\": \"hl-\"}");
    assert_refused("m1.state>=idle", "= or !=");
    assert_refused("m1.state", "= or !=");
}
END_TEST

START_TEST(flags_may_stand_alone)
{
    assert_means("idle", NULL, "{\"idle\": true}");
    assert_means("idle=0", NULL, "{\"idle\": false}");
    assert_means("m3.idle", NULL, "{\"motor\": 3, \"idle\": true}");
    assert_means("m3.idle!=1", NULL, "{\"motor\": 3, \"idle\": false}");
    assert_means("powered", NULL, "{\"powered\": true}");
    assert_refused("idle>=1", "idle=0 or idle=1");
    assert_refused("idle=2", "idle=0 or idle=1");
}
END_TEST

START_TEST(inputs_outputs_and_variables_are_0_or_1)
{
    assert_means("do3=1", NULL, "{\"do\": {\"03\": 1}}");
    assert_means("di08=0", NULL, "{\"di\": {\"08\": 0}}");
    assert_means("var95!=1", NULL, "{\"var\": {\"95\": 0}}");
    assert_refused("do0=1", "do1 to do32");
    assert_refused("di33=1", "di1 to di32");
    assert_refused("di.=1", "di1 to di32");
    assert_refused("di.near=2", "di.near=0 or di.near=1");
    assert_means("var12=1", NULL, "{\"var\": {\"12\": 1}}");
    assert_refused("var0=1", "var1 to var99");
    assert_refused("var100=1", "var1 to var99");
    assert_refused("do3=2", "do3=0 or do3=1");
    assert_refused("do3", "do3=0 or do3=1");
    assert_refused("do003=1", "do1 to do32");
}
END_TEST

START_TEST(messages_are_chosen_by_number_and_sender)
{
    assert_means("message", NULL, "{\"message\": {}}");
    assert_means("message=4", NULL, "{\"message\": {\"number\": 4}}");
    assert_means("master.message=2", NULL, "{\"message\": {\"number\": 2, \"from\": \"master\"}}");
    assert_means("unit.message", NULL, "{\"message\": {\"from\": \"unit\"}}");
    assert_means("u3-2.message=4", NULL, "{\"message\": {\"number\": 4, \"from\": \"3-2\"}}");
    assert_means("dropped", NULL, "{\"message\": {\"dropped\": true}}");
    assert_refused("message=256", "message=0 to message=255");
    assert_refused("message>=2", "message=0 to message=255");
    assert_refused("dropped=1", "dropped alone");
}
END_TEST

START_TEST(times_have_a_unit_or_are_us)
{
    assert_means("t>=2.5s", NULL, "{\"t\": {\">=\": \"2.5s\"}}");
    assert_means("t=1500", NULL, "{\"t\": 1500}");
    assert_refused("t", "t>=2.5s");
}
END_TEST

START_TEST(a_unit_can_be_in_front_or_the_same_for_all)
{
    assert_means("u3.m1.idle", NULL, "{\"unit\": \"3\", \"motor\": 1, \"idle\": true}");
    assert_means("u3-2.do1=1", "5", "{\"unit\": \"3-2\", \"do\": {\"01\": 1}}");
    assert_means("do1=1", "5", "{\"unit\": \"5\", \"do\": {\"01\": 1}}");
    assert_means("m1.led!=on", "5", "{\"unit\": \"5\", \"motor\": 1, \"led\": {\"!=\": \"on\"}}");
    assert_means("t>=1 message", "5", "{\"all\": [{\"t\": {\">=\": 1}}, {\"message\": {}}]}");
    assert_refused("u3.t>=1", "t, found 'u3.t'");
}
END_TEST

START_TEST(what_is_no_condition_is_refused_with_what_is_one)
{
    assert_refused("", "m1.position>=5000");
    assert_refused(">=5", "m1.position>=5000");
    assert_refused("m17.idle", "m1.position");
    assert_refused("m0.idle", "m1.position");
    assert_refused("cell.PO_STOP", "a comparison after cell.PO_STOP");
    assert_refused("cell.=1", "m1.position");
    assert_refused("m1.speed>5", "m1.position, true, steps");
    assert_refused("m1.position", "a comparison after m1.position");
    assert_refused("m1.position>=", "a value after m1.position>=");
    assert_refused("m1.position>=ten", "a whole number");
    assert_refused("m1.position>=99999999999999999999", "a whole number");
    assert_refused("m1.position=5;idle", "found ';idle'");
    assert_refused("a_name_that_is_much_longer_than_any_name_of_a_condition_could_be=1", "a condition such as");
}
END_TEST

/* ---- Several ---------------------------------------------------------------------------------------------------------- */

START_TEST(terms_beside_one_another_hold_together)
{
    static const char meaning[] = "{\"all\": [{\"do\": {\"01\": 1}}, {\"do\": {\"02\": 0}}, {\"idle\": true}]}";
    assert_means("do1=1 do2=0 idle", NULL, meaning);
    assert_means("do1=1 and do2=0 and idle", NULL, meaning);
    assert_means("do1=1&&do2=0 && idle", NULL, meaning);
    assert_means("do1=1,do2=0, idle", NULL, meaning);
    assert_refused("do1=1 and", "a condition such as");
    assert_refused("and do1=1", "found 'and'");
}
END_TEST

START_TEST(or_binds_less_than_and)
{
    assert_means("idle or do1=1", NULL, "{\"any\": [{\"idle\": true}, {\"do\": {\"01\": 1}}]}");
    assert_means("idle do2=1 || do1=1 and do3=0", NULL,
                 "{\"any\": [{\"all\": [{\"idle\": true}, {\"do\": {\"02\": 1}}]}, "
                 "{\"all\": [{\"do\": {\"01\": 1}}, {\"do\": {\"03\": 0}}]}]}");
    assert_refused("idle or", "a condition such as");
    assert_refused("or idle", "found 'or'");
}
END_TEST

START_TEST(json_is_taken_as_it_is)
{
    static const char between[] = "{\"motor\": 1, \"position\": {\">=\": 1, \"<\": 5}}";
    assert_means(between, "3", between);
    assert_refused("{\"motor\": 1", "JSON");
}
END_TEST

static Suite *client_condition_suite(void)
{
    Suite *suite = suite_create("client_condition");
    TCase *terms = tcase_create("terms"), *several = tcase_create("several");
    tcase_add_test(terms, numbers_of_motors_are_compared);
    tcase_add_test(terms, names_of_states_leds_and_faults_are_those_of_the_device);
    tcase_add_test(terms, flags_may_stand_alone);
    tcase_add_test(terms, inputs_outputs_and_variables_are_0_or_1);
    tcase_add_test(terms, messages_are_chosen_by_number_and_sender);
    tcase_add_test(terms, times_have_a_unit_or_are_us);
    tcase_add_test(terms, a_unit_can_be_in_front_or_the_same_for_all);
    tcase_add_test(terms, what_is_no_condition_is_refused_with_what_is_one);
    tcase_add_test(several, terms_beside_one_another_hold_together);
    tcase_add_test(several, or_binds_less_than_and);
    tcase_add_test(several, json_is_taken_as_it_is);
    suite_add_tcase(suite, terms);
    suite_add_tcase(suite, several);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(client_condition_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
