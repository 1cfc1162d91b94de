/* SPDX-License-Identifier: MIT */
#include "story.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rig.h"

/* ---- Telling -------------------------------------------------------------------------------------------------------- */

static uint64_t dice;

uint64_t story_draw(uint64_t below)
{
    dice ^= dice << 13; /* xorshift64 */
    dice ^= dice >> 7;
    dice ^= dice << 17;
    return dice % below;
}

static void seed_dice(unsigned seed)
{
    dice = UINT64_C(0x9E3779B97F4A7C15) * (seed + 1);
    for (int i = 0; i < 8; i++)
        story_draw(2);
}

static unsigned from(const unsigned *list, size_t n)
{
    return list[story_draw(n)];
}

#define PICK(...) from((const unsigned[]){__VA_ARGS__}, sizeof((const unsigned[]){__VA_ARGS__}) / sizeof(unsigned))

/* Bits 1..4 and 80..83 only, so that motors, inputs and waits meet. */
static unsigned draw_bit(void)
{
    return (unsigned)(story_draw(2) ? 1 + story_draw(4) : 80 + story_draw(4));
}

/* Moves and their figures. */
static void draw_move(char *one, size_t room, bool slow)
{
    unsigned n = (unsigned)(1 + story_draw(4)); /* of inputs */
    switch (story_draw(20)) {
    case 0: case 1: case 2: case 3: case 4:
        snprintf(one, room, "R");
        break;
    case 5: case 6:
        snprintf(one, room, "F%u", slow ? PICK(1, 2, 3, 17, 250, 3000) : PICK(1, 2, 3, 7, 30, 90));
        break;
    case 7:
        snprintf(one, room, "B%u", slow ? PICK(1, 5, 40, 700) : PICK(1, 5, 20, 60));
        break;
    case 8: case 9:
        snprintf(one, room, "V%u", slow ? PICK(50, 333, 1000, 3001) : PICK(700, 1999, 5003, 16000));
        break;
    case 10:
        snprintf(one, room, "S%u", slow ? PICK(7, 100, 1000) : PICK(100, 1000, 2000));
        break;
    case 11:
        snprintf(one, room, "A%u", slow ? PICK(100, 2000, 7777) : PICK(7777, 30011, 60000));
        break;
    case 12: case 13:
        snprintf(one, room, "Y");
        break;
    case 14:
        snprintf(one, room, "%s", story_draw(2) ? "G+" : "G-");
        break;
    case 15:
        snprintf(one, room, "G%u", PICK(1, 10, 50));
        break;
    case 16:
        snprintf(one, room, story_draw(2) ? "H" : "D");
        break;
    case 17:
        snprintf(one, room, "%c%02u", story_draw(2) ? ')' : '(', n);
        break;
    default:
        snprintf(one, room, "W%u", slow ? PICK(1, 20, 300) : PICK(1, 2, 5));
        break;
    }
}

/* Everything else: bits, guards, jumps, loops, blocks, functions. */
static void draw_control(char *one, size_t room)
{
    unsigned n = (unsigned)(1 + story_draw(4)); /* of labels, inputs */
    switch (story_draw(14)) {
    case 0:
        snprintf(one, room, "%c%02u", story_draw(2) ? 'O' : 'Z', draw_bit());
        break;
    case 1: case 2:
        snprintf(one, room, "T%02u", draw_bit());
        break;
    case 3:
        snprintf(one, room, "C%02u", draw_bit());
        break;
    case 4:
        snprintf(one, room, "%c%02u", story_draw(2) ? 'M' : 'N', n);
        break;
    case 5:
        snprintf(one, room, story_draw(4) ? "U" : "X%02u", n);
        break;
    case 6: case 7:
        snprintf(one, room, "@%u", n);
        break;
    case 8:
        snprintf(one, room, "I%02u%c%u", draw_bit(), story_draw(2) ? 'H' : 'L', n);
        break;
    case 9:
        snprintf(one, room, "%c%u", story_draw(3) ? 'J' : '\'', n);
        break;
    case 10: case 11:
        snprintf(one, room, story_draw(2) ? "L%u" : "E", n);
        break;
    case 12:
        snprintf(one, room, "%c", (int)PICK('.', '[', ']', ']', ']', ']'));
        break;
    default:
        snprintf(one, room, "%c%u", story_draw(2) ? 'T' : 'C', PICK(41, 51, 52, 58, 40));
        break;
    }
}

