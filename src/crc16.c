/* SPDX-License-Identifier: MIT */
#include "crc16.h"

/* Eight steps of the bitwise form at once: the polynomial has few enough taps to do without a table. */
uint16_t crc16_update(uint16_t crc, uint8_t byte)
{
    unsigned x = (crc ^ byte) & 0xFFu;
    x = (x ^ (x << 4)) & 0xFFu;
    return (uint16_t)(((unsigned)crc >> 8) ^ (x << 8) ^ (x << 3) ^ (x >> 4));
}

uint16_t crc16_final(uint16_t crc)
{
    return (uint16_t)(crc ^ 0xFFFFu);
}
