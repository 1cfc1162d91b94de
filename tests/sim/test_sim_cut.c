/* SPDX-License-Identifier: MIT */
/* test_sim_cut.c: a session does not depend on how its time is cut. Random sessions with requests, noise, all faults, plants,
 * hands, power, snapshots in memory and in files, and changes of the clock live several times: in one go, in pieces of random
 * lengths, and without anybody who watches; and their recordings are replayed. All that can be seen is the same.
 *
 * RKM04_TEST_LONG: many more sessions; RKM04_TEST_SEED: the first one (it is named when a test fails).
 * One case alone: CK_RUN_CASE=CASE ./test_sim_cut */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/rig.h"
#include "record/record.h"
#include "record/session_rig.h"
#include "record/snapshot.h"

#define SESSIONS 150u
#define SESSIONS_LONG 6000u
#define ACTS 40u
#define TEXT 400u

static struct session session;
static char path[64];

/* ---- What happens: parts of JSON, put together at random -------------------------------------------------------------- */

static const char *one_of(const char *const *texts, size_t count)
{
    return texts[session_draw(&session, count)];
}

#define ONE_OF(texts) one_of(texts, sizeof(texts) / sizeof(texts)[0])

static void act_fault(void)
{
    static const char *const kinds[] = {
        "\"kind\":\"drop\"", "\"kind\":\"flip\",\"mask\":4", "\"kind\":\"duplicate\"", "\"kind\":\"insert\",\"byte\":126",
        "\"kind\":\"echo\"", "\"kind\":\"delay\",\"delay\":\"7ms\"", "\"kind\":\"no_answer\"", "\"kind\":\"wrong_fcs\"",
        "\"kind\":\"cut\",\"bytes\":3", "\"kind\":\"flash\",\"torn\":true", "\"kind\":\"flash\",\"operation\":\"read\"",
        "\"kind\":\"power\",\"operation\":2,\"duration\":\"30ms\"", "\"kind\":\"power\"",
        "\"kind\":\"break\",\"duration\":\"3ms\"", "\"kind\":\"break\",\"duration\":\"777us\",\"every\":\"5003us\"",
        "\"kind\":\"unplugged\",\"duration\":\"20ms\"", "\"kind\":\"cable\",\"duration\":\"9001us\",\"every\":\"31ms\"",
        "\"kind\":\"cable\"",
    };
    static const char *const whens[] = {"", "", ",\"after\":\"12345us\"", ",\"after\":\"40ms\",\"for\":\"71ms\"",
                                        ",\"for\":\"333us\""};
    static const char *const hows[] = {"", ",\"count\":2", ",\"probability\":0.3", ",\"skip\":1,\"count\":3",
                                       ",\"probability\":0.02"};
    char text[TEXT], kind[120];
    snprintf(kind, sizeof kind, "%s", ONE_OF(kinds));
    if (session_draw(&session, 3) == 0)
        snprintf(kind, sizeof kind, "\"kind\":\"input\",\"input\":%u,\"level\":%u,\"duration\":%u,\"every\":%u",
                 1u + (unsigned)session_draw(&session, 3), (unsigned)session_draw(&session, 2),
                 1u + (unsigned)session_draw(&session, 900), 1000u + (unsigned)session_draw(&session, 9000));
    snprintf(text, sizeof text, "{%s%s%s}", kind, ONE_OF(whens), ONE_OF(hows));
    session_refusal(&session, "fault.inject", text);
}

static void act_plant(const char *unit)
{
    static const char *const motors[] = {
        "\"1\":{\"offset\":20,\"stops\":{\"low\":-5,\"high\":60}}", "\"1\":{\"turn\":37},\"2\":{}",
        "\"1\":{\"stall\":{\"start\":300,\"limit\":[{\"speed\":500,\"acceleration\":9000},"
        "{\"speed\":2500,\"acceleration\":1000}]}}",
        "\"2\":{\"missing_lead\":true}", "\"1\":{\"jam\":{\"from\":\"50ms\",\"to\":\"200ms\"}},\"3\":{\"offset\":-7}",
    };
    static const char *const switches[] = {
        "{\"input\":1,\"motor\":1,\"at_most\":0,\"hysteresis\":3,\"bounce\":\"3ms\"},{\"input\":2,\"motor\":1,\"at_least\":30}",
        "{\"input\":2,\"motor\":2,\"at_least\":5,\"normally_closed\":true,\"bounce\":\"700us\"},"
        "{\"input\":3,\"motor\":1,\"between\":[4,9]}",
        "{\"input\":1,\"motor\":1,\"between\":[1,3]},{\"input\":1,\"motor\":2,\"at_least\":2,\"bounce\":\"20ms\"}",
    };
    char text[2 * TEXT], inner[TEXT];
    snprintf(inner, sizeof inner, "{\"motors\":{%s},\"switches\":[%s]}", ONE_OF(motors), ONE_OF(switches));
    if (sim_units(&session.sim) > 1)
        snprintf(text, sizeof text, "{\"plant\":{\"units\":{\"%s\":%s}}}", unit, inner);
    else
        snprintf(text, sizeof text, "{\"plant\":%s}", session_draw(&session, 8) > 0 ? inner : "null");
    session_refusal(&session, "plant.set", text);
}

