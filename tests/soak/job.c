/* SPDX-License-Identifier: MIT */
#include "job.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define LOOPS 8
#define CALLS 6
#define EXECUTED_MAX 20000u
#define SUBROUTINE 7 /* its label; others count from 10 on */

/* ---- Dice ----------------------------------------------------------------------------------------------------------- */

static uint64_t draw(struct dice *dice)
{
    dice->state += UINT64_C(0x9E3779B97F4A7C15); /* splitmix64 */
    uint64_t z = dice->state;
    z = (z ^ z >> 30) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ z >> 27) * UINT64_C(0x94D049BB133111EB);
    return z ^ z >> 31;
}

int64_t dice_roll(struct dice *dice, int64_t low, int64_t high)
{
    return low + (int64_t)(draw(dice) % (uint64_t)(high - low + 1));
}

int64_t dice_scale(struct dice *dice, int64_t low, int64_t high)
{
    double part = (double)(draw(dice) >> 11) / 9007199254740992.0;
    int64_t value = (int64_t)((double)low * pow((double)high / (double)low, part));
    return value < low ? low : value > high ? high : value;
}

bool dice_chance(struct dice *dice, unsigned percent)
{
    return draw(dice) % 100u < percent;
}

/* ---- Making --------------------------------------------------------------------------------------------------------- */

struct maker {
    struct job *job;
    struct dice *dice;
    unsigned motor;
    uint8_t labels; /* used */
    bool calls;     /* there will be a subroutine */
};

static void put(struct maker *maker, char op, int64_t argument)
{
    struct job *job = maker->job;
    if (job->count < JOB_OPS)
        job->op[job->count++] = (struct job_op){.op = op, .argument = (int32_t)argument};
}

static void put_move(struct maker *maker, char op)
{
    put(maker, op, dice_scale(maker->dice, 1, 60000));
}

static void put_parameter(struct maker *maker)
{
    switch (dice_roll(maker->dice, 0, 2)) {
    case 0:
        put(maker, 'S', dice_scale(maker->dice, JOB_SPEED_MIN, 2000));
        break;
    case 1:
        put(maker, 'V', dice_scale(maker->dice, JOB_SPEED_MIN, 16000));
        break;
    default:
        put(maker, 'A', dice_scale(maker->dice, 50, 60000));
        break;
    }
}

/* An output or a variable of this motor's own: DO m and m + 4, VAR 80 + 4 (m - 1) and the three after it. */
static int own(struct maker *maker)
{
    int motor = (int)maker->motor;
    return dice_chance(maker->dice, 40) ? motor + 4 * (int)dice_roll(maker->dice, 0, 1)
                                        : 76 + 4 * motor + (int)dice_roll(maker->dice, 0, 3);
}

static void put_compound(struct maker *maker)
{
    char way = dice_chance(maker->dice, 50) ? 'F' : 'B';
    for (int64_t segments = dice_roll(maker->dice, 1, 10); segments > 0; segments--) {
        if (dice_chance(maker->dice, 60))
            put_parameter(maker);
        put_move(maker, way);
        put(maker, 'Y', 0);
    }
    put(maker, 'R', 0);
}

/* A wait that is over at once, or a jump over something. */
static void put_flow(struct maker *maker)
{
    int variable = 76 + 4 * (int)maker->motor;
    bool high = dice_chance(maker->dice, 50);
    put(maker, high ? 'T' : 'C', variable);
    if (dice_chance(maker->dice, 40)) {
        put(maker, high ? 'O' : 'Z', variable);
        return;
    }
    uint8_t label = ++maker->labels;
    put(maker, 'I', variable);
    maker->job->op[maker->job->count - 1u].level = dice_chance(maker->dice, 50);
    maker->job->op[maker->job->count - 1u].label = label;
    put_move(maker, 'B');
    put(maker, 'R', 0);
    put(maker, '@', label);
}

static void put_body(struct maker *maker, int depth, int64_t items)
{
    struct dice *dice = maker->dice;
    for (; items > 0 && maker->job->count + 40u < JOB_OPS; items--)
        switch (dice_roll(dice, 0, 15)) {
        case 0:
        case 1:
        case 2:
            put_move(maker, dice_chance(dice, 50) ? 'F' : 'B');
            put(maker, 'R', 0);
            break;
        case 3:
            put(maker, dice_chance(dice, 50) ? 'R' : 'D', 0);
            break;
        case 4:
            put(maker, 'G', dice_scale(dice, 1, 50000));
            break;
        case 5:
            put(maker, dice_chance(dice, 60) ? 'H' : 'c', 0);
            break;
        case 6:
            put(maker, '=', dice_roll(dice, -30000, 30000));
            break;
        case 7:
        case 8:
            put(maker, 'W', dice_scale(dice, 1, 6000000));
            break;
        case 9:
            put(maker, dice_chance(dice, 50) ? 'T' : 'C', own(maker));
            break;
        case 10:
            put_compound(maker);
            break;
        case 11:
            put_flow(maker);
            break;
        case 12:
            if (maker->calls && depth < LOOPS)
                put(maker, '\'', SUBROUTINE);
            break;
        case 13:
            if (depth >= 4)
                break;
            put(maker, 'L', dice_roll(dice, 1, 5));
            put_body(maker, depth + 1, dice_roll(dice, 1, 4));
            put(maker, 'E', 0);
            break;
        default:
            put_parameter(maker);
            break;
        }
}

