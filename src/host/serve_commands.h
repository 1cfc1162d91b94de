/* serve_commands.h: --commands: what somebody types, or a script writes, while the emulator runs. */
#ifndef RKM04_HOST_SERVE_COMMANDS_H
#define RKM04_HOST_SERVE_COMMANDS_H

#include "bus.h"

struct serve_commands {
    const struct serve_options *options;
    struct bus *const *buses;
    uv_poll_t stdin_ready;
    size_t length;
    char line[128]; /* what has come of the present one */
};

/* Begin to read stdin. *commands and the buses must stay. Failures are reported. Returns false if it did not work. */
bool serve_commands_start(struct serve_commands *commands, uv_loop_t *loop, const struct serve_options *options,
                          struct bus *const *buses);

#endif
