/* SPDX-License-Identifier: MIT */
#include "device/rkm04_device.h"
#include "soak.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define JOB_STEPS 100000          /* of a job at most */
#define JOB_TIME (21600u * SECOND) /* likewise */
#define SLACK (2u * SECOND)       /* turns, requests between the pieces of a program */
#define PIECE 300u                /* characters of a program, where it comes in pieces */

static struct rkm04_motor_state motor_state(struct soak *soak, unsigned unit, unsigned motor)
{
    struct rkm04_motor_state state = {0};
    rkm04_motor_state(rkm04_of(sim_core(&soak->sim, unit + 1u)), motor + 1u, &state);
    return state;
}

void soak_command(struct soak *soak, const char *method, const char *format, ...)
{
    char text[600];
    struct refusal refusal;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    json_t *params = json_loads(text, 0, NULL);
    json_t *result = params ? sim_command(&soak->sim, method, params, &refusal) : NULL;
    if (!result)
        soak_fail(soak, "%s %s: %s", method, text, params ? refusal.text : "no JSON");
    json_decref(params);
    json_decref(result);
}

static void pass(struct soak *soak, uint64_t ticks)
{
    sim_advance(&soak->sim, sim_now(&soak->sim) + ticks);
}

/* ---- Jobs ----------------------------------------------------------------------------------------------------------- */

/* What the job does, from where the motor will be. */
static void foresee(struct soak *soak, struct soak_motor *motor, const struct job_state *begin)
{
    motor->end = *begin;
    motor->pulses = 0;
    if (!job_run(&motor->job, &motor->end, INT64_MAX, UINT64_MAX / 2u, &motor->way))
        soak_fail(soak, "a job too long: %s", motor->job.text);
    motor->done = sim_now(&soak->sim) + motor->way.ticks + SLACK;
}

/* A program, in one piece or several. */
static void give_text(struct soak *soak, unsigned unit, char motor, const char *text)
{
    char piece[JOB_TEXT + 2] = "\\";
    bool cut = dice_chance(&soak->dice, 30);
    while (*text != '\0') {
        size_t length = strlen(text);
        if (cut && length > PIECE) {
            length = (size_t)dice_roll(&soak->dice, 1, PIECE);
            while (text[length] != '\0' && text[length] != ' ')
                length++;
        }
        strncat(piece, text, length);
        host_set(soak, unit, motor, piece, 0, 0);
        text += length;
        piece[0] = '\0';
    }
}

static void give_job(struct soak *soak, unsigned unit, unsigned motor)
{
    struct soak_motor *m = &soak->unit[unit].motor[motor];
    struct job_state begin = m->end;
    if (motor_state(soak, unit, motor).state != RKM04_IDLE)
        return; /* where it would stop cannot be known */
    job_make(&m->job, &soak->dice, motor + 1u, &begin, JOB_STEPS, JOB_TIME);
    m->pulses = 0;
    foresee(soak, m, &begin);
    give_text(soak, unit, (char)('1' + motor), m->job.count > 0 ? m->job.text : " ");
    m->done = sim_now(&soak->sim) + m->way.ticks + SLACK;
    soak->jobs++;
    soak->steps_done += (uint64_t)m->way.steps;
}

/* Stop and resume: it does the same, later. */
static void hold(struct soak *soak, unsigned unit)
{
    unsigned motor = (unsigned)dice_roll(&soak->dice, 0, RKM04_MOTORS - 1);
    uint64_t begin = sim_now(&soak->sim);
    host_set(soak, unit, (char)('1' + motor), "K", 0, 0);
    pass(soak, (uint64_t)dice_scale(&soak->dice, 1, 3 * SECOND));
    host_poll(soak, unit);
    host_set(soak, unit, (char)('1' + motor), "{ go on } C75", 0, 0);
    uint64_t ramp = 16000 * SECOND / 50; /* the longest */
    soak->unit[unit].motor[motor].done += sim_now(&soak->sim) - begin + ramp;
}

