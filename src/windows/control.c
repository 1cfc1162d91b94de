/* SPDX-License-Identifier: MIT */
/* control.c: the emulator for Windows has no control socket. */
#include "control/control.h"

struct control *control_open(uv_loop_t *loop, const char *path, struct bus *const *buses, unsigned lines,
                             const struct control_calls *calls)
{
    (void)loop;
    (void)path;
    (void)buses;
    (void)lines;
    (void)calls;
    return NULL;
}

const char *control_path(const struct control *control)
{
    (void)control;
    return NULL;
}

unsigned control_clients(const struct control *control)
{
    (void)control;
    return 0;
}

void control_close(struct control *control)
{
    (void)control;
}

void control_free(struct control *control)
{
    (void)control;
}
