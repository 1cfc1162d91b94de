/* SPDX-License-Identifier: MIT */
/* control_place.h: the path under which control clients find the emulator: of a Unix socket, or of a file with the address and
 * token of a TCP port. It is for its owner alone.
 *
 * Beside it lies PATH.lock, locked as long as the emulator runs; it says which file is ours. Nothing else is ever removed, and no
 * link is followed in the last part of the path. */
#ifndef RKM04_CONTROL_PLACE_H
#define RKM04_CONTROL_PLACE_H

#include <limits.h>
#include <stdbool.h>
#include <sys/types.h>

#define CONTROL_FILE_BEGIN "tcp:" /* of a control file */

struct control_place {
    char path[PATH_MAX], lock_path[PATH_MAX];
    int lock;     /* -1: not claimed */
    dev_t device; /* of the socket or file that we made; both 0: none */
    ino_t inode;
};

/* Claim the path, and remove what a killed emulator has left there. Failures are reported with advice. Returns false if it did
 * not work: then nothing is left. */
bool control_place_claim(struct control_place *place, const char *path);

/* Note that what lies there now is ours. Returns false if that did not work (errno). */
bool control_place_record(struct control_place *place);

/* Remove what is ours and give the lock free. One that was never claimed, or is released, is left alone. */
void control_place_release(struct control_place *place);

#endif
