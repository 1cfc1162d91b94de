/* SPDX-License-Identifier: MIT */
/* port_client.exe PORT CHECK...: a Windows program that uses a unit as host software does. PORT: COM1 to COM256, or
 * tcp:HOST:PORT. The port is opened and closed for each check.
 *
 * Exit status: 0 every check has passed; 1 one has failed (reported); 2 usage. */
#include <stdio.h>
#include <string.h>

#include "checks.h"

static char path[32];

const char *port_name(void)
{
    return path;
}

static bool run(const char *name, const struct check *check)
{
    struct port port;
    if (!port_open(&port, name, check->opening != PLAIN_PORT))
        return false;
    bool passed = port_set_up(&port) && check->run(&port);
    port_close(&port);
    return passed;
}

int main(int argc, char **argv)
{
    bool passed = true;
    setvbuf(stdout, NULL, _IONBF, 0);
    if (argc < 3) {
        fprintf(stderr, "usage: port_client.exe PORT CHECK...\n");
        return 2;
    }
    snprintf(path, sizeof path, "\\\\.\\%.16s", argv[1]);
    for (int i = 2; i < argc; i++) {
        const struct check *check = checks;
        while (check->name && strcmp(check->name, argv[i]) != 0)
            check++;
        if (!check->name || (check->opening != ANY_PORT && strncmp(argv[1], "tcp:", 4) == 0)) {
            fprintf(stderr, "port_client.exe: there is no check '%s' for %s\n", argv[i], argv[1]);
            return 2;
        }
        bool ok = run(argv[1], check);
        printf("%s %s\n", ok ? "ok" : "FAILED", check->name);
        passed = passed && ok;
    }
    return passed ? 0 : 1;
}