static void add_command(char *text, size_t room, bool slow)
{
    char one[32];
    if (story_draw(34) < 20)
        draw_move(one, sizeof one, slow);
    else
        draw_control(one, sizeof one);
    size_t length = strlen(text);
    snprintf(text + length, room - length, "%s ", one);
}

static void add_text(struct action *action, bool slow)
{
    char text[STORY_TEXT_MAX] = "";
    unsigned luck = (unsigned)story_draw(20);
    if (luck < 3) {
        strcpy(text, "K");
    } else if (luck < 6) {
        strcpy(text, "C75");
    } else if (luck < 9) {
        snprintf(text, sizeof text, "V%u", PICK(90, 400, 1500, 9000));
    } else {
        if (luck < 12)
            strcpy(text, "\\ ");
        for (uint64_t left = 1 + story_draw(25); left > 0; left--)
            add_command(text, sizeof text, slow);
    }
    action->length = (uint16_t)strlen(text);
    memcpy(action->text, text, action->length);
}

/* What each motor starts with: all labels are there, and something moves. */
static void add_opening(struct action *action, bool slow)
{
    static const char *const fast_opening[] = {"S2000 V9000 A60000 F90 R", "A50000 F30 R F9 Y V3000 F25 Y R",
                                               "S1500 V2000 B25 L9 R E", "V16000 A60000 F40 Y Y Y R"};
    static const char *const slow_opening[] = {"F250 R", "F90 Y V500 Y R", "G+", "B700 R W20 D R"};
    char text[STORY_TEXT_MAX];
    snprintf(text, sizeof text, "@1 @2 @3 @4 T5%u %s ", (unsigned)(1 + story_draw(8)),
             (slow ? slow_opening : fast_opening)[story_draw(4)]);
    for (uint64_t left = 5 + story_draw(25); left > 0; left--)
        add_command(text, sizeof text, slow);
    action->length = (uint16_t)strlen(text);
    memcpy(action->text, text, action->length);
}

/* A whole request, sometimes with a byte wrong or missing. */
static void add_frame(struct action *action, bool slow)
{
    uint8_t message[STORY_TEXT_MAX];
    size_t length = 2;
    message[0] = (uint8_t)PICK(1, 2, 2, 2, 4, 4, 5, 6, 6, 7, 7, 9);
    message[1] = (uint8_t)('0' + story_draw(5));
    if (message[0] == 2) {
        struct action program;
        add_text(&program, slow);
        length += program.length < 150 ? program.length : 150;
        memcpy(message + 2, program.text, length - 2);
    }
    struct rkm04_sender sender;
    size_t n = rkm04_hdlc.begin(&sender, story_draw(8) ? 1 : 0, 0, length, false, action->text);
    for (size_t i = 0; i < length; i++)
        n += rkm04_hdlc.put(&sender, message[i], action->text + n);
    n += rkm04_hdlc.end(&sender, action->text + n);
    if (story_draw(10) == 0)
        action->text[story_draw(n)] ^= 4;
    action->length = (uint16_t)(story_draw(10) ? n : 1 + story_draw(n));
}

static int by_tick(const void *a, const void *b)
{
    uint64_t x = ((const struct action *)a)->tick, y = ((const struct action *)b)->tick;
    return x < y ? -1 : x > y;
}

static uint8_t one_of_two(void)
{
    return story_draw(3) == 0;
}

static void draw_readings(struct rkm04_readings *readings)
{
    *readings = (struct rkm04_readings){
        .label = one_of_two(),
        .fault_exit = one_of_two(),
        .hold_exit = one_of_two(),
        .x_after = one_of_two(),
        .guard_start = one_of_two(),
        .v_alone = one_of_two(),
        .y_eleventh = one_of_two(),
        .reset_t41 = one_of_two(),
        .negative_position = one_of_two(),
        .input_filter = (uint8_t)(one_of_two() * (1 + story_draw(8))),
        .speed_change = readings->speed_change,
        .planning = (uint16_t)(one_of_two() * (1 + story_draw(8))),
        .store_time = (uint16_t)(one_of_two() * (1 + story_draw(8))),
    };
}

