/* SPDX-License-Identifier: MIT */
/* test_end_of_time.c: virtual time ends at SIM_TIME_MAX: nothing goes past it, nothing hangs there, and recordings and snapshots
 * made there can be read. One case alone: CK_RUN_CASE=CASE ./test_end_of_time */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "condition/condition.h"
#include "core/rig.h"
#include "device/rkm04_device.h"
#include "record/record.h"
#include "record/session_rig.h"
#include "record/snapshot.h"
#include "scenario/scenario.h"

static struct session session;

static void begin(size_t kind)
{
    session_begin(&session, &session_kinds[kind]);
    session_set(&session, session.sim.config.nodes.node[0], '1', "@1 W16000000 J1");
    sim_advance(&session.sim, SECOND);
}

START_TEST(time_stops_at_its_end)
{
    begin(0);
    ck_assert(!sim_time_is_over(&session.sim));
    sim_advance(&session.sim, SIM_TIME_MAX - 1u);
    ck_assert(!sim_time_is_over(&session.sim));
    sim_advance(&session.sim, UINT64_MAX);
    ck_assert_uint_eq(sim_now(&session.sim), SIM_TIME_MAX);
    ck_assert(sim_time_is_over(&session.sim));
    sim_advance(&session.sim, SIM_TIME_MAX + 1000u);
    ck_assert_uint_eq(sim_now(&session.sim), SIM_TIME_MAX);
    ck_assert_uint_eq(rkm04_now(rkm04_of(sim_core(&session.sim, 1))), SIM_TIME_MAX);
    session_end(&session);
}
END_TEST

START_TEST(bytes_under_way_at_the_end_keep_nobody_waiting)
{
    begin(0);
    sim_advance(&session.sim, SIM_TIME_MAX - 3000u);
    session_ask(&session, 1, "\1", 1);
    sim_advance(&session.sim, UINT64_MAX);
    ck_assert_uint_gt(sim_due(&session.sim), SIM_TIME_MAX);
    sim_set_timed(&session.sim, false);
    session_ask(&session, 1, "\1", 1);
    sim_finish_tick(&session.sim);
    sim_set_timed(&session.sim, true);
    session_command(&session, "power", "{\"on\": false}");
    session_command(&session, "power", "{\"on\": true}");
    ck_assert_uint_eq(sim_now(&session.sim), SIM_TIME_MAX);
    session_end(&session);
}
END_TEST

START_TEST(who_waits_for_a_condition_is_told_at_the_end)
{
    struct refusal refusal;
    begin(0);
    json_t *json = json_pack("{s:{s:i}}", "do", "1", 1);
    struct condition *condition = condition_read(&session.sim, json, &refusal);
    ck_assert_msg(condition != NULL, "%s", refusal.text);
    condition_arm(condition);
    ck_assert(!condition_run(condition, RKM04_NEVER));
    ck_assert_uint_eq(sim_now(&session.sim), SIM_TIME_MAX);
    condition_free(condition);
    json_decref(json);
    session_end(&session);
}
END_TEST

static void expect_replay(const char *text, size_t length)
{
    FILE *in = fmemopen((void *)text, length, "r");
    struct replay *replay = in ? replay_open("recording", in) : NULL;
    ck_assert_ptr_nonnull(replay);
    enum replay_end end = replay_run(replay, NULL, NULL);
    ck_assert_msg(end == REPLAY_SAME, "%s", replay_text(replay));
    ck_assert_uint_eq(sim_now(replay_sim(replay)), SIM_TIME_MAX);
    replay_free(replay);
    fclose(in);
}

