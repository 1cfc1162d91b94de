/* SPDX-License-Identifier: MIT */
/* net_listen.h: a TCP port that listens, as net_port and service_port need it. */
#ifndef RKM04_LINE_NET_LISTEN_H
#define RKM04_LINE_NET_LISTEN_H

#include <uv.h>

#include "net_address.h"

/* Let an initialised handle listen at `address`, which has its host in digits. `real` gets the address with the real port.
 * Returns NULL, or what is wrong. */
const char *net_listen(uv_tcp_t *listener, const char *address, uv_connection_cb on_connection, char real[NET_NAME_SIZE]);

#endif
