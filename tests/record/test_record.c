/* SPDX-License-Identifier: MIT */
/* test_record.c: records of sessions, and replays that compare.
 * One case alone: CK_RUN_CASE=CASE ./test_record */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/rig.h"
#include "device/rkm04_device.h"
#include "record/record.h"
#include "record/snapshot.h"
#include "session_rig.h"

static struct session session;
static char folder[32], path[64];

/* Records of the session, to be freed. */
struct taken {
    char *text;
    size_t length;
    FILE *stream;
    struct record *record;
};

static void begin_record(struct taken *taken)
{
    *taken = (struct taken){0};
    taken->stream = open_memstream(&taken->text, &taken->length);
    ck_assert_ptr_nonnull(taken->stream);
    taken->record = record_begin(&session.sim, taken->stream);
    ck_assert_ptr_nonnull(taken->record);
}

static void end_record(struct taken *taken)
{
    ck_assert_int_eq(record_end(taken->record), 0);
    ck_assert_int_eq(fclose(taken->stream), 0);
}

/* What a replay of a text says: "same: …", with its note, if there is one, in brackets. Static memory. */
static const char *replayed(const char *text, size_t length)
{
    static const char *const ends[] = {"same", "different", "wrong", "interrupted", "no memory"};
    static char said[1200];
    FILE *in = fmemopen((void *)text, length, "r");
    ck_assert_ptr_nonnull(in);
    struct replay *replay = replay_open("file.record", in);
    ck_assert_ptr_nonnull(replay);
    enum replay_end end = replay_run(replay, NULL, NULL);
    ck_assert((end == REPLAY_DIFFERENT) == (replay_difference(replay) != NULL));
    snprintf(said, sizeof said, "%s: %s%s%s%s", ends[end], replay_text(replay), replay_note(replay) ? " [" : "",
             replay_note(replay) ? replay_note(replay) : "", replay_note(replay) ? "]" : "");
    replay_free(replay);
    fclose(in);
    return said;
}

static void expect(const char *text, size_t length, const char *expected)
{
    const char *said = replayed(text, length);
    ck_assert_msg(strncmp(said, expected, strlen(expected)) == 0, "the replay says\n%s\ninstead of\n%s\nof\n%.3000s", said,
                  expected, text);
}

/* ---- Stories -------------------------------------------------------------------------------------------------------- */

/* A session with snapshots in memory and in a file, in pieces of up to `piece` ticks. */
static void live(struct taken *taken, unsigned seed, const struct session_kind *kind, uint64_t piece)
{
    char params[100];
    snprintf(params, sizeof params, "{\"file\": \"%s\"}", path);
    session_begin(&session, kind);
    session.dice += seed * 7919u;
    ck_assert(snapshots_keep_journal(&session.sim));
    begin_record(taken);
    session_live(&session, 8, 300000, piece);
    session_command(&session, "snapshot", "{\"name\": \"a\"}");
    session_live(&session, 8, 300000, piece);
    session_refusal(&session, "snapshot", params);
    session_live(&session, 4, 100000 + session_draw(&session, 50000), piece);
    session_command(&session, "restore", "{\"name\": \"a\"}");
    session_live(&session, 4, 200000, piece);
    session_command(&session, "restore", params);
    session_live(&session, 4, 200000, piece);
    end_record(taken);
    session_end(&session);
}

START_TEST(a_session_goes_out_again_as_it_did)
{
    for (size_t kind = 0; kind < session_kind_count; kind++) {
        for (unsigned seed = 0; seed < 12; seed++) {
            struct taken taken;
            live(&taken, seed, &session_kinds[kind], 0);
            remove(path); /* the recording has it */
            expect(taken.text, taken.length, "same: the same up to tick ");
            ck_assert_ptr_null(strchr(replayed(taken.text, taken.length), '['));
            ck_assert_int_ne(access(path, F_OK), 0); /* and the replay does not write it */
            free(taken.text);
        }
    }
}
END_TEST

START_TEST(a_record_does_not_depend_on_how_time_was_cut)
{
    for (size_t kind = 0; kind < session_kind_count; kind++) {
        for (unsigned seed = 0; seed < 6; seed++) {
            struct taken whole, cut;
            live(&whole, seed, &session_kinds[kind], 0);
            live(&cut, seed, &session_kinds[kind], 700);
            session_same(whole.text, cut.text, session_kinds[kind].nodes);
            free(whole.text);
            free(cut.text);
        }
    }
}
END_TEST

