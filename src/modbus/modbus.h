/* SPDX-License-Identifier: MIT */
/* modbus.h: frames of Modbus RTU (MODBUS over Serial Line 1.02): check value, length, words, exceptions; requests of Modbus TCP.
 *
 * A frame is address, function, data, check value (low byte first); words in it have their high byte first. When a frame is over,
 * and what its registers mean, is the device's business. */
#ifndef RKM04_MODBUS_MODBUS_H
#define RKM04_MODBUS_MODBUS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define MODBUS_FRAME_MIN 4u /* bytes: address, function, check value */
#define MODBUS_FRAME_MAX 256u
#define MODBUS_ADDRESS_MAX 247u
#define MODBUS_CRC_START 0xFFFFu /* value before the first byte */
#define MODBUS_IS_EXCEPTION 0x80u /* bit of the function code in an answer that refuses */

enum modbus_function {
    MODBUS_READ_COILS = 1,
    MODBUS_READ_DISCRETE = 2,
    MODBUS_READ_HOLDING = 3,
    MODBUS_READ_INPUT = 4,
    MODBUS_WRITE_COIL = 5,
    MODBUS_WRITE_HOLDING = 6,
    MODBUS_WRITE_COILS = 15,
    MODBUS_WRITE_REGISTERS = 16
};

enum modbus_exception {
    MODBUS_NO_EXCEPTION = 0,
    MODBUS_ILLEGAL_FUNCTION = 1,
    MODBUS_ILLEGAL_ADDRESS = 2,
    MODBUS_ILLEGAL_VALUE = 3,
    MODBUS_DEVICE_FAILURE = 4,
    MODBUS_DEVICE_BUSY = 6,
    MODBUS_NO_TARGET = 11
};

/* Take one byte into the running check value `crc` (reflected polynomial A001). Returns the new value. */
uint16_t modbus_crc_update(uint16_t crc, uint8_t byte);

/* The check value of `length` bytes. For "123456789" it is 4B37. */
uint16_t modbus_crc(const uint8_t *bytes, size_t length);

/* Is it a frame: MODBUS_FRAME_MIN..MODBUS_FRAME_MAX bytes with a correct check value? */
bool modbus_is_frame(const uint8_t *bytes, size_t length);

/* Append the check value to `length` bytes; there is room for two more. Returns the length with it. */
size_t modbus_append_crc(uint8_t *bytes, size_t length);

/* Bytes of a whole request, check value included, whose first `length` bytes are there: as its function prescribes. Returns 0 if
 * they do not say yet; MODBUS_NO_LENGTH if no length follows from the function, or one above MODBUS_FRAME_MAX. */
#define MODBUS_NO_LENGTH SIZE_MAX
size_t modbus_request_length(const uint8_t *bytes, size_t length);

/* The same of an answer. */
size_t modbus_answer_length(const uint8_t *bytes, size_t length);

/* A word, high byte first. */
uint16_t modbus_word(const uint8_t *bytes);
void modbus_put_word(uint8_t *bytes, uint16_t word);

/* Make the function code and data of a refusal of `function`, after the address. Returns their length. */
size_t modbus_put_exception(uint8_t *bytes, uint8_t function, enum modbus_exception exception);

/* ---- Modbus TCP: modbus_tcp.c --------------------------------------------------------------------------------------
 *
 *     transaction, protocol 0, length: two bytes each; unit; then function and data
 */

#define MODBUS_TCP_HEAD 7u
#define MODBUS_TCP_UNIT 6u /* where the unit is in the head */
#define MODBUS_PDU_MAX 253u /* bytes of function and data */
#define MODBUS_TCP_MAX (MODBUS_TCP_HEAD + MODBUS_PDU_MAX) /* bytes of a request or answer */

/* The request of a client that comes in: plain data, zero at the begin. */
struct modbus_tcp {
    uint16_t length; /* bytes so far */
    uint8_t frame[MODBUS_TCP_MAX];
};

enum modbus_tcp_result {
    MODBUS_TCP_MORE,  /* the request is not whole yet */
    MODBUS_TCP_WHOLE, /* function and data are `length - MODBUS_TCP_HEAD` bytes, one at least, after the head */
    MODBUS_TCP_WRONG  /* it is not Modbus TCP: the connection is to be closed, and nothing more taken */
};

/* Take a byte of a client. A whole request must be ended by modbus_tcp_answer(). */
enum modbus_tcp_result modbus_tcp_take(struct modbus_tcp *tcp, uint8_t byte);

/* Write the head of an answer whose function and data, `length` bytes, are after it already, and end the request. Returns the
 * length of the whole answer. */
size_t modbus_tcp_answer(struct modbus_tcp *tcp, uint8_t answer[MODBUS_TCP_MAX], size_t length);

#endif
