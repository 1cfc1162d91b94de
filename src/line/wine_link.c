/* SPDX-License-Identifier: MIT */
#include "wine_link.h"

#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "log.h"
#include "text/text.h"

/* The number of the port. Returns 0 if `name` is none. `*prefix`: how many characters of it are the prefix. */
static unsigned read_name(const char *name, int *prefix)
{
    const char *colon = strrchr(name, ':');
    uint64_t number;
    if (!colon || colon == name || colon - name >= PATH_MAX || strncasecmp(colon, ":COM", 4) != 0 ||
        !number_read(colon + 4, 1, WINE_PORT_MAX, &number))
        return 0;
    *prefix = (int)(colon - name);
    return (unsigned)number;
}

bool wine_link_valid(const char *name)
{
    int prefix;
    return read_name(name, &prefix) != 0;
}

/* Where the link leads. Returns false if there is no link. */
static bool read_link(const char *path, char found[PATH_MAX])
{
    ssize_t length = readlink(path, found, PATH_MAX - 1);
    found[length > 0 ? length : 0] = '\0';
    return length > 0;
}

/* What is in the way, and may stay there: the link that is wanted, or one of a killed emulator. Returns false if something else
 * is there (reported). */
static bool clear_place(const char *path, const char *target)
{
    char found[PATH_MAX];
    struct stat there;
    if (lstat(path, &there) != 0)
        return true;
    if (!read_link(path, found)) {
        log_error("--wine: %s is not a link: choose another port", path);
        return false;
    }
    bool stale = strcmp(found, target) == 0 || (stat(path, &there) != 0 && strncmp(found, "/dev/", 5) != 0);
    if (stale && unlink(path) == 0)
        return true;
    log_error("--wine: %s leads to %s already: choose another port, as in --wine PREFIX:COM20 (docs/WINDOWS.md tells how to "
              "have a port that Wine gives to a device)", path, found);
    return false;
}

/* Make a path absolute. Returns false if that does not work (reported). */
static bool make_absolute(const char *path, char absolute[PATH_MAX])
{
    char folder[PATH_MAX] = "";
    bool made = *path == '/' || getcwd(folder, sizeof folder);
    if (made && snprintf(absolute, PATH_MAX, "%s%s%s", folder, *path == '/' ? "" : "/", path) < PATH_MAX)
        return true;
    log_error("--wine: cannot name the link: %s", made ? "the path is too long" : strerror(errno));
    return false;
}

bool wine_link_prepare(struct wine_link *link, const char *name, unsigned further)
{
    int prefix = 0, length = 0;
    unsigned number = read_name(name, &prefix) + further;
    struct stat folder;
    link->target[0] = '\0';
    if (number > WINE_PORT_MAX) {
        log_error("--wine: no port for bus %u: Wine knows up to COM%u", further, WINE_PORT_MAX);
        return false;
    }
    length = snprintf(link->path, sizeof link->path, "%.*s/dosdevices", prefix, name);
    if (length + 8 >= (int)sizeof link->path) {
        log_error("--wine: the path is too long");
        return false;
    }
    if (stat(link->path, &folder) != 0 || !S_ISDIR(folder.st_mode)) {
        log_error("--wine: there is no folder %s: expected a Wine prefix, as `wineboot' makes it", link->path);
        return false;
    }
    snprintf(link->path + length, sizeof link->path - (size_t)length, "/com%u", number);
    return true;
}

bool wine_link_make(struct wine_link *link, const char *target)
{
    char absolute[PATH_MAX];
    if (!make_absolute(target, absolute) || !clear_place(link->path, absolute))
        return false;
    if (symlink(absolute, link->path) != 0) {
        log_error("--wine: cannot make the link %s: %s", link->path, strerror(errno));
        return false;
    }
    snprintf(link->target, sizeof link->target, "%s", absolute);
    return true;
}

void wine_link_remove(struct wine_link *link)
{
    char found[PATH_MAX];
    if (link->target[0] && read_link(link->path, found) && strcmp(found, link->target) == 0)
        unlink(link->path);
    link->target[0] = '\0';
}