static void store(struct soak *soak, unsigned unit)
{
    unsigned motor = (unsigned)dice_roll(&soak->dice, 0, RKM04_MOTORS); /* 0: all */
    size_t length = host_ask(soak, unit, (uint8_t[]){3, (uint8_t)('0' + motor)}, 2);
    if (length != 3 || soak->answer[0] != 3 || soak->answer[1] != '0' + motor || soak->answer[2] != 0)
        soak_fail(soak, "unit %u: Store Flash %u is answered with error %u", unit + 1u, motor, soak->answer[2]);
    for (unsigned i = 0; i < RKM04_MOTORS; i++)
        if (motor == 0 || motor == i + 1u)
            soak->unit[unit].motor[i].slot = soak->unit[unit].motor[i].job;
    soak->stores++;
}

/* Something happens to a unit, or is asked of it; time continues. */
static void act(struct soak *soak, unsigned unit)
{
    pass(soak, (uint64_t)dice_scale(&soak->dice, 1, 120 * SECOND));
    switch (dice_roll(&soak->dice, 0, 19)) {
    case 0:
        hold(soak, unit);
        break;
    case 1:
        store(soak, unit);
        break;
    case 2:
        sim_set_di(&soak->sim, unit + 1u, (uint8_t)dice_roll(&soak->dice, 0, 255));
        break;
    case 3:
        give_job(soak, unit, (unsigned)dice_roll(&soak->dice, 0, RKM04_MOTORS - 1));
        break;
    default:
        host_poll(soak, unit);
        break;
    }
}

static void count_pulse(void *context, const struct watch_event *event)
{
    struct soak *soak = context;
    soak->unit[event->unit - 1u].motor[event->motor - 1u].pulses++;
}

void round_jobs(struct soak *soak)
{
    if (dice_chance(&soak->dice, 20)) {
        soak_settle(soak);
        soak->watched = true;
        for (unsigned i = 0; i < UNITS * RKM04_MOTORS; i++) {
            struct soak_motor *motor = &soak->unit[i / RKM04_MOTORS].motor[i % RKM04_MOTORS];
            motor->pulses = motor->way.steps = 0;
        }
        soak->steps = (struct watcher){.kinds = WATCH_BIT(WATCH_STEP), .on_event = count_pulse, .context = soak};
        sim_watch(&soak->sim, &soak->steps);
    }
    unsigned percent = (unsigned)dice_roll(&soak->dice, 1, 60);
    for (unsigned unit = 0; unit < UNITS; unit++)
        for (unsigned motor = 0; motor < RKM04_MOTORS; motor++)
            if (dice_chance(&soak->dice, percent))
                give_job(soak, unit, motor);
    for (int64_t acts = dice_scale(&soak->dice, 5, 200); acts > 0; acts--)
        act(soak, (unsigned)dice_roll(&soak->dice, 0, UNITS - 1));
    if (soak->watched || dice_chance(&soak->dice, 70))
        soak_settle(soak);
    if (soak->watched)
        sim_unwatch(&soak->sim, &soak->steps);
    soak->watched = false;
}

/* ---- Ends ----------------------------------------------------------------------------------------------------------- */

static void check_unit(struct soak *soak, unsigned unit)
{
    uint8_t outputs = 0;
    uint16_t variables = 0;
    for (unsigned i = 0; i < RKM04_MOTORS; i++) {
        const struct soak_motor *motor = &soak->unit[unit].motor[i];
        struct rkm04_motor_state state = motor_state(soak, unit, i);
        if (state.state != RKM04_IDLE || state.fault != RKM04_FAULT_NONE)
            soak_fail(soak, "unit %u, motor %u is %s (%s) at place %u, long after it should have done %s", unit + 1u, i + 1u,
                      rkm04_state_name(state.state), rkm04_fault_name(state.fault), state.index, motor->job.text);
        if (soak->watched && motor->pulses != motor->way.steps)
            soak_fail(soak, "unit %u, motor %u: %" PRId64 " pulses, expected %" PRId64 " of %s", unit + 1u, i + 1u, motor->pulses,
                      motor->way.steps, motor->job.text);
        outputs |= motor->end.outputs;
        variables |= motor->end.variables;
    }
    struct rkm04_unit *core = rkm04_of(sim_core(&soak->sim, unit + 1u));
    if (rkm04_outputs(core) != outputs || rkm04_variables(core) != variables)
        soak_fail(soak, "unit %u: outputs %02X, variables %04X; expected %02X, %04X", unit + 1u, rkm04_outputs(core),
                  rkm04_variables(core), outputs, variables);
    host_check_ends(soak, unit);
}

