/* SPDX-License-Identifier: MIT */
#include <rkm04/unit.h>

#include "interp.h"
#include "motion.h"
#include "program.h"
#include "prt.h"
#include "ramp.h"
#include "reading.h"
#include "report.h"
#include "store.h"

_Static_assert(sizeof(struct rkm04_unit) - RKM04_MESSAGE_MAX + 1024 <= 24 * 1024,
               "a unit with requests of 1024 bytes has to fit into 24 KiB of a small microcontroller");

static const struct rkm04_framing *framing_of(const struct rkm04_unit *unit)
{
    return unit->config.framing ? unit->config.framing : &rkm04_hdlc;
}

void rkm04_init(struct rkm04_unit *unit, const struct rkm04_config *config, const struct rkm04_port *port, void *context)
{
    /* Byte by byte, not from a second unit on the stack: a unit is large, and memset() is not ours to ask for. */
    uint8_t *byte = (uint8_t *)unit;
    for (size_t i = 0; i < sizeof *unit; i++)
        byte[i] = 0;
    unit->config = *config;
    unit->port = port;
    unit->context = context;
    for (unsigned i = 0; i < RKM04_MOTORS; i++) {
        struct rkm04_motor *motor = &unit->motor[i];
        motor->motion.ramp.next = RKM04_NEVER;
        interp_reset(unit, motor);
        motor->slot = (uint8_t)store_load(port, context, i + 1, &motor->program);
        if (motor->program.written > 0) {
            interp_note_stored(unit, motor, 0);
            unit->touched = true;
        }
    }
}

uint64_t rkm04_now(const struct rkm04_unit *unit)
{
    return unit->now;
}

/* ---- Time (section 2) --------------------------------------------------------------------------------------------------- */

/* The next slot in which a motor's turn has something to do. */
static uint64_t next_slot(const struct rkm04_unit *unit)
{
    if (unit->touched)
        return interp_slot(unit->now);
    uint64_t slot = RKM04_NEVER;
    for (unsigned i = 0; i < RKM04_MOTORS; i++)
        if (unit->motor[i].wake < slot)
            slot = unit->motor[i].wake;
    return slot;
}

uint64_t rkm04_next_event(const struct rkm04_unit *unit)
{
    uint64_t next = next_slot(unit);
    for (unsigned i = 0; i < RKM04_MOTORS; i++)
        if (unit->motor[i].motion.ramp.next < next)
            next = unit->motor[i].motion.ramp.next;
    return next < unit->now ? unit->now : next;
}

uint64_t rkm04_next_report(const struct rkm04_unit *unit)
{
    uint64_t next = next_slot(unit);
    for (unsigned i = 0; i < RKM04_MOTORS; i++) {
        uint64_t report = motion_next_report(unit, &unit->motor[i]);
        next = report < next ? report : next;
    }
    return next < unit->now ? unit->now : next;
}

/* All pulses due up to and including `limit`. Between slots motors meet in one thing only, the outputs that their pulses set
 * (C12): those come in order of time. */
static void run_motors(struct rkm04_unit *unit, uint64_t limit)
{
    for (unsigned i = 0; i < RKM04_MOTORS; i++)
        motion_run(unit, &unit->motor[i], limit);
    for (;;) {
        struct rkm04_motor *first = NULL;
        for (unsigned i = 0; i < RKM04_MOTORS; i++) {
            struct rkm04_motor *motor = &unit->motor[i];
            if (motion_mark_due(motor) <= limit && (!first || motion_mark_due(motor) < motion_mark_due(first)))
                first = motor;
        }
        if (!first)
            return;
        motion_pass_mark(unit, first);
        motion_run(unit, first, limit);
    }
}

/* What a slot begins with. As long as something is counted here, the next slot has its turn, too. */
static void begin_slot(struct rkm04_unit *unit)
{
    bool counting = unit->busy > 0;
    if (counting)
        unit->busy--;
    if (unit->touched) {
        unsigned changed = unit->inputs ^ unit->seen;
        uint8_t *differs = unit->differs;
        for (unsigned bit = 1; bit < 1u << RKM04_INPUTS; bit <<= 1, differs++) {
            unsigned slots = *differs;
            *differs = 0;
            if ((changed & bit) != 0 && slots < READING(unit, input_filter)) {
                *differs = (uint8_t)(slots + 1);
                changed -= bit;
                counting = true;
            }
        }
        unit->seen = (uint8_t)(unit->seen ^ changed);
    }
    unit->touched = counting;
}