void story_tell(struct story *story, unsigned seed, uint64_t end, bool slow)
{
    memset(story, 0, sizeof *story);
    seed_dice(seed);
    story->seed = seed;
    story->end = end;
    story->readings.speed_change = story_draw(3) ? 0 : (uint16_t)(1 + story_draw(end / 3 / MS));
    if (seed % 2 != 0)
        draw_readings(&story->readings);
    story->count = (unsigned)(8 + story_draw(STORY_ACTIONS_MAX - 8));
    for (unsigned i = 0; i < story->count; i++) {
        struct action *action = &story->action[i];
        action->kind = (int)PICK(ACT_INPUTS, ACT_TEXT, ACT_FRAME, ACT_FRAME, ACT_DRAIN, ACT_DRAIN);
        action->tick = i < 4 ? 0 : story_draw(end);
        if (story_draw(3) == 0)
            action->tick -= action->tick % MS; /* at the tick of a slot */
        action->motor = (char)('1' + (i < 4 ? i : story_draw(4)));
        action->inputs = (uint8_t)story_draw(16);
        action->bytes = (unsigned)(1 + story_draw(60));
        if (i < 4)
            action->kind = ACT_TEXT;
        if (i < 4)
            add_opening(action, slow);
        else if (action->kind == ACT_TEXT)
            add_text(action, slow);
        else if (action->kind == ACT_FRAME)
            add_frame(action, slow);
    }
    for (unsigned i = 1; i < story->count; i++) /* stable, so that equal ticks keep their order */
        for (unsigned k = i; k > 0 && by_tick(&story->action[k], &story->action[k - 1]) < 0; k--) {
            struct action other = story->action[k];
            story->action[k] = story->action[k - 1];
            story->action[k - 1] = other;
        }
}

/* ---- Running ---------------------------------------------------------------------------------------------------- */

void run_begin(struct run *run, const struct story *story)
{
    recorder_clear(&run->record);
    run->wired = 0;
    run->next = 0;
    run->dice = story->seed + 77;
    rkm04_init(&run->unit, &(struct rkm04_config){.node = 1, .readings = story->readings}, &recorder_port, &run->record);
}

void run_act(struct run *run, const struct action *action)
{
    switch (action->kind) {
    case ACT_INPUTS:
        rkm04_set_inputs(&run->unit, action->inputs);
        break;
    case ACT_TEXT:
        rkm04_set_command(&run->unit, action->motor, action->text, action->length, NULL);
        break;
    case ACT_FRAME: /* what is not taken is lost */
        rkm04_receive(&run->unit, action->text, action->length);
        break;
    case ACT_DRAIN:
        ck_assert_uint_lt(run->wired + action->bytes, STORY_WIRE_MAX);
        run->wired += rkm04_send(&run->unit, run->wire + run->wired, action->bytes);
        break;
    }
}

static void advance_to(struct run *run, uint64_t tick, enum pace pace)
{
    uint64_t now;
    while ((now = rkm04_now(&run->unit)) < tick) {
        uint64_t step = tick - now, event;
        switch (pace) {
        case PACE_TICK:
            step = 1;
            break;
        case PACE_MS:
            step = MS;
            break;
        case PACE_LEAPS:
            run->dice = run->dice * UINT64_C(6364136223846793005) + 1442695040888963407;
            step = 1 + (run->dice >> 33) % (run->dice >> 63 ? 300 : 30000);
            break;
        case PACE_EVENTS:
            event = rkm04_next_event(&run->unit);
            ck_assert_msg(event >= now, "the next event is in the past");
            step = event < tick ? event + 1 - now : tick - now;
            break;
        case PACE_WHOLE:
            break;
        }
        rkm04_advance(&run->unit, step < tick - now ? step : tick - now);
    }
}

void run_until(struct run *run, const struct story *story, uint64_t until, enum pace pace)
{
    while (run->next < story->count && story->action[run->next].tick < until) {
        advance_to(run, story->action[run->next].tick, pace);
        run_act(run, &story->action[run->next++]);
    }
    advance_to(run, until, pace);
}

/* ---- Comparing ------------------------------------------------------------------------------------------------------ */

static void compare_records(struct recorder *a, struct recorder *b, unsigned seed, const char *what)
{
    recorder_sort(a);
    recorder_sort(b);
    for (size_t i = 0; i < a->count && i < b->count; i++) {
        const struct record *x = &a->list[i], *y = &b->list[i];
        bool same = x->tick == y->tick && x->kind == y->kind && x->motor == y->motor && x->value == y->value &&
                    (x->kind != RECORD_EVENT || x->what == y->what);
        ck_assert_msg(same,
                      "seed %u, %s: record %zu is tick %llu kind %d motor %u event %d value %lld; "
                      "wanted tick %llu kind %d motor %u event %d value %lld",
                      seed, what, i, (unsigned long long)y->tick, y->kind, y->motor, y->what, (long long)y->value,
                      (unsigned long long)x->tick, x->kind, x->motor, x->what, (long long)x->value);
    }
    ck_assert_msg(a->count == b->count, "seed %u, %s: %zu records, not %zu", seed, what, b->count, a->count);
}