static bool busy(struct soak *soak, uint64_t *done)
{
    bool is = false;
    for (unsigned i = 0; i < UNITS * RKM04_MOTORS; i++) {
        if (motor_state(soak, i / RKM04_MOTORS, i % RKM04_MOTORS).state == RKM04_IDLE)
            continue;
        uint64_t end = soak->unit[i / RKM04_MOTORS].motor[i % RKM04_MOTORS].done;
        *done = end > *done ? end : *done;
        is = true;
    }
    return is;
}

void soak_settle(struct soak *soak)
{
    uint64_t done = 0;
    while (busy(soak, &done) && sim_now(&soak->sim) < done)
        pass(soak, 10 * SECOND);
    pass(soak, 2000); /* what was under way when a motor went idle */
    for (unsigned unit = 0; unit < UNITS; unit++)
        check_unit(soak, unit);
    counters_check(soak);
    counters_begin(soak);
}

/* ---- Power ---------------------------------------------------------------------------------------------------------- */

void soak_powered_up(struct soak *soak, unsigned unit)
{
    struct soak_unit *u = &soak->unit[unit];
    for (unsigned i = 0; i < RKM04_MOTORS; i++) {
        u->motor[i].job = u->motor[i].slot;
        foresee(soak, &u->motor[i], &(struct job_state){0});
    }
    u->begin = (struct rkm04_counters){0};
    u->requests = u->answers = u->others = u->dropped = 0;
}

void round_power(struct soak *soak)
{
    for (int64_t times = dice_roll(&soak->dice, 1, 8); times > 0; times--) {
        unsigned unit = (unsigned)dice_roll(&soak->dice, 0, UNITS - 1);
        pass(soak, (uint64_t)dice_scale(&soak->dice, 1, 5 * SECOND));
        if (dice_chance(&soak->dice, 50)) {
            soak_command(soak, "reset", "{\"unit\":%u}", unit + 1u);
        } else {
            soak_command(soak, "power", "{\"unit\":%u,\"on\":false}", unit + 1u);
            pass(soak, (uint64_t)dice_scale(&soak->dice, 1, 60 * SECOND));
            soak_command(soak, "power", "{\"unit\":%u,\"on\":true}", unit + 1u);
        }
        soak_powered_up(soak, unit);
        soak->resets++;
        for (int64_t polls = dice_roll(&soak->dice, 0, 8); polls > 0; polls--)
            host_poll(soak, unit);
    }
}

/* ---- Garbage -------------------------------------------------------------------------------------------------------- */

static void all_drop(struct soak *soak, uint32_t frames)
{
    for (unsigned i = 0; i < UNITS; i++)
        soak->unit[i].dropped += frames;
}

static void pass_by(struct soak *soak, const uint8_t *bytes, size_t length)
{
    soak->heard = 0;
    soak->garbage++;
    host_send(soak, bytes, length);
    host_finish(soak);
    pass(soak, 10000);
    if (soak->heard > 0)
        soak_fail(soak, "unit %u answers garbage", soak->receiver.snode);
}

