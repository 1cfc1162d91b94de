/* SPDX-License-Identifier: MIT */
/* test_replay.c: files that are no records, or damaged: every one gets a clear answer, in bounded time.
 * One case alone: CK_RUN_CASE=CASE ./test_replay */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/rig.h"
#include "record/record.h"
#include "record/snapshot.h"
#include "session_rig.h"

#define HEAD "{\"rkm04_record\":1,\"nodes\":[1],\"framing\":\"hdlc\",\"timed\":true,\"turnaround\":521,\"seed\":\"1\"}\n"
#define HEAD_OUT "{\"rkm04_record\":1,\"nodes\":[1],\"framing\":\"hdlc\",\"timed\":true,\"seed\":\"1\",\"outputs\":true}\n"

static char said[1200];

static enum replay_end replayed(const char *text, size_t length, bool (*interrupted)(void *context), void *context)
{
    FILE *in = length > 0 ? fmemopen((void *)text, length, "r") : fopen("/dev/null", "r");
    ck_assert_ptr_nonnull(in);
    struct replay *replay = replay_open("x", in);
    ck_assert_ptr_nonnull(replay);
    enum replay_end end = replay_run(replay, interrupted, context);
    snprintf(said, sizeof said, "%s", replay_text(replay));
    replay_free(replay);
    fclose(in);
    return end;
}

static void expect_wrong(const char *text, const char *expected)
{
    enum replay_end end = replayed(text, strlen(text), NULL, NULL);
    ck_assert_msg(end == REPLAY_WRONG && strncmp(said, expected, strlen(expected)) == 0, "%s\nsays\n%s\ninstead of\n%s", text,
                  said, expected);
}

