/* SPDX-License-Identifier: MIT */
/* run.h: `rkm04 exec`, `test`, `replay`: runs in virtual time, from the options to the exit status; the face of the room.
 *
 *     exec, exec_*, stimulus    programs of a unit and what is done to its inputs meanwhile
 *     test, test_*              scenarios, under one or several sets of readings; reports
 *     replay_main               a recording again, compared with what was recorded
 *     plot_main                 a picture of what programs, a trace or a recording do
 *     devices                   the list of the kinds of devices
 *     signals                   the list of a CNC872's cells
 *
 * argv[0] is the name for messages ("rkm04 exec"), the rest the command's own arguments. Each returns the exit status
 * (text/exit_status.h), or ends the program with it. */
#ifndef RKM04_RUN_H
#define RKM04_RUN_H

int exec_main(int argc, char **argv);   /* programs in virtual time */
int test_main(int argc, char **argv);   /* scenarios in virtual time */
int replay_main(int argc, char **argv); /* a recording, again in virtual time */
int plot_main(int argc, char **argv);   /* pictures of runs */
int devices_main(int argc, char **argv); /* the kinds of devices */
int signals_main(int argc, char **argv); /* the cells of a CNC872 */

#endif
