/* SPDX-License-Identifier: MIT */
/* test_lsp_turns.c: what the language server does in one turn, between two looks for messages. */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lsp/lsp.h"

#define PROGRAMS 20u

static struct lsp_server server;
static char *sent;
static size_t sent_length;
static FILE *out;

static void set_up(void)
{
    static const struct session_options options;
    out = open_memstream(&sent, &sent_length);
    ck_assert_ptr_nonnull(out);
    lsp_begin(&server, &options, out);
    const char *initialize = "{\"id\":1,\"method\":\"initialize\",\"params\":{}}";
    lsp_receive(&server, initialize, strlen(initialize));
}

static void tear_down(void)
{
    lsp_end(&server);
    fclose(out);
    free(sent);
}

/* name: of the file; text: the inside of a JSON string. */
static void tell(const char *method, const char *name, const char *text)
{
    char message[400];
    snprintf(message, sizeof message,
             "{\"method\":\"textDocument/%s\",\"params\":{\"textDocument\":{\"uri\":\"file:///m/%s\",\"version\":1,"
             "\"text\":\"%s\"},\"contentChanges\":[{\"text\":\"%s\"}]}}",
             method, name, text, text);
    lsp_receive(&server, message, strlen(message));
}

/* One turn. Returns what was sent within it, one message, or NULL. */
static const char *turn(void)
{
    fflush(out);
    const size_t before = sent_length;
    const bool has_reported = lsp_report_change(&server);
    fflush(out);
    ck_assert(has_reported || sent_length == before);
    ck_assert(!has_reported || strstr(sent + before + 1, "Content-Length") == NULL);
    return has_reported ? sent + before : NULL;
}

static void expect(const char *part, const char *other)
{
    const char *message = turn();
    ck_assert_msg(message && strstr(message, part) && strstr(message, other), "expected %s and %s in %s", part, other,
                  message ? message : "nothing");
}

/* However many programs a configuration has, each turn checks one text; what was edited comes first. */
START_TEST(programs_of_a_configuration_are_checked_one_by_one)
{
    for (unsigned i = 0; i < PROGRAMS; i++) {
        char name[20];
        snprintf(name, sizeof name, "%u.nc", i);
        tell("didOpen", name, "G1 A4=1 F100");
        expect(name, "nc-error");
    }
    tell("didOpen", "a.xml", "<ChannelConfig><Axis Name=\\\"4\\\"/></ChannelConfig>");
    expect("a.xml", "\"diagnostics\":[]");
    for (unsigned i = 0; i < PROGRAMS / 2u; i++)
        expect(".nc", "\"diagnostics\":[]");
    tell("didChange", "19.nc", "G1 A5=1 F100");
    expect("19.nc", "nc-error");
    for (unsigned i = 0; i < PROGRAMS / 2u - 1u; i++)
        expect(".nc", "\"diagnostics\":[]");
    ck_assert_ptr_null(turn());
}
END_TEST

START_TEST(programs_are_checked_again_when_their_configuration_is_closed)
{
    tell("didOpen", "a.xml", "<ChannelConfig><Axis Name=\\\"4\\\"/></ChannelConfig>");
    expect("a.xml", "\"diagnostics\":[]");
    tell("didOpen", "a.nc", "G1 A4=1 F100");
    expect("a.nc", "\"diagnostics\":[]");
    tell("didClose", "a.xml", "");
    expect("a.nc", "nc-error");
    ck_assert_ptr_null(turn());
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("lsp_turns");
    TCase *turns = tcase_create("turns");
    tcase_add_checked_fixture(turns, set_up, tear_down);
    tcase_add_test(turns, programs_of_a_configuration_are_checked_one_by_one);
    tcase_add_test(turns, programs_are_checked_again_when_their_configuration_is_closed);
    suite_add_tcase(suite, turns);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? 0 : 1;
}
