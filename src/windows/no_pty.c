/* SPDX-License-Identifier: MIT */
/* no_pty.c: Windows has no ptys, hence none of their names and watches. The options that ask for them are refused (serve.c), so
 * that none of these functions is called but to find nothing. */
#include "bus/bus.h"
#include "line/line.h"

bool line_watch_open(struct line_watch *watch)
{
    (void)watch;
    return false;
}

void line_watch_close(struct line_watch *watch)
{
    (void)watch;
}

void line_watch_update(struct line_watch *watch)
{
    (void)watch;
}

bool line_pty_open(struct line *line, struct line_watch *watch, line_notify *notify, void *context)
{
    (void)watch;
    (void)notify;
    (void)context;
    line_none(line);
    return false;
}

void line_pty_recount(struct line *line)
{
    (void)line;
}

bool line_settings_read(int fd, struct line_settings *settings)
{
    (void)fd;
    (void)settings;
    return false;
}

bool wine_link_valid(const char *name)
{
    (void)name;
    return false;
}

void bus_pty_prepare(struct bus_pty *pty)
{
    (void)pty;
}

bool bus_pty_claim(struct bus_pty *pty, const struct bus_options *options, unsigned number)
{
    (void)pty;
    (void)options;
    (void)number;
    return false;
}

bool bus_pty_publish(struct bus_pty *pty, const struct bus_options *options, const struct line *line)
{
    (void)pty;
    (void)options;
    (void)line;
    return false;
}

void bus_pty_hide(struct bus_pty *pty, const struct line *line)
{
    (void)pty;
    (void)line;
}

void bus_pty_restore_access(const struct bus_pty *pty, const struct line *line)
{
    (void)pty;
    (void)line;
}

void bus_pty_release(struct bus_pty *pty)
{
    (void)pty;
}
