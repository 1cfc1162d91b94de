/* SPDX-License-Identifier: MIT */
/* test_fault.c: when an injected fault acts, and what can be said about it. One case alone: CK_RUN_CASE=CASE ./test_fault */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "device/rkm04_device.h"
#include "fault_rig.h"

#define BYTES 2000u

/* Send BYTES bytes to no client, one a millisecond from tick 0 on: those that fault 1 has acted on become 'B'. */
static void send_all(void)
{
    uint8_t bytes[BYTES];
    memset(bytes, 'A', sizeof bytes);
    for (unsigned i = 0; i < BYTES; i++) {
        sim_queue_bytes(&rig.sim, bytes + i, 1, i * UINT64_C(1000));
        sim_advance(&rig.sim, (i + 1) * UINT64_C(1000));
    }
    ck_assert_uint_eq(rig.line.count, BYTES);
}

static unsigned acted_on(void)
{
    unsigned number = 0;
    for (size_t i = 0; i < rig.line.count; i++)
        number += rig.line.byte[i] == 'B';
    return number;
}

static json_t *listed(size_t at)
{
    json_t *result = run_command("fault.list", "{}"), *fault = json_incref(json_array_get(json_object_get(result, "faults"), at));
    json_decref(result);
    return fault;
}

static void assert_state(size_t at, const char *state, int acted)
{
    json_t *fault = listed(at);
    ck_assert_str_eq(json_string_value(json_object_get(fault, "state")), state);
    ck_assert_int_eq((int)json_integer_value(json_object_get(fault, "acted")), acted);
    json_decref(fault);
}

/* ---- Occasions ------------------------------------------------------------------------------------------------------ */

START_TEST(count_and_skip_choose_some_out_of_many)
{
    rig_begin(true, 1);
    inject("{'kind': 'flip', 'mask': 3, 'skip': 7, 'count': 5}");
    assert_state(0, "armed", 0);
    send_all();
    for (unsigned i = 0; i < BYTES; i++)
        ck_assert_uint_eq(rig.line.byte[i], i >= 7 && i < 12 ? 'B' : 'A');
    assert_state(0, "spent", 5);
    ck_assert_uint_eq(rig.news, 5);
    assert_news(0, "1 flip: 41 of the host becomes 42");
    rig_end();
}
END_TEST

START_TEST(without_count_or_window_a_fault_acts_on_every_occasion)
{
    rig_begin(true, 1);
    sim_unwatch(&rig.sim, &rig.watcher); /* so many are not kept */
    rig.watcher.kinds = WATCH_BIT(WATCH_BYTE);
    sim_watch(&rig.sim, &rig.watcher);
    inject("{'kind': 'flip', 'mask': 3}");
    send_all();
    ck_assert_uint_eq(acted_on(), BYTES);
    assert_state(0, "armed", BYTES);
    rig_end();
}
END_TEST

/* A byte sets out at the tick at which it is handed over. */
START_TEST(the_window_is_kept_to_the_tick)
{
    rig_begin(true, 1);
    inject("{'kind': 'flip', 'mask': 3, 'after': %d, 'for': '10ms'}", 50000 + (_i == 1));
    assert_state(0, "waiting", 0);
    send_all();
    for (unsigned i = 0; i < BYTES; i++)
        ck_assert_uint_eq(rig.line.byte[i], i >= 50u + (unsigned)_i && i < 60u + (unsigned)_i ? 'B' : 'A');
    assert_state(0, "spent", 10);
    rig_end();
}
END_TEST

static unsigned by_chance(const char *probability, uint64_t seed, uint8_t *bytes)
{
    rig_begin_with(true, 1, seed, NULL);
    sim_unwatch(&rig.sim, &rig.watcher);
    rig.watcher.kinds = WATCH_BIT(WATCH_BYTE);
    sim_watch(&rig.sim, &rig.watcher);
    inject("{'kind': 'flip', 'mask': 3, 'probability': %s}", probability);
    send_all();
    memcpy(bytes, rig.line.byte, BYTES);
    unsigned number = acted_on();
    rig_end();
    return number;
}