START_TEST(recordings_and_snapshots_of_the_end_can_be_read)
{
    char path[] = "/tmp/test_end_of_time-XXXXXX", params[80], *text = NULL;
    size_t length, kind = (size_t)_i;
    int fd = mkstemp(path);
    ck_assert_int_ge(fd, 0);
    close(fd);
    snprintf(params, sizeof params, "{\"file\": \"%s\"}", path);
    session_begin(&session, &session_kinds[kind]);
    ck_assert(snapshots_keep_journal(&session.sim));
    FILE *out = open_memstream(&text, &length);
    struct record *record = record_begin(&session.sim, out);
    ck_assert_ptr_nonnull(record);
    session_live(&session, 20, 300000, 0);
    session_command(&session, "fault.clear", "{}");
    session_command(&session, "snapshot", "{\"name\": \"early\"}");
    for (unsigned number = 1; number <= sim_units(&session.sim); number++) {
        char unit[40];
        snprintf(unit, sizeof unit, "{\"unit\": \"%s\", \"on\": false}", session.sim.unit[number - 1u].name);
        session_command(&session, "power", unit); /* nothing moves */
        snprintf(unit, sizeof unit, "{\"unit\": \"%s\", \"on\": true}", session.sim.unit[number - 1u].name);
        session_command(&session, "power", unit);
    }
    sim_advance(&session.sim, SIM_TIME_MAX - 200000u);
    session_live(&session, 20, 300000, 0);
    ck_assert_uint_eq(sim_now(&session.sim), SIM_TIME_MAX);
    session_refusal(&session, "snapshot", params);
    session_refusal(&session, "restore", params);
    session_command(&session, "restore", "{\"name\": \"early\"}");
    session_live(&session, 20, 300000, 0);
    session_command(&session, "snapshot", "{\"name\": \"late\"}");
    session_command(&session, "restore", "{\"name\": \"late\"}");
    session_refusal(&session, "snapshot", params);
    session_refusal(&session, "restore", params);
    ck_assert_uint_eq(sim_now(&session.sim), SIM_TIME_MAX);
    ck_assert_int_eq(record_end(record), 0);
    fclose(out);
    session_end(&session);
    remove(path);
    expect_replay(text, length);
    free(text);
}
END_TEST

START_TEST(a_scenario_that_goes_past_the_end_fails_there)
{
    static const char *const texts[] = {
        "steps:\n  - advance: 999999999s\n  - advance: 2s\n",
        "steps:\n  - advance: 999999999s\n  - wait: {do: {1: 1}}\n    within: 5s\n",
        "steps:\n  - advance: 999999999.9999s\n  - message: 01\n    answer: any\n",
        "steps:\n  - advance: 999999999s\n  - stays: {do: {1: 0}}\n    for: 5s\n",
    };
    char *said = NULL;
    size_t length;
    struct scenario_result result;
    FILE *errors = open_memstream(&said, &length);
    struct scenario_files files = {0};
    struct scenario *scenario = scenario_read("x.yaml", texts[_i], strlen(texts[_i]), &files, errors);
    fclose(errors);
    ck_assert_msg(scenario != NULL, "%s", said);
    ck_assert_int_eq(scenario_run(scenario, NULL, NULL, NULL, &result), SCENARIO_FAILED);
    ck_assert_str_eq(result.expected, "virtual time to continue");
    ck_assert_str_eq(result.seen, "its end, after 1000000000 s");
    ck_assert_uint_eq(result.line, 3);
    ck_assert_uint_eq(result.tick, SIM_TIME_MAX);
    scenario_result_free(&result);
    scenario_free(scenario);
    free(said);
}
END_TEST

int main(int argc, char **argv)
{
    Suite *suite = suite_create("end_of_time");
    TCase *end = tcase_create("end");
    (void)argc;
    tcase_set_timeout(end, 60);
    tcase_add_test(end, time_stops_at_its_end);
    tcase_add_test(end, bytes_under_way_at_the_end_keep_nobody_waiting);
    tcase_add_test(end, who_waits_for_a_condition_is_told_at_the_end);
    tcase_add_loop_test(end, recordings_and_snapshots_of_the_end_can_be_read, 0, (int)session_kind_count);
    tcase_add_loop_test(end, a_scenario_that_goes_past_the_end_fails_there, 0, 4);
    suite_add_tcase(suite, end);
    return rig_run(suite, argv[0]);
}
