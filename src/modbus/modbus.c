/* SPDX-License-Identifier: MIT */
#include "modbus.h"

#define READ_AND_SINGLE 8u /* bytes of a request: address, function, two words, check value */
#define BLOCK_HEAD 7u      /* bytes before the data of functions 15 and 16; the last one counts the data */
#define CRC_BYTES 2u

uint16_t modbus_crc_update(uint16_t crc, uint8_t byte)
{
    unsigned x = (unsigned)crc ^ byte;
    for (unsigned i = 0; i < 8; i++)
        x = (x & 1u) != 0 ? x >> 1 ^ 0xA001u : x >> 1;
    return (uint16_t)x;
}

uint16_t modbus_crc(const uint8_t *bytes, size_t length)
{
    uint16_t crc = MODBUS_CRC_START;
    for (size_t i = 0; i < length; i++)
        crc = modbus_crc_update(crc, bytes[i]);
    return crc;
}

bool modbus_is_frame(const uint8_t *bytes, size_t length)
{
    return length >= MODBUS_FRAME_MIN && length <= MODBUS_FRAME_MAX && modbus_crc(bytes, length) == 0;
}

size_t modbus_append_crc(uint8_t *bytes, size_t length)
{
    uint16_t crc = modbus_crc(bytes, length);
    bytes[length] = (uint8_t)crc;
    bytes[length + 1u] = (uint8_t)(crc >> 8);
    return length + CRC_BYTES;
}

/* A frame whose byte at `at` counts the bytes that follow before the check value. */
static size_t counted(const uint8_t *bytes, size_t length, size_t at)
{
    if (length <= at)
        return 0;
    size_t whole = at + 1u + bytes[at] + CRC_BYTES;
    return whole <= MODBUS_FRAME_MAX ? whole : MODBUS_NO_LENGTH;
}

size_t modbus_request_length(const uint8_t *bytes, size_t length)
{
    if (length < 2)
        return 0;
    if (bytes[1] >= MODBUS_READ_COILS && bytes[1] <= MODBUS_WRITE_HOLDING)
        return READ_AND_SINGLE;
    if (bytes[1] == MODBUS_WRITE_COILS || bytes[1] == MODBUS_WRITE_REGISTERS)
        return counted(bytes, length, BLOCK_HEAD - 1u);
    return MODBUS_NO_LENGTH;
}

size_t modbus_answer_length(const uint8_t *bytes, size_t length)
{
    if (length < 2)
        return 0;
    if ((bytes[1] & MODBUS_IS_EXCEPTION) != 0)
        return 3u + CRC_BYTES;
    if (bytes[1] >= MODBUS_READ_COILS && bytes[1] <= MODBUS_READ_INPUT)
        return counted(bytes, length, 2);
    if (bytes[1] == MODBUS_WRITE_COIL || bytes[1] == MODBUS_WRITE_HOLDING || bytes[1] == MODBUS_WRITE_COILS ||
        bytes[1] == MODBUS_WRITE_REGISTERS)
        return READ_AND_SINGLE;
    return MODBUS_NO_LENGTH;
}

uint16_t modbus_word(const uint8_t *bytes)
{
    return (uint16_t)((unsigned)bytes[0] << 8 | bytes[1]);
}

void modbus_put_word(uint8_t *bytes, uint16_t word)
{
    bytes[0] = (uint8_t)(word >> 8);
    bytes[1] = (uint8_t)word;
}

size_t modbus_put_exception(uint8_t *bytes, uint8_t function, enum modbus_exception exception)
{
    bytes[0] = (uint8_t)(function | MODBUS_IS_EXCEPTION);
    bytes[1] = (uint8_t)exception;
    return 2;
}
