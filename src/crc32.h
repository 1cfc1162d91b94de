/* SPDX-License-Identifier: MIT */
/* crc32.h: the check value of flash records: CRC-32 of ISO-HDLC (reflected, polynomial EDB88320; "123456789" gives CBF43926). */
#ifndef RKM04_SRC_CRC32_H
#define RKM04_SRC_CRC32_H

#include <stddef.h>
#include <stdint.h>

/* Continue over `length` bytes. `crc`: 0 at the start, later what the call before returned. Returns the value so far. */
uint32_t crc32_update(uint32_t crc, const uint8_t *data, size_t length);

#endif