START_TEST(a_file_that_is_no_record_is_named_with_line_column_and_what_was_expected)
{
    static const struct {
        const char *text, *expected;
    } cases[] = {
        {"", "x:1:1: expected a recording, which begins with {\"rkm04_record\":1,"},
        {"hello\n", "x:1:1: expected a recording, which begins with {\"rkm04_record\":1,: `rkm04 serve --record FILE' makes"},
        {"[]\n", "x:1:1: expected a recording, which begins with"},
        {"{}\n", "x:1:1: expected a recording, which begins with"},
        {"{\"rkm04_record\":2}\n", "x:1:17: expected \"rkm04_record\": 1"},
        {"{\"rkm04_record\":1}\n", "x:1:1: expected \"nodes\", a list of 1 to 16 addresses from 1 to 16"},
        {"{\"rkm04_record\":1,\"nodes\":[17]}\n", "x:1:27: expected \"nodes\""},
        {"{\"rkm04_record\":1,\"nodes\":[1],\"framing\":\"x\"}\n", "x:1:41: expected \"framing\", hdlc or plain"},
        {"{\"rkm04_record\":1,\"nodes\":[1],\"farming\":\"x\"}\n",
         "x:1:41: unexpected \"farming\" in this line: expected rkm04_record"},
        {"{\"rkm04_record\":1,\"nodes\":[1],\"nodes\":[1]}\n", "x:1:37: expected a JSON object: duplicate object key"},
        {"{\"rkm04_record\":1,\"nodes\":[1],\"framing\":\"hdlc\",\"seed\":\"-1\"}\n", "x:1:55: expected \"seed\""},
        {"{\"rkm04_record\":1,\"nodes\":[1],\"framing\":\"hdlc\",\"seed\":\"1\",\"plant\":\"motors: 3\"}\n",
         "x:1:1: plant:1:9: error: "},
        {"{\"rkm04_record\":1,\"nodes\":[1],\"framing\":\"hdlc\",\"readings\":{\"hold-exti\":\"latch\"},\"seed\":\"1\"}\n",
         "x:1:59: \"readings\": unknown reading `hold-exti'; did you mean `hold-exit'?"},
        {"{\"rkm04_record\":1,\"nodes\":[1],\"framing\":\"hdlc\",\"readings\":{\"planning\":2001},\"seed\":\"1\"}\n",
         "x:1:59: \"readings\": planning: expected whole ms from 0 to 2000"},
        {HEAD "{\"flash\":2,\"block\":0,\"hex\":\"00\"}\n", "x:2:10: expected \"flash\": 1"},
        {HEAD "{\"flash\":1,\"block\":8,\"hex\":\"00\"}\n", "x:2:20: expected \"block\", a whole number from 0 to 7"},
        {HEAD "{\"flash\":1,\"block\":0,\"hex\":\"0\"}\n", "x:2:28: expected \"hex\", 1 to 4096 bytes of two hexadecimal digits"},
        {HEAD "{\"t\":1}\n", "x:2:1: expected a line with one of \"in\", \"out\""},
        {HEAD "\n", "x:2:1: expected a JSON object: "},
        {HEAD "{\"t\":-1,\"in\":\"00\"}\n", "x:2:6: expected \"t\", a whole number from 0 to 1000000000000000"},
        {HEAD "{\"t\":9,\"in\":\"00\"}\n{\"t\":8,\"in\":\"00\"}\n", "x:3:6: expected \"t\", a whole number from 9 to"},
        {HEAD "{\"t\":9,\"at\":8,\"in\":\"00\"}\n", "x:2:13: expected \"at\", a whole number from 9 to"},
        {HEAD "{\"t\":9,\"in\":\"\"}\n", "x:2:13: expected \"in\", 1 to 4096 bytes"},
        {HEAD "{\"t\":9,\"in\":\"0G\"}\n", "x:2:13: expected \"in\", 1 to 4096 bytes"},
        {HEAD "{\"t\":9,\"in\":7}\n", "x:2:13: expected \"in\", 1 to 4096 bytes"},
        {HEAD "{\"t\":9,\"in\":\"00\",\"x\":{\"in\":1}}\n", "x:2:22: unexpected \"x\" in this line: expected t, at, in"},
        {HEAD "{\"t\":9,\"break\":1}\n", "x:2:16: expected \"break\", true or false"},
        {HEAD "{\"t\":9,\"timed\":\"no\"}\n", "x:2:16: expected \"timed\", true or false"},
        {HEAD "{\"t\":9,\"command\":\"di.set\"}\n", "x:2:1: expected \"params\", an object"},
        {HEAD "{\"t\":9,\"command\":\"shutdown\",\"params\":{}}\n", "x:2:18: expected \"command\", one that rkm04 "},
        {HEAD "{\"t\":9,\"command\":\"restore\",\"params\":{\"file\":\"/etc/passwd\"}}\n",
         "x:2:18: expected a line \"embedded\" with the restored file before this line"},
        {HEAD "{\"t\":9,\"out\":\"7e\"}\n", "x:2:14: expected no outputs: the recording declares that it has none"},
        {HEAD "{\"outputs\":true}\n", "x:2:12: expected \"outputs\": false"},
        {HEAD_OUT "{\"t\":9,\"moved\":1}\n", "x:2:16: expected {\"outputs\":false} before this line"},
        {HEAD_OUT "{\"t\":9,\"to\":8,\"out\":\"7e\"}\n", "x:2:13: expected \"to\", a whole number from 9"},
        {HEAD_OUT "{\"t\":9,\"unit\":2,\"motor\":0,\"events\":1,\"digest\":\"0123456789abcdef\"}\n",
         "x:2:15: expected \"unit\", a whole number from 0 to 1"},
        {HEAD_OUT "{\"t\":9,\"unit\":1,\"motor\":5,\"events\":1,\"digest\":\"0123456789abcdef\"}\n",
         "x:2:25: expected \"motor\", a whole number from 0 to 4"},
        {HEAD_OUT "{\"t\":9,\"unit\":1,\"motor\":0,\"events\":1,\"digest\":\"xyz\"}\n",
         "x:2:47: expected \"digest\", 16 hexadecimal digits"},
        {HEAD "{\"t\":9,\"embedded\":0}\n", "x:2:19: expected \"embedded\", a whole number from 1 to"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        expect_wrong(cases[i].text, cases[i].expected);
}
END_TEST

START_TEST(a_line_without_end_is_refused_at_128_mebibytes)
{
    size_t length = sizeof HEAD - 1 + (129u << 20);
    char *text = malloc(length);
    memset(text, ' ', length);
    memcpy(text, HEAD, sizeof HEAD - 1);
    ck_assert_int_eq(replayed(text, length, NULL, NULL), REPLAY_WRONG);
    ck_assert_str_eq(said, "x:2:134217728: expected a line of at most 134217728 bytes");
    free(text);
}
END_TEST

START_TEST(bytes_that_no_line_could_have_held_are_refused)
{
    char *text = NULL;
    size_t length;
    FILE *out = open_memstream(&text, &length);
    fputs(HEAD, out);
    for (unsigned line = 0; line < 5; line++) {
        fputs("{\"t\":0,\"in\":\"", out);
        for (unsigned i = 0; i < 1000; i++)
            fputs("00", out);
        fputs("\"}\n", out);
    }
    fclose(out);
    ck_assert_int_eq(replayed(text, length, NULL, NULL), REPLAY_WRONG);
    ck_assert_msg(strstr(said, "x:6:13: expected \"in\", 1 to 97 bytes"), "%s", said); /* one has set out */
    free(text);
}
END_TEST

START_TEST(records_within_one_another_have_an_end)
{
    char *text = strdup(HEAD);
    for (unsigned depth = 0; depth < 12; depth++) {
        char *around = NULL;
        size_t length, lines = 0;
        FILE *out = open_memstream(&around, &length);
        for (const char *at = text; (at = strchr(at, '\n')) != NULL; at++)
            lines++;
        fprintf(out, HEAD "{\"t\":0,\"embedded\":%zu}\n%s{\"t\":0,\"command\":\"restore\",\"params\":{\"file\":\"f\"}}\n", lines,
                text);
        fclose(out);
        free(text);
        text = around;
        enum replay_end end = replayed(text, length, NULL, NULL);
        ck_assert_int_eq(end, depth < 8 ? REPLAY_SAME : REPLAY_DIFFERENT);
    }
    ck_assert_msg(strstr(said, "recorded success of `restore'; came a refusal"), "%s", said);
    free(text);
}
END_TEST

START_TEST(a_record_cannot_ask_for_more_work_than_it_has_lines)
{
    /* An endless motion, and an end in 30 years: the first tenth of a second of pulses that was not recorded ends it. */
    char *text = NULL;
    size_t length;
    static struct session session;
    session_begin(&session, &session_kinds[0]);
    FILE *out = open_memstream(&text, &length);
    struct record *record = record_begin(&session.sim, out);
    session_set(&session, 1, '0', "V16000 G+");
    sim_advance(&session.sim, SECOND);
    record_end(record);
    fclose(out);
    session_end(&session);
    char *place = strstr(text, "{\"t\":1000000");
    ck_assert_ptr_nonnull(place);
    char *longer = malloc(length + 200);
    snprintf(longer, length + 200, "%.*s{\"t\":1000000000000000,\"end\":true}\n", (int)(place - text), text);
    ck_assert_int_eq(replayed(longer, strlen(longer), NULL, NULL), REPLAY_DIFFERENT);
    ck_assert_msg(strstr(said, "ticks 900000 to 999999: recorded nothing; came "), "%s", said);
    free(longer);
    free(text);
}
END_TEST

static bool after_a_while(void *context)
{
    unsigned *steps = context;
    return ++*steps > 200;
}

/* What can be made of a recording by changing some of its bytes: anything but a crash. */
START_TEST(damaged_records_harm_nobody)
{
    static struct session session;
    static const char bits[] = "0123456789abcdef{}[]\",:-truefalsn\n\\. ";
    for (size_t kind = 0; kind < session_kind_count; kind++) {
        char *text = NULL;
        size_t length;
        session_begin(&session, &session_kinds[kind]);
        FILE *out = open_memstream(&text, &length);
        struct record *record = record_begin(&session.sim, out);
        session_live(&session, 12, 300000, 0);
        session_command(&session, "snapshot", "{\"name\":\"a\"}");
        session_live(&session, 8, 200000, 0);
        session_command(&session, "restore", "{\"name\":\"a\"}");
        session_live(&session, 8, 200000, 0);
        record_end(record);
        fclose(out);
        char *damaged = malloc(length);
        for (unsigned round = 0; round < 150; round++) {
            unsigned steps = 0;
            memcpy(damaged, text, length);
            for (uint64_t n = 1 + session_draw(&session, 6); n > 0; n--) {
                size_t at = session_draw(&session, length);
                if (session_draw(&session, 4) == 0)
                    at = session_draw(&session, length < 400 ? length : 400); /* the head */
                damaged[at] = bits[session_draw(&session, sizeof bits - 1)];
                if (session_draw(&session, 3) == 0)
                    damaged[at] = (char)session_draw(&session, 256);
            }
            replayed(damaged, length, after_a_while, &steps);
            ck_assert_uint_gt(strlen(said), 0);
        }
        free(damaged);
        free(text);
        session_end(&session);
    }
}
END_TEST

START_TEST(a_record_makes_nobody_touch_files)
{
    char text[400], folder[] = "/tmp/test_replay-XXXXXX", path[64];
    ck_assert_ptr_nonnull(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/a.record", folder);
    snprintf(text, sizeof text, HEAD "{\"t\":5,\"command\":\"snapshot\",\"params\":{\"file\":\"%s\"}}\n{\"t\":6,\"end\":true}\n",
             path);
    ck_assert_int_eq(replayed(text, strlen(text), NULL, NULL), REPLAY_SAME);
    ck_assert_int_eq(rmdir(folder), 0); /* which it refuses unless empty */
}
END_TEST

static Suite *make_suite(void)
{
    Suite *suite = suite_create("replay");
    TCase *wrong = tcase_create("wrong"), *limits = tcase_create("limits");
    tcase_set_timeout(limits, 120);
    tcase_add_test(wrong, a_file_that_is_no_record_is_named_with_line_column_and_what_was_expected);
    tcase_add_test(limits, a_line_without_end_is_refused_at_128_mebibytes);
    tcase_add_test(limits, bytes_that_no_line_could_have_held_are_refused);
    tcase_add_test(limits, records_within_one_another_have_an_end);
    tcase_add_test(limits, a_record_cannot_ask_for_more_work_than_it_has_lines);
    tcase_add_test(limits, damaged_records_harm_nobody);
    tcase_add_test(limits, a_record_makes_nobody_touch_files);
    suite_add_tcase(suite, wrong);
    suite_add_tcase(suite, limits);
    return suite;
}

int main(int argc, char **argv)
{
    (void)argc;
    return rig_run(make_suite(), argv[0]);
}
