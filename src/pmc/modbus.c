/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "modbus/modbus.h"
#include "modbus_map.h"
#include "reply.h"

#define BITS_PER_BYTE 10u
#define FAST_BAUD 19200u      /* above: fixed times */
#define FAST_SILENCE 14000u   /* ticks: 1.75 ms */
#define FAST_GAP 6000u        /* ticks: 750 us */
#define BROADCAST 0u
#define BROADCAST_2 128u        /* AB1 */
#define READ_MAX 125u
#define WRITE_MAX 123u
#define BLOCK_ADDRESS 1u
#define BLOCK_WORDS 9u
#define READ_LENGTH 5u        /* bytes of function and data, without address and check value */
#define WRITE_HEAD 6u         /* of function 16, before its words */

/* ---- Bytes of a frame ---------------------------------------------------------------------------------------------------- */

/* Ticks of `halves` half characters, rounded up to a us, as bytes are dated. */
static uint64_t character_ticks(uint32_t baud, unsigned halves)
{
    uint64_t us = (halves * BITS_PER_BYTE * UINT64_C(500000) + baud - 1u) / baud;
    return us * PMC_TICKS_PER_US;
}

static uint64_t silence_ticks(uint32_t baud)
{
    return baud > FAST_BAUD ? FAST_SILENCE : character_ticks(baud, 7);
}

/* The silence that ends a frame, and the time between the ends of two bytes of one at most: 1.5 characters and the second one. */
static uint64_t gap_ticks(uint32_t baud)
{
    return baud > FAST_BAUD ? FAST_GAP + character_ticks(baud, 2) : character_ticks(baud, 5);
}

enum addressee { NO_ONE, OTHERS, ALL, THIS_UNIT };

/* Whom does the frame address? NO_ONE: it is no frame. */
static enum addressee addressee_of(const struct pmc_unit *unit)
{
    const struct pmc_modbus *modbus = &unit->face.modbus;
    uint8_t address = modbus->frame[0];
    if (modbus->is_spoilt || !modbus_is_frame(modbus->frame, modbus->length))
        return NO_ONE;
    if (address == BROADCAST || address == BROADCAST_2)
        return ALL;
    return address == unit->config.address ? THIS_UNIT : OTHERS;
}

static enum modbus_exception exception_of(enum pmc_answer answer)
{
    switch (answer) {
    case PMC_OK:
        return MODBUS_NO_EXCEPTION;
    case PMC_BUSY:
        return MODBUS_DEVICE_BUSY;
    case PMC_STORE_FAILED:
        return MODBUS_DEVICE_FAILURE;
    default:
        return MODBUS_ILLEGAL_VALUE;
    }
}

/* ---- Commands (AB4) ------------------------------------------------------------------------------------------------------ */

/* A start that is right otherwise is refused while `emg` is active (AB2, AL4). */
static enum pmc_answer start(struct pmc_unit *unit, const struct pmc_request *request)
{
    enum pmc_answer answer = pmc_check(unit, request);
    if (answer != PMC_OK)
        return answer;
    return pmc_emergency(unit) ? PMC_BUSY : pmc_request(unit, request);
}

static enum pmc_answer ask(struct pmc_unit *unit, enum pmc_request_kind kind, unsigned axes)
{
    return pmc_request(unit, &(struct pmc_request){.kind = (uint8_t)kind, .axes = (uint8_t)axes});
}

/* Are these bits of axes that the unit has, one at least? */
static bool are_axes(const struct pmc_unit *unit, unsigned axes)
{
    return axes != 0 && axes >> unit->config.axes == 0;
}

/* 20 X+, 10 X-, 02 Y+, 01 Y-. */
static enum pmc_answer jog(struct pmc_unit *unit, uint8_t digits)
{
    struct pmc_request request = {.kind = PMC_JOG};
    for (unsigned axis = 0; axis < PMC_AXES; axis++) {
        unsigned minus = 0x10u >> 4u * axis, plus = 2u * minus, named = digits & (minus | plus);
        if (named == (minus | plus))
            return PMC_RANGE;
        request.axes |= (uint8_t)((named != 0 ? 1u : 0u) << axis);
        request.value[axis] = named == plus ? 1 : -1;
        digits = (uint8_t)(digits & ~named);
    }
    return digits == 0 && are_axes(unit, request.axes) ? start(unit, &request) : PMC_RANGE;
}

