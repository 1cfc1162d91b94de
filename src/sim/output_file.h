/* SPDX-License-Identifier: MIT */
/* output_file.h: files that a line writes while it runs. */
#ifndef RKM04_SIM_OUTPUT_FILE_H
#define RKM04_SIM_OUTPUT_FILE_H

#include <stdio.h>

/* Open `path` for writing from its beginning, making it if it is not there, without waiting for anybody: a pipe could hold up the
 * units, so only files and devices like /dev/null are taken. Returns NULL if it did not work; errno says why, EINVAL: neither. */
FILE *output_file_open(const char *path);

#endif
