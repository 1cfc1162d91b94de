/* SPDX-License-Identifier: MIT */
#include "window_folder.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

bool window_folder_make(char folder[PATH_MAX], const char *control)
{
    const char *slash = strrchr(control, '/');
    int base = slash != NULL ? (int)(slash - control) : 0;
    if (folder[0] != '\0')
        return true;
    if (slash != NULL && snprintf(folder, PATH_MAX, "%.*s/rkm04-window-XXXXXX", base, control) < PATH_MAX &&
        mkdtemp(folder) != NULL)
        return true;
    folder[0] = '\0';
    return false;
}

void window_folder_remove(char folder[PATH_MAX])
{
    DIR *opened = folder[0] != '\0' ? opendir(folder) : NULL;
    const struct dirent *entry;
    if (opened == NULL)
        return;
    while ((entry = readdir(opened)) != NULL)
        unlinkat(dirfd(opened), entry->d_name, 0);
    closedir(opened);
    rmdir(folder);
    folder[0] = '\0';
}
