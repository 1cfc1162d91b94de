/* SPDX-License-Identifier: MIT */
/* run.h: the face of the room for `rkm04 exec`, `test`, `replay`: runs in virtual time, from the options to the exit status. */
#ifndef RKM04_ROOM_RUN_H
#define RKM04_ROOM_RUN_H

#include "subcommands.h"

#endif