START_TEST(chance_follows_the_probability_and_the_seed)
{
    uint8_t first[BYTES], second[BYTES], other[BYTES];
    unsigned number = by_chance("0.25", 7, first);
    ck_assert_uint_gt(number, 440); /* 500 +- 3 sigma, 19 each */
    ck_assert_uint_lt(number, 560);
    by_chance("0.25", 7, second);
    by_chance("0.25", 8, other);
    ck_assert_mem_eq(first, second, BYTES);
    ck_assert_mem_ne(first, other, BYTES);
    ck_assert_uint_eq(by_chance("1", 7, first), BYTES);
    ck_assert_uint_lt(by_chance("0.000001", 7, first), 2);
}
END_TEST

START_TEST(of_two_faults_of_a_kind_the_older_acts_first_and_then_the_other)
{
    rig_begin(true, 1);
    inject("{'kind': 'flip', 'mask': 3, 'count': 2}");
    inject("{'kind': 'flip', 'mask': 5, 'count': 2}");
    send_all();
    ck_assert_mem_eq(rig.line.byte, "BBDDA", 5);
    rig_end();
}
END_TEST

START_TEST(spells_come_every_so_often_with_count_skip_and_chance)
{
    rig_begin(true, 1);
    inject("{'kind': 'unplugged', 'after': 500, 'duration': '2ms', 'every': '10ms', 'skip': 2, 'count': 3}");
    run(1000000);
    ck_assert_uint_eq(rig.plugs, 6);
    ck_assert_uint_eq(rig.plug[0].tick, 20500);
    ck_assert_uint_eq(rig.plug[1].tick, 22500);
    ck_assert_uint_eq(rig.plug[4].tick, 40500);
    assert_state(0, "spent", 3);
    inject("{'kind': 'input', 'input': 1, 'level': 1, 'duration': 1000, 'every': '10ms', 'for': '10s', 'probability': 0.5}");
    rig.news = 0;
    for (unsigned i = 0; i < 10; i++, rig.news = 0)
        run(1000000);
    json_t *fault = listed(1);
    ck_assert_int_gt((int)json_integer_value(json_object_get(fault, "acted")), 430);
    ck_assert_int_lt((int)json_integer_value(json_object_get(fault, "acted")), 570);
    ck_assert_str_eq(json_string_value(json_object_get(fault, "state")), "spent");
    json_decref(fault);
    rig_end();
}
END_TEST

START_TEST(a_spell_ends_with_its_window)
{
    rig_begin(true, 1);
    inject("{'kind': 'input', 'input': 1, 'level': 1, 'duration': '10s', 'for': '3s'}");
    run(2999999);
    assert_state(0, "active", 1);
    ck_assert_uint_eq(rkm04_inputs(rkm04_of(sim_core(&rig.sim, 1))), 1);
    run(1);
    assert_state(0, "spent", 1);
    ck_assert_uint_eq(rkm04_inputs(rkm04_of(sim_core(&rig.sim, 1))), 0);
    rig_end();
}
END_TEST

/* ---- Clear, list, going back ---------------------------------------------------------------------------------------- */

START_TEST(clearing_ends_what_is_in_force_at_once)
{
    rig_begin(true, 1);
    inject("{'kind': 'input', 'input': 1, 'level': 1}");
    inject("{'kind': 'cable'}");
    inject("{'kind': 'unplugged'}");
    inject("{'kind': 'break', 'duration': '1s'}");
    inject("{'kind': 'no_answer'}");
    json_t *result = run_command("fault.clear", "{}");
    ck_assert_int_eq((int)json_integer_value(json_object_get(result, "cleared")), 5);
    json_decref(result);
    ck_assert_uint_eq(rkm04_inputs(rkm04_of(sim_core(&rig.sim, 1))), 0);
    ck_assert_uint_eq(rig.plugs, 2);
    ck_assert_ptr_null(listed(0));
    run(10);
    ck_assert_uint_eq(answers_to(1, VERSION, 1), 1);
    rig_end();
}
END_TEST

