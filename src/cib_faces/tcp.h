/* SPDX-License-Identifier: MIT */
/* tcp.h: a connection of a Modbus TCP client to CIB modules (docs/CIB.md, BL6).
 * A request is executed and answered in the tick in which its last byte comes. */
#ifndef RKM04_CIB_FACES_TCP_H
#define RKM04_CIB_FACES_TCP_H

#include "cib/cib.h"
#include "pdu.h"
#include "variables.h"

/* State of a connection: plain data, zero-initialised. */
struct cib_tcp {
    struct modbus_tcp request;
};

/* Gets the answers. */
typedef void cib_tcp_out(void *context, const uint8_t *bytes, size_t length);

/* Bytes of the client at the present tick of the modules. Returns false: what comes is not Modbus TCP, the connection is to be
 * closed. */
bool cib_tcp_receive(struct cib_tcp *tcp, const struct cib_modules *modules, const uint8_t *bytes, size_t length,
                     cib_tcp_out *out, void *context);

#endif
