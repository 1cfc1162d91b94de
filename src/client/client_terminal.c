/* SPDX-License-Identifier: MIT */
#include "client_terminal.h"

#include <curses.h>
#include <err.h>
#include <stdlib.h>
#include <term.h> /* takes names like `columns' away: not to be mixed with anything */
#include <unistd.h>

bool client_terminal_is_usable(void)
{
    int known;
    const char *name = getenv("TERM");
    bool fits = setupterm(NULL, STDOUT_FILENO, &known) == OK;
    if (fits) {
        fits = tigetstr("cup") != NULL;
        del_curterm(cur_term);
    }
    if (!fits)
        warnx("watch: the terminal `%s' is unknown, or cannot show a panel: set TERM, or use --once",
              name != NULL ? name : "");
    return fits;
}