static void write_text(struct job *job)
{
    size_t at = 0;
    for (unsigned i = 0; i < job->count; i++) {
        const struct job_op *op = &job->op[i];
        const char *blank = i > 0 ? " " : "";
        char *text = job->text + at;
        size_t room = JOB_TEXT - at;
        if (op->op == 'I')
            at += (size_t)snprintf(text, room, "%sI%02d%c%u", blank, (int)op->argument, op->level ? 'H' : 'L', op->label);
        else if (op->op == 'c')
            at += (size_t)snprintf(text, room, "%sC100", blank);
        else if (strchr("TCOZ", op->op))
            at += (size_t)snprintf(text, room, "%s%c%02d", blank, op->op, (int)op->argument);
        else if (strchr("RDHEY.", op->op))
            at += (size_t)snprintf(text, room, "%s%c", blank, op->op);
        else
            at += (size_t)snprintf(text, room, "%s%c%d", blank, op->op, (int)op->argument);
    }
    job->text[at] = '\0';
}

void job_make(struct job *job, struct dice *dice, unsigned motor, const struct job_state *state, int64_t steps, uint64_t ticks)
{
    struct job_way way;
    struct job_state end;
    do {
        struct maker maker = {.job = job, .dice = dice, .motor = motor, .labels = 10, .calls = dice_chance(dice, 30)};
        *job = (struct job){0};
        if (maker.calls) {
            put(&maker, 'J', 5);
            put(&maker, '@', SUBROUTINE);
            maker.calls = false; /* it does not call itself */
            put_body(&maker, 4, dice_roll(dice, 1, 4));
            put(&maker, '.', 0);
            put(&maker, '@', 5);
            maker.calls = true;
        }
        put_parameter(&maker);
        put_body(&maker, 0, dice_roll(dice, 1, 12));
        end = *state;
    } while (!job_run(job, &end, steps, ticks, &way));
    write_text(job);
}

/* ---- The model ------------------------------------------------------------------------------------------------------ */

struct run {
    const struct job *job;
    struct job_state *state;
    struct job_way *way;
    unsigned next;
    int64_t count, table; /* of the next R; of the Y table, both with their sign */
    unsigned segments;
    struct {
        unsigned start;
        int32_t left;
        unsigned level;
    } loop[LOOPS];
    unsigned call[CALLS];
    unsigned loops, calls;
};

static unsigned label(const struct job *job, int32_t number)
{
    for (unsigned i = 0; i < job->count; i++)
        if (job->op[i].op == '@' && job->op[i].argument == number)
            return i;
    return job->count;
}

static void move(struct run *run, int64_t steps)
{
    struct job_way *way = run->way;
    int64_t distance = steps < 0 ? -steps : steps;
    run->state->position += steps;
    way->steps += distance;
    way->ticks += (uint64_t)distance * 1000000u / JOB_SPEED_MIN + 2000u;
    way->lowest = run->state->position < way->lowest ? run->state->position : way->lowest;
    way->highest = run->state->position > way->highest ? run->state->position : way->highest;
}

static void set_position(struct run *run, int64_t position)
{
    run->state->position = position;
    move(run, 0);
}

static void perform(struct run *run)
{
    move(run, run->segments > 0 ? run->table : run->count);
    run->segments = 0;
    run->table = 0;
}

static void set_bit(struct run *run, int32_t number, bool on)
{
    uint32_t bit = number >= 80 ? UINT32_C(1) << (number - 80) : UINT32_C(1) << (number - 1);
    if (number >= 80)
        run->state->variables = (uint16_t)(on ? run->state->variables | bit : run->state->variables & ~bit);
    else
        run->state->outputs = (uint8_t)(on ? run->state->outputs | bit : run->state->outputs & ~bit);
}

static void loop_end(struct run *run)
{
    if (--run->loop[run->loops - 1u].left > 0)
        run->next = run->loop[run->loops - 1u].start + 1u;
    else
        run->loops--;
}

static void flow(struct run *run, const struct job_op *op)
{
    switch (op->op) {
    case 'L':
        run->loop[run->loops].start = run->next - 1u;
        run->loop[run->loops++].left = op->argument;
        break;
    case 'E':
        loop_end(run);
        break;
    case 'J':
        run->next = label(run->job, op->argument);
        break;
    case 'I':
        if (((run->state->variables >> (op->argument - 80)) & 1) == op->level)
            run->next = label(run->job, op->label);
        break;
    case '\'':
        run->call[run->calls++] = run->next;
        run->next = label(run->job, op->argument);
        break;
    case '.':
        run->next = run->call[--run->calls];
        break;
    default:
        break;
    }
}

static void execute(struct run *run, const struct job_op *op)
{
    switch (op->op) {
    case 'F':
        run->count = op->argument;
        break;
    case 'B':
        run->count = -(int64_t)op->argument;
        break;
    case 'D':
        run->count = -run->count;
        break;
    case 'R':
        perform(run);
        break;
    case 'Y':
        run->segments++;
        run->table += run->count;
        break;
    case 'G':
        run->count = op->argument - run->state->position;
        move(run, run->count);
        break;
    case 'H':
        move(run, -run->state->position);
        break;
    case 'c':
        set_position(run, 0);
        break;
    case '=':
        set_position(run, op->argument);
        break;
    case 'W':
        run->way->ticks += (uint64_t)op->argument * 1000u;
        break;
    case 'T':
    case 'C':
        set_bit(run, op->argument, op->op == 'T');
        break;
    default:
        flow(run, op);
        break;
    }
}

bool job_run(const struct job *job, struct job_state *state, int64_t steps, uint64_t ticks, struct job_way *way)
{
    struct run run = {.job = job, .state = state, .way = way};
    *way = (struct job_way){.lowest = state->position, .highest = state->position};
    for (unsigned executed = 0; run.next < job->count; executed++) {
        if (executed > EXECUTED_MAX || way->steps > steps || way->ticks > ticks)
            return false;
        way->ticks += 1000;
        execute(&run, &job->op[run.next++]);
    }
    return way->steps <= steps && way->ticks <= ticks;
}