#define SAME(field) ck_assert_msg(a->field == b->field, "seed %u, %s: motor %u differs in " #field, seed, what, motor)

static void compare_motor(const struct rkm04_motor *a, const struct rkm04_motor *b, unsigned motor, unsigned seed,
                          const char *what)
{
    SAME(program.written); SAME(program.closed); SAME(next); SAME(fresh); SAME(loops); SAME(calls); SAME(count);
    SAME(position); SAME(start_speed); SAME(speed); SAME(acceleration); SAME(forward); SAME(segments);
    SAME(functions); SAME(keep); SAME(guard_m); SAME(guard_n); SAME(guard_x); SAME(state); SAME(fault); SAME(led);
    SAME(resume); SAME(pin_forward); SAME(pendings); SAME(change_speed); SAME(motion.moving);
    if (a->motion.moving) {
        SAME(motion.done); SAME(motion.total); SAME(motion.stopping); SAME(motion.ramp.next); SAME(motion.ramp.left);
        SAME(motion.ramp.slope); SAME(motion.profile.count); SAME(motion.mark);
    }
    for (unsigned i = 0; i < a->loops; i++) {
        SAME(loop[i].start);
        SAME(loop[i].left);
    }
    for (unsigned i = 0; i < a->calls; i++)
        SAME(call[i]);
    for (unsigned i = 0; i < RKM04_LABELS; i++)
        SAME(program.label[i]);
}

static size_t ask(const struct run *run, uint8_t number, unsigned motor, uint8_t *answer, size_t room)
{
    static struct rkm04_unit copy; /* questions change nothing in the unit that is asked */
    copy = run->unit;
    memset(&copy.answer, 0, sizeof copy.answer);
    copy.waiting = false;
    return rkm04_exchange(&copy, (const uint8_t[]){number, (uint8_t)('0' + motor)}, 2, answer, room);
}

static void compare_states(const struct run *a, const struct run *b, unsigned seed, const char *what)
{
    ck_assert_msg(a->wired == b->wired && memcmp(a->wire, b->wire, a->wired) == 0, "seed %u, %s: other answers", seed, what);
    ck_assert_uint_eq(rkm04_now(&a->unit), rkm04_now(&b->unit));
    ck_assert_msg(rkm04_outputs(&a->unit) == rkm04_outputs(&b->unit), "seed %u, %s: other outputs", seed, what);
    ck_assert_msg(rkm04_variables(&a->unit) == rkm04_variables(&b->unit), "seed %u, %s: other variables", seed, what);
    struct rkm04_counters x = rkm04_counters(&a->unit), y = rkm04_counters(&b->unit);
    ck_assert_msg(memcmp(&x, &y, sizeof x) == 0, "seed %u, %s: other line counters", seed, what);
    for (unsigned motor = 1; motor <= RKM04_MOTORS; motor++) {
        compare_motor(&a->unit.motor[motor - 1], &b->unit.motor[motor - 1], motor, seed, what);
        struct rkm04_motor_state s, t;
        ck_assert(rkm04_motor_state(&a->unit, motor, &s) && rkm04_motor_state(&b->unit, motor, &t));
        bool alike = s.steps == t.steps && s.speed == t.speed && s.index == t.index && s.lit == t.lit && s.stopping == t.stopping;
        ck_assert_msg(alike, "seed %u, %s: motor %u looks different", seed, what, motor);
        for (uint8_t number = 4; number <= 7; number++) {
            static uint8_t first[9300], second[9300];
            size_t n = ask(a, number, motor, first, sizeof first), m = ask(b, number, motor, second, sizeof second);
            ck_assert_msg(n == m && memcmp(first, second, n) == 0, "seed %u, %s: motor %u answers differently to %u", seed, what,
                          motor, number);
        }
    }
}

void run_compare(struct run *a, struct run *b, unsigned seed, const char *what)
{
    compare_records(&a->record, &b->record, seed, what);
    compare_states(a, b, seed, what);
}
