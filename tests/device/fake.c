/* SPDX-License-Identifier: MIT */
#include "fake.h"

#include <string.h>

#define LIMIT_SWITCH 1u
#define MARK 0x46 /* flash: a rate follows */
#define TICKS_PER_S (1000000u * FAKE_TICKS_PER_US)

static void end_motion(struct fake_unit *unit)
{
    unit->due = FAKE_NEVER;
    unit->left = 0;
    unit->calls->motion(unit->context, unit->now, false);
}

static void set_limit(struct fake_unit *unit, bool hit)
{
    if (unit->limit != hit)
        unit->calls->limit(unit->context, unit->now, hit);
    unit->limit = hit;
}

static void begin_motion(struct fake_unit *unit, int32_t steps)
{
    bool forward = steps > 0;
    set_limit(unit, false);
    if (unit->forward != forward)
        unit->calls->direction(unit->context, unit->now, forward);
    if (unit->due == FAKE_NEVER)
        unit->calls->motion(unit->context, unit->now, true);
    unit->forward = forward;
    unit->left = (uint32_t)(forward ? steps : -steps);
    unit->done = 0;
    unit->due = unit->now + TICKS_PER_S / unit->rate;
}

static void step(struct fake_unit *unit)
{
    unit->now = unit->due;
    unit->position = (int32_t)((uint32_t)unit->position + (unit->forward ? 1u : UINT32_MAX));
    unit->done++;
    unit->due += TICKS_PER_S / unit->rate;
    unit->calls->step(unit->context, unit->now, unit->position, unit->forward);
    if (--unit->left == 0)
        end_motion(unit);
}

void fake_advance(struct fake_unit *unit, uint64_t ticks)
{
    uint64_t end = unit->now + ticks;
    while (unit->due < end)
        step(unit);
    unit->now = end;
}

uint64_t fake_end(const struct fake_unit *unit)
{
    return unit->due == FAKE_NEVER ? FAKE_NEVER : unit->due + (uint64_t)(unit->left - 1) * (TICKS_PER_S / unit->rate);
}

void fake_set_inputs(struct fake_unit *unit, uint32_t mask)
{
    unit->inputs = mask & ((1u << FAKE_INPUTS) - 1u);
    if ((mask & LIMIT_SWITCH) == 0 || unit->due == FAKE_NEVER || !unit->forward)
        return;
    end_motion(unit);
    set_limit(unit, true);
}

static bool read_number(const char *text, int32_t low, int32_t high, int32_t *number)
{
    bool minus = *text == '-';
    int32_t value = 0;
    text += minus;
    if (*text == '\0')
        return false;
    for (; *text >= '0' && *text <= '9' && value <= FAKE_MOVE_MAX; text++)
        value = value * 10 + (*text - '0');
    *number = minus ? -value : value;
    return *text == '\0' && *number >= low && *number <= high;
}

static const char *write_number(struct fake_unit *unit, int32_t number)
{
    char *to = unit->answer + FAKE_TEXT_MAX;
    uint32_t value = number < 0 ? 0u - (uint32_t)number : (uint32_t)number;
    *to = '\0';
    do
        *--to = (char)('0' + value % 10u);
    while ((value /= 10u) > 0);
    if (number < 0)
        *--to = '-';
    return to;
}

static const char *obey_move(struct fake_unit *unit, const char *argument)
{
    int32_t steps;
    if (!read_number(argument, -FAKE_MOVE_MAX, FAKE_MOVE_MAX, &steps) || steps == 0)
        return "E2";
    if (steps > 0 && (unit->inputs & LIMIT_SWITCH) != 0)
        return "E3";
    begin_motion(unit, steps);
    return "OK";
}

static const char *obey_save(struct fake_unit *unit)
{
    const uint8_t data[4] = {MARK, (uint8_t)(unit->rate >> 8), (uint8_t)unit->rate, 0};
    return unit->calls->save(unit->context, data) ? "OK" : "E4";
}

static const char *obey_stop(struct fake_unit *unit)
{
    set_limit(unit, false);
    if (unit->due != FAKE_NEVER)
        end_motion(unit);
    return "OK";
}

static const char *obey_output(struct fake_unit *unit, bool on)
{
    if (unit->output != on)
        unit->calls->output(unit->context, unit->now, on);
    unit->output = on;
    return "OK";
}