START_TEST(readings_are_part_of_a_record)
{
    static const struct session_kind kind = {"5", false, false, NULL, "speed-change=300,hold-exit=latch"};
    struct taken taken;
    session_end(&session);
    session_begin(&session, &kind);
    begin_record(&taken);
    session_set(&session, 5, '1', "S100 V100 F1000 R");
    sim_advance(&session.sim, SECOND);
    session_set(&session, 5, '1', "V1000");
    sim_advance(&session.sim, 3 * SECOND);
    end_record(&taken);
    ck_assert_ptr_nonnull(strstr(taken.text, "\"readings\":{\"hold-exit\":\"latch\",\"speed-change\":300}"));
    expect(taken.text, taken.length, "same: ");
    char *at = strstr(taken.text, "\"speed-change\":300");
    memcpy(at, "\"speed-change\":900", 18);
    expect(taken.text, taken.length, "different: ");
    memcpy(at, "\"speed-change\":9e9", 18);
    expect(taken.text, taken.length, "wrong: ");
    free(taken.text);
}
END_TEST

START_TEST(a_record_of_before_the_readings_has_a_latency)
{
    static const char text[] = "{\"rkm04_record\":1,\"nodes\":[1],\"framing\":\"hdlc\","
                               "\"speed_change_latency\":300,\"seed\":\"1\"}\n";
    FILE *in = fmemopen((void *)text, sizeof text - 1, "r");
    struct replay *replay = replay_open("x", in);
    replay_run(replay, NULL, NULL);
    ck_assert_uint_eq(rkm04_of(sim_core(replay_sim(replay), 1))->config.readings.speed_change, 300);
    replay_free(replay);
    fclose(in);
}
END_TEST

START_TEST(what_is_left_of_a_killed_process_is_replayed)
{
    struct taken taken;
    live(&taken, 3, &session_kinds[2], 0);
    const char *head = strchr(taken.text, '\n');
    for (size_t length = (size_t)(head - taken.text) + 1u; length < taken.length; length += length % 97 + 1u) {
        const char *said = replayed(taken.text, length);
        bool whole = taken.text[length - 1] == '\n';
        ck_assert_msg(strncmp(said, "same: ", 6) == 0, "%zu bytes: %s", length, said);
        ck_assert_msg(strstr(said, "incomplete: the lines before it were replayed") || (whole && strstr(said, "no \"end\" line")),
                      "%zu bytes: %s", length, said);
    }
    expect(taken.text, 20, "wrong: file.record:1:1: expected a recording, which begins with {\"rkm04_record\":1,");
    free(taken.text);
}
END_TEST

/* ---- Differences ---------------------------------------------------------------------------------------------------- */

static struct taken simple;

/* A move of 300 steps from 4 ms on, Get Position at 100 ms, an output at 1.5 s. */
static void simple_setup(void)
{
    static const struct session_kind kind = {"5", false, false, NULL, NULL};
    session_begin(&session, &kind);
    begin_record(&simple);
    session_set(&session, 5, '2', "F300 R T03");
    sim_advance(&session.sim, 100000);
    session_ask(&session, 5, "\0042", 2);
    sim_advance(&session.sim, 1500000);
    session_command(&session, "di.set", "{\"mask\": 3}");
    sim_advance(&session.sim, 1600000);
    end_record(&simple);
}

static void simple_teardown(void)
{
    session_end(&session);
    free(simple.text);
}

/* The recording with one place replaced. `from` must be there, and is replaced where it is for the first time. */
static void expect_changed(const char *from, const char *to, const char *expected)
{
    char *text = malloc(simple.length + strlen(to) + 1);
    const char *at = strstr(simple.text, from);
    ck_assert_msg(at != NULL, "there is no `%s' in\n%s", from, simple.text);
    size_t before = (size_t)(at - simple.text);
    memcpy(text, simple.text, before);
    strcpy(text + before, to);
    strcat(text, at + strlen(from));
    expect(text, strlen(text), expected);
    free(text);
}

START_TEST(pulses_that_differ_are_named_with_unit_motor_and_span)
{
    expect(simple.text, simple.length, "same: ");
    expect_changed("\"steps\":19,\"position\":19", "\"steps\":20,\"position\":20",
                   "different: unit 5, motor 2, ticks 0 to 99999: recorded 20 pulses since the beginning, the last one to 20; "
                   "came 19 pulses since the beginning, the last one to 19");
}
END_TEST