START_TEST(there_is_room_for_many_and_spent_ones_give_way)
{
    rig_begin(true, 1);
    for (unsigned i = 0; i < FAULTS_MAX - 1; i++)
        inject("{'kind': 'no_answer'}");
    inject("{'kind': 'drop', 'count': 1, 'direction': 'to_units'}");
    ck_assert_str_eq(refused("fault.inject", "{'kind': 'echo'}"),
                     "-32000 too many faults: 64 can still act; clear some of them first");
    ask(1, VERSION, 1);
    settle();
    ck_assert_uint_eq(inject("{'kind': 'echo'}"), FAULTS_MAX + 1);
    ck_assert_str_eq(refused("fault.clear", "{'id': 64}"), "-32602 id: there is no fault 64: see fault.list");
    rig_end();
}
END_TEST

START_TEST(all_times_move_along_when_a_snapshot_comes_back)
{
    rig_begin(true, 1);
    inject("{'kind': 'cable', 'after': '1s', 'duration': '1s', 'every': '5s', 'for': '100s'}");
    inject("{'kind': 'delay', 'delay': 5}");
    struct faults faults = rig.sim.faults;
    faults_shift(&faults, 7000000);
    ck_assert_uint_eq(faults.fault[0].from, 8000000);
    ck_assert_uint_eq(faults.fault[0].next, 8000000);
    ck_assert_uint_eq(faults.fault[0].until, 108000000);
    ck_assert_uint_eq(faults.fault[0].every, 5000000);
    ck_assert_uint_eq(faults.fault[1].from, 7000000);
    ck_assert_uint_eq(faults.fault[1].until, RKM04_NEVER);
    rig_end();
}
END_TEST

START_TEST(a_snapshot_brings_faults_back_as_they_were)
{
    rig_begin(true, 1);
    inject("{'kind': 'no_answer', 'count': 1}");
    inject("{'kind': 'unplugged', 'after': '1s', 'for': '1s'}");
    json_decref(run_command("snapshot", "{'name': 'before'}"));
    run(1500000);
    ck_assert_uint_eq(rig.plugs, 1);
    json_decref(run_command("restore", "{'name': 'before'}"));
    ck_assert_uint_eq(rig.plugs, 2);
    ck_assert(rig.plug[1].plugged);
    ck_assert_uint_eq(answers_to(1, VERSION, 1), 0);
    ck_assert_uint_eq(answers_to(1, VERSION, 1), 1);
    run(1000000);
    ck_assert_uint_eq(rig.plugs, 3);
    rig_end();
}
END_TEST

/* ---- Refusals ------------------------------------------------------------------------------------------------------- */

