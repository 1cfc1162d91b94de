/* SPDX-License-Identifier: MIT */
/* crc16.h: the FCS-16 of RFC 1662 appendix C: reflected polynomial 8408, start FFFF, sent inverted and low byte first (L1). */
#ifndef RKM04_SRC_CRC16_H
#define RKM04_SRC_CRC16_H

#include <stdint.h>

#define CRC16_START 0xFFFFu /* value before the first byte */
#define CRC16_GOOD 0xF0B8u  /* value after a whole frame, its check sum included */

/* Take one byte into the running value `crc`. Returns the new value. */
uint16_t crc16_update(uint16_t crc, uint8_t byte);

/* The check sum to be sent for a running value, low byte first. For "123456789" it is 906E. */
uint16_t crc16_final(uint16_t crc);

#endif
