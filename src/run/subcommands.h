/* SPDX-License-Identifier: MIT */
/* subcommands.h: the sub-commands of rkm04 and what its exit status says. */
#ifndef RKM04_HOST_SUBCOMMANDS_H
#define RKM04_HOST_SUBCOMMANDS_H

enum exit_status {
    STATUS_WELL = 0,
    STATUS_FAILURE = 1,  /* at run time: a device that cannot be opened, a refused text, a motor in fault */
    STATUS_USAGE = 2,    /* wrong options or arguments */
    STATUS_FAILED = 3,   /* test: a scenario has failed */
    STATUS_COVERAGE = 4, /* serve: less than --min-coverage was exercised */
    STATUS_UNTIL = 124   /* exec: --until was reached with a motor still running */
};

/* argv[0] is the name for messages ("rkm04 serve"), the rest the sub-command's own arguments. Each returns the exit
 * status, or ends the program with it. */
int serve_main(int argc, char **argv); /* units on lines, until a signal ends it */
int exec_main(int argc, char **argv);  /* programs in virtual time */
int test_main(int argc, char **argv);  /* scenarios in virtual time */
int replay_main(int argc, char **argv); /* a record, again in virtual time */

#endif
