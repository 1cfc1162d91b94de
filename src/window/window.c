/* SPDX-License-Identifier: MIT */
#include "window.h"

#include <err.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "window_folder.h"
#include "window_inside.h"
#include "window_requests.h"
#include "window_server.h"
#include "window_system.h"

/* ---- Begin, end ------------------------------------------------------------------------------------------------------- */

static void on_signal(uv_signal_t *handle, int number)
{
    (void)number;
    uv_stop(handle->loop);
}

static void begin_signals(struct window *window)
{
    for (size_t i = 0; i < WINDOW_SIGNALS; i++) {
        uv_signal_init(&window->loop, &window->signals[i]);
        uv_signal_start(&window->signals[i], on_signal, window_signals[i]);
    }
}

static void open_port(struct window *window, const char *port)
{
    struct port_job *job = port_job_new(PORT_OPEN, 0, json_null());
    if (job == NULL)
        return;
    job->text = strdup(port);
    job->framing = &rkm04_hdlc;
    window_port_do(&window->port, job);
}

static void close_handle(uv_handle_t *handle, void *unused)
{
    (void)unused;
    if (!uv_is_closing(handle))
        uv_close(handle, NULL);
}

static void end_window(struct window *window)
{
    window_watch_end(&window->watch);
    window_port_end(&window->port);
    window_server_end(window);
    while (window->port.present != NULL && uv_run(&window->loop, UV_RUN_ONCE) != 0)
        ; /* the thread gives up at once */
    for (int i = 0; i < 100 && uv_run(&window->loop, UV_RUN_NOWAIT) != 0; i++)
        ; /* what the server closes */
    window_server_end(window);
    uv_walk(&window->loop, close_handle, NULL);
    uv_run(&window->loop, UV_RUN_DEFAULT);
    uv_loop_close(&window->loop);
    window_port_close(&window->port);
    window_folder_remove(window->folder);
}

enum exit_status window_run(const struct window_options *options)
{
    static struct window window; /* its buffers are large */
    char address[160];
    window_system_begin();
    window.timeout_ms = options->timeout_ms;
    window.pages = (struct pages){.loop = &window.loop, .request = window_request, .closed = window_page_closed,
                                  .context = &window};
    if (options->bound && !window_is_wanted())
        return STATUS_SUCCESS;
    if (uv_loop_init(&window.loop) != 0 || !window_port_begin(&window.port, &window.pages)) {
        warnx("cannot make an event loop");
        return STATUS_FAILURE;
    }
    begin_signals(&window);
    if (options->bound)
        window_watch_input(&window.loop, &window.input);
    window_watch_begin(&window.watch, &window.pages);
    bool listens = window_server_begin(&window, options->http);
    if (listens) {
        snprintf(address, sizeof address, "http://%s/?token=%s", window.host, window.token);
        printf("WINDOW %s\n", address);
        listens = fflush(stdout) == 0;
    }
    if (listens) {
        if (options->control != NULL)
            window_watch_choose(&window.watch, options->control, 0);
        if (options->port != NULL)
            open_port(&window, options->port);
        if (options->open)
            window_show_in_browser(address);
        uv_run(&window.loop, UV_RUN_DEFAULT);
    }
    end_window(&window);
    return listens ? STATUS_SUCCESS : STATUS_FAILURE;
}
