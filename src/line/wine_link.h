/* SPDX-License-Identifier: MIT */
/* wine_link.h: a COM port of a Wine prefix that leads to the emulator: PREFIX/dosdevices/comN, a symbolic link to the link of
 * the emulator's pty. */
#ifndef RKM04_LINE_WINE_LINK_H
#define RKM04_LINE_WINE_LINK_H

#include <limits.h>
#include <stdbool.h>

#define WINE_PORT_MAX 256u /* COM1 to COM256 are what Wine knows */
#define WINE_PORT_EXPECTED "PREFIX:COMn, n from 1 to 256, PREFIX the folder of a Wine prefix"

struct wine_link {
    char path[PATH_MAX];
    char target[PATH_MAX]; /* of the link once it is made by us; "" otherwise */
};

/* Is this the name of a port, as in ~/.wine:COM5? Whether the prefix is there is not checked. */
bool wine_link_valid(const char *name);

/* Find the port `further` ports above the one `name`. Failures are reported. Returns false if there is none. */
bool wine_link_prepare(struct wine_link *link, const char *name, unsigned further);

/* Have the port lead to `target`, a path. A link of a killed emulator is replaced; whatever else is there is left alone, and
 * refused. Failures are reported. Returns false if it did not work. */
bool wine_link_make(struct wine_link *link, const char *target);

/* Remove the link if it is still as it was made. */
void wine_link_remove(struct wine_link *link);

#endif
