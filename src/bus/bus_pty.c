/* SPDX-License-Identifier: MIT */
#include "bus_pty.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

void bus_pty_prepare(struct bus_pty *pty)
{
    pty->link.lock = -1;
}

bool bus_pty_claim(struct bus_pty *pty, const struct bus_options *options, unsigned number)
{
    char path[PATH_MAX];
    if (options->link && !name_expand(options->link, NULL, number, path)) {
        log_error("--link: the path is too long");
        return false;
    }
    return (!options->wine || wine_link_prepare(&pty->wine, options->wine, number)) &&
           link_path_claim(&pty->link, options->link ? path : NULL, number);
}

bool bus_pty_publish(struct bus_pty *pty, const struct bus_options *options, const struct line *line)
{
    return link_path_make(&pty->link, line->path) &&
           (!options->wine || pty->wine.target[0] || wine_link_make(&pty->wine, pty->link.path));
}

void bus_pty_hide(struct bus_pty *pty, const struct line *line)
{
    struct stat found;
    if (stat(line->path, &found) == 0) {
        pty->group = found.st_gid;
        pty->mode = found.st_mode & 0777;
    }
    link_path_hide(&pty->link);
}

void bus_pty_restore_access(const struct bus_pty *pty, const struct line *line)
{
    const char *path = line->path;
    struct stat found;
    if (pty->mode == 0 || stat(path, &found) != 0)
        return;
    if (found.st_gid != pty->group && chown(path, (uid_t)-1, pty->group) != 0)
        log_error("cannot set the group of %s to %u, as before: %s", path, (unsigned)pty->group, strerror(errno));
    else if ((found.st_mode & 0777) != pty->mode && chmod(path, pty->mode) != 0)
        log_error("cannot set the mode of %s to %03o, as before: %s", path, (unsigned)pty->mode, strerror(errno));
}

void bus_pty_release(struct bus_pty *pty)
{
    wine_link_remove(&pty->wine);
    link_path_release(&pty->link);
}
