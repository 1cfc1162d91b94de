/* SPDX-License-Identifier: MIT */
/* test_command.c: tables of commands that rooms above bring along. One test alone: CK_RUN_CASE=NAME ./test_command */
#include <check.h>
#include <string.h>

#include "command/command.h"
#include "core/rig.h"
#include "record/record.h"
#include "sim/sim.h"

static struct sim sim;
static struct refusal refusal;
static unsigned taken_down; /* by the journal */

static void setup(void)
{
    struct sim_config config = {.nodes = {.count = 1, .node = {1}}};
    memset(&sim, 0, sizeof sim);
    ck_assert(sim_begin(&sim, &config));
    taken_down = 0;
}

static void teardown(void)
{
    sim_end(&sim);
}

static bool is_obeyed(const char *method, const char *params)
{
    json_t *object = json_loads(params, 0, NULL), *result = sim_command(&sim, method, object, &refusal);
    bool obeyed = result != NULL;
    ck_assert_ptr_nonnull(object);
    json_decref(object);
    json_decref(result);
    return obeyed;
}

static json_t *answer(struct sim *asked, const json_t *params, struct refusal *why)
{
    static const char *const names[] = {NULL};
    ck_assert_ptr_eq(asked, &sim);
    return params_known(params, names, why) ? json_integer(42) : NULL;
}

static const struct command_method own[] = {{"own.read", answer, false}, {"own.change", answer, true}, {NULL, NULL, false}};

static void on_command(void *context, uint64_t now, const char *method, const json_t *params)
{
    (void)context, (void)now, (void)params;
    ck_assert_str_eq(method, "own.change");
    taken_down++;
}

START_TEST(a_sim_obeys_the_methods_of_a_table_once_it_is_attached)
{
    ck_assert(!sim_has_command(&sim, "own.read"));
    ck_assert(!is_obeyed("own.read", "{}"));
    ck_assert_int_eq(refusal.code, REFUSED_METHOD);
    ck_assert(command_attach(&sim, own));
    ck_assert(sim_has_command(&sim, "own.read") && sim_has_command(&sim, "state"));
    ck_assert(is_obeyed("own.read", "{}"));
    ck_assert(is_obeyed("state", "{}"));
    ck_assert(!is_obeyed("own.read", "{\"x\": 1}"));
    ck_assert_int_eq(refusal.code, REFUSED_PARAMS);
    ck_assert(!sim_has_command(&sim, "own.other"));
}
END_TEST

START_TEST(the_journal_takes_down_what_such_a_table_changes)
{
    static const struct sim_journal journal = {.command = on_command};
    ck_assert(command_attach(&sim, own));
    sim.journal = &journal;
    ck_assert(is_obeyed("own.read", "{}"));
    ck_assert_uint_eq(taken_down, 0);
    ck_assert(is_obeyed("own.change", "{}"));
    ck_assert_uint_eq(taken_down, 1);
    ck_assert(!is_obeyed("own.change", "{\"x\": 1}"));
    ck_assert_uint_eq(taken_down, 1);
}
END_TEST

START_TEST(a_table_is_attached_once_and_there_is_a_limit)
{
    static const struct command_method none[SIM_COMMAND_TABLES] = {{NULL, NULL, false}};
    for (unsigned i = 0; i < 2 * SIM_COMMAND_TABLES; i++)
        ck_assert(command_attach(&sim, own));
    for (unsigned i = 0; i < SIM_COMMAND_TABLES - 1; i++)
        ck_assert(command_attach(&sim, &none[i]));
    ck_assert(!command_attach(&sim, &none[SIM_COMMAND_TABLES - 1]));
    ck_assert(is_obeyed("own.read", "{}"));
}
END_TEST

START_TEST(snapshots_are_obeyed_by_a_sim_that_has_them)
{
    ck_assert(!is_obeyed("snapshot", "{\"name\": \"a\"}"));
    ck_assert_int_eq(refusal.code, REFUSED_METHOD);
    ck_assert(snapshots_attach(&sim));
    ck_assert(is_obeyed("snapshot", "{\"name\": \"a\"}"));
    ck_assert(is_obeyed("restore", "{\"name\": \"a\"}"));
}
END_TEST

static Suite *command_suite(void)
{
    Suite *suite = suite_create("command");
    TCase *tables = tcase_create("tables");
    tcase_add_checked_fixture(tables, setup, teardown);
    tcase_add_test(tables, a_sim_obeys_the_methods_of_a_table_once_it_is_attached);
    tcase_add_test(tables, the_journal_takes_down_what_such_a_table_changes);
    tcase_add_test(tables, a_table_is_attached_once_and_there_is_a_limit);
    tcase_add_test(tables, snapshots_are_obeyed_by_a_sim_that_has_them);
    suite_add_tcase(suite, tables);
    return suite;
}

int main(void)
{
    return rig_run(command_suite(), "test_command");
}