void rkm04_advance(struct rkm04_unit *unit, uint64_t ticks)
{
    uint64_t end = unit->now > RKM04_NEVER - ticks ? RKM04_NEVER : unit->now + ticks;
    while (unit->now < end) {
        uint64_t slot = next_slot(unit);
        bool reached = slot < end;
        run_motors(unit, reached ? slot : end - 1);
        if (reached) {
            unit->now = slot;
            begin_slot(unit);
            for (unsigned i = 0; i < RKM04_MOTORS; i++)
                interp_turn(unit, &unit->motor[i]);
        }
        unit->now = reached ? slot + 1 : end;
    }
}

void rkm04_set_inputs(struct rkm04_unit *unit, uint8_t mask)
{
    unit->touched = unit->touched || unit->inputs != mask;
    unit->inputs = mask;
}

/* ---- Line (section 4) --------------------------------------------------------------------------------------------------- */

/* Is the frame in the buffer a request for this unit? Answers of other units, recognised by SNode 1..16, are not (L1). */
static bool is_for(const struct rkm04_unit *unit)
{
    const struct rkm04_receiver *receiver = &unit->receiver;
    if (receiver->snode >= 1 && receiver->snode <= RKM04_NODE_MAX)
        return false;
    return receiver->dnode == 0 || receiver->dnode == unit->config.node;
}

static void handle_message(struct rkm04_unit *unit)
{
    unit->waiting = false;
    unit->counters.requests++;
    prt_handle(unit, unit->message, unit->receiver.length, unit->receiver.snode, unit->receiver.dnode == 0);
}

size_t rkm04_receive(struct rkm04_unit *unit, const uint8_t *bytes, size_t length)
{
    const struct rkm04_framing *framing = framing_of(unit);
    for (size_t i = 0; i < length; i++) {
        if (unit->waiting)
            return i;
        if (!framing->receive(&unit->receiver, bytes[i], unit->now, unit->message, sizeof unit->message))
            continue;
        if (!is_for(unit))
            unit->counters.others++;
        else if (unit->answer.kind != 0)
            unit->waiting = true;
        else
            handle_message(unit);
    }
    return length;
}

enum phase { PHASE_BEGIN, PHASE_BODY, PHASE_END };

/* Encode the next piece of the answer into answer->out. */
static void encode(struct rkm04_unit *unit)
{
    const struct rkm04_framing *framing = framing_of(unit);
    struct rkm04_answer *answer = &unit->answer;
    size_t length = 0;
    uint8_t byte;
    if (answer->phase == PHASE_BEGIN) {
        size_t whole = prt_answer_length(unit, answer);
        length = framing->begin(&unit->sender, answer->to, unit->config.node, whole, true, answer->out);
        answer->phase = PHASE_BODY;
    } else if (answer->phase == PHASE_BODY && prt_answer_byte(unit, answer, &byte)) {
        length = framing->put(&unit->sender, byte, answer->out);
    } else if (answer->phase == PHASE_BODY) {
        length = framing->end(&unit->sender, answer->out);
        answer->phase = PHASE_END;
    } else {
        answer->kind = 0;
        unit->counters.answers++;
    }
    answer->out_at = 0;
    answer->out_length = (uint8_t)length;
}

/* Have something in answer->out, unless the answer is out; then the request that waited has its turn (P10). */
static void fill_answer(struct rkm04_unit *unit)
{
    struct rkm04_answer *answer = &unit->answer;
    while (answer->kind != 0 && answer->out_at == answer->out_length)
        encode(unit);
}

bool rkm04_sending(const struct rkm04_unit *unit)
{
    return unit->answer.kind != 0 && unit->busy == 0;
}

