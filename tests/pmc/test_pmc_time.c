/* SPDX-License-Identifier: MIT */
/* AT1, AT2: however time is cut, the same comes out; nothing happens between two events; copies are snapshots. Random sessions on
 * two axes with programs, moves, stops, changes of speed, searches, inputs. RKM04_TEST_SEED, RKM04_TEST_SCALE: others, more. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "crc32.h"
#include "pmc/pmc.h"

#include <check.h>

#define ACTS_MAX 40u
#define SESSIONS 60u
#define SLOT ((uint64_t)PMC_SLOT_TICKS)

static uint32_t state;

static uint32_t next_random(uint32_t below)
{
    state = state * 1664525u + 1013904223u;
    return (uint32_t)((uint64_t)(state >> 8) * below >> 24);
}

/* What is done to the unit at a tick. */
struct act {
    uint64_t tick;
    uint16_t inputs;
    struct pmc_request request;
};

static struct session {
    unsigned acts;
    struct act act[ACTS_MAX];
    int32_t value[PMC_AXES][PMC_PARAMETERS];
    struct pmc_command program[PMC_AXES][PMC_REGISTERS];
    uint64_t end;
} session;

/* What a run gave: check values of all reports of an axis, and of the unit. */
struct result {
    uint32_t axis[PMC_AXES], outputs;
    uint64_t reports;
    struct pmc_axis_state last[PMC_AXES];
};

static struct pmc_unit unit;
static struct result result;
static uint64_t quiet_until; /* nothing may be reported before */

static void add(uint32_t *check, uint64_t a, uint64_t b, uint64_t c)
{
    const uint64_t bytes[] = {a, b, c};
    *check = crc32_update(*check, (const uint8_t *)bytes, sizeof bytes);
    result.reports++;
    if (c < quiet_until)
        ck_abort_msg("reported at %llu, before the next event at %llu", (unsigned long long)c, (unsigned long long)quiet_until);
}

static void on_steps(void *context, unsigned axis, const uint64_t *tick, size_t count, int32_t position, bool forward)
{
    (void)context;
    for (size_t i = 0; i < count; i++)
        add(&result.axis[axis], 1, (uint64_t)(position + (forward ? (int32_t)i : -(int32_t)i)), tick[i]);
}

static void on_direction(void *context, uint64_t tick, unsigned axis, bool forward)
{
    (void)context;
    add(&result.axis[axis], 2, forward, tick);
}

static void on_outputs(void *context, uint64_t tick, uint8_t mask)
{
    (void)context;
    add(&result.outputs, 3, mask, tick);
}

static void on_event(void *context, uint64_t tick, unsigned axis, enum pmc_event what, uint32_t value)
{
    (void)context;
    add(&result.axis[axis], 4 + (uint64_t)what, value, tick);
}

static const struct pmc_port
    loud = {.steps = on_steps, .direction = on_direction, .outputs = on_outputs, .event = on_event},
    quiet = {.steps = NULL};

/* ---- Sessions ---- */

static struct pmc_command random_command(void)
{
    struct pmc_command command = {.op = (uint8_t)next_random(PMC_OPS)};
    const unsigned operands = pmc_command_rows[command.op].operands;
    if (operands & PMC_OPERAND_VALUE)
        command.value = (int32_t)next_random(4000) - 2000;
    if (operands & PMC_OPERAND_SPEED)
        command.speed = (uint8_t)(1 + next_random(4));
    if (operands & (PMC_OPERAND_MS | PMC_OPERAND_DWELL))
        command.ms = (uint16_t)(1 + next_random(20));
    if (operands & PMC_OPERAND_STATE)
        command.argument = (uint8_t)next_random(2);
    if (operands & PMC_OPERAND_TARGET)
        command.argument = (uint8_t)next_random(20);
    if (operands & PMC_OPERAND_COUNT)
        command.argument = (uint8_t)(1 + next_random(4));
    if (operands & (PMC_OPERAND_INPUT | PMC_OPERAND_OUTPUT))
        command.number = (uint8_t)next_random(2);
    return command;
}

static void make_request(struct pmc_request *request)
{
    request->kind = (uint8_t)next_random(PMC_RESET + 1);
    if (request->kind == PMC_RESET && next_random(4))
        request->kind = PMC_SET_SPEED;
    request->axes = (uint8_t)(1 + next_random(3));
    for (unsigned i = 0; i < PMC_AXES; i++) {
        request->value[i] = (int32_t)next_random(2000) - 1000;
        if (request->kind == PMC_RUN)
            request->value[i] = (int32_t)next_random(10);
        if (request->kind == PMC_SET_SPEED)
            request->value[i] = 1 + (int32_t)next_random(next_random(2) ? 100 : 4000);
    }
}