/* The fifth speed becomes one of V1-V4: X in the high, Y in the low digit, 0 none. */
static enum pmc_answer choose_speed(struct pmc_unit *unit, uint8_t digits)
{
    const unsigned number[PMC_AXES] = {digits >> 4, digits & 15u};
    struct pmc_request request = {.kind = PMC_SET_SPEED};
    for (unsigned axis = 0; axis < PMC_AXES; axis++) {
        if (number[axis] == 0)
            continue;
        if (number[axis] > 4)
            return PMC_RANGE;
        request.axes |= (uint8_t)(1u << axis);
        request.value[axis] =
            pmc_parameter(&unit->axis[axis].parameters, (enum pmc_parameter)(PMC_SPEED1 + number[axis] - 1u));
    }
    return are_axes(unit, request.axes) ? pmc_request(unit, &request) : PMC_RANGE;
}

/* 01 X, 02 Y with a ramp, 10 X, 20 Y at once. */
static enum pmc_answer stop(struct pmc_unit *unit, uint8_t digits)
{
    unsigned slow = digits & 15u, at_once = digits >> 4;
    if (!are_axes(unit, slow | at_once) || (slow & at_once) != 0)
        return PMC_RANGE;
    if (slow != 0) /* stops are always taken */
        (void)ask(unit, PMC_STOP, slow);
    if (at_once != 0)
        (void)ask(unit, PMC_STOP_NOW, at_once);
    return PMC_OK;
}

/* 01 X, 02 Y commanded, 10 X, 20 Y actual counter. */
static enum pmc_answer clear_counters(struct pmc_unit *unit, uint8_t digits)
{
    unsigned commanded = digits & 15u, actual = digits >> 4;
    if (!are_axes(unit, commanded | actual))
        return PMC_RANGE;
    for (unsigned axis = 0; axis < unit->config.axes; axis++) {
        const unsigned requests = (commanded >> axis & 1u) + (actual >> axis & 1u);
        if (requests > 0 && (pmc_is_busy(unit, axis) || unit->axis[axis].pendings + requests > PMC_PENDING_MAX))
            return PMC_BUSY;
    }
    if (commanded != 0)
        (void)ask(unit, PMC_CLEAR_COMMANDED, commanded);
    if (actual != 0)
        (void)ask(unit, PMC_CLEAR_ACTUAL, actual);
    return PMC_OK;
}

/* X, then Y. */
static enum pmc_answer store(struct pmc_unit *unit, unsigned axes)
{
    enum pmc_answer answer = PMC_OK;
    for (unsigned axis = 0; axis < unit->config.axes; axis++)
        if ((axes & 1u << axis) != 0 && pmc_is_busy(unit, axis))
            return PMC_BUSY;
    for (unsigned axis = 0; axis < unit->config.axes && answer == PMC_OK; axis++)
        if ((axes & 1u << axis) != 0)
            answer = pmc_store(unit, axis);
    return answer;
}

/* Commands for axes 01 X, 02 Y, 03 both. */
static enum pmc_answer execute_for_axes(struct pmc_unit *unit, uint8_t code, uint8_t axes)
{
    const uint8_t *reg = unit->start;
    if (!are_axes(unit, axes))
        return PMC_RANGE;
    switch (code) {
    case 0x06:
        return start(unit, &(struct pmc_request){.kind = PMC_SEARCH, .axes = axes});
    case 0x07:
        return start(unit, &(struct pmc_request){.kind = PMC_RUN, .axes = axes, .value = {reg[0], reg[1]}});
    case 0x08:
        return ask(unit, PMC_STOP_PROGRAM, axes);
    case 0x09:
        return ask(unit, PMC_CLEAR_ERRORS, axes);
    case 0x0B:
        return store(unit, axes);
    default:
        return PMC_RANGE;
    }
}

