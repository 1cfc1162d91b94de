/* SPDX-License-Identifier: MIT */
/* fuzz_window.c: any bytes as messages of a page to the window, one after the other, each ended by a zero. Each is answered with
 * JSON, or the page is closed. No port is opened, no emulator is asked; the program tools run at once. */
#include <libwebsockets.h>
#include <string.h>

#include "fuzz.h"
#include "window/window_control.h"
#include "window/window_folder.h"
#include "window/window_inside.h"
#include "window/window_ports.h"
#include "window/window_requests.h"

int __wrap_uv_queue_work(uv_loop_t *loop, uv_work_t *work, uv_work_cb begin, uv_after_work_cb end);
int __wrap_uv_queue_work(uv_loop_t *loop, uv_work_t *work, uv_work_cb begin, uv_after_work_cb end)
{
    (void)loop;
    begin(work);
    end(work, 0);
    return 0;
}

bool __wrap_window_port_do(struct window_port *port, struct port_job *job);
bool __wrap_window_port_do(struct window_port *port, struct port_job *job)
{
    bool taken = job->node % 2 == 0;
    (void)port;
    port_job_free(job);
    return taken;
}

struct window_control *__wrap_window_control_open(uv_loop_t *loop, const char *path, const struct window_control_calls *calls,
                                                  char trouble[256]);
struct window_control *__wrap_window_control_open(uv_loop_t *loop, const char *path, const struct window_control_calls *calls,
                                                  char trouble[256])
{
    (void)loop;
    (void)calls;
    snprintf(trouble, 256, "%.200s", path);
    return NULL;
}

bool __wrap_window_folder_make(char folder[PATH_MAX], const char *control);
bool __wrap_window_folder_make(char folder[PATH_MAX], const char *control)
{
    (void)folder;
    return control[0] != '\0';
}

json_t *__wrap_window_ports_find(void);
json_t *__wrap_window_ports_find(void)
{
    return json_pack("{s:[]}", "ports");
}

/* Read all that the page has got. */
static void drain(struct page *page)
{
    for (struct page_text *text = page_next(page); text != NULL; text = page_next(page)) {
        json_t *object = json_loadb((const char *)text->bytes + LWS_PRE, text->length, 0, NULL);
        FUZZ_CHECK(json_is_object(object), "%.*s", (int)text->length, (const char *)text->bytes + LWS_PRE);
        json_decref(object);
        page_written(page);
    }
    FUZZ_CHECK(page->waiting == 0, "%zu bytes", page->waiting);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static struct window window;
    window = (struct window){.pages = {.loop = &window.loop, .request = window_request, .closed = window_page_closed,
                                       .context = &window}};
    uv_loop_init(&window.loop);
    FUZZ_CHECK(window_port_begin(&window.port, &window.pages), "port");
    window_watch_begin(&window.watch, &window.pages);
    struct page *page = page_open(&window.pages, NULL);
    for (size_t at = 0; at < size && !page->failed;) {
        const uint8_t *end = memchr(data + at, 0, size - at);
        size_t length = end != NULL ? (size_t)(end - data) - at : size - at;
        if (!page_receive(page, data + at, length, true))
            break;
        drain(page);
        at += length + 1;
    }
    page_close(page);
    window_watch_end(&window.watch);
    window_port_end(&window.port);
    uv_close((uv_handle_t *)&window.port.progress, NULL);
    uv_close((uv_handle_t *)&window.watch.timer, NULL);
    uv_run(&window.loop, UV_RUN_DEFAULT);
    FUZZ_CHECK(uv_loop_close(&window.loop) == 0, "handles are left");
    close(window.port.cancel);
    return 0;
}
