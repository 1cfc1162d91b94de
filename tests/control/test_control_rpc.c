/* SPDX-License-Identifier: MIT */
/* test_control_rpc.c: requests of the control socket, line by line.
 * One test case alone: CK_RUN_CASE=requests ./test_control_rpc */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "control/control_rpc.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

static struct rpc_request request;
static struct refusal refusal;

static void teardown(void)
{
    rpc_end(&request);
}

static bool read_one_of(const char *line, unsigned lines)
{
    rpc_end(&request);
    memset(&refusal, 0, sizeof refusal);
    return rpc_read(&request, line, strlen(line), lines, &refusal);
}

static bool read_line(const char *line)
{
    return read_one_of(line, 1);
}

/* ---- Requests ------------------------------------------------------------------------------------------------------- */

START_TEST(a_request_has_a_method_an_id_and_parameters)
{
    ck_assert_msg(read_line("{\"jsonrpc\":\"2.0\",\"id\":\"a\",\"method\":\"di.set\",\"params\":{\"mask\":3}}"), "%s",
                  refusal.text);
    ck_assert_str_eq(request.method, "di.set");
    ck_assert_str_eq(json_string_value(request.id), "a");
    ck_assert_int_eq(json_integer_value(json_object_get(request.params, "mask")), 3);
}
END_TEST

START_TEST(parameters_may_be_left_out)
{
    ck_assert(read_line(" {\"id\": 1.5, \"method\": \"state\", \"jsonrpc\": \"2.0\"} \r"));
    ck_assert_uint_eq(json_object_size(request.params), 0);
    ck_assert_uint_eq(request.line, 0);
}
END_TEST

START_TEST(a_request_without_id_is_a_notification_and_one_with_null_is_not)
{
    ck_assert(read_line("{\"jsonrpc\":\"2.0\",\"method\":\"state\"}"));
    ck_assert_ptr_null(request.id);
    ck_assert(read_line("{\"jsonrpc\":\"2.0\",\"id\":null,\"method\":\"state\"}"));
    ck_assert(json_is_null(request.id));
}
END_TEST

START_TEST(the_line_is_taken_out_of_the_parameters)
{
    ck_assert(read_one_of("{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"state\",\"params\":{\"line\":2,\"unit\":1}}", 3));
    ck_assert_uint_eq(request.line, 2);
    ck_assert(request.line_given);
    ck_assert_uint_eq(json_object_size(request.params), 1);
}
END_TEST

/* ---- Wrong ones ----------------------------------------------------------------------------------------------------- */

static const struct {
    const char *line;
    int code;
    const char *text;
} wrong[] = {
    {"nonsense", RPC_NO_JSON, "invalid JSON at character 8: invalid token near 'nonsense'"},
    {"{\"a\":1,\"a\":2}", RPC_NO_JSON, "invalid JSON at character 10: duplicate object key near '\"a\"'"},
    {"{} {}", RPC_NO_JSON, "invalid JSON at character 4: end of file expected near '{'"},
    {"\"\\u0000\"", RPC_NO_JSON, "invalid JSON at character 8: \\u0000 is not allowed without JSON_ALLOW_NUL near '\"\\u0000\"'"},
    {"17", RPC_NO_REQUEST, "expected an object"},
    {"[]", RPC_NO_REQUEST, "batches are not supported: expected one object per line"},
    {"{\"id\":1,\"method\":\"state\"}", RPC_NO_REQUEST, "jsonrpc: expected \"2.0\""},
    {"{\"jsonrpc\":2.0,\"id\":1,\"method\":\"state\"}", RPC_NO_REQUEST, "jsonrpc: expected \"2.0\""},
    {"{\"jsonrpc\":\"1.0\",\"id\":1,\"method\":\"state\"}", RPC_NO_REQUEST, "jsonrpc: expected \"2.0\""},
    {"{\"jsonrpc\":\"2.0\",\"id\":1}", RPC_NO_REQUEST, "method: expected a string"},
    {"{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":[]}", RPC_NO_REQUEST, "method: expected a string"},
    {"{\"jsonrpc\":\"2.0\",\"id\":{},\"method\":\"state\"}", RPC_NO_REQUEST, "id: expected a string, a number or null"},
    {"{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"state\",\"params\":[1]}", REFUSED_PARAMS,
     "params: expected an object, as in {\"unit\": 1}"},
    {"{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"state\",\"params\":{\"line\":1}}", REFUSED_PARAMS,
     "line: expected a whole number from 0 to 0"},
    {"{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"state\",\"params\":{\"line\":\"0\"}}", REFUSED_PARAMS,
     "line: expected a whole number from 0 to 0"},
};

START_TEST(a_wrong_line_is_refused_with_what_was_expected)
{
    ck_assert(!read_line(wrong[_i].line));
    ck_assert_int_eq(refusal.code, wrong[_i].code);
    ck_assert_str_eq(refusal.text, wrong[_i].text);
}
END_TEST

START_TEST(the_id_of_a_wrong_request_is_known_if_it_can_be)
{
    ck_assert(!read_line("{\"jsonrpc\":\"2.0\",\"id\":7}"));
    ck_assert_int_eq(json_integer_value(request.id), 7);
    ck_assert(!read_line("{\"jsonrpc\":\"2.0\",\"id\":[7]}"));
    ck_assert(json_is_null(request.id));
    ck_assert(!read_line("{\"jsonrpc\":\"2.0\",\"id\":7"));
    ck_assert(json_is_null(request.id));
    ck_assert(!read_line("{}")); /* not even a notification: it is answered */
    ck_assert(json_is_null(request.id));
    ck_assert(!read_line("{\"jsonrpc\":\"2.0\",\"method\":\"state\",\"params\":1}"));
    ck_assert_ptr_null(request.id);
}
END_TEST