static const struct {
    const char *params, *answer;
} wrong[] = {
    {"{}", "-32602 kind: expected one of drop, flip, duplicate, insert, echo, delay, no_answer, wrong_fcs, cut, flash, power, "
           "break, unplugged, cable, input"},
    {"{'kind': 'dropp'}", "-32602 kind: expected one of drop"},
    {"{'kind': 3}", "-32602 kind: expected one of drop"},
    {"{'kind': 'drop', 'bytes': 3}", "-32602 unknown parameter `bytes': expected kind, count, skip, probability, "
                                     "after, for, unit, direction"},
    {"{'kind': 'echo', 'unit': 1}", "-32602 unknown parameter `unit'"},
    {"{'kind': 'drop', 'count': 0}", "-32602 count: expected a whole number from 1 to 4294967295"},
    {"{'kind': 'drop', 'count': 'one'}", "-32602 count: expected"},
    {"{'kind': 'drop', 'skip': -1}", "-32602 skip: expected a whole number from 0"},
    {"{'kind': 'drop', 'probability': 0}", "-32602 probability: expected a number from 0.000001 to 1"},
    {"{'kind': 'drop', 'probability': 1.1}", "-32602 probability: expected"},
    {"{'kind': 'drop', 'probability': '1'}", "-32602 probability: expected"},
    {"{'kind': 'drop', 'after': '1 day'}", "-32602 after: expected a time"},
    {"{'kind': 'drop', 'for': 0}", "-32602 for: expected a time of at least 1us"},
    {"{'kind': 'drop', 'unit': 4}", "-32602 unit: there is no such unit: expected one of 1, 2"},
    {"{'kind': 'drop', 'direction': 'up'}", "-32602 direction: expected \"to_units\", \"to_master\" or \"both\""},
    {"{'kind': 'drop', 'direction': 1}", "-32602 direction: expected"},
    {"{'kind': 'drop', 'direction': 'both', 'unit': 1}", "-32602 direction: with unit expected \"to_master\""},
    {"{'kind': 'flip', 'mask': 0}", "-32602 mask: expected a whole number from 1 to 255"},
    {"{'kind': 'insert', 'byte': 256}", "-32602 byte: expected a whole number from 0 to 255"},
    {"{'kind': 'delay'}", "-32602 delay: expected a time"},
    {"{'kind': 'delay', 'delay': '1000001s'}", "-32602 delay: expected a time up to 1000000s"},
    {"{'kind': 'cut'}", "-32602 bytes: expected a whole number from 0 to 65535"},
    {"{'kind': 'break'}", "-32602 duration: missing: how long the bus is held at 0"},
    {"{'kind': 'cable', 'duration': 0}", "-32602 duration: expected a time of at least 1us"},
    {"{'kind': 'cable', 'every': '1s'}", "-32602 every: expected a duration, too, and a time longer than the duration"},
    {"{'kind': 'cable', 'every': '1s', 'duration': '1s'}", "-32602 every: expected a duration"},
    {"{'kind': 'cable', 'every': 0, 'duration': '1s'}", "-32602 every: expected a time of at least 1ms"},
    {"{'kind': 'cable', 'every': 999, 'duration': 10}", "-32602 every: expected a time of at least 1ms"},
    {"{'kind': 'flash', 'operation': 'format'}", "-32602 operation: expected \"write\" (an erase or a program), \"erase\""},
    {"{'kind': 'flash', 'operation': 1}", "-32602 operation: expected a string"},
    {"{'kind': 'flash', 'torn': 'yes'}", "-32602 torn: expected 1, 0, true or false"},
    {"{'kind': 'power', 'operation': 0}", "-32602 operation: expected a whole number from 1"},
    {"{'kind': 'input', 'level': 1}", "-32602 input: expected a whole number from 1 to 8"},
    {"{'kind': 'input', 'input': 9, 'level': 1}", "-32602 input: expected a whole number from 1 to 8"},
    {"{'kind': 'input', 'input': 8}", "-32602 level: expected 1, 0, true or false"},
};

START_TEST(a_wrong_fault_is_refused_with_what_was_expected)
{
    rig_begin(true, 2);
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        const char *text = refused("fault.inject", wrong[i].params);
        ck_assert_msg(strncmp(text, wrong[i].answer, strlen(wrong[i].answer)) == 0, "%s: %s", wrong[i].params, text);
    }
    ck_assert_str_eq(refused("fault.clear", "{'id': 0}"), "-32602 id: expected a whole number from 1 to 4294967295");
    ck_assert_str_eq(refused("fault.list", "{'id': 1}"), "-32602 unknown parameter `id': expected none");
    ck_assert_ptr_null(listed(0));
    rig_end();
}
END_TEST

/* ---- What is reported of kinds ------------------------------------------------------------------------------------------ */

/* A value that a parameter takes. */
static json_t *sample(const json_t *parameter)
{
    const char *type = json_string_value(json_object_get(parameter, "type"));
    const json_t *choices = json_object_get(parameter, "choices");
    ck_assert_ptr_nonnull(type);
    if (strcmp(type, "choice") == 0) {
        ck_assert_uint_gt(json_array_size(choices), 1);
        return json_incref(json_array_get(choices, 1)); /* to_master: with a unit, too */
    }
    if (strcmp(type, "time") == 0)
        return json_string(strcmp(json_string_value(json_object_get(parameter, "name")), "every") == 0 ? "2ms" : "1ms");
    if (strcmp(type, "flag") == 0)
        return json_true();
    ck_assert(strcmp(type, "number") == 0 || strcmp(type, "unit") == 0 || strcmp(type, "input") == 0);
    return json_integer(1);
}

