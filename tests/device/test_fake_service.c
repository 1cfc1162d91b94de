/* SPDX-License-Identifier: MIT */
/* test_fake_service.c: the servers of a device, in virtual time: commands, limits, events, recordings, snapshots, scenarios. */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "core/rig.h"
#include "fake_device.h"
#include "fake_rig.h"
#include "record/record.h"
#include "trace/trace.h"

static struct fake_rig rig;
static char out[1024]; /* what the ports get: "1:HELLO 1\r\n", "1:closed\n" */

static void hear(void *context, unsigned client, const uint8_t *bytes, size_t length)
{
    size_t at = strlen(out);
    (void)context;
    snprintf(out + at, sizeof out - at, "%u:%.*s%s", client, (int)length, (const char *)bytes, length == 0 ? "closed\n" : "");
}

static void begin(void)
{
    fake_rig_begin_as(&rig, &fake_alone_device, NULL, "1", true);
    rig.sim.config.service_out = hear;
    out[0] = '\0';
}

static void end(void)
{
    fake_rig_end(&rig);
}

/* A member of a result that is a text. */
static void expect(const char *method, const char *params, const char *member, const char *value)
{
    json_t *result = fake_rig_command(&rig, method, params);
    char *text = json_dumps(json_object_get(result, member), JSON_ENCODE_ANY);
    ck_assert_msg(text && strcmp(text, value) == 0, "%s %s: %s is %s, expected %s", method, params, member, text, value);
    free(text);
    json_decref(result);
}

static void open_one(void)
{
    fake_rig_do(&rig, "service.open", "{\"service\": \"lines\", \"peer\": \"127.0.0.1:4000\"}");
}

START_TEST(requests_are_left_when_the_room_for_answers_is_used_up)
{
    open_one();
    expect("service.bytes", "{\"client\": 1, \"text\": \"POS?\\nPOS?\\nIN?\\n\", \"room\": 4}", "taken", "10");
    expect("service.bytes", "{\"client\": 1, \"text\": \"IN?\\nPOS?\\n\", \"room\": 1}", "taken", "4");
    expect("service.bytes", "{\"client\": 1, \"text\": \"POS?\\n\", \"room\": 32768}", "text", "\"0\\r\\n\"");
    ck_assert_str_eq(out, "1:HELLO 1\r\n1:0\r\n1:0\r\n1:0\r\n1:0\r\n");
    fake_rig_expect_refusal(&rig, "service.bytes", "{\"client\": 1, \"text\": \"\", \"room\": 32769}",
                            "room: expected a whole number from 1 to 32768");
}
END_TEST

START_TEST(client_is_answered_at_once)
{
    expect("service.open", "{\"service\": \"lines\"}", "text", "\"HELLO 1\\r\\n\"");
    expect("service.bytes", "{\"client\": 1, \"text\": \"MOVE 3\\n\"}", "text", "\"OK\\r\\n\"");
    expect("service.bytes", "{\"client\": 1, \"hex\": \"504F 533F0a\"}", "sent", "\"300D0A\"");
    sim_advance(&rig.sim, 1000000);
    expect("service.bytes", "{\"client\": 1, \"text\": \"PO\"}", "sent", "\"\"");
    expect("service.bytes", "{\"client\": 1, \"text\": \"S?\\nIN?\\n\"}", "text", "\"3\\r\\n0\\r\\n\"");
    ck_assert_str_eq(out, "1:HELLO 1\r\n1:OK\r\n1:0\r\n1:3\r\n1:0\r\n");
}
END_TEST

/* TELL: at each 100 ms of the bus; nothing changes from 200 ms on. */
START_TEST(server_sends_of_itself_at_its_time)
{
    sim_advance(&rig.sim, 50);
    open_one();
    fake_rig_do(&rig, "service.bytes", "{\"client\": 1, \"text\": \"TELL\\nMOVE 15\\n\"}");
    ck_assert_uint_eq(sim_due(&rig.sim), 100000);
    out[0] = '\0';
    sim_advance(&rig.sim, 99999);
    ck_assert_str_eq(out, "");
    sim_advance(&rig.sim, 100000);
    ck_assert_str_eq(out, "1:POS 9\r\n");
    sim_advance(&rig.sim, 5000000);
    ck_assert_str_eq(out, "1:POS 9\r\n1:POS 15\r\n");
    fake_rig_do(&rig, "service.close", "{\"client\": 1}");
    ck_assert_uint_eq(sim_due(&rig.sim), DEVICE_NEVER);
    ck_assert_str_eq(out, "1:POS 9\r\n1:POS 15\r\n1:closed\n");
}
END_TEST

