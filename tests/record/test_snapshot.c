/* SPDX-License-Identifier: MIT */
/* test_snapshot.c: coming back to a snapshot: what follows is what followed then, only later.
 * One case alone: CK_RUN_CASE=CASE ./test_snapshot */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/rig.h"
#include "device/rkm04_device.h"
#include "record/journal.h"
#include "record/snapshot.h"
#include "session_rig.h"

static struct session here;

static void teardown(void)
{
    session_end(&here);
}

/* ---- The continuation ----------------------------------------------------------------------------------------------- */

/* Live on for a while with the dice as they are now; what was seen, and the state at the end. Both to be freed. */
static void live_on(uint64_t dice, char **seen, char **state)
{
    here.dice = dice;
    session_forget(&here);
    session_live(&here, 12, 400000, 0);
    *seen = strdup(session_seen(&here));
    *state = session_state(&here);
}

/* What coming back changes is reported at once, and is no part of what follows. */
static void restore(const struct snapshot *snapshot)
{
    ck_assert(snapshot_restore(&here.sim, snapshot));
    watch_deliver(&here.sim.watch, sim_now(&here.sim) + 1u);
}

static void compare_continuations(unsigned seed, const struct session_kind *kind)
{
    char *seen[3], *state[3], what[80];
    session_begin(&here, kind);
    here.dice += seed * 7919u;
    snprintf(what, sizeof what, "seed %u, units %s", seed, kind->nodes);
    session_live(&here, 10, 200000 + session_draw(&here, 50000), 0);
    session_act(&here);
    sim_advance(&here.sim, sim_now(&here.sim) + 1 + session_draw(&here, 12000)); /* in the middle of anything */
    struct snapshot *snapshot = snapshot_take(&here.sim);
    ck_assert_ptr_nonnull(snapshot);
    uint64_t dice = here.dice, taken = here.taken - sim_now(&here.sim);
    for (unsigned i = 0; i < 3; i++) {
        if (i > 0) {
            uint64_t before = sim_now(&here.sim);
            restore(snapshot);
            ck_assert_uint_eq(sim_now(&here.sim), before); /* time does not go back */
            here.taken = sim_now(&here.sim) + taken;
        }
        live_on(dice, &seen[i], &state[i]);
        session_same(seen[0], seen[i], what);
        session_same(state[0], state[i], what);
    }
    for (unsigned i = 0; i < 3; i++) {
        free(seen[i]);
        free(state[i]);
    }
    snapshot_free(snapshot);
    session_end(&here);
}

START_TEST(what_follows_is_what_followed_then)
{
    for (size_t kind = 0; kind < session_kind_count; kind++)
        for (unsigned seed = 0; seed < 25; seed++)
            compare_continuations(seed, &session_kinds[kind]);
}
END_TEST

START_TEST(in_the_middle_of_an_answer_the_rest_of_it_follows)
{
    char *rest;
    session_begin(&here, &session_kinds[0]);
    session_ask(&here, 1, "\1", 1);
    sim_advance(&here.sim, 10000); /* the answer has begun, in the middle of a byte */
    struct snapshot *snapshot = snapshot_take(&here.sim);
    session_forget(&here);
    sim_advance(&here.sim, SECOND);
    rest = strdup(session_seen(&here));
    ck_assert_ptr_nonnull(strstr(rest, "heard 7e"));
    restore(snapshot);
    session_forget(&here);
    sim_advance(&here.sim, 2 * SECOND);
    session_same(rest, session_seen(&here), "the rest of the answer");
    free(rest);
    snapshot_free(snapshot);
}
END_TEST

START_TEST(in_the_middle_of_a_motion_its_pulses_follow)
{
    struct rkm04_motor_state state;
    session_begin(&here, &session_kinds[0]);
    session_set(&here, 1, '1', "F1000 R");
    sim_advance(&here.sim, 543217);
    struct snapshot *snapshot = snapshot_take(&here.sim);
    session_forget(&here);
    sim_advance(&here.sim, 4 * SECOND);
    char *pulses = strdup(session_seen(&here));
    ck_assert_ptr_nonnull(strstr(pulses, "step 1000\n"));
    restore(snapshot);
    ck_assert(rkm04_motor_state(rkm04_of(sim_core(&here.sim, 1)), 1, &state));
    ck_assert_int_lt(state.position, 1000);
    session_forget(&here);
    sim_advance(&here.sim, 8 * SECOND);
    session_same(pulses, session_seen(&here), "the pulses");
    free(pulses);
    snapshot_free(snapshot);
}
END_TEST

