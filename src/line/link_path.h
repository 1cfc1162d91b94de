/* SPDX-License-Identifier: MIT */
/* link_path.h: the stable name of the emulator's pty: a symbolic link, and next to it a lock file "LINK.lock" that says whose
 * the link is. The kernel frees the lock however its holder ends, so a link under a free lock of ours is stale. */
#ifndef RKM04_LINE_LINK_PATH_H
#define RKM04_LINE_LINK_PATH_H

#include <limits.h>
#include <stdbool.h>

struct link_path {
    char path[PATH_MAX];
    char lock_path[PATH_MAX];
    char target[64]; /* of the link once it is made; "" before */
    int lock;        /* -1: not ours */
};

/* Make the path of `name` in the folder of default names: $XDG_RUNTIME_DIR/rkm04, else rkm04-UID under the temporary directory;
 * the folder is made for its owner alone. Failures are reported. Returns false if there is no such folder. */
bool link_path_default(char path[PATH_MAX], const char *name);

/* Take the name `path` (NULL: the default, $XDG_RUNTIME_DIR/rkm04/busNUMBER or a private folder under the temporary directory),
 * and remove a stale link of our own there. Whatever else is there is left alone, and refused. Failures are reported.
 * Returns false if the name cannot be had. */
bool link_path_claim(struct link_path *link, const char *path, unsigned number);

/* Make the link to `target`, atomically. Failures are reported. Returns false if it did not work. */
bool link_path_make(struct link_path *link, const char *target);

/* Remove the link if it is still ours. The name stays claimed: link_path_make() makes it again. */
void link_path_hide(struct link_path *link);

/* Remove the link if it is still ours, and give the name free. */
void link_path_release(struct link_path *link);

#endif
