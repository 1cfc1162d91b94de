/* SPDX-License-Identifier: MIT */
/* main_stdio.c: the digest on a machine with a C library. */
#include <stdio.h>

#include "digest.h"

static void say(const char *line)
{
    puts(line);
}

int main(void)
{
    digest_run(say);
    return fflush(stdout) == 0 ? 0 : 1;
}