START_TEST(flash_comes_back_too)
{
    session_begin(&here, &session_kinds[1]);
    session_set(&here, 1, '1', "F7 R");
    session_ask(&here, 1, "\003""1", 2);
    sim_advance(&here.sim, SECOND);
    struct snapshot *snapshot = snapshot_take(&here.sim);
    session_set(&here, 1, '1', "\\");
    session_ask(&here, 1, "\003""1", 2); /* empties the slot */
    sim_advance(&here.sim, 2 * SECOND);
    restore(snapshot);
    sim_power(&here.sim, 1, true);
    session_forget(&here);
    sim_advance(&here.sim, 4 * SECOND);
    ck_assert_ptr_nonnull(strstr(session_seen(&here), "step 7\n"));
    snapshot_free(snapshot);
}
END_TEST

START_TEST(those_who_watch_are_told_what_has_changed)
{
    session_begin(&here, &session_kinds[1]);
    struct snapshot *snapshot = snapshot_take(&here.sim);
    session_set(&here, 1, '2', "T03 T80 D F20000 R");
    session_command(&here, "di.set", "{\"di\": {\"5\": 1}}");
    sim_advance(&here.sim, SECOND);
    session_forget(&here);
    restore(snapshot);
    session_same("0 unit 1 motor 0 inputs 0\n0 unit 1 motor 0 outputs 0\n0 unit 1 motor 0 variables 0\n"
                 "0 unit 1 motor 2 position 0\n0 unit 1 motor 2 motion 0\n0 unit 1 motor 2 direction 0\n"
                 "0 unit 1 motor 2 command 0\n0 unit 1 motor 2 led 0\n",
                 session_seen(&here), "what was told");
    snapshot_free(snapshot);
}
END_TEST

static void come_along(const char *fault)
{
    struct session other;
    session_begin(&other, &session_kinds[0]);
    session_begin(&here, &session_kinds[0]);
    if (fault)
        session_command(&here, "fault.inject", fault);
    session_ask(&here, 1, "\1", 1);
    sim_advance(&here.sim, 400); /* the first byte is under way, its double has yet to come */
    struct snapshot *snapshot = snapshot_take(&here.sim);
    session_forget(&here);
    session_ask(&here, 1, "\2", 1);
    sim_advance(&here.sim, SECOND);
    char *first = strdup(session_seen(&here));
    restore(snapshot);
    session_forget(&here);
    session_ask(&here, 1, "\2", 1);
    sim_advance(&here.sim, 2 * SECOND);
    session_same(first, session_seen(&here), "the same line");
    ck_assert(snapshot_restore(&other.sim, snapshot));
    session_forget(&other);
    session_ask(&other, 1, "\2", 1);
    sim_advance(&other.sim, 2 * SECOND);
    session_same(first, session_seen(&other), "another line");
    session_end(&other);
    snapshot_free(snapshot);
    free(first);
}

START_TEST(bytes_that_have_not_set_out_and_faults_come_along_into_another_line)
{
    come_along("{\"kind\": \"duplicate\", \"probability\": 0.999}");
    session_end(&here);
    come_along(NULL);
}
END_TEST

/* ---- Commands ------------------------------------------------------------------------------------------------------- */

static int32_t counter(unsigned motor)
{
    struct rkm04_motor_state state;
    ck_assert(rkm04_motor_state(rkm04_of(sim_core(&here.sim, 1)), motor, &state));
    return state.position;
}

START_TEST(a_name_can_be_come_back_to_again_and_again_and_be_used_anew)
{
    session_begin(&here, &session_kinds[1]);
    session_command(&here, "snapshot", "{\"name\": \"home\"}");
    for (unsigned i = 1; i <= 3; i++) {
        session_set(&here, 1, '1', "F5 R");
        sim_advance(&here.sim, i * SECOND);
        ck_assert_int_eq(counter(1), 5);
        session_command(&here, "restore", "{\"name\": \"home\"}");
        ck_assert_int_eq(counter(1), 0);
    }
    session_set(&here, 1, '1', "F5 R");
    sim_advance(&here.sim, 10 * SECOND);
    session_command(&here, "snapshot", "{\"name\": \"home\"}");
    session_command(&here, "di.set", "{\"mask\": 3}");
    session_command(&here, "restore", "{\"name\": \"home\"}");
    ck_assert_int_eq(counter(1), 5);
    ck_assert_uint_eq(rkm04_inputs(rkm04_of(sim_core(&here.sim, 1))), 0);
}
END_TEST

