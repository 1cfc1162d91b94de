/* SPDX-License-Identifier: MIT */
/* client_watch.h: `rkmctl watch`: the front panel of a unit, live in the terminal, or once as text. */
#ifndef RKM04_CLIENT_WATCH_H
#define RKM04_CLIENT_WATCH_H

#include "client_job.h"

/* Watch until q, Ctrl-C or the end of the emulator. Without job->unit it begins with the first unit of the line. Returns the exit
 * status; the terminal is then as it was. */
enum exit_status client_watch(struct client_job *job);

#endif