const char *fake_obey(struct fake_unit *unit, const char *text)
{
    int32_t number;
    if (strcmp(text, "POS?") == 0)
        return write_number(unit, unit->position);
    if (strcmp(text, "IN?") == 0)
        return write_number(unit, (int32_t)unit->inputs);
    if (strncmp(text, "MOVE ", 5) == 0)
        return obey_move(unit, text + 5);
    if (strcmp(text, "STOP") == 0)
        return obey_stop(unit);
    if (strcmp(text, "SAVE") == 0)
        return obey_save(unit);
    if (strncmp(text, "OUT ", 4) == 0)
        return read_number(text + 4, 0, 1, &number) ? obey_output(unit, number == 1) : "E2";
    if (strcmp(text, "ZERO") == 0) {
        unit->position = 0;
        unit->calls->position(unit->context, unit->now, 0);
        return "OK";
    }
    if (strncmp(text, "RATE ", 5) != 0)
        return "E1";
    if (!read_number(text + 5, 1, FAKE_RATE_MAX, &number))
        return "E2";
    unit->rate = (uint16_t)number;
    return "OK";
}

static void answer_request(struct fake_unit *unit)
{
    unit->requests++;
    unit->text[unit->length] = '\0';
    const char *answer = fake_obey(unit, unit->text);
    uint8_t sum = 0;
    unit->answer_length = (uint8_t)strlen(answer);
    memmove(unit->answer, answer, unit->answer_length);
    for (unsigned i = 0; i < unit->answer_length; i++)
        sum = (uint8_t)(sum + (uint8_t)unit->answer[i]);
    unit->answer[unit->answer_length++] = unit->silent ? (char)sum : '\r';
    unit->answer_sent = 0;
}

static void end_request(struct fake_unit *unit)
{
    unit->frames++;
    if (unit->addressed)
        answer_request(unit);
    unit->addressed = false;
}

/* The silence is over: the last byte was the check byte. */
static void end_silence(struct fake_unit *unit)
{
    uint8_t check = unit->length > 0 ? (uint8_t)unit->text[unit->length - 1u] : 0;
    unit->addressed = unit->addressed && unit->length > 0 && (uint8_t)(unit->sum - check) == check;
    if (unit->length > 0)
        unit->length--;
    unit->silence = FAKE_NEVER;
    end_request(unit);
}

/* A byte of a request that ends with a silence. The first one is the address. */
static void gather_byte(struct fake_unit *unit, uint8_t byte)
{
    if (unit->silence == FAKE_NEVER) {
        unit->addressed = byte == 0x80 + unit->address;
        unit->length = unit->sum = 0;
    } else if (unit->length <= FAKE_TEXT_MAX) {
        unit->text[unit->length++] = (char)byte;
    } else {
        unit->addressed = false;
    }
    unit->sum = (uint8_t)(unit->sum + byte);
    unit->silence = unit->now + FAKE_SILENCE * FAKE_TICKS_PER_US;
}

static void receive_byte(struct fake_unit *unit, uint8_t byte)
{
    if (unit->silent) {
        gather_byte(unit, byte);
    } else if (byte >= 0x80) {
        unit->addressed = byte == 0x80 + unit->address;
        unit->length = 0;
    } else if (byte == '\r') {
        end_request(unit);
    } else if (unit->length < FAKE_TEXT_MAX) {
        unit->text[unit->length++] = (char)byte;
    } else {
        unit->addressed = false;
    }
}

size_t fake_receive(struct fake_unit *unit, const uint8_t *bytes, size_t length)
{
    size_t taken = 0;
    if (length == 0 && unit->silence <= unit->now)
        end_silence(unit);
    for (; taken < length && unit->answer_length == 0; taken++)
        receive_byte(unit, bytes[taken]);
    return taken;
}

size_t fake_send(struct fake_unit *unit, uint8_t *bytes, size_t room)
{
    size_t sent = 0;
    while (sent < room && unit->answer_sent < unit->answer_length)
        bytes[sent++] = (uint8_t)unit->answer[unit->answer_sent++];
    if (unit->answer_length > 0 && unit->answer_sent == unit->answer_length) {
        unit->answers++;
        unit->answer_length = unit->answer_sent = 0;
    }
    return sent;
}

void fake_begin(struct fake_unit *unit, uint8_t address, const struct fake_calls *calls, void *context)
{
    uint8_t data[4];
    *unit = (struct fake_unit){.calls = calls, .context = context, .due = FAKE_NEVER, .silence = FAKE_NEVER, .rate = 100,
                               .address = address, .forward = true};
    bool is_read = calls->load(context, data) && data[0] == MARK;
    unsigned rate = is_read ? data[1] * 256u + data[2] : 0;
    if (rate >= 1 && rate <= FAKE_RATE_MAX)
        unit->rate = (uint16_t)rate;
}
