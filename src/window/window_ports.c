/* SPDX-License-Identifier: MIT */
#include "window_ports.h"

#include <stdlib.h>
#include <uv.h>

#include "client/client.h"
#include "window_devices.h"
#include "window_page.h"

struct listing {
    struct pages *pages;
    uint64_t page;
    json_t *request, *found;
    uv_work_t work;
};

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
    return json_pack("{s:o, s:o}", "ports", window_devices_find(), "emulators", find_emulators());
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
