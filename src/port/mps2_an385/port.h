/* SPDX-License-Identifier: MIT */
/* port.h: what the unit asks of this board. */
#ifndef PORT_H
#define PORT_H

#include <rkm04/unit.h>

extern const struct rkm04_port port;

#endif