static enum pmc_answer execute_command(struct pmc_unit *unit, uint8_t code, uint8_t axes)
{
    switch (code) {
    case 0x01:
        return jog(unit, axes);
    case 0x04:
        return choose_speed(unit, axes);
    case 0x05:
        return stop(unit, axes);
    case 0x0A:
        return clear_counters(unit, axes);
    case 0x0C:
        return axes == 0 ? ask(unit, PMC_RESET, 0) : PMC_RANGE;
    default:
        return execute_for_axes(unit, code, axes);
    }
}

/* ---- Blocks (AB5) -------------------------------------------------------------------------------------------------------- */

/* Code and axes, then data: `count` words in all. The data of an axis not named is ignored. */
static enum pmc_answer execute_block(struct pmc_unit *unit, const uint8_t *words, unsigned count)
{
    static const struct {
        uint8_t code, count, kind;
    } blocks[] = {{0x61, 3, PMC_SET_SPEED}, {0x71, 5, PMC_MOVE_TO}, {0x72, 5, PMC_MOVE_BY}};
    struct pmc_request request = {.axes = words[1]};
    if (!are_axes(unit, words[1]))
        return PMC_RANGE;
    for (unsigned i = 0; i < sizeof blocks / sizeof *blocks; i++) {
        if (words[0] != blocks[i].code || count != blocks[i].count)
            continue;
        bool is_speed = blocks[i].kind == PMC_SET_SPEED;
        request.kind = blocks[i].kind;
        for (unsigned axis = 0; axis < PMC_AXES; axis++)
            request.value[axis] = is_speed ? modbus_word(words + 2u + 2u * axis) : pmc_signed_words(words + 2u + 4u * axis);
        return is_speed ? pmc_request(unit, &request) : start(unit, &request);
    }
    return PMC_RANGE;
}

/* ---- Functions (AB2): they return an exception, or the answer is in the request ------------------------------------------ */

struct request {
    struct pmc_unit *unit;
    const uint8_t *data; /* function, address, ... */
    size_t length;
    uint8_t *answer;     /* function, ...; may be the same memory */
    size_t made;         /* bytes of the answer */
};

static enum modbus_exception read_registers(struct request *request)
{
    bool is_input = request->data[0] == MODBUS_READ_INPUT;
    if (request->length != READ_LENGTH)
        return MODBUS_ILLEGAL_VALUE;
    uint16_t address = modbus_word(request->data + 1), count = modbus_word(request->data + 3);
    if (count < 1 || count > READ_MAX)
        return MODBUS_ILLEGAL_VALUE;
    for (unsigned i = 0; i < count; i++) {
        unsigned at = address + i;
        if (at > UINT16_MAX)
            return MODBUS_ILLEGAL_ADDRESS;
        struct pmc_place place = pmc_holding_place(request->unit, (uint16_t)at);
        bool is_there = is_input ? pmc_has_input(request->unit, (uint16_t)at)
                                 : place.kind != PMC_PLACE_NONE && place.kind != PMC_PLACE_BLOCK;
        if (!is_there)
            return MODBUS_ILLEGAL_ADDRESS;
    }
    request->answer[1] = (uint8_t)(2u * count);
    for (unsigned i = 0; i < count; i++) {
        uint16_t at = (uint16_t)(address + i);
        struct pmc_place place = pmc_holding_place(request->unit, at);
        uint16_t word = is_input ? pmc_read_input(request->unit, at) : pmc_read_holding(request->unit, &place);
        modbus_put_word(request->answer + 2u + 2u * i, word);
    }
    request->made = 2u + 2u * count;
    return MODBUS_NO_EXCEPTION;
}

/* What may be written by registers: whole values of parameters, speeds, starts and program registers. */
static bool is_value(const struct pmc_place *place)
{
    return place->kind >= PMC_PLACE_PARAMETER;
}

