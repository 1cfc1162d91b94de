/* SPDX-License-Identifier: MIT */
/* test_check_run.c: what is said about random programs against what a unit does with them: a command that is never executed is
 * not; a fault of loops and calls has had its warning. RKM04_TEST_SEED chooses others, RKM04_TEST_SCALE more.
 * One case alone: CK_RUN_CASE=run ./test_check_run */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <rkm04/unit.h>

#include "program_tools/program_tools.h"

#define PROGRAMS 400u
#define COMMANDS_MAX 40u
#define SLOTS 600u

static uint32_t state;

static uint32_t draw(uint32_t below)
{
    state = state * 1664525u + 1013904223u;
    return (state >> 8) % below;
}

static unsigned from_environment(const char *name, unsigned otherwise)
{
    const char *text = getenv(name);
    return text != NULL ? (unsigned)strtoul(text, NULL, 10) : otherwise;
}

static struct program {
    char text[COMMANDS_MAX * 8];
    size_t length, offset[COMMANDS_MAX], count;
    bool executed[COMMANDS_MAX];
    unsigned faults; /* bit: enum rkm04_fault */
} program;

/* Much that jumps, loops and calls; few labels, so that they meet. */
static void draw_program(void)
{
    static const char *const forms[] = {"@%u ", "@%u ", "J%u ", "I01H%u ", "I02L%u ", "'%u ",
                                        "L%u ", "E ",   "E ",   ". ",      "D ",      "W%u "};
    program = (struct program){.count = 3 + draw(COMMANDS_MAX - 3)};
    for (size_t i = 0; i < program.count; i++) {
        program.offset[i] = program.length;
        program.length += (size_t)snprintf(program.text + program.length, sizeof program.text - program.length,
                                           forms[draw(sizeof forms / sizeof forms[0])], 1 + draw(5));
    }
}

static void take_event(void *context, uint64_t tick, unsigned motor, enum rkm04_event what, uint32_t value)
{
    (void)context, (void)tick, (void)motor;
    if (what == RKM04_EVENT_COMMAND && value > 0)
        program.executed[value - 1] = true;
    if (what == RKM04_EVENT_FAULT)
        program.faults |= 1u << value;
}

/* Run it with inputs that change at random. */
static void run_program(void)
{
    static const struct rkm04_port port = {.event = take_event};
    static const struct rkm04_config config = {.node = 1};
    static struct rkm04_unit unit;
    rkm04_init(&unit, &config, &port, NULL);
    ck_assert_int_eq(rkm04_set_command(&unit, '1', program.text, program.length, NULL), 0);
    for (unsigned slot = 0; slot < SLOTS; slot++) {
        if (draw(4) == 0)
            rkm04_set_inputs(&unit, (uint8_t)draw(4));
        rkm04_advance(&unit, RKM04_SLOT_TICKS);
    }
}

static bool is_told(const struct diagnostics *found, const char *name)
{
    for (size_t i = 0; i < found->count; i++)
        if (strcmp(found->list[i].name, name) == 0)
            return true;
    return false;
}

static void compare(const struct diagnostics *found, unsigned number)
{
    static const struct {
        unsigned fault;
        const char *name, *other;
    } faults[] = {
        {RKM04_FAULT_NO_LOOP, "loop-end", "loop-end"},
        {RKM04_FAULT_LOOP_LEVELS, "loop-depth", "loop-depth"},
        {RKM04_FAULT_CALL_LEVELS, "call-depth", "call-depth"},
        {RKM04_FAULT_NO_CALL, "stray-return", "run-into"},
    };
    for (size_t i = 0; i < sizeof faults / sizeof faults[0]; i++)
        ck_assert_msg((program.faults >> faults[i].fault & 1) == 0 || is_told(found, faults[i].name) ||
                          is_told(found, faults[i].other),
                      "program %u: no word about %s: %s", number, faults[i].name, program.text);
    for (size_t i = 0; i < found->count; i++) {
        const struct diagnostic *one = &found->list[i];
        for (size_t k = 0; strcmp(one->name, "unreachable") == 0 && k < program.count; k++)
            ck_assert_msg(!program.executed[k] || program.offset[k] < one->offset ||
                              program.offset[k] >= one->offset + one->length,
                          "program %u: command %zu was executed: %s", number, k + 1, program.text);
    }
}

START_TEST(what_is_said_is_what_happens)
{
    const unsigned programs = PROGRAMS * from_environment("RKM04_TEST_SCALE", 1);
    unsigned with_faults = 0, unreachable = 0;
    state = from_environment("RKM04_TEST_SEED", 1);
    for (unsigned number = 0; number < programs; number++) {
        static const struct check_options options;
        struct diagnostics found;
        draw_program();
        const struct program_source source = {"x", program.text, program.length, 1};
        ck_assert(check_programs(&source, 1, &options, &found));
        ck_assert_uint_eq(found.errors, 0);
        run_program();
        compare(&found, number);
        with_faults += program.faults > 1;
        unreachable += is_told(&found, "unreachable");
        diagnostics_free(&found);
    }
    /* They are worth something. */
    ck_assert_uint_gt(with_faults, programs / 10);
    ck_assert_uint_gt(unreachable, programs / 10);
}
END_TEST

static Suite *check_run_suite(void)
{
    Suite *suite = suite_create("check_run");
    TCase *run = tcase_create("run");
    tcase_set_timeout(run, 200);
    tcase_add_test(run, what_is_said_is_what_happens);
    suite_add_tcase(suite, run);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(check_run_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed > 0)
        puts("one test case alone: CK_RUN_CASE=run ./test_check_run");
    return failed > 0;
}
