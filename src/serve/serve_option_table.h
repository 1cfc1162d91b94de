/* SPDX-License-Identifier: MIT */
/* serve_option_table.h: the options of `rkm04 serve' with their help. What the system has nothing for (serve_process.h) is not
 * shown, and is refused. */
#ifndef RKM04_SERVE_OPTION_TABLE_H
#define RKM04_SERVE_OPTION_TABLE_H

#include <argp.h>

enum serve_option_key {
    KEY_NODE = 'n',
    KEY_LINK = 'l',
    KEY_PORT = 'p',
    KEY_VERBOSE = 'v',
    KEY_FLASH = 256,
    KEY_BAUD,
    KEY_CLOCK,
    KEY_LINES,
    KEY_TCP,
    KEY_SERVICE,
    KEY_RFC2217,
    KEY_RTS,
    KEY_TURNAROUND,
    KEY_STRICT_LINE,
    KEY_EXIT_WHEN_IDLE,
    KEY_READY_FD,
    KEY_COVERAGE,
    KEY_MIN_COVERAGE,
    KEY_LATE,
    KEY_SEED,
    KEY_PLANT,
    KEY_TRACE,
    KEY_WIRE,
    KEY_RECORD,
    KEY_FORCE,
    KEY_CONTROL,
    KEY_ALLOW_FOLDER,
    KEY_NO_SANDBOX,
    KEY_NO_CONTROL,
    KEY_WINDOW,
    KEY_WINE,
    KEY_CONTROL_FILE,
    KEY_BACKUP
};

/* For argp, with the options that the system does not have hidden. */
const struct argp_option *serve_option_table(void);

/* What --help prints before and after the options. */
const char *serve_option_doc(void);

/* The name of the option if it is one that the system does not have; NULL otherwise. */
const char *serve_option_missing(int key);

#endif
