/* SPDX-License-Identifier: MIT */
#include "window_devices.h"

#include <glob.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Of the devices ttyS0 … most are not there: the kernel knows their type. */
static bool is_there(const char *path)
{
    char name[64];
    int type = 1;
    if (sscanf(path, "/dev/ttyS%d", &type) != 1)
        return true;
    snprintf(name, sizeof name, "/sys/class/tty/ttyS%d/type", type);
    FILE *file = fopen(name, "re");
    type = 0;
    if (file != NULL) {
        if (fscanf(file, "%d", &type) != 1)
            type = 0;
        fclose(file);
    }
    return type != 0;
}

static bool is_listed(const json_t *list, const char *real)
{
    size_t i;
    json_t *one;
    json_array_foreach(list, i, one)
        if (strcmp(json_string_value(json_object_get(one, "device")), real) == 0)
            return true;
    return false;
}

/* Names that udev gives last longer than numbers: they come first. */
json_t *window_devices_find(void)
{
    static const char *const patterns[] = {"/dev/serial/by-id/*", "/dev/ttyUSB*", "/dev/ttyACM*", "/dev/ttyAMA*", "/dev/ttyS*"};
    json_t *list = json_array();
    for (size_t i = 0; i < sizeof patterns / sizeof patterns[0]; i++) {
        glob_t found;
        if (glob(patterns[i], 0, NULL, &found) != 0)
            continue;
        for (size_t k = 0; k < found.gl_pathc; k++) {
            char real[PATH_MAX];
            if (realpath(found.gl_pathv[k], real) != NULL && is_there(real) && !is_listed(list, real))
                json_array_append_new(list, json_pack("{s:s, s:s}", "port", found.gl_pathv[k], "device", real));
        }
        globfree(&found);
    }
    return list;
}