static void make_session(uint32_t seed)
{
    state = seed * 2654435761u + 12345;
    memset(&session, 0, sizeof session);
    session.acts = 5 + next_random(ACTS_MAX - 5);
    uint64_t tick = 0;
    for (unsigned i = 0; i < session.acts; i++) {
        tick += next_random(3) ? next_random(60 * 8000) : next_random(9000) / 1000 * 8000;
        if (next_random(4) == 0)
            tick = tick / SLOT * SLOT + next_random(3); /* next to a slot */
        session.act[i].tick = tick;
        session.act[i].inputs = (uint16_t)(next_random(1u << 15) & next_random(1u << 15) & next_random(1u << 15) &
                                           (next_random(4) ? 0xFF7F : 0xFFFF));
        make_request(&session.act[i].request);
    }
    session.end = tick + 300 * SLOT;
    for (unsigned axis = 0; axis < PMC_AXES; axis++) {
        struct pmc_parameters parameters;
        pmc_parameters_clear(&parameters);
        parameters.value[PMC_MULTIPLIER] = 1 + (int32_t)next_random(40);
        parameters.value[PMC_START_SPEED] = 1 + (int32_t)next_random(400);
        parameters.value[PMC_ACCELERATION] = 1 + (int32_t)next_random(3000);
        pmc_parameter_put(&parameters, PMC_DECELERATION, 1 + (int32_t)next_random(3000));
        parameters.value[PMC_FLAGS] ^= (int32_t)(next_random(4) + (next_random(2) << 5));
        parameters.value[PMC_STEPS] = 0x1F00 + (int32_t)next_random(256);
        parameters.value[PMC_HOME_OFFSET] = (int32_t)next_random(100);
        memcpy(session.value[axis], parameters.value, sizeof parameters.value);
        for (unsigned i = 0; i < 20; i++)
            session.program[axis][i] = random_command();
    }
}

/* ---- Runs ---- */

enum way { AT_ONCE, IN_PIECES, TICK_BY_TICK_NEAR_EVENTS, WITH_COPIES, UNSEEN, WAYS };

static struct pmc_unit copy;

/* Go on to `tick`. */
static void advance_to(uint64_t tick, enum way way)
{
    while (pmc_now(&unit) < tick) {
        uint64_t most = tick - pmc_now(&unit), ticks = most;
        quiet_until = 0;
        if (way == IN_PIECES)
            ticks = next_random(3) ? 1 + next_random(20000) : 1 + next_random(3);
        if (way == TICK_BY_TICK_NEAR_EVENTS) {
            const uint64_t event = pmc_next_event(&unit);
            if (event < pmc_now(&unit))
                ck_abort_msg("the next event is in the past");
            ticks = event > pmc_now(&unit) ? event - pmc_now(&unit) : 1; /* up to it nothing happens */
            quiet_until = event;
        }
        pmc_advance(&unit, ticks < most ? ticks : most);
        if (way == WITH_COPIES) {
            copy = unit;
            memset(&unit, 0xA5, sizeof unit);
            unit = copy;
        }
    }
}

static struct result run(enum way way)
{
    memset(&result, 0, sizeof result);
    quiet_until = 0;
    state = 99;
    const struct pmc_config config = {.axes = 2};
    pmc_init(&unit, &config, way == UNSEEN ? &quiet : &loud, NULL);
    for (unsigned axis = 0; axis < PMC_AXES; axis++) {
        memcpy(unit.axis[axis].parameters.value, session.value[axis], sizeof session.value[axis]);
        memcpy(unit.axis[axis].program, session.program[axis], sizeof session.program[axis]);
    }
    for (unsigned i = 0; i < session.acts; i++) {
        advance_to(session.act[i].tick, way);
        pmc_set_inputs(&unit, session.act[i].inputs);
        pmc_request(&unit, &session.act[i].request);
    }
    advance_to(session.end, way);
    for (unsigned i = 0; i < PMC_AXES; i++)
        pmc_axis_state(&unit, i, &result.last[i]);
    return result;
}

static bool same_state(const struct pmc_axis_state *a, const struct pmc_axis_state *b)
{
    return a->commanded == b->commanded && a->actual == b->actual && a->speed == b->speed && a->made == b->made &&
           a->state == b->state && a->reg == b->reg && a->errors == b->errors && a->outputs == b->outputs &&
           a->homed == b->homed && a->moving == b->moving && a->forward == b->forward && a->repetitions == b->repetitions &&
           a->fifth == b->fifth;
}

