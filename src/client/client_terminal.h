/* SPDX-License-Identifier: MIT */
/* client_terminal.h: what is known of the terminal before it is taken over. */
#ifndef RKM04_CLIENT_TERMINAL_H
#define RKM04_CLIENT_TERMINAL_H

#include <stdbool.h>

/* Is the terminal of standard output, named by TERM, known, and can the cursor be placed on it? If not, that is reported. */
bool client_terminal_is_usable(void);

#endif