static void refused(const char *method, const char *params, const char *expected)
{
    const char *text = session_refusal(&here, method, params);
    ck_assert_msg(strstr(text, expected) != NULL, "%s %s: `%s' does not say `%s'", method, params, text, expected);
}

START_TEST(what_is_wrong_with_parameters_is_said)
{
    session_begin(&here, &session_kinds[1]);
    refused("snapshot", "{}", "expected either `name', for a snapshot in memory, or `file'");
    refused("snapshot", "{\"name\": \"a\", \"file\": \"b\"}", "expected either `name'");
    refused("snapshot", "{\"name\": 7}", "name: expected a string");
    refused("snapshot", "{\"name\": \"\"}", "name: expected 1 to 64 characters");
    refused("snapshot", "{\"nane\": \"a\"}", "unknown parameter `nane': expected name, file");
    refused("restore", "{\"name\": \"a\"}",
            "name: there is no snapshot `a': expected one of those taken with `snapshot': none yet");
    session_command(&here, "snapshot", "{\"name\": \"one\"}");
    session_command(&here, "snapshot", "{\"name\": \"two\"}");
    refused("restore", "{\"name\": \"a\"}", "there is no snapshot `a': expected one of one, two");
    refused("snapshot", "{\"file\": \"\"}", "file: expected a path");
    refused("snapshot", "{\"file\": \"x\"}", "the inputs since power-up were not kept");
    refused("restore", "{\"file\": \"/nowhere/at/all\"}", "cannot read /nowhere/at/all: No such file");
    refused("restore", "{\"file\": \"/dev/zero\"}", "/dev/zero is not a regular file");
}
END_TEST

START_TEST(there_is_room_for_64_names)
{
    char params[40];
    session_begin(&here, &session_kinds[1]);
    for (unsigned i = 0; i < 64; i++) {
        snprintf(params, sizeof params, "{\"name\": \"%u\"}", i);
        session_command(&here, "snapshot", params);
    }
    refused("snapshot", "{\"name\": \"64\"}", "too many snapshots (64): replace one by using its name");
    session_command(&here, "snapshot", "{\"name\": \"63\"}");
}
END_TEST

START_TEST(a_line_with_another_time_of_bytes_is_refused)
{
    session_begin(&here, &session_kinds[0]);
    session_command(&here, "snapshot", "{\"name\": \"a\"}");
    sim_set_timed(&here.sim, false);
    refused("restore", "{\"name\": \"a\"}", "does not fit this bus: whether bytes take time (--baud, --clock stepped)");
    sim_set_timed(&here.sim, true);
    session_command(&here, "restore", "{\"name\": \"a\"}");
}
END_TEST

START_TEST(a_line_with_other_readings_is_refused)
{
    static const struct session_kind kind = {"1", false, false, NULL, "hold-exit=latch"};
    static struct session other;
    session_begin(&other, &session_kinds[1]);
    session_command(&other, "snapshot", "{\"name\": \"a\"}");
    session_begin(&here, &kind);
    struct snapshot *snapshot = snapshot_take(&other.sim);
    ck_assert_str_eq(snapshot_misfit(&here.sim, snapshot), "one of the readings (--readings)");
    snapshot_free(snapshot);
    session_end(&other);
}
END_TEST

/* ---- Files ---------------------------------------------------------------------------------------------------------- */

static char folder[32], path[64], params[100];