START_TEST(AT1_however_time_is_cut_the_same_comes_out)
{
    const char *seed = getenv("RKM04_TEST_SEED"), *scale = getenv("RKM04_TEST_SCALE");
    const unsigned sessions = SESSIONS * (scale ? (unsigned)atoi(scale) : 1);
    uint64_t reports = 0;
    for (unsigned i = 0; i < sessions; i++) {
        const uint32_t number = (seed ? (uint32_t)atoi(seed) : 1) * 1000 + i;
        make_session(number);
        const struct result first = run(AT_ONCE);
        reports += first.reports;
        for (enum way way = IN_PIECES; way < WAYS; way++) {
            const struct result other = run(way);
            bool same = way == UNSEEN || (memcmp(first.axis, other.axis, sizeof first.axis) == 0 &&
                                          first.outputs == other.outputs && first.reports == other.reports);
            for (unsigned axis = 0; axis < PMC_AXES; axis++)
                same = same && same_state(&first.last[axis], &other.last[axis]);
            if (!same)
                ck_abort_msg("session %u is another one in way %d", (unsigned)number, (int)way);
        }
    }
    ck_assert_uint_gt(reports, sessions * UINT64_C(500));
}
END_TEST

START_TEST(AT2_nothing_is_due_in_a_unit_at_rest)
{
    const struct pmc_config config = {.axes = 1};
    pmc_init(&unit, &config, &loud, NULL);
    ck_assert_uint_eq(pmc_next_event(&unit), SLOT); /* the first slot looks at the inputs */
    pmc_advance(&unit, SLOT + 1);
    ck_assert_uint_eq(pmc_next_event(&unit), PMC_NEVER);
    ck_assert_uint_eq(pmc_next_report(&unit), PMC_NEVER);
    pmc_set_inputs(&unit, 0);
    ck_assert_uint_eq(pmc_next_event(&unit), PMC_NEVER);
    pmc_set_inputs(&unit, PMC_IN0);
    ck_assert_uint_eq(pmc_next_event(&unit), 2 * SLOT);
    pmc_advance(&unit, PMC_NEVER);
    ck_assert_uint_eq(pmc_now(&unit), PMC_NEVER);
}
END_TEST

START_TEST(AT2_unseen_pulses_are_no_reports)
{
    const struct pmc_config config = {.axes = 2};
    pmc_init(&unit, &config, &quiet, NULL);
    const struct pmc_request speed = {.kind = PMC_SET_SPEED, .axes = 3, .value = {8000, 8000}};
    const struct pmc_request move = {.kind = PMC_MOVE_BY, .axes = 3, .value = {8000000, 100}};
    ck_assert_int_eq(pmc_request(&unit, &speed), PMC_OK);
    ck_assert_int_eq(pmc_request(&unit, &move), PMC_OK);
    pmc_advance(&unit, SLOT + 1);
    unsigned looks = 0;
    for (; unit.axis[0].motion.active; looks++) {
        const uint64_t next = pmc_next_report(&unit);
        ck_assert_uint_ne(next, PMC_NEVER);
        pmc_advance(&unit, next - pmc_now(&unit) + 1);
        ck_assert_uint_lt(looks, 200);
    }
    ck_assert_int_eq(unit.axis[0].commanded, 8000000);
    ck_assert_int_eq(unit.axis[1].commanded, 100);
    ck_assert_int_eq(pmc_set_parameter(&unit, 1, PMC_FLAGS, 0x0103), PMC_OK);
    const struct pmc_request jog = {.kind = PMC_JOG, .axes = 2, .value = {0, 1}};
    ck_assert_int_eq(pmc_request(&unit, &jog), PMC_OK);
    for (looks = 0; pmc_next_report(&unit) != PMC_NEVER; looks++) {
        pmc_advance(&unit, pmc_next_report(&unit) - pmc_now(&unit) + 1);
        ck_assert_uint_lt(looks, 10);
    }
    ck_assert_uint_ne(pmc_next_event(&unit), PMC_NEVER);
}
END_TEST

static Suite *time_suite(void)
{
    Suite *suite = suite_create("pmc_time");
    TCase *all = tcase_create("time");
    tcase_set_timeout(all, 200);
    tcase_add_test(all, AT1_however_time_is_cut_the_same_comes_out);
    tcase_add_test(all, AT2_nothing_is_due_in_a_unit_at_rest);
    tcase_add_test(all, AT2_unseen_pulses_are_no_reports);
    suite_add_tcase(suite, all);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(time_suite());
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? 0 : 1;
}