static void act_hand(const char *unit)
{
    static const char *const hands[] = {"\"jammed\":true", "\"jammed\":false", "\"missing_lead\":false", "\"position\":3",
                                        "\"position\":29", "\"missing_lead\":true"};
    char text[TEXT];
    snprintf(text, sizeof text, "{\"unit\":\"%s\",\"motor\":%u,%s}", unit, 1u + (unsigned)session_draw(&session, 2),
             ONE_OF(hands));
    session_refusal(&session, "plant.set", text);
}

static void act_unit(const char *unit)
{
    char text[TEXT];
    switch (session_draw(&session, 4)) {
    case 0:
        snprintf(text, sizeof text, "{\"unit\":\"%s\",\"on\":%s}", unit, session_draw(&session, 3) > 0 ? "true" : "false");
        session_refusal(&session, "power", text);
        break;
    case 1:
        snprintf(text, sizeof text, "{\"unit\":\"%s\"}", unit);
        session_refusal(&session, "reset", text);
        break;
    case 2:
        snprintf(text, sizeof text, "{\"unit\":\"%s\",\"node\":%u,\"reset\":%s}", unit, 1u + (unsigned)session_draw(&session, 3),
                 session_draw(&session, 2) > 0 ? "true" : "false");
        session_refusal(&session, "switch", text);
        break;
    default:
        snprintf(text, sizeof text, "{\"unit\":\"%s\",\"mask\":%u}", unit, (unsigned)session_draw(&session, 8));
        session_refusal(&session, "di.set", text);
        break;
    }
}

static void act_snapshot(void)
{
    char text[TEXT];
    const char *method = session_draw(&session, 2) > 0 ? "snapshot" : "restore";
    if (session_draw(&session, 3) > 0)
        snprintf(text, sizeof text, "{\"name\":\"%u\"}", (unsigned)session_draw(&session, 2));
    else
        snprintf(text, sizeof text, "{\"file\":\"%s\"}", path);
    session_refusal(&session, method, text);
}

/* Programs that move, wait for inputs and follow switches. */
static void act_program(uint8_t node)
{
    static const char *const texts[] = {
        "\\V900 A30000 @1 F7 R B9 R J1", "\\@1 (01 W3 )02 J1", "@1 O01 T03 Z01 C03 J1", "X02 V3000 A90000 G+", "M03 G- U W2 D G+",
        "@1 I02H2 F3 R J1 @2 B2 R J1", "\\V300 A60000 F40 R H", "T80 O81 F3 R C80", "G+", "K", "C75", "V700", "L9 T03 W2 C03 E",
        "T41 F30 R C41", "Y F20 Y B50 V400 Y R",
    };
    session_set(&session, node, (char)('0' + session_draw(&session, 4)), ONE_OF(texts));
}

/* Things that are rare by themselves: a switch that is passed while a fault comes and goes at its input; power that goes and
 * soon comes back. */
static void act_together(const char *unit, uint8_t node)
{
    static const uint8_t store[] = {3, '0'};
    char text[TEXT];
    if (session_draw(&session, 2) > 0) {
        snprintf(text, sizeof text, "{\"kind\":\"input\",\"input\":%u,\"level\":%u,\"duration\":%u,\"every\":%u}",
                 1u + (unsigned)session_draw(&session, 2), (unsigned)session_draw(&session, 2),
                 1u + (unsigned)session_draw(&session, 900), 1000u + (unsigned)session_draw(&session, 9000));
        act_plant(unit);
        session_refusal(&session, "fault.inject", text);
        act_program(0);
    } else {
        snprintf(text, sizeof text, "{\"kind\":\"power\",\"operation\":%u,\"duration\":%u}",
                 1u + (unsigned)session_draw(&session, 3), 1u + (unsigned)session_draw(&session, 3000));
        act_program(0);
        session_refusal(&session, "fault.inject", text);
        session_ask(&session, node, store, sizeof store);
    }
}

