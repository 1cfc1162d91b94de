/* SPDX-License-Identifier: MIT */
#include "pdu.h"

#define BITS_READ_MAX 2000u
#define BITS_WRITE_MAX 1968u
#define REGISTERS_READ_MAX 125u
#define REGISTERS_WRITE_MAX 123u

#define WRITE_HEAD 6u /* bytes before the values of functions 15 and 16 */

static size_t copy(uint8_t *to, const uint8_t *from, size_t length)
{
    for (size_t i = 0; i < length; i++)
        to[i] = from[i];
    return length;
}

bool cib_modbus_writes(uint8_t function)
{
    return function == MODBUS_WRITE_COIL || function == MODBUS_WRITE_HOLDING || function == MODBUS_WRITE_COILS ||
           function == MODBUS_WRITE_REGISTERS;
}

/* ---- One function each: the length of the answer, or 0 and an exception ------------------------------------------------ */

static size_t refuse(enum modbus_exception *exception, enum modbus_exception code)
{
    *exception = code;
    return 0;
}

static size_t read_bits(const struct cib_unit *unit, const uint8_t *request, size_t length, uint8_t *answer,
                        enum modbus_exception *exception)
{
    enum cib_zone zone = request[0] == MODBUS_READ_COILS ? CIB_OUTPUT_ZONE : CIB_INPUT_ZONE;
    unsigned first = length == 5 ? modbus_word(request + 1) : 0, count = length == 5 ? modbus_word(request + 3) : 0;
    if (count < 1 || count > BITS_READ_MAX)
        return refuse(exception, MODBUS_ILLEGAL_VALUE);
    if (first + count > (zone == CIB_OUTPUT_ZONE ? CIB_COILS : CIB_DISCRETE_INPUTS))
        return refuse(exception, MODBUS_ILLEGAL_ADDRESS);
    unsigned bits = (unsigned)cib_read_bits(unit, zone) >> first & ((1u << count) - 1u);
    answer[0] = request[0];
    answer[1] = (uint8_t)((count + 7u) / 8u);
    answer[2] = (uint8_t)(bits & 0xffu);
    answer[3] = (uint8_t)(bits >> 8);
    return 2u + answer[1];
}

static size_t read_registers(const struct cib_unit *unit, const uint8_t *request, size_t length, uint8_t *answer,
                             enum modbus_exception *exception)
{
    enum cib_zone zone = request[0] == MODBUS_READ_HOLDING ? CIB_OUTPUT_ZONE : CIB_INPUT_ZONE;
    unsigned first = length == 5 ? modbus_word(request + 1) : 0, count = length == 5 ? modbus_word(request + 3) : 0;
    if (count < 1 || count > REGISTERS_READ_MAX)
        return refuse(exception, MODBUS_ILLEGAL_VALUE);
    for (unsigned address = first; address < first + count; address++) {
        if (address > UINT16_MAX || !cib_has_register(zone, (uint16_t)address))
            return refuse(exception, MODBUS_ILLEGAL_ADDRESS);
        modbus_put_word(answer + 2u + 2u * (address - first), cib_read(unit, zone, (uint16_t)address));
    }
    answer[0] = request[0];
    answer[1] = (uint8_t)(2u * count);
    return 2u + 2u * count;
}

static size_t write_bits(struct cib_unit *unit, unsigned first, unsigned count, unsigned bits, enum modbus_exception *exception)
{
    if (first + count > CIB_COILS)
        return refuse(exception, MODBUS_ILLEGAL_ADDRESS);
    cib_write_coils(unit, (uint8_t)(((1u << count) - 1u) << first), (uint8_t)(bits << first & 0xffu));
    return 5;
}

static size_t write_words(struct cib_unit *unit, unsigned first, const uint16_t *value, unsigned count,
                          enum modbus_exception *exception)
{
    static const enum modbus_exception codes[] = {[CIB_DONE] = MODBUS_NO_EXCEPTION,
                                                  [CIB_NO_REGISTER] = MODBUS_ILLEGAL_ADDRESS,
                                                  [CIB_BAD_VALUE] = MODBUS_ILLEGAL_VALUE};
    *exception = first + count > UINT16_MAX + 1u ? MODBUS_ILLEGAL_ADDRESS : codes[cib_write(unit, (uint16_t)first, value, count)];
    return 5;
}

static size_t write_one(struct cib_unit *unit, const uint8_t *request, size_t length, enum modbus_exception *exception)
{
    unsigned first = length == 5 ? modbus_word(request + 1) : 0, value = length == 5 ? modbus_word(request + 3) : 0;
    uint16_t word = (uint16_t)value;
    if (length != 5 || (request[0] == MODBUS_WRITE_COIL && value != 0 && value != 0xff00u))
        return refuse(exception, MODBUS_ILLEGAL_VALUE);
    if (request[0] == MODBUS_WRITE_COIL)
        return write_bits(unit, first, 1, value != 0, exception);
    return write_words(unit, first, &word, 1, exception);
}

static size_t write_several(struct cib_unit *unit, const uint8_t *request, size_t length, enum modbus_exception *exception)
{
    bool coils = request[0] == MODBUS_WRITE_COILS;
    bool has_head = length > WRITE_HEAD;
    unsigned first = has_head ? modbus_word(request + 1) : 0, count = has_head ? modbus_word(request + 3) : 0;
    unsigned bytes = coils ? (count + 7u) / 8u : 2u * count;
    uint16_t value[REGISTERS_WRITE_MAX];
    if (count < 1 || count > (coils ? BITS_WRITE_MAX : REGISTERS_WRITE_MAX) || request[WRITE_HEAD - 1u] != bytes ||
        length != WRITE_HEAD + bytes)
        return refuse(exception, MODBUS_ILLEGAL_VALUE);
    if (coils)
        return write_bits(unit, first, count, request[WRITE_HEAD], exception);
    for (unsigned i = 0; i < count; i++)
        value[i] = (uint16_t)modbus_word(request + WRITE_HEAD + 2u * i);
    return write_words(unit, first, value, count, exception);
}

size_t cib_modbus(struct cib_unit *unit, const uint8_t *request, size_t length, uint8_t answer[MODBUS_PDU_MAX])
{
    enum modbus_exception exception = MODBUS_NO_EXCEPTION;
    size_t answered = 0;
    switch (request[0]) {
    case MODBUS_READ_COILS:
    case MODBUS_READ_DISCRETE:
        answered = read_bits(unit, request, length, answer, &exception);
        break;
    case MODBUS_READ_HOLDING:
    case MODBUS_READ_INPUT:
        answered = read_registers(unit, request, length, answer, &exception);
        break;
    case MODBUS_WRITE_COIL:
    case MODBUS_WRITE_HOLDING:
        answered = write_one(unit, request, length, &exception);
        break;
    case MODBUS_WRITE_COILS:
    case MODBUS_WRITE_REGISTERS:
        answered = write_several(unit, request, length, &exception);
        break;
    default:
        exception = MODBUS_ILLEGAL_FUNCTION;
        break;
    }
    if (exception != MODBUS_NO_EXCEPTION)
        return modbus_put_exception(answer, request[0], exception);
    return cib_modbus_writes(request[0]) ? copy(answer, request, answered) : answered;
}
