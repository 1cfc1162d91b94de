/* SPDX-License-Identifier: MIT */
#include "window_ports.h"

#include <glob.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <uv.h>

#include "client/client.h"
#include "window_page.h"

struct listing {
    struct pages *pages;
    uint64_t page;
    json_t *request, *found;
    uv_work_t work;
};

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
static json_t *find_devices(void)
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

static json_t *find_emulators(void)
{
    struct client_found *found = calloc(CLIENT_FOUND_MAX, sizeof *found);
    json_t *list = json_array();
    size_t count = found != NULL ? client_find(found) : 0;
    for (size_t i = 0; i < count; i++)
        json_array_append_new(list, json_pack("{s:s, s:s}", "control", found[i].control, "port", found[i].port));
    free(found);
    return list;
}

json_t *window_ports_find(void)
{
    return json_pack("{s:o, s:o}", "ports", find_devices(), "emulators", find_emulators());
}

static void on_work(uv_work_t *work)
{
    struct listing *listing = work->data;
    listing->found = window_ports_find();
}

static void on_done(uv_work_t *work, int status)
{
    struct listing *listing = work->data;
    struct page *page = page_find(listing->pages, listing->page);
    (void)status;
    if (page != NULL)
        page_answer(page, listing->request, json_incref(listing->found));
    json_decref(listing->found);
    json_decref(listing->request);
    free(listing);
}

void window_ports_list(struct page *page, json_t *request)
{
    struct listing *listing = calloc(1, sizeof *listing);
    if (listing == NULL)
        return;
    *listing = (struct listing){.pages = page->pages, .page = page->number, .request = json_incref(request)};
    listing->work.data = listing;
    uv_queue_work(page->pages->loop, &listing->work, on_work, on_done);
}