START_TEST(clients_are_counted_and_limited)
{
    for (unsigned i = 0; i < 8; i++)
        open_one();
    fake_rig_expect_refusal(&rig, "service.open", "{\"service\": \"lines\"}",
                            "service lines: too many clients: expected at most 8");
    fake_rig_do(&rig, "service.close", "{\"client\": 3}");
    fake_rig_expect_refusal(&rig, "service.bytes", "{\"client\": 3, \"text\": \"\"}", "there is no client 3");
    expect("service.open", "{\"service\": \"lines\", \"peer\": \"last\"}", "client", "3");
    fake_rig_do(&rig, "service.close", "{}");
    fake_rig_do(&rig, "service.open", "{\"service\": \"lines\", \"peer\": \"a\"}");
    fake_rig_do(&rig, "service.open", "{\"service\": \"lines\", \"peer\": \"b\"}");
    fake_rig_do(&rig, "service.close", "{\"client\": 1}");
    fake_rig_do(&rig, "service.open", "{\"service\": \"lines\", \"peer\": \"c\"}");
    expect("service.bytes", "{\"client\": 2, \"text\": \"WHO\\n\"}", "text", "\"b\\r\\nc\\r\\n\"");
}
END_TEST

START_TEST(server_hangs_up)
{
    open_one();
    expect("service.bytes", "{\"client\": 1, \"text\": \"BYE\\nPOS?\\n\"}", "open", "false");
    open_one();
    expect("service.bytes", "{\"client\": 1, \"text\": \"12345678901234567\"}", "open", "false");
    ck_assert_str_eq(out, "1:HELLO 1\r\n1:closed\n1:HELLO 1\r\n1:closed\n");
}
END_TEST

START_TEST(clients_outlive_the_power_of_the_unit)
{
    open_one();
    fake_rig_do(&rig, "power", "{\"on\": false}");
    expect("service.bytes", "{\"client\": 1, \"text\": \"POS?\\n\"}", "text", "\"no power\\r\\n\"");
    fake_rig_do(&rig, "power", "{\"on\": true}");
    expect("service.bytes", "{\"client\": 1, \"text\": \"POS?\\n\"}", "text", "\"0\\r\\n\"");
}
END_TEST

START_TEST(wrong_parameters_are_refused)
{
    static const char *const wrong[][3] = {
        {"service.open", "{}", "there is no server `': expected one of lines"},
        {"service.open", "{\"service\": \"line\"}", "there is no server `line': expected one of lines"},
        {"service.open", "{\"service\": \"lines\", \"peer\": 1}", "peer: expected an address"},
        {"service.open", "{\"name\": \"lines\"}", "unknown parameter `name'"},
        {"service.bytes", "{\"client\": 0, \"text\": \"\"}", "client: expected a whole number from 1 to 128"},
        {"service.bytes", "{\"client\": 1}", "expected either hex"},
        {"service.bytes", "{\"client\": 1, \"text\": \"\", \"hex\": \"\"}", "expected either hex"},
        {"service.bytes", "{\"client\": 1, \"hex\": \"0\"}", "expected either hex"},
        {"service.bytes", "{\"client\": 1, \"hex\": \"0g\"}", "expected either hex"},
        {"service.close", "{\"client\": 129}", "client: expected a whole number from 1 to 128"},
    };
    open_one();
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        fake_rig_expect_refusal(&rig, wrong[i][0], wrong[i][1], wrong[i][2]);
    end();
    fake_rig_begin(&rig, "1", false);
    fake_rig_expect_refusal(&rig, "service.open", "{\"service\": \"lines\"}", "the device fake has no servers");
}
END_TEST

/* ---- Files ---------------------------------------------------------------------------------------------------------- */

START_TEST(traces_have_what_passes)
{
    char *text;
    size_t length;
    FILE *stream = open_memstream(&text, &length);
    struct trace_file *file = trace_file_begin_on(&rig.sim, stream, TRACE_JSONL);
    open_one();
    fake_rig_do(&rig, "service.bytes", "{\"client\": 1, \"text\": \"BYE\\n\"}");
    ck_assert_int_eq(trace_file_end(file), 0);
    fclose(stream);
    static const char *const parts[] = {
        "{\"t_us\":0.000,\"kind\":\"service\",\"value\":1,\"service\":\"lines\",\"act\":\"open\",\"bytes\":\"\"}\n",
        "\"act\":\"sent\",\"bytes\":\"48454C4C4F20310D0A\"}\n", "\"act\":\"received\",\"bytes\":\"4259450A\"}\n",
        "\"act\":\"closed\",\"bytes\":\"\"}\n"};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        ck_assert_msg(strstr(text, parts[i]) != NULL, "%s\nis not in\n%s", parts[i], text);
    free(text);
}
END_TEST

static char *session(size_t *length)
{
    char *text;
    FILE *stream = open_memstream(&text, length);
    struct record *record = record_begin(&rig.sim, stream);
    open_one();
    fake_rig_do(&rig, "service.bytes", "{\"client\": 1, \"text\": \"TELL\\nMOVE 15\\n\"}");
    sim_advance(&rig.sim, 120000);
    fake_rig_do(&rig, "snapshot", "{\"name\": \"a\"}");
    sim_advance(&rig.sim, 150000);
    fake_rig_do(&rig, "restore", "{\"name\": \"a\"}");
    open_one();
    fake_rig_do(&rig, "service.bytes", "{\"client\": 1, \"text\": \"POS?\\n\"}");
    sim_advance(&rig.sim, 1000000);
    ck_assert_int_eq(record_end(record), 0);
    fclose(stream);
    return text;
}

