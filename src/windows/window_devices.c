/* SPDX-License-Identifier: MIT */
/* window_devices.c: the COM ports. Drivers put the names of theirs into the registry, those of com0com, too. */
#include "window/window_devices.h"

#include <windows.h>

#define PORTS_MAX 256

struct com_name {
    char port[64], device[256];
};

/* COM9 comes before COM10. */
static int compare(const void *left, const void *right)
{
    const char *a = ((const struct com_name *)left)->port, *b = ((const struct com_name *)right)->port;
    size_t length_a = strlen(a), length_b = strlen(b);
    return length_a != length_b ? (length_a < length_b ? -1 : 1) : strcmp(a, b);
}

static size_t read_names(struct com_name names[PORTS_MAX])
{
    HKEY key;
    size_t count = 0;
    if (RegOpenKeyExA(HKEY_LOCAL_MACHINE, "HARDWARE\\DEVICEMAP\\SERIALCOMM", 0, KEY_READ, &key) != ERROR_SUCCESS)
        return 0;
    for (DWORD i = 0; count < PORTS_MAX; i++) {
        struct com_name *name = &names[count];
        DWORD device_size = sizeof name->device, port_size = sizeof name->port - 1, type;
        LSTATUS found = RegEnumValueA(key, i, name->device, &device_size, NULL, &type, (BYTE *)name->port, &port_size);
        if (found != ERROR_SUCCESS && found != ERROR_MORE_DATA)
            break;
        if (found == ERROR_MORE_DATA || type != REG_SZ)
            continue; /* no name of a port */
        name->port[port_size] = '\0';
        count++;
    }
    RegCloseKey(key);
    return count;
}

json_t *window_devices_find(void)
{
    struct com_name *names = calloc(PORTS_MAX, sizeof *names);
    json_t *list = json_array();
    size_t count = names != NULL ? read_names(names) : 0;
    if (count > 0)
        qsort(names, count, sizeof *names, compare);
    for (size_t i = 0; i < count; i++)
        json_array_append_new(list, json_pack("{s:s, s:s}", "port", names[i].port, "device", names[i].device));
    free(names);
    return list;
}