size_t rkm04_send(struct rkm04_unit *unit, uint8_t *bytes, size_t room)
{
    struct rkm04_answer *answer = &unit->answer;
    size_t n = 0;
    for (;;) {
        fill_answer(unit);
        if (answer->kind == 0) {
            if (!unit->waiting)
                break;
            handle_message(unit);
            continue;
        }
        if (n == room || unit->busy > 0)
            break;
        bytes[n++] = answer->out[answer->out_at++];
    }
    return n;
}

/* ---- Without a line ----------------------------------------------------------------------------------------------------- */

int rkm04_set_command(struct rkm04_unit *unit, char motor, const void *text, size_t length, uint8_t *character)
{
    uint8_t unused;
    return prt_set_command(unit, (uint8_t)motor, text, length, character ? character : &unused);
}

size_t rkm04_exchange(struct rkm04_unit *unit, const uint8_t *message, size_t length, uint8_t *answer, size_t room)
{
    size_t n = 0;
    uint8_t byte;
    prt_handle(unit, message, length, 0, false);
    if (length == 0)
        return 0;
    while (prt_answer_byte(unit, &unit->answer, &byte)) {
        if (n < room)
            answer[n] = byte;
        n++;
    }
    unit->answer.kind = 0;
    return n;
}

/* ---- What can be seen ----------------------------------------------------------------------------------------------------- */

static bool is_lit(const struct rkm04_unit *unit, const struct rkm04_motor *motor)
{
    const uint64_t half = RKM04_TICKS_PER_SECOND / 2;
    if (motor->led == RKM04_LED_BLINK)
        return (unit->now - motor->blink_from) / half % 2 == 0;
    return motor->led == RKM04_LED_ON;
}

bool rkm04_motor_state(const struct rkm04_unit *unit, unsigned number, struct rkm04_motor_state *state)
{
    if (number < 1 || number > RKM04_MOTORS)
        return false;
    const struct rkm04_motor *motor = &unit->motor[number - 1];
    const struct rkm04_motion *motion = &motor->motion;
    *state = (struct rkm04_motor_state){
        .position = motor->position,
        .steps = motion->kind == RKM04_MOTION_NONE ? 0 : motion->done,
        .index = (uint16_t)interp_index(motor),
        .commands = (uint16_t)program_count(&motor->program),
        .state = (enum rkm04_state)motor->state,
        .fault = (enum rkm04_fault)motor->fault,
        .led = (enum rkm04_led)motor->led,
        .lit = is_lit(unit, motor),
        .stopping = motion->moving && motion->stopping,
        .forward = motor->pin_forward && !unit->simulation,
        .slot = (enum rkm04_slot)motor->slot,
    };
    if (motion->moving) {
        struct rkm04_fixed y, w;
        ramp_state_at(&motion->ramp, unit->now, &y, &w);
        state->speed = (uint32_t)(w.whole / ramp_speed_unit(&motion->ramp));
    }
    return true;
}

uint8_t rkm04_inputs(const struct rkm04_unit *unit)
{
    return unit->inputs;
}

uint8_t rkm04_outputs(const struct rkm04_unit *unit)
{
    return unit->simulation ? 0 : unit->outputs;
}

uint16_t rkm04_variables(const struct rkm04_unit *unit)
{
    return unit->variables;
}

struct rkm04_counters rkm04_counters(const struct rkm04_unit *unit)
{
    struct rkm04_counters counters = unit->counters;
    counters.dropped = unit->receiver.bad_check + unit->receiver.malformed + unit->receiver.too_long;
    return counters;
}

const char *rkm04_state_name(enum rkm04_state state)
{
    static const char *const name[] = {"idle", "ready", "moving", "dwell", "wait", "block", "held", "ended", "fault"};
    return (unsigned)state < sizeof name / sizeof *name ? name[state] : "unknown";
}

const char *rkm04_fault_name(enum rkm04_fault fault)
{
    static const char *const name[] = {"none",        "no_label", "loop_levels", "no_loop",
                                       "call_levels", "no_call",  "overwritten", "motion"};
    return (unsigned)fault < sizeof name / sizeof *name ? name[fault] : "unknown";
}

const char *rkm04_led_name(enum rkm04_led led)
{
    static const char *const name[] = {"off", "on", "blink"};
    return (unsigned)led < sizeof name / sizeof *name ? name[led] : "unknown";
}