/* Is the range made of whole values? */
static bool are_values(const struct pmc_unit *unit, uint16_t address, unsigned count)
{
    for (unsigned i = 0; i < count;) {
        if (address + i > UINT16_MAX)
            return false;
        struct pmc_place place = pmc_holding_place(unit, (uint16_t)(address + i));
        if (!is_value(&place) || place.word != 0 || i + place.words > count)
            return false;
        i += place.words;
    }
    return true;
}

/* Can nothing be written there now? A fifth speed waits for the slot, and the queue may be full. */
static bool is_busy(const struct pmc_unit *unit, const struct pmc_place *place)
{
    const struct pmc_request speed = {.kind = PMC_SET_SPEED, .axes = (uint8_t)(1u << place->axis), .value = {1, 1}};
    if (place->kind == PMC_PLACE_SPEED)
        return pmc_check(unit, &speed) != PMC_OK;
    return place->kind != PMC_PLACE_START && pmc_is_busy(unit, place->axis);
}

static enum modbus_exception check_values(const struct pmc_unit *unit, uint16_t address, unsigned count, const uint8_t *words)
{
    enum modbus_exception exception = MODBUS_NO_EXCEPTION;
    for (unsigned i = 0; i < count;) {
        const struct pmc_place place = pmc_holding_place(unit, (uint16_t)(address + i));
        if (!pmc_is_holding_value(&place, words + 2u * i))
            return MODBUS_ILLEGAL_VALUE;
        if (is_busy(unit, &place))
            exception = MODBUS_DEVICE_BUSY;
        i += place.words;
    }
    return exception;
}

/* Write values that have been checked. */
static void write_values(struct pmc_unit *unit, uint16_t address, unsigned count, const uint8_t *words)
{
    for (unsigned i = 0; i < count;) {
        const struct pmc_place place = pmc_holding_place(unit, (uint16_t)(address + i));
        (void)pmc_write_holding(unit, &place, words + 2u * i);
        i += place.words;
    }
}

static enum modbus_exception write_range(struct request *request, uint16_t address, unsigned count, const uint8_t *words)
{
    if (address == 0 && count == 1)
        return exception_of(execute_command(request->unit, words[0], words[1]));
    if (address == BLOCK_ADDRESS && count <= BLOCK_WORDS)
        return exception_of(execute_block(request->unit, words, count));
    if (!are_values(request->unit, address, count))
        return MODBUS_ILLEGAL_ADDRESS;
    enum modbus_exception exception = check_values(request->unit, address, count, words);
    if (exception == MODBUS_NO_EXCEPTION)
        write_values(request->unit, address, count, words);
    return exception;
}

static enum modbus_exception write_one(struct request *request)
{
    if (request->length != READ_LENGTH)
        return MODBUS_ILLEGAL_VALUE;
    uint16_t address = modbus_word(request->data + 1);
    if (address == BLOCK_ADDRESS)
        return MODBUS_ILLEGAL_ADDRESS; /* blocks come whole */
    enum modbus_exception exception = write_range(request, address, 1, request->data + 3);
    memmove(request->answer, request->data, READ_LENGTH);
    request->made = READ_LENGTH;
    return exception;
}

static enum modbus_exception write_several(struct request *request)
{
    if (request->length < WRITE_HEAD)
        return MODBUS_ILLEGAL_VALUE;
    uint16_t address = modbus_word(request->data + 1), count = modbus_word(request->data + 3);
    if (count < 1 || count > WRITE_MAX || request->data[5] != 2u * count || request->length != WRITE_HEAD + 2u * count)
        return MODBUS_ILLEGAL_VALUE;
    enum modbus_exception exception = write_range(request, address, count, request->data + WRITE_HEAD);
    memmove(request->answer, request->data, READ_LENGTH);
    request->made = READ_LENGTH;
    return exception;
}