START_TEST(other_pulses_at_the_same_places_are_a_difference)
{
    const char *at = strstr(simple.text, "\"motor\":2");
    char digest[17], other[17];
    ck_assert_ptr_nonnull(at);
    memcpy(digest, strstr(at, "\"digest\":\"") + 10, 16);
    digest[16] = '\0';
    strcpy(other, digest);
    other[5] = other[5] == '0' ? '1' : '0';
    char expected[300];
    int events = atoi(strstr(at, "\"events\":") + 9);
    snprintf(expected, sizeof expected,
             "different: unit 5, motor 2, ticks 0 to 99999: recorded %d events and pulses with the digest %s; came %d events and "
             "pulses with the digest %s",
             events, other, events, digest);
    expect_changed(digest, other, expected);
}
END_TEST

START_TEST(an_answer_that_differs_is_named_with_its_bytes)
{
    expect_changed("\"out\":\"7e0005043", "\"out\":\"7e0005053",
                   "different: the host, tick 100000: recorded as byte 4 of 7e00050532");
}
END_TEST

START_TEST(what_comes_and_was_not_recorded_is_a_difference)
{
    char line[200];
    const char *at = strstr(simple.text, "{\"t\":100000,\"out\""), *end = strchr(at, '\n') + 1;
    memcpy(line, at, (size_t)(end - at));
    line[end - at] = '\0';
    expect_changed(line, "", "different: the host, tick 100000: recorded nothing; came 7e000504320a");
    at = strstr(simple.text, "{\"t\":300000,\"unit\":1,\"motor\":2");
    end = strchr(at, '\n') + 1;
    memcpy(line, at, (size_t)(end - at));
    line[end - at] = '\0';
    expect_changed(line, "", "different: unit 5, motor 2, ticks 200000 to 299999: recorded nothing; came ");
}
END_TEST

START_TEST(what_was_recorded_and_does_not_come_is_a_difference)
{
    expect_changed("{\"t\":1500000,\"command\"", "{\"t\":1400000,\"out\":\"7e\"}\n{\"t\":1500000,\"command\"",
                   "different: the host, tick 1400000: recorded as byte 1 of 7e; came nothing");
    expect_changed("{\"t\":1500000,\"command\"",
                   "{\"t\":1400000,\"unit\":1,\"motor\":4,\"events\":1,\"digest\":\"0123456789abcdef\"}\n"
                   "{\"t\":1500000,\"command\"",
                   "different: unit 5, motor 4, ticks 1300000 to 1399999: recorded 1 events since the beginning; came nothing");
}
END_TEST

START_TEST(an_input_that_differs_shows_where_it_leads_to_something_else)
{
    expect_changed("\"in\":\"7e0500", "\"in\":\"7e0600", "different: the host, tick 0: recorded as byte 1 of 7e");
    expect_changed("{\"mask\":3}", "{\"mask\":7}", "different: unit 5, ticks 1500000 to 1599999: recorded ");
    expect_changed("{\"mask\":3}", "{\"mask\":300}",
                   "different: the control, tick 1500000: recorded success of `di.set'; came a refusal: mask: expected");
}
END_TEST

START_TEST(no_setting_of_a_device_is_called_as_a_key_of_the_head)
{
    json_error_t error;
    json_t *head = json_loads(simple.text, JSON_DISABLE_EOF_CHECK, &error);
    ck_assert_ptr_nonnull(head);
    for (const char *const *name = rkm04_device.settings; *name; name++)
        json_object_del(head, *name);
    ck_assert_ptr_nonnull(json_object_get(head, "nodes"));
    for (unsigned at = 0; device_kind_at(at); at++)
        for (const char *const *name = device_kind_at(at)->settings; *name; name++)
            ck_assert_msg(!json_object_get(head, *name), "%s: %s", device_kind_at(at)->name, *name);
    json_decref(head);
}
END_TEST

START_TEST(a_record_of_another_emulator_says_so_when_it_differs)
{
    expect_changed("rkm04 0", "rkm04 9", "same: ");
    expect_changed("\"emulator\":", "\"program\":", "same: "); /* as it was called */
    char *text = strdup(simple.text);
    memcpy(strstr(text, "rkm04 0"), "rkm04 9", 7);
    memcpy(strstr(text, "\"position\":19"), "\"position\":18", 13);
    ck_assert_ptr_nonnull(strstr(replayed(text, strlen(text)), "(recorded by rkm04 9"));
    free(text);
}
END_TEST

START_TEST(a_replay_ends_where_it_is_told_to)
{
    FILE *in = fmemopen(simple.text, simple.length, "r");
    struct replay *replay = replay_open("file.record", in);
    replay_until(replay, 123456);
    ck_assert_int_eq(replay_run(replay, NULL, NULL), REPLAY_SAME);
    ck_assert_uint_eq(sim_now(replay_sim(replay)), 123456);
    replay_free(replay);
    fclose(in);
}
END_TEST

