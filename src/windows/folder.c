/* SPDX-License-Identifier: MIT */
/* folder.c: the folder of default names. Windows gives the folder of a user's own data to that user alone. */
#include <windows.h>

#include "line/line.h"

bool link_path_default(char path[PATH_MAX], const char *name)
{
    const char *own = getenv("LOCALAPPDATA");
    int length = snprintf(path, PATH_MAX, "%s/rkm04", own ? own : "");
    if (!own || length >= PATH_MAX - 1 || (!CreateDirectoryA(path, NULL) && GetLastError() != ERROR_ALREADY_EXISTS)) {
        log_error("there is no folder for default names: LOCALAPPDATA is %s", own ? own : "not set");
        return false;
    }
    for (int i = 0; i < length; i++)
        path[i] = path[i] == '\\' ? '/' : path[i];
    path[length++] = '/';
    for (; *name && length < PATH_MAX - 1; name++)
        path[length++] = strchr("<>:\"/\\|?*", *name) ? '-' : *name;
    path[length] = '\0';
    return true;
}
