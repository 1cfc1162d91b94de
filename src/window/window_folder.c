/* SPDX-License-Identifier: MIT */
#include "window_folder.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <uv.h>

/* The folder in which the file lies, from the root: the emulator may run elsewhere. Returns false if there is none. */
static bool find_folder(const char *file, char folder[PATH_MAX])
{
    const char *slash = strrchr(file, '/');
    char part[PATH_MAX];
    int length = slash == NULL ? 0 : slash == file ? 1 : (int)(slash - file);
    return snprintf(part, sizeof part, "%.*s", length, file) < PATH_MAX && realpath(length > 0 ? part : ".", folder) != NULL;
}

bool window_folder_make(char folder[PATH_MAX], const char *control)
{
    char base[PATH_MAX], wanted[PATH_MAX];
    uv_fs_t made;
    if (folder[0] != '\0')
        return true;
    if (!find_folder(control, base) || snprintf(wanted, sizeof wanted, "%s/rkm04-window-XXXXXX", base) >= PATH_MAX)
        return false;
    bool done = uv_fs_mkdtemp(NULL, &made, wanted, NULL) == 0 && strlen(made.path) < PATH_MAX;
    if (done)
        strcpy(folder, made.path);
    uv_fs_req_cleanup(&made);
    return done;
}

static void remove_file(const char *folder, const char *name)
{
    char path[PATH_MAX + 256];
    uv_fs_t removed;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    uv_fs_unlink(NULL, &removed, path, NULL);
    uv_fs_req_cleanup(&removed);
}

void window_folder_remove(char folder[PATH_MAX])
{
    uv_fs_t found, removed;
    uv_dirent_t entry;
    if (folder[0] == '\0')
        return;
    if (uv_fs_scandir(NULL, &found, folder, 0, NULL) >= 0)
        while (uv_fs_scandir_next(&found, &entry) == 0)
            remove_file(folder, entry.name);
    uv_fs_req_cleanup(&found);
    uv_fs_rmdir(NULL, &removed, folder, NULL);
    uv_fs_req_cleanup(&removed);
    folder[0] = '\0';
}
