/* SPDX-License-Identifier: MIT */
/* options.h: what the command lines of all programs share; the face of the room.
 *
 *     arguments        reading a command line, with --help and --version
 *     host_address     the address of a host by its name, found within a time
 *     program_argument [M=]FILE, a program and its motor
 *     process          what a program must not inherit from its starter
 *     readings_option  --readings
 *     socket_address   the address of a Unix socket
 *
 * Who has an option that only one program knows reads it in that program's room. */
#ifndef RKM04_OPTIONS_H
#define RKM04_OPTIONS_H

#include "arguments.h"
#include "host_address.h"
#include "process.h"
#include "program_argument.h"
#include "readings_option.h"
#include "socket_address.h"

#endif