static void act(void)
{
    const char *unit = session.sim.unit[session_draw(&session, sim_units(&session.sim))].name;
    uint8_t node = (uint8_t)session_draw(&session, 4), store[] = {3, '0'};
    switch (session_draw(&session, 13)) {
    case 0:
        act_fault();
        break;
    case 1:
        act_together(unit, node);
        break;
    case 2:
        act_plant(unit);
        break;
    case 3:
        act_hand(unit);
        break;
    case 4:
        act_unit(unit);
        break;
    case 5:
        act_snapshot();
        break;
    case 6:
        sim_set_timed(&session.sim, session_draw(&session, 3) > 0);
        break;
    case 7:
        session_ask(&session, node, store, sizeof store);
        break;
    case 8:
    case 9:
        act_program(node);
        break;
    default:
        session_act(&session);
        break;
    }
}

/* ---- Lives ------------------------------------------------------------------------------------------------------------ */

struct life {
    bool watched;
    uint64_t piece; /* longest, ticks; 0: time is not cut */
};

struct seen {
    char *heard, *events, *state, *recording;
    size_t length; /* of the recording */
};

/* The lines about bytes that the host receives, or the others; to be freed. Bytes are reported at once, events later. */
static char *pick(const char *text, bool heard)
{
    char *picked = calloc(1, strlen(text) + 1), *to = picked;
    ck_assert_ptr_nonnull(picked);
    for (const char *line = text, *end; *line != '\0'; line = end) {
        end = strchr(line, '\n') + 1;
        size_t length = (size_t)(end - line);
        if ((memmem(line, length, " heard ", 7) != NULL) != heard)
            continue;
        memcpy(to, line, length);
        to += length;
    }
    return picked;
}

static uint64_t roll(uint64_t *dice, uint64_t below)
{
    *dice = *dice * UINT64_C(6364136223846793005) + 1442695040888963407u;
    return (*dice >> 33) % below;
}

static void pass(uint64_t ticks, uint64_t piece, uint64_t *cuts)
{
    uint64_t end = sim_now(&session.sim) + ticks;
    while (piece > 0 && sim_now(&session.sim) < end) {
        uint64_t next = sim_now(&session.sim) + roll(cuts, roll(cuts, 4) > 0 ? piece : 20 * piece);
        sim_advance(&session.sim, next < end ? next : end);
    }
    sim_advance(&session.sim, end);
}

static uint64_t draw_pause(void)
{
    switch (session_draw(&session, 6)) {
    case 0:
        return 0;
    case 1:
        return 1000 * session_draw(&session, 8);
    default:
        return session_draw(&session, 60000);
    }
}

static void live(unsigned seed, const struct life *life, struct seen *seen)
{
    uint64_t cuts = seed + 77u;
    FILE *out = NULL;
    struct record *record = NULL;
    *seen = (struct seen){0};
    remove(path);
    session_begin(&session, &session_kinds[seed % session_kind_count]);
    session.dice += seed * UINT64_C(7919);
    ck_assert(snapshots_keep_journal(&session.sim));
    if (life->watched) {
        out = open_memstream(&seen->recording, &seen->length);
        record = out ? record_begin(&session.sim, out) : NULL;
        ck_assert_ptr_nonnull(record);
    } else {
        sim_unwatch(&session.sim, &session.watcher);
    }
    for (unsigned i = 0; i < ACTS; i++) {
        pass(draw_pause(), life->piece, &cuts);
        act();
    }
    pass(100000, life->piece, &cuts);
    seen->state = session_state(&session);
    if (record) {
        ck_assert_int_eq(record_end(record), 0);
        ck_assert_int_eq(fclose(out), 0);
    }
    seen->heard = pick(session_seen(&session), true);
    seen->events = pick(session_seen(&session), false);
    session_end(&session);
}

static void forget(struct seen *seen)
{
    free(seen->heard);
    free(seen->events);
    free(seen->state);
    free(seen->recording);
}

static void replay(unsigned seed, const struct seen *seen)
{
    FILE *in = fmemopen(seen->recording, seen->length, "r");
    ck_assert_ptr_nonnull(in);
    struct replay *replay = replay_open("recording", in);
    ck_assert_ptr_nonnull(replay);
    enum replay_end end = replay_run(replay, NULL, NULL);
    ck_assert_msg(end == REPLAY_SAME, "session %u: its replay: %s", seed, replay_text(replay));
    replay_free(replay);
    fclose(in);
}

static void compare(unsigned seed, const struct life *life, const struct seen *whole)
{
    char what[60];
    struct seen seen;
    snprintf(what, sizeof what, "session %u in pieces of up to %u us", seed, (unsigned)life->piece);
    live(seed, life, &seen);
    if (life->watched) {
        session_same(whole->events, seen.events, what);
        session_same(whole->recording, seen.recording, what);
    }
    session_same(whole->heard, seen.heard, what);
    session_same(whole->state, seen.state, what);
    forget(&seen);
}