static void execute_function(struct request *request)
{
    enum modbus_exception exception = MODBUS_ILLEGAL_FUNCTION;
    uint8_t function = request->data[0];
    if (function == MODBUS_READ_HOLDING || function == MODBUS_READ_INPUT)
        exception = read_registers(request);
    else if (function == MODBUS_WRITE_HOLDING)
        exception = write_one(request);
    else if (function == MODBUS_WRITE_REGISTERS)
        exception = write_several(request);
    request->answer[0] = function;
    if (exception != MODBUS_NO_EXCEPTION)
        request->made = modbus_put_exception(request->answer, function, exception);
}

/* ---- The line ----------------------------------------------------------------------------------------------------------- */

static bool is_between_frames(const struct pmc_modbus *modbus)
{
    return modbus->length == 0 && !modbus->is_spoilt;
}

static uint64_t due(const struct pmc_unit *unit)
{
    const struct pmc_modbus *modbus = &unit->face.modbus;
    return is_between_frames(modbus) ? PMC_NEVER : modbus->last + silence_ticks(pmc_baud(unit));
}

/* Execute the frame; the answer takes its place. Returns its length. */
static size_t execute_frame(struct pmc_unit *unit)
{
    struct pmc_modbus *modbus = &unit->face.modbus;
    struct request request = {
        .unit = unit, .data = modbus->frame + 1, .length = modbus->length - 3u, .answer = modbus->frame + 1};
    execute_function(&request);
    return modbus_append_crc(modbus->frame, 1u + request.made);
}

static void end_frame(struct pmc_unit *unit)
{
    struct pmc_modbus *modbus = &unit->face.modbus;
    struct pmc_counters *counters = &modbus->reply.counters;
    size_t answer = 0;
    switch (addressee_of(unit)) {
    case NO_ONE:
        counters->dropped++;
        break;
    case OTHERS:
        counters->others++;
        break;
    case ALL:
        counters->requests++;
        (void)execute_frame(unit);
        break;
    default:
        counters->requests++;
        answer = execute_frame(unit);
        break;
    }
    modbus->length = 0;
    modbus->is_spoilt = false;
    pmc_reply_begin(unit, answer);
}

static void act(struct pmc_unit *unit)
{
    if (due(unit) <= pmc_now(unit))
        end_frame(unit);
}

static size_t receive(struct pmc_unit *unit, const uint8_t *bytes, size_t length)
{
    struct pmc_modbus *modbus = &unit->face.modbus;
    uint64_t now = pmc_now(unit);
    act(unit);
    if (modbus->reply.length > 0)
        return 0;
    for (size_t i = 0; i < length; i++) {
        if (!is_between_frames(modbus) && now - modbus->last > gap_ticks(pmc_baud(unit)))
            modbus->is_spoilt = true;
        if (modbus->length < PMC_FRAME_MAX)
            modbus->frame[modbus->length++] = bytes[i];
        else
            modbus->length = PMC_FRAME_MAX + 1;
        modbus->last = now;
    }
    return length;
}

static size_t send(struct pmc_unit *unit, uint8_t *bytes, size_t room)
{
    act(unit);
    return pmc_reply_take(unit, unit->face.modbus.frame, bytes, room);
}

static bool has_answer(const struct pmc_unit *unit)
{
    return unit->face.reply.length > 0;
}

const struct pmc_face pmc_modbus_face = {
    .name = "modbus", .receive = receive, .send = send, .has_answer = has_answer, .due = due, .act = act};

void pmc_modbus_lose_byte(struct pmc_unit *unit)
{
    act(unit);
    unit->face.modbus.is_spoilt = true;
    unit->face.modbus.last = pmc_now(unit);
}

size_t pmc_modbus_exchange(struct pmc_unit *unit, const uint8_t *message, size_t length, uint8_t *answer, size_t room)
{
    uint8_t made[PMC_FRAME_MAX] = {0};
    struct request request = {.unit = unit, .data = message, .length = length, .answer = made};
    if (length == 0)
        return 0;
    execute_function(&request);
    memcpy(answer, made, request.made < room ? request.made : room);
    return request.made;
}
