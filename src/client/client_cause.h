/* SPDX-License-Identifier: MIT */
/* client_cause.h: why a unit does not answer, as far as its emulator knows. */
#ifndef RKM04_CLIENT_CAUSE_H
#define RKM04_CLIENT_CAUSE_H

#include <rkm04/link.h>

/* If an emulator with a control socket next to it (PORT.control) makes `port`: print what keeps the unit with address `node` from
 * answering a request in this framing: another framing, no such unit, two of them, no power, time that is stopped. Returns
 * whether there was anything to print. Waits for an emulator that hangs for a second. */
bool client_print_emulator_causes(const char *port, const struct rkm04_framing *framing, unsigned node);

#endif
