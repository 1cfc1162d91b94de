/* SPDX-License-Identifier: MIT */
/* serve.h: the face of the room for `rkm04 serve`: buses with clocks in one event loop, from the options to the exit status;
 * confinement, readiness.
 *
 * argv[0] is the name for messages ("rkm04 serve"), the rest the command's own arguments. Returns the exit status
 * (text/exit_status.h), or ends the program with it: units on buses, until a signal ends it. */
#ifndef RKM04_SERVE_H
#define RKM04_SERVE_H

int serve_main(int argc, char **argv);

#endif
