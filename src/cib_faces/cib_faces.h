/* SPDX-License-Identifier: MIT */
/* cib_faces.h: how a host reaches CIB modules; the face of the room. Pure like the module's core: whole numbers, no heap;
 * its user brings the bytes and the time.
 *
 *     pdu        a Modbus request and its answer: functions, exceptions, registers
 *     rtu        Modbus RTU: requests among bytes on the bus, silence, addresses
 *     tcp        a connection of a Modbus TCP client
 *     variables  names, types and values for PLCComS clients
 *     lines      a connection of a PLCComS client
 */
#ifndef RKM04_CIB_FACES_CIB_FACES_H
#define RKM04_CIB_FACES_CIB_FACES_H

#include "lines.h"
#include "pdu.h"
#include "rtu.h"
#include "tcp.h"
#include "variables.h"

#endif
