/* SPDX-License-Identifier: MIT */
/* exit_status.h: what the exit status of rkm04 and rkmctl says. */
#ifndef RKM04_TEXT_EXIT_STATUS_H
#define RKM04_TEXT_EXIT_STATUS_H

enum exit_status {
    STATUS_SUCCESS = 0,
    STATUS_FAILURE = 1,  /* at run time: a device that cannot be opened, a refused text, a motor in fault, a lost port */
    STATUS_USAGE = 2,    /* wrong options or arguments */
    STATUS_FAILED = 3,   /* rkm04 test: a scenario has failed */
    STATUS_NO_ANSWER = 3, /* rkmctl: no answer, or what is waited for does not come */
    STATUS_COVERAGE = 4, /* rkm04 serve: less than --min-coverage was exercised */
    STATUS_UNTIL = 124   /* rkm04 exec: --until was reached with a motor still running */
};

#endif