/* Is the fault refused with these of the kind's parameters? `but`: not that one; -1: all; `all` false: only what is required. */
static bool is_refused(const json_t *kind, const json_t *common, int but, bool all)
{
    json_t *params = json_pack("{s:O}", "kind", json_object_get(kind, "kind"));
    const json_t *lists[] = {json_object_get(kind, "parameters"), common};
    struct refusal refusal;
    for (unsigned list = 0; list < 2; list++)
        for (size_t i = 0; i < json_array_size(lists[list]); i++) {
            const json_t *parameter = json_array_get(lists[list], i);
            if ((all || json_is_true(json_object_get(parameter, "required"))) && !(list == 0 && (int)i == but))
                json_object_set_new(params, json_string_value(json_object_get(parameter, "name")), sample(parameter));
        }
    json_t *result = sim_command(&rig.sim, "fault.inject", params, &refusal);
    bool refused_it = result == NULL;
    json_decref(params);
    json_decref(result);
    return refused_it;
}

START_TEST(fault_kinds_tells_what_fault_inject_takes_and_requires)
{
    rig_begin(true, 2);
    json_t *told = run_command("fault.kinds", "{}");
    const json_t *kinds = json_object_get(told, "kinds"), *common = json_object_get(told, "common");
    ck_assert_uint_eq(json_array_size(kinds), FAULT_KINDS);
    ck_assert_uint_eq(json_array_size(common), 5);
    for (size_t i = 0; i < FAULT_KINDS; i++) {
        const json_t *kind = json_array_get(kinds, i), *parameters = json_object_get(kind, "parameters");
        const char *name = json_string_value(json_object_get(kind, "kind"));
        ck_assert_msg(!is_refused(kind, common, -1, true), "%s with all its parameters", name);
        /* A break needs a duration or an end of its own. */
        ck_assert_msg(is_refused(kind, common, -1, false) == (strcmp(name, "break") == 0), "%s with what is required", name);
        for (size_t at = 0; at < json_array_size(parameters); at++)
            if (json_is_true(json_object_get(json_array_get(parameters, at), "required")))
                ck_assert_msg(is_refused(kind, common, (int)at, true), "%s without a required parameter", name);
    }
    ck_assert_str_eq(refused("fault.kinds", "{'kind': 'drop'}"), "-32602 unknown parameter `kind': expected none");
    json_decref(told);
    rig_end();
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("fault");
    TCase *occasion = tcase_create("occasion"), *list = tcase_create("list"), *refusal = tcase_create("refusal");
    tcase_add_test(occasion, count_and_skip_choose_some_out_of_many);
    tcase_add_test(occasion, without_count_or_window_a_fault_acts_on_every_occasion);
    tcase_add_loop_test(occasion, the_window_is_kept_to_the_tick, 0, 2);
    tcase_add_test(occasion, chance_follows_the_probability_and_the_seed);
    tcase_add_test(occasion, of_two_faults_of_a_kind_the_older_acts_first_and_then_the_other);
    tcase_add_test(occasion, spells_come_every_so_often_with_count_skip_and_chance);
    tcase_add_test(occasion, a_spell_ends_with_its_window);
    tcase_add_test(list, clearing_ends_what_is_in_force_at_once);
    tcase_add_test(list, there_is_room_for_many_and_spent_ones_give_way);
    tcase_add_test(list, all_times_move_along_when_a_snapshot_comes_back);
    tcase_add_test(list, a_snapshot_brings_faults_back_as_they_were);
    tcase_add_test(refusal, a_wrong_fault_is_refused_with_what_was_expected);
    tcase_add_test(refusal, fault_kinds_tells_what_fault_inject_takes_and_requires);
    suite_add_tcase(suite, occasion);
    suite_add_tcase(suite, list);
    suite_add_tcase(suite, refusal);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