/* A request whose parameters are `depth` - 2 lists inside one another. */
static char *deep(unsigned depth)
{
    char *line = NULL;
    char lists[RPC_DEPTH * 2] = "", ends[RPC_DEPTH * 2] = "";
    memset(lists, '[', depth - 2);
    memset(ends, ']', depth - 2);
    int length = asprintf(&line, "{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"state\",\"params\":{\"a]\\\"[\":%s%s}}", lists,
                          ends);
    ck_assert_int_gt(length, 0);
    return line;
}

START_TEST(what_is_too_deep_is_refused)
{
    char *deepest = deep(RPC_DEPTH), *deeper = deep(RPC_DEPTH + 1);
    ck_assert_msg(read_line(deepest), "%s", refusal.text);
    ck_assert(!read_line(deeper));
    ck_assert_int_eq(refusal.code, RPC_NO_REQUEST);
    ck_assert_str_eq(refusal.text, "too deep: expected at most 64 nested lists and objects");
    free(deepest);
    free(deeper);
}
END_TEST

START_TEST(a_million_brackets_do_no_harm)
{
    size_t length = 1000000;
    char *line = malloc(length);
    memset(line, '[', length);
    ck_assert(!rpc_read(&request, line, length, 1, &refusal));
    ck_assert_int_eq(refusal.code, RPC_NO_REQUEST);
    free(line);
}
END_TEST

START_TEST(any_byte_anywhere_is_refused_or_read)
{
    static const char model[] = "{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"state\",\"params\":{\"unit\":\"1\"}}";
    char line[sizeof model];
    for (size_t at = 0; at + 1 < sizeof model; at++) {
        memcpy(line, model, sizeof model);
        line[at] = (char)_i;
        rpc_end(&request);
        memset(&refusal, 0, sizeof refusal);
        if (!rpc_read(&request, line, sizeof model - 1, 1, &refusal)) {
            char *text = rpc_error(request.id, &refusal);
            ck_assert_ptr_nonnull(text);
            ck_assert_ptr_nonnull(strstr(text, "\"message\":\""));
            free(text);
        }
    }
}
END_TEST

/* ---- Answers -------------------------------------------------------------------------------------------------------- */

static void says(char *text, const char *wanted)
{
    ck_assert_str_eq(text, wanted);
    free(text);
}

START_TEST(answers_and_notifications_are_one_line)
{
    json_t *id = json_string("a\nb");
    refuse(&refusal, REFUSED_STATE, "no \"power\"\n");
    says(rpc_result(id, json_pack("{s:i}", "t_us", 5)), "{\"jsonrpc\":\"2.0\",\"id\":\"a\\nb\",\"result\":{\"t_us\":5}}\n");
    says(rpc_error(id, &refusal),
         "{\"jsonrpc\":\"2.0\",\"id\":\"a\\nb\",\"error\":{\"code\":-32000,\"message\":\"no \\\"power\\\"\\n\"}}\n");
    says(rpc_notification("lost", json_pack("{s:i}", "events", 3)),
         "{\"jsonrpc\":\"2.0\",\"method\":\"lost\",\"params\":{\"events\":3}}\n");
    json_decref(id);
}
END_TEST

START_TEST(a_name_that_was_cut_in_the_middle_of_a_character_makes_a_whole_answer)
{
    refuse(&refusal, REFUSED_METHOD, "no method `%.2s", "t\xC3\xBC");
    says(rpc_error(json_null(), &refusal),
         "{\"jsonrpc\":\"2.0\",\"id\":null,\"error\":{\"code\":-32601,\"message\":\"no method `t\"}}\n");
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("control_rpc");
    TCase *requests = tcase_create("requests"), *refused = tcase_create("wrong"), *answers = tcase_create("answers");
    tcase_add_checked_fixture(requests, NULL, teardown);
    tcase_add_test(requests, a_request_has_a_method_an_id_and_parameters);
    tcase_add_test(requests, parameters_may_be_left_out);
    tcase_add_test(requests, a_request_without_id_is_a_notification_and_one_with_null_is_not);
    tcase_add_test(requests, the_line_is_taken_out_of_the_parameters);
    tcase_add_checked_fixture(refused, NULL, teardown);
    tcase_add_loop_test(refused, a_wrong_line_is_refused_with_what_was_expected, 0, (int)COUNT(wrong));
    tcase_add_test(refused, the_id_of_a_wrong_request_is_known_if_it_can_be);
    tcase_add_test(refused, what_is_too_deep_is_refused);
    tcase_add_test(refused, a_million_brackets_do_no_harm);
    tcase_add_loop_test(refused, any_byte_anywhere_is_refused_or_read, 0, 256);
    tcase_add_test(answers, answers_and_notifications_are_one_line);
    tcase_add_test(answers, a_name_that_was_cut_in_the_middle_of_a_character_makes_a_whole_answer);
    suite_add_tcase(suite, requests);
    suite_add_tcase(suite, refused);
    suite_add_tcase(suite, answers);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}
