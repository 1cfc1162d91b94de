/* SPDX-License-Identifier: MIT */
/* pdu.h: what a Modbus request does in a CIB module, and its answer (docs/CIB.md, BL5, BL7), without the frame around
 * them. */
#ifndef RKM04_CIB_FACES_PDU_H
#define RKM04_CIB_FACES_PDU_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cib/cib.h"
#include "modbus/modbus.h"

/* Execute a request of `length` bytes, 1..MODBUS_PDU_MAX, at the present tick. An exception changes nothing. Returns the
 * length of the answer, which is never empty. */
size_t cib_modbus(struct cib_unit *unit, const uint8_t *request, size_t length, uint8_t answer[MODBUS_PDU_MAX]);

/* Does a request with this function write, so that a broadcast of it is executed (BL2)? */
bool cib_modbus_writes(uint8_t function);

#endif