static enum replay_end replay(char *text, size_t length, char said[300])
{
    FILE *in = fmemopen(text, length, "r");
    struct replay *replay = replay_open("test.record", in);
    enum replay_end end = replay_run(replay, NULL, NULL);
    snprintf(said, 300, "%s", replay_text(replay));
    replay_free(replay);
    fclose(in);
    return end;
}

/* Restoring a snapshot hangs clients up. */
START_TEST(recording_has_the_clients_and_replays)
{
    size_t length;
    char *text = session(&length), said[300];
    ck_assert_str_eq(out, "1:HELLO 1\r\n1:OK\r\n1:POS 9\r\n1:closed\n1:HELLO 1\r\n1:11\r\n");
    ck_assert_msg(replay(text, length, said) == REPLAY_SAME, "%s", said);
    char *place = strstr(text, "POS?");
    place[0] = 'Q';
    ck_assert_int_eq(replay(text, length, said), REPLAY_DIFFERENT);
    free(text);
}
END_TEST

/* The file of a snapshot is restored by a replay of what came in: the clients of then are not those of now. */
START_TEST(snapshot_in_a_file_is_restored_among_clients)
{
    char path[] = "/tmp/test_fake_service-XXXXXX", params[128];
    ck_assert_ptr_nonnull(mkdtemp(path));
    ck_assert(snapshots_keep_journal(&rig.sim));
    open_one();
    open_one();
    fake_rig_do(&rig, "service.bytes", "{\"client\": 2, \"text\": \"MOVE 15\\n\"}");
    sim_advance(&rig.sim, 50000);
    snprintf(params, sizeof params, "{\"file\": \"%s/a.record\"}", path);
    fake_rig_do(&rig, "snapshot", params);
    fake_rig_do(&rig, "restore", params);
    ck_assert(!sim_services_are_open(&rig.sim));
    open_one();
    fake_rig_do(&rig, "service.bytes", "{\"client\": 1, \"text\": \"POS?\\n\"}");
    snprintf(params, sizeof params, "{\"file\": \"%s/b.record\"}", path);
    fake_rig_do(&rig, "snapshot", params);
    fake_rig_do(&rig, "restore", params);
    fake_rig_expect_state(&rig, "motors.0.position", "4");
    char command[160];
    snprintf(command, sizeof command, "rm -r '%s'", path);
    ck_assert_int_eq(system(command), 0);
}
END_TEST

START_TEST(scenario_is_a_client_and_checks_results)
{
    static const char *const head =
        "device: alone\nsteps:\n  - {call: service.open, params: {service: lines}, result: {client: 1}}\n";
    static const struct {
        const char *step, *said;
    } stories[] = {
        {"  - {call: service.bytes, params: {client: 1, text: \"POS?\\n\"}, result: {text: \"0\\r\\n\", open: true}}\n", NULL},
        {"  - {call: service.bytes, params: {client: 1, text: \"POS?\\n\"}, result: {text: \"1\\r\\n\"}}\n",
         "line 4: expected text \"1\\r\\n\" in the result, seen text \"0\\r\\n\" in the result"},
        {"  - {call: service.bytes, params: {client: 1, text: \"\"}, result: {test: 1}}\n",
         "expected test 1 in the result, seen test missing in the result"},
        {"  - {call: service.close, result: 1}\n", "test.yaml:4:35: error: expected a map"},
        {"  - {call: service.bytes, params: {client: 2, text: \"\"}}\n", "refused: client: there is no client 2"},
    };
    for (size_t i = 0; i < sizeof stories / sizeof *stories; i++) {
        char text[500];
        snprintf(text, sizeof text, "%s%s", head, stories[i].step);
        run_story(text, stories[i].said ? SCENARIO_FAILED : SCENARIO_PASSED, stories[i].said);
    }
}
END_TEST

static Suite *fake_service_suite(void)
{
    Suite *suite = suite_create("fake_service");
    TCase *all = tcase_create("all");
    tcase_add_checked_fixture(all, begin, end);
    tcase_add_test(all, client_is_answered_at_once);
    tcase_add_test(all, requests_are_left_when_the_room_for_answers_is_used_up);
    tcase_add_test(all, server_sends_of_itself_at_its_time);
    tcase_add_test(all, clients_are_counted_and_limited);
    tcase_add_test(all, server_hangs_up);
    tcase_add_test(all, clients_outlive_the_power_of_the_unit);
    tcase_add_test(all, wrong_parameters_are_refused);
    tcase_add_test(all, traces_have_what_passes);
    tcase_add_test(all, recording_has_the_clients_and_replays);
    tcase_add_test(all, snapshot_in_a_file_is_restored_among_clients);
    tcase_add_test(all, scenario_is_a_client_and_checks_results);
    suite_add_tcase(suite, all);
    return suite;
}

int main(void)
{
    return rig_run(fake_service_suite(), "./test_fake_service");
}
