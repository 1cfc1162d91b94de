/* SPDX-License-Identifier: MIT */
/* file.h: the face of the room for files that are written: opened when all inputs are valid, never over an input, an output or
 * a file of another kind. */
#ifndef RKM04_FILE_H
#define RKM04_FILE_H

#include "output_file.h"
#include "output_kind.h"

#endif