static void live_all(unsigned seed)
{
    static const struct life whole = {true, 0}, fine = {true, 300}, coarse = {true, 9000};
    static const struct life alone = {false, 0}, cut = {false, 2000};
    struct seen seen;
    live(seed, &whole, &seen);
    replay(seed, &seen);
    compare(seed, seed % 2 > 0 ? &fine : &coarse, &seen);
    compare(seed, seed % 4 > 1 ? &alone : &cut, &seen);
    forget(&seen);
}

START_TEST(sessions_are_the_same_however_time_is_cut)
{
    const char *first = getenv("RKM04_TEST_SEED");
    unsigned begin = first ? (unsigned)strtoul(first, NULL, 10) : 0;
    unsigned count = getenv("RKM04_TEST_LONG") ? SESSIONS_LONG : SESSIONS;
    for (unsigned seed = begin; seed < begin + count; seed++)
        live_all(seed);
}
END_TEST

/* What is seen of 300 ms in pieces of so many ticks; to be freed. */
static char *seen_of(const char *const (*commands)[2], const char *program, bool stored, uint64_t piece)
{
    static const struct session_kind kind = {"1", true, false, NULL, NULL};
    static const uint8_t store[] = {3, '0'};
    session_begin(&session, &kind);
    for (; (*commands)[0]; commands++)
        session_command(&session, (*commands)[0], (*commands)[1]);
    session_set(&session, 1, '1', program);
    if (stored) {
        sim_advance(&session.sim, 100000);
        session_ask(&session, 1, store, sizeof store);
    }
    while (sim_now(&session.sim) < 300000)
        sim_advance(&session.sim, sim_now(&session.sim) + piece);
    char *events = pick(session_seen(&session), false);
    session_end(&session);
    return events;
}

static void expect_in_pieces(const char *const (*commands)[2], const char *program, bool stored, const char *expected)
{
    char *whole = seen_of(commands, program, stored, 300000), *cut = seen_of(commands, program, stored, 100);
    session_same(cut, whole, "300 ms in one go");
    ck_assert_msg(strstr(whole, expected) != NULL, "expected %s in\n%s", expected, whole);
    free(whole);
    free(cut);
}

START_TEST(a_switch_that_changes_before_a_fault_lets_its_input_go_is_seen_at_its_tick)
{
    static const char *const commands[][2] = {
        {"plant.set", "{\"plant\":{\"motors\":{\"1\":{}},\"switches\":[{\"input\":1,\"motor\":1,\"at_least\":9}]}}"},
        {"fault.inject", "{\"kind\":\"input\",\"input\":1,\"level\":0,\"after\":900,\"duration\":90,\"every\":1000}"},
        {NULL, NULL}};
    static const char *const between[][2] = {
        {"plant.set", "{\"plant\":{\"motors\":{\"1\":{}},\"switches\":[{\"input\":1,\"motor\":1,\"at_least\":9}]}}"},
        {NULL, NULL}};
    char *free_of_faults = seen_of(between, "S100 A2000 F12 R", false, 300000), expected[80];
    const char *edge = strstr(free_of_faults, "inputs 1");
    ck_assert_ptr_nonnull(edge);
    while (edge > free_of_faults && edge[-1] != '\n')
        edge--;
    snprintf(expected, sizeof expected, "%.*s\n", (int)strcspn(edge, "\n"), edge);
    expect_in_pieces(commands, "S100 A2000 F12 R", false, expected);
    free(free_of_faults);
}
END_TEST

START_TEST(power_that_is_lost_on_the_way_comes_back_at_its_tick)
{
    static const char *const commands[][2] = {
        {"fault.inject", "{\"kind\":\"power\",\"operation\":2,\"duration\":\"350us\"}"}, {NULL, NULL}};
    expect_in_pieces(commands, "F1 R", true, "the power is back");
}
END_TEST

static void setup(void)
{
    snprintf(path, sizeof path, "/tmp/test_sim_cut-XXXXXX");
    int fd = mkstemp(path);
    ck_assert_int_ge(fd, 0);
    close(fd);
}

static void teardown(void)
{
    remove(path);
}

int main(int argc, char **argv)
{
    Suite *suite = suite_create("sim_cut");
    TCase *cut = tcase_create("cut");
    tcase_add_checked_fixture(cut, setup, teardown);
    tcase_add_test(cut, a_switch_that_changes_before_a_fault_lets_its_input_go_is_seen_at_its_tick);
    tcase_add_test(cut, power_that_is_lost_on_the_way_comes_back_at_its_tick);
    tcase_add_test(cut, sessions_are_the_same_however_time_is_cut);
    tcase_set_timeout(cut, getenv("RKM04_TEST_LONG") ? 36000 : 200);
    suite_add_tcase(suite, cut);
    (void)argc;
    return rig_run(suite, argv[0]);
}