static void file_setup(void)
{
    strcpy(folder, "/tmp/test_snapshot-XXXXXX");
    ck_assert_ptr_nonnull(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/a.record", folder);
    snprintf(params, sizeof params, "{\"file\": \"%s\"}", path);
}

static void file_teardown(void)
{
    session_end(&here);
    remove(path);
    rmdir(folder);
}

/* Write a snapshot, live on, come back in a new line, and live on there. */
static void compare_lines(unsigned seed, const struct session_kind *kind)
{
    char *seen[2], *state[2], what[80];
    session_begin(&here, kind);
    ck_assert(snapshots_keep_journal(&here.sim));
    here.dice += seed * 7919u;
    snprintf(what, sizeof what, "seed %u, units %s", seed, kind->nodes);
    session_live(&here, 6, 100000, 0);
    session_command(&here, "snapshot", "{\"name\": \"a\"}");
    session_live(&here, 6, 100000, 0);
    if (seed % 2 == 0)
        session_command(&here, "restore", "{\"name\": \"a\"}");
    session_live(&here, 6, 100000 + session_draw(&here, 50000), 0);
    session_command(&here, "snapshot", params);
    uint64_t dice = here.dice, taken = here.taken;
    live_on(dice, &seen[0], &state[0]);
    session_end(&here);

    session_begin(&here, kind);
    ck_assert(snapshots_keep_journal(&here.sim));
    session_live(&here, seed % 3 * 4 + 1, seed % 3 * 300000 + 1000, 0); /* shorter and longer than the other */
    uint64_t before = sim_now(&here.sim);
    session_command(&here, "restore", params);
    watch_deliver(&here.sim.watch, sim_now(&here.sim) + 1u);
    ck_assert_uint_ge(sim_now(&here.sim), before);
    here.taken = sim_now(&here.sim) + taken; /* later than needed: the same distance does not matter when nothing is queued */
    here.taken = 0;
    live_on(dice, &seen[1], &state[1]);
    if (kind->timed) /* the tick for which bytes are handed over is the master's, not the line's */
        session_same(seen[0], seen[1], what);
    session_same(state[0], state[1], what);
    session_command(&here, "snapshot", params); /* a recording of a recording */
    session_command(&here, "restore", params);
    session_end(&here);
    for (unsigned i = 0; i < 2; i++) {
        free(seen[i]);
        free(state[i]);
    }
}

START_TEST(a_file_brings_another_line_to_the_same_place)
{
    for (size_t kind = 0; kind < session_kind_count; kind++)
        for (unsigned seed = 0; seed < 8; seed++)
            compare_lines(seed, &session_kinds[kind]);
    session_begin(&here, &session_kinds[0]);
}
END_TEST

static long size_of_file(void)
{
    FILE *file = fopen(path, "r");
    ck_assert_ptr_nonnull(file);
    ck_assert_int_eq(fseek(file, 0, SEEK_END), 0);
    long size = ftell(file);
    fclose(file);
    return size;
}

START_TEST(coming_back_shortens_the_past)
{
    session_begin(&here, &session_kinds[1]);
    ck_assert(snapshots_keep_journal(&here.sim));
    session_command(&here, "snapshot", "{\"name\": \"a\"}");
    for (unsigned i = 0; i < 1000; i++) {
        session_set(&here, 1, '1', "F5 R");
        sim_advance(&here.sim, sim_now(&here.sim) + 1000);
        session_command(&here, "restore", "{\"name\": \"a\"}");
    }
    session_command(&here, "snapshot", params);
    ck_assert_int_lt(size_of_file(), 400);
}
END_TEST

START_TEST(too_long_a_past_is_refused_until_it_is_shorter)
{
    static const uint8_t nothing[4000];
    session_begin(&here, &session_kinds[1]);
    ck_assert(snapshots_keep_journal(&here.sim));
    session_command(&here, "snapshot", "{\"name\": \"a\"}");
    for (unsigned i = 0; i < 2200; i++) {
        sim_queue_bytes(&here.sim, nothing, sizeof nothing, sim_now(&here.sim));
        sim_advance(&here.sim, sim_now(&here.sim));
        if (i % 50 == 0)
            session_forget(&here);
    }
    refused("snapshot", params, "a snapshot file holds at most 16 MiB of inputs since power-up");
    session_command(&here, "snapshot", "{\"name\": \"b\"}");
    session_command(&here, "restore", "{\"name\": \"a\"}");
    session_command(&here, "snapshot", params);
    session_command(&here, "restore", params);
}
END_TEST

START_TEST(a_file_of_a_line_with_other_readings_is_refused)
{
    static const struct session_kind kind = {"1", true, false, NULL, "planning=3"};
    session_begin(&here, &session_kinds[0]);
    ck_assert(snapshots_keep_journal(&here.sim));
    session_command(&here, "snapshot", params);
    session_end(&here);
    session_begin(&here, &kind);
    refused("restore", params, "the snapshot does not fit this bus: one of the readings (--readings) is different");
}
END_TEST

START_TEST(a_file_of_another_line_is_refused_and_changes_nothing)
{
    session_begin(&here, &session_kinds[0]);
    ck_assert(snapshots_keep_journal(&here.sim));
    session_command(&here, "snapshot", params);
    session_end(&here);
    session_begin(&here, &session_kinds[2]);
    session_set(&here, 1, '1', "F5 R");
    sim_advance(&here.sim, SECOND);
    refused("restore", params, "the snapshot does not fit this bus: the number of units is different");
    ck_assert_int_eq(counter(1), 5);
    FILE *file = fopen(path, "w");
    fputs("{\"rkm04_record\":1,\n", file);
    fclose(file);
    refused("restore", params, ".record:1:18: expected a JSON object");
    ck_assert_int_eq(counter(1), 5);
}
END_TEST

START_TEST(taking_and_coming_back_by_turns_keeps_nothing_of_what_is_over)
{
    session_begin(&here, &session_kinds[4]);
    ck_assert(snapshots_keep_journal(&here.sim));
    session_set(&here, 4, '1', "V900 A30000 @1 F30 R B30 R J1");
    for (unsigned i = 0; i < 300; i++) {
        session_command(&here, "snapshot", "{\"name\": \"a\"}");
        sim_advance(&here.sim, sim_now(&here.sim) + 777u);
        session_command(&here, "restore", "{\"name\": \"a\"}");
        sim_advance(&here.sim, sim_now(&here.sim) + 1777u);
    }
    session_command(&here, "snapshot", params);
    ck_assert_int_lt(size_of_file(), 2000);
    sim_advance(&here.sim, sim_now(&here.sim) + 1u);
    session_forget(&here);
    sim_advance(&here.sim, sim_now(&here.sim) + SECOND);
    char *wanted = strdup(session_seen(&here)), *state = session_state(&here);
    session_command(&here, "restore", params);
    sim_advance(&here.sim, sim_now(&here.sim) + 1u); /* what coming back changes is reported */
    session_forget(&here);
    sim_advance(&here.sim, sim_now(&here.sim) + SECOND);
    char *again = session_state(&here);
    session_same(wanted, session_seen(&here), "what followed");
    session_same(state, again, "the state");
    free(wanted);
    free(state);
    free(again);
}
END_TEST

START_TEST(what_snapshots_keep_of_the_past_is_counted)
{
    session_begin(&here, &session_kinds[0]);
    struct journal *journal = journal_begin(&here.sim);
    unsigned marks = 0;
    ck_assert_ptr_nonnull(journal);
    while (!journal_gap(journal) && marks < 40000) {
        session_command(&here, "di.set", "{\"mask\": 1}");
        journal_page_free(journal_mark(journal));
        marks++;
    }
    ck_assert_ptr_nonnull(journal_gap(journal));
    ck_assert_uint_lt(marks, 17000);
    journal_free(journal);
}
END_TEST

static Suite *make_suite(void)
{
    Suite *suite = suite_create("snapshot");
    TCase *stories = tcase_create("stories"), *commands = tcase_create("commands"), *files = tcase_create("files");
    tcase_set_timeout(stories, 120);
    tcase_add_test(stories, what_follows_is_what_followed_then);
    tcase_add_checked_fixture(commands, NULL, teardown);
    tcase_add_test(commands, in_the_middle_of_an_answer_the_rest_of_it_follows);
    tcase_add_test(commands, in_the_middle_of_a_motion_its_pulses_follow);
    tcase_add_test(commands, bytes_that_have_not_set_out_and_faults_come_along_into_another_line);
    tcase_add_test(commands, flash_comes_back_too);
    tcase_add_test(commands, those_who_watch_are_told_what_has_changed);
    tcase_add_test(commands, a_name_can_be_come_back_to_again_and_again_and_be_used_anew);
    tcase_add_test(commands, what_is_wrong_with_parameters_is_said);
    tcase_add_test(commands, there_is_room_for_64_names);
    tcase_add_test(commands, a_line_with_another_time_of_bytes_is_refused);
    tcase_add_test(commands, a_line_with_other_readings_is_refused);
    tcase_set_timeout(files, 120);
    tcase_add_test(files, taking_and_coming_back_by_turns_keeps_nothing_of_what_is_over);
    tcase_add_test(files, what_snapshots_keep_of_the_past_is_counted);
    tcase_add_checked_fixture(files, file_setup, file_teardown);
    tcase_add_test(files, a_file_brings_another_line_to_the_same_place);
    tcase_add_test(files, coming_back_shortens_the_past);
    tcase_add_test(files, too_long_a_past_is_refused_until_it_is_shorter);
    tcase_add_test(files, a_file_of_a_line_with_other_readings_is_refused);
    tcase_add_test(files, a_file_of_another_line_is_refused_and_changes_nothing);
    suite_add_tcase(suite, stories);
    suite_add_tcase(suite, commands);
    suite_add_tcase(suite, files);
    return suite;
}

int main(int argc, char **argv)
{
    (void)argc;
    return rig_run(make_suite(), argv[0]);
}
