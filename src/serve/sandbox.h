/* SPDX-License-Identifier: MIT */
/* sandbox.h: what the emulator gives up when it is ready, so that an attacker who finds a fault in it cannot use it for more than
 * the emulator itself does (docs/SECURITY.md): access to files outside some folders (Landlock), and system calls (seccomp). Both
 * are Linux's; a kernel without them leaves things as they are. */
#ifndef RKM04_SANDBOX_H
#define RKM04_SANDBOX_H

#include <stdbool.h>

struct sandbox {
    int ruleset; /* -1: this kernel has no Landlock */
};

/* Begin a list of folders. */
void sandbox_begin(struct sandbox *sandbox);

/* Files below this folder may be read, made, written and removed; if it is no folder, that file read and written. What is not
 * there, or cannot be reached, is left out. */
void sandbox_allow(struct sandbox *sandbox, const char *path);

/* The folder in which `file` is, or would be made. */
void sandbox_allow_beside(struct sandbox *sandbox, const char *file);

/* From now on the calling thread, and all that it starts, opens and makes files in these folders only. The list is gone then.
 * Returns false, errno set, if the kernel does not do that. */
bool sandbox_close_files(struct sandbox *sandbox);

/* From now on all threads have only the system calls that the running emulator needs: no other programs, no new threads, no new
 * connections to the network, no memory that can be executed, no keys typed into the terminal. Others fail with EPERM.
 * Returns false, errno set, if the kernel does not do that. A build with sanitizers, which need more, does nothing. */
bool sandbox_close_calls(void);

#endif
