/* SPDX-License-Identifier: MIT */
/* client_help.h: help for one command of rkmctl. */
#ifndef RKM04_CLIENT_HELP_H
#define RKM04_CLIENT_HELP_H

#include <stdbool.h>

/* Do the arguments ask for help for a command (`rkmctl wait --help`)? Then it is printed. */
bool client_help_wanted(int argc, char **argv);

/* Print help for this command. Returns false if there is none of that name. */
bool client_help_show(const char *command);

/* The name of the i-th command, from 0; NULL after the last one. */
const char *client_help_name(unsigned i);

#endif