static bool at_once(void *context)
{
    (void)context;
    return true;
}

START_TEST(a_replay_can_be_interrupted)
{
    FILE *in = fmemopen(simple.text, simple.length, "r");
    struct replay *replay = replay_open("file.record", in);
    ck_assert_int_eq(replay_run(replay, at_once, NULL), REPLAY_INTERRUPTED);
    ck_assert_str_eq(replay_text(replay), "interrupted at tick 0");
    replay_free(replay);
    fclose(in);
}
END_TEST

START_TEST(the_flash_and_the_plant_at_the_beginning_are_part_of_a_record)
{
    static const struct session_kind kind = {"5", false, false, NULL, NULL};
    session_end(&session);
    session_begin(&session, &kind);
    session_set(&session, 5, '1', "F4 R T05");
    session_ask(&session, 5, "\003""1", 2);
    sim_advance(&session.sim, SECOND);
    uint8_t *memory = session.sim.unit[0].memory;
    session.sim.unit[0].memory = NULL;
    sim_end(&session.sim);
    session.sim = (struct sim){.config = session.sim.config};
    /* the same flash in a new line: the unit starts with its program */
    struct sim_config config = {.nodes = {.count = 1, .node = {5}}};
    ck_assert(sim_begin(&session.sim, &config));
    ck_assert(snapshots_attach(&session.sim));
    session.sim.unit[0].memory = memory;
    sim_power(&session.sim, 1, true);
    sim_advance(&session.sim, 0);
    static const char plant[] = "switches: [{input: 04, motor: 1, at_least: 3}]";
    ck_assert(sim_configure_plants(&session.sim, "plant", plant, strlen(plant), stderr));
    struct taken taken;
    begin_record(&taken);
    sim_advance(&session.sim, SECOND);
    end_record(&taken);
    ck_assert_ptr_nonnull(strstr(taken.text, "{\"flash\":1,\"block\":"));
    ck_assert_ptr_nonnull(strstr(taken.text, "\"plant\":\"switches: "));
    ck_assert_ptr_nonnull(strstr(taken.text, "\"steps\":4,\"position\":4"));
    expect(taken.text, taken.length, "same: ");
    free(taken.text);
}
END_TEST

static void setup(void)
{
    strcpy(folder, "/tmp/test_record-XXXXXX");
    ck_assert_ptr_nonnull(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/a.record", folder);
}

static void teardown(void)
{
    remove(path);
    rmdir(folder);
}

static Suite *make_suite(void)
{
    Suite *suite = suite_create("record");
    TCase *stories = tcase_create("stories"), *differences = tcase_create("differences");
    tcase_set_timeout(stories, 120);
    tcase_add_checked_fixture(stories, setup, teardown);
    tcase_add_test(stories, a_session_goes_out_again_as_it_did);
    tcase_add_test(stories, a_record_does_not_depend_on_how_time_was_cut);
    tcase_add_test(stories, what_is_left_of_a_killed_process_is_replayed);
    tcase_add_checked_fixture(differences, simple_setup, simple_teardown);
    tcase_add_test(differences, pulses_that_differ_are_named_with_unit_motor_and_span);
    tcase_add_test(differences, other_pulses_at_the_same_places_are_a_difference);
    tcase_add_test(differences, an_answer_that_differs_is_named_with_its_bytes);
    tcase_add_test(differences, what_comes_and_was_not_recorded_is_a_difference);
    tcase_add_test(differences, what_was_recorded_and_does_not_come_is_a_difference);
    tcase_add_test(differences, an_input_that_differs_shows_where_it_leads_to_something_else);
    tcase_add_test(differences, no_setting_of_a_device_is_called_as_a_key_of_the_head);
    tcase_add_test(differences, a_record_of_another_emulator_says_so_when_it_differs);
    tcase_add_test(differences, a_replay_ends_where_it_is_told_to);
    tcase_add_test(differences, a_replay_can_be_interrupted);
    tcase_add_test(differences, the_flash_and_the_plant_at_the_beginning_are_part_of_a_record);
    tcase_add_test(differences, readings_are_part_of_a_record);
    tcase_add_test(differences, a_record_of_before_the_readings_has_a_latency);
    suite_add_tcase(suite, stories);
    suite_add_tcase(suite, differences);
    return suite;
}

int main(int argc, char **argv)
{
    (void)argc;
    return rig_run(make_suite(), argv[0]);
}
