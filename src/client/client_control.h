/* SPDX-License-Identifier: MIT */
/* client_control.h: the commands of rkmctl that go to the control socket of an emulator (docs/CONTROL.md). */
#ifndef RKM04_CLIENT_CONTROL_H
#define RKM04_CLIENT_CONTROL_H

#include "client_job.h"

#define CLIENT_CONTROL_NAMES \
    "state, di, wait, advance, watch, events, snapshot, restore, reset, power, switch, fault, plant, cib, cnc, clock, trace, " \
    "call or shutdown"

/* Is `name` one of them? */
bool client_control_has(const char *name);

/* Do the command `name`, with everything of *job but connected and rpc set. Returns the exit status. */
enum exit_status client_control(struct client_job *job, const char *name);

#endif