/* Nothing but noise between two flags: counted as the framing has it, by itself. */
static void noise(struct soak *soak)
{
    uint8_t bytes[600], message[sizeof bytes];
    struct rkm04_receiver receiver = {0};
    size_t length = (size_t)dice_scale(&soak->dice, 1, 590);
    bytes[0] = bytes[length + 1u] = 0x7E;
    for (size_t i = 1; i <= length; i++)
        bytes[i] = (uint8_t)dice_roll(&soak->dice, 0, 255);
    for (size_t i = 0; i < length + 2u; i++)
        if (rkm04_hdlc.receive(&receiver, bytes[i], 0, message, sizeof message))
            return; /* by chance no noise at all */
    all_drop(soak, receiver.bad_check + receiver.malformed);
    pass_by(soak, bytes, length + 2u);
}

/* A frame that one bit makes wrong. */
static void wrong_check(struct soak *soak)
{
    uint8_t frame[64];
    size_t length = host_frame((uint8_t)dice_roll(&soak->dice, 0, 16), 0, "\2" "0\\ F100 R", 11, frame);
    frame[3 + dice_roll(&soak->dice, 0, 10)] ^= 1;
    all_drop(soak, 1);
    pass_by(soak, frame, length);
}

static void too_long(struct soak *soak)
{
    static uint8_t frame[RKM04_MESSAGE_MAX + 20];
    memset(frame, ' ', sizeof frame);
    frame[0] = frame[sizeof frame - 1u] = 0x7E;
    all_drop(soak, 1);
    pass_by(soak, frame, sizeof frame);
}

/* Broadcasts without a pause; they do nothing. */
static void flood(struct soak *soak)
{
    static const struct {
        const char *message;
        size_t length;
    } idle[] = {{"\1", 1}, {"\4" "0", 2}, {"\5" "1", 2}, {"\2" "0", 2}, {"\2" "0{ nothing }", 13}, {"\2" "0C75", 5}, {"\11", 1}};
    uint8_t frame[64];
    for (int64_t count = dice_scale(&soak->dice, 10, 300); count > 0; count--) {
        size_t which = (size_t)dice_roll(&soak->dice, 0, sizeof idle / sizeof *idle - 1);
        host_send(soak, frame, host_frame(0, 0, idle[which].message, idle[which].length, frame));
        for (unsigned i = 0; i < UNITS; i++)
            soak->unit[i].requests++;
        soak->requests++;
    }
    pass_by(soak, NULL, 0);
}

/* For other units: nodes that no unit has, and answers of units. */
static void for_others(struct soak *soak)
{
    uint8_t frame[64];
    bool answer = dice_chance(&soak->dice, 50);
    uint8_t node = answer ? 0 : (uint8_t)dice_roll(&soak->dice, 17, 255);
    uint8_t snode = answer ? (uint8_t)dice_roll(&soak->dice, 1, 16) : 0;
    size_t length = host_frame(node, snode, "\2" "0\\ F100 R", 11, frame);
    for (unsigned i = 0; i < UNITS; i++)
        soak->unit[i].others++;
    pass_by(soak, frame, length);
}

void round_garbage(struct soak *soak)
{
    for (int64_t times = dice_scale(&soak->dice, 1, 30); times > 0; times--) {
        switch (dice_roll(&soak->dice, 0, 9)) {
        case 0:
            flood(soak);
            break;
        case 1:
            if (dice_chance(&soak->dice, 5))
                too_long(soak);
            break;
        case 2:
            all_drop(soak, 1);
            pass_by(soak, (const uint8_t *)"\x7E\x01\x00\x02\x30\x46\x35\x7D\x7E", 9); /* aborted */
            break;
        case 3:
            all_drop(soak, 1);
            pass_by(soak, (const uint8_t *)"\x7E\x01\x00\x01\x7E", 5); /* too short */
            break;
        case 4:
            pass_by(soak, (const uint8_t *)"\x7E\x7E\x7E\x7E", 4); /* nothing */
            break;
        case 5:
            for_others(soak);
            break;
        case 6:
        case 7:
            wrong_check(soak);
            break;
        default:
            noise(soak);
            break;
        }
        if (dice_chance(&soak->dice, 50))
            host_poll(soak, (unsigned)dice_roll(&soak->dice, 0, UNITS - 1));
    }
}
