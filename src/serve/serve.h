/* SPDX-License-Identifier: MIT */
/* serve.h: `rkm04 serve`, from its options to its exit status; the face of the room.
 *
 *     serve            buses and control socket in one event loop, until a signal or a client ends it
 *     serve_option_table  the options and their help
 *     serve_options    the command line
 *     serve_process    signals and descriptors
 *     serve_report     what is logged at the beginning and the end, and the READY line
 *     serve_sandbox, sandbox    what the process may still do once all is open
 *     notify           readiness for systemd
 *
 * argv[0] is the name for messages ("rkm04 serve"), the rest the command's own arguments. Returns the exit status
 * (text/exit_status.h), or ends the program with it. */
#ifndef RKM04_SERVE_H
#define RKM04_SERVE_H

int serve_main(int argc, char **argv);

#endif
