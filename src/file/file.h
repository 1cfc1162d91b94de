/* SPDX-License-Identifier: MIT */
/* file.h: files that are written; the face of the room.
 *
 *     output_file    opens a file when all inputs are valid: never over an input, another output, or a file of another kind
 *     output_kind    kinds of files, recognised by their first bytes
 *
 * Who writes a kind of file describes it (struct output_kind) and opens it here. Files are made for their owner alone, but for
 * reports. */
#ifndef RKM04_FILE_H
#define RKM04_FILE_H

#include "output_file.h"
#include "output_kind.h"

#endif
