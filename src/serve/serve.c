/* SPDX-License-Identifier: MIT */
/* rkm04 serve: lines with their units (bus.c) in one event loop, from the options to the exit status. */
#include <errno.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <uv.h>

#include "bus/bus.h"
#include "control/control.h"
#include "device/device.h"
#include "file/file.h"
#include "line/line.h"
#include "notify.h"
#include "serve.h"
#include "serve_options.h"
#include "serve_process.h"
#include "serve_report.h"
#include "serve_sandbox.h"
#include "serve_window.h"
#include "text/text.h"

#define PLANT_MAX (1u << 20) /* bytes; a recording may hold as many */
#define LOG_WAIT_MS 200u /* how long to wait for the reader of the log, at the start and at the end */
#define NAME_WAIT_MS 30000u /* how long a name server may take: as long as the resolver tries by default */

struct serve {
    struct bus_options options;
    char tcp[NET_NAME_SIZE], rfc2217[NET_NAME_SIZE], service[DEVICE_SERVICES_MAX][NET_NAME_SIZE]; /* of options, in digits */
    char control_tcp[NET_NAME_SIZE];
    struct bus *bus[BUS_LINES_MAX];
    struct line_watch watch;
    struct coverage coverage;
    struct coverage_files coverage_files;
    struct control *control; /* NULL: none */
    int window;              /* descriptor of serve_window.h; -1: none */
    enum exit_status status;

    uv_loop_t loop;
    uv_poll_t notices;
    uv_timer_t idle;
    uv_signal_t signals[SERVE_SIGNALS];
};

static bool is_coverage_wanted(const struct serve *serve)
{
    return serve->options.coverage || serve->options.min_coverage >= 0;
}

/* ---- While it runs -------------------------------------------------------------------------------------------------- */

static void on_signal(uv_signal_t *handle, int number)
{
    struct serve *serve = handle->data;
    log_at(bus_present(serve->bus[0]), "ended by %s", serve_signal_name(number));
    uv_stop(&serve->loop);
}

static void on_idle(uv_timer_t *handle)
{
    struct serve *serve = handle->data;
    log_at(bus_present(serve->bus[0]), "ended: no client has used the bus for %u s", serve->options.idle_seconds);
    uv_stop(&serve->loop);
}

static void on_failed(void *context)
{
    struct serve *serve = context;
    serve->status = STATUS_FAILURE;
    uv_stop(&serve->loop);
}

static json_t *on_ready(void *context)
{
    const struct serve *serve = context;
    return serve_report_json(&serve->options, serve->bus, serve->control);
}

/* A client has come or gone, or a device has been used. */
static void on_presence(void *context)
{
    struct serve *serve = context;
    if (!serve->options.exit_when_idle)
        return;
    for (unsigned i = 0; i < serve->options.lines; i++) {
        if (serve->bus[i] && bus_ports_clients(&serve->bus[i]->ports) + bus_services_clients(serve->bus[i]->services) > 0) {
            uv_timer_stop(&serve->idle);
            return;
        }
    }
    if (control_clients(serve->control) > 0) {
        uv_timer_stop(&serve->idle);
        return;
    }
    uv_timer_start(&serve->idle, on_idle, serve->options.idle_seconds * UINT64_C(1000), 0);
}

static void on_shutdown(void *context)
{
    struct serve *serve = context;
    log_at(bus_present(serve->bus[0]), "ended through the control socket");
    uv_stop(&serve->loop);
}

static const struct bus_calls calls = {.failed = on_failed, .presence = on_presence};

static void on_notice(uv_poll_t *handle, int status, int events)
{
    struct serve *serve = handle->data;
    (void)status;
    (void)events;
    line_watch_update(&serve->watch);
}

/* ---- Begin ---------------------------------------------------------------------------------------------------------- */

/* Report what libuv could not do. Returns true if nothing is wrong. */
static bool check_uv(const char *what, int error)
{
    if (error != 0)
        log_error("cannot %s: %s", what, uv_strerror(error));
    return error == 0;
}

static bool start_signals(struct serve *serve)
{
    for (size_t i = 0; i < SERVE_SIGNALS; i++) {
        if (!serve_signal_ends(serve_signals[i]))
            continue;
        serve->signals[i].data = serve;
        if (!check_uv("handle signals", uv_signal_init(&serve->loop, &serve->signals[i])) ||
            !check_uv("handle signals", uv_signal_start(&serve->signals[i], on_signal, serve_signals[i])))
            return false;
    }
    return true;
}

static bool start_watch(struct serve *serve)
{
    if (!serve->options.pty)
        return true;
    serve->notices.data = serve;
    return line_watch_open(&serve->watch) &&
           check_uv("watch the bus", uv_poll_init(&serve->loop, &serve->notices, serve->watch.fd)) &&
           check_uv("watch the bus", uv_poll_start(&serve->notices, UV_READABLE, on_notice));
}

/* When all inputs are read and valid: see that all files can be written, while none is changed. */
static bool reserve_files(struct serve *serve)
{
    const struct bus_options *options = &serve->options;
    for (unsigned i = 0; i < options->lines; i++)
        if (!bus_reserve_files(serve->bus[i]))
            return false;
    return !options->coverage || coverage_open(&serve->coverage_files, options->coverage, options->output_flags);
}

static bool start_buses(struct serve *serve)
{
    struct coverage *coverage = is_coverage_wanted(serve) ? &serve->coverage : NULL;
    for (unsigned i = 0; i < serve->options.lines; i++) {
        serve->bus[i] = calloc(1, sizeof *serve->bus[i]); /* fresh pages: units that are not there cost nothing */
        if (!serve->bus[i]) {
            log_error("out of memory");
            return false;
        }
        if (!bus_begin(serve->bus[i], i, &serve->options, &serve->loop, &serve->watch, coverage, &calls, serve))
            return false;
    }
    return true;
}

/* Nothing is refused any more: begin the files, and time. */
static bool run_buses(struct serve *serve)
{
    for (unsigned i = 0; i < serve->options.lines; i++)
        if (!bus_begin_files(serve->bus[i]))
            return false;
    serve_report_start(&serve->options, serve->bus);
    for (unsigned i = 0; i < serve->options.lines; i++)
        if (!bus_start(serve->bus[i]))
            return false;
    return true;
}

/* Before rights are given up: the window needs other ones. */
static bool start_window(struct serve *serve)
{
    if (!serve->options.window)
        return true;
    if (serve->control)
        serve->window = serve_window_start(control_path(serve->control), serve->options.window);
    return serve->window >= 0;
}

/* The default path of the control socket: next to the link of the first bus; without one a name made of where the bus is, or of
 * the device that has none, in the folder of default links. Returns false if there is none (reported). */
static bool default_control(const struct serve *serve, char path[PATH_MAX])
{
    const struct bus_ports *ports = &serve->bus[0]->ports;
    const char *port = serve->options.port, *slash = port ? strrchr(port, '/') : NULL;
    char name[NAME_MAX];
    if (serve->options.pty) {
        if (snprintf(path, PATH_MAX, "%s.control", ports->pty.link.path) < PATH_MAX)
            return true;
        log_error("the path of the link is too long for a control socket next to it");
        return false;
    }
    const char *kind = ports->tcp ? "tcp-" : ports->rfc2217 ? "rfc2217-" : "";
    const char *where = slash ? slash + 1 : port ? port : serve->options.device.kind->name;
    if (ports->tcp || ports->rfc2217)
        where = ports->tcp ? ports->tcp->address : ports->rfc2217->address;
    snprintf(name, sizeof name, "%s%.200s.control", kind, where);
    return link_path_default(path, name);
}

static bool start_control(struct serve *serve)
{
    const struct bus_options *options = &serve->options;
    const struct control_calls control_calls = {.shutdown = on_shutdown, .presence = on_presence, .ready = on_ready,
                                                .context = serve};
    char path[PATH_MAX];
    if (options->no_control)
        return true;
    if (options->control || default_control(serve, path))
        serve->control = control_open(&serve->loop, options->control ? options->control : path, options->control_tcp, serve->bus,
                                      options->lines, &control_calls);
    const bool is_wanted = options->control || options->control_tcp;
    if (!serve->control && !is_wanted)
        log_error("continuing without a control socket; choose another path with --control PATH");
    return serve->control || !is_wanted;
}

/* Read a whole plant. Returns a string to be freed; NULL: reported. */
static char *read_text(const char *path)
{
    FILE *file = fopen(path, "re");
    char *text = file ? malloc(PLANT_MAX + 1u) : NULL;
    size_t length = text ? fread(text, 1, PLANT_MAX + 1u, file) : 0;
    const char *wrong = NULL;
    if (!text || ferror(file))
        wrong = strerror(errno);
    else if (length > PLANT_MAX)
        wrong = "it is longer than 1 MiB";
    else if (memchr(text, '\0', length))
        wrong = "expected text without the character 0";
    if (file)
        fclose(file);
    if (text && !wrong) {
        text[length] = '\0';
        return text;
    }
    log_error("cannot read %s: %s", path, wrong);
    free(text);
    return NULL;
}

/* The plant, for all buses. Before signals are handled: it may come through a pipe, and take its time. */
static bool read_plant(struct bus_options *options)
{
    if (options->plant)
        options->plant_text = read_text(options->plant);
    if (options->plant_text && !output_file_spare(options->plant)) {
        log_error("out of memory");
        return false;
    }
    return !options->plant || options->plant_text;
}

/* Replace the address of an option by the same in digits. Before signals are handled, too: a name server may take its time. */
static bool find_address(const char **address, char found[NET_NAME_SIZE])
{
    const char *wrong = *address ? net_address_find(*address, NAME_WAIT_MS, found) : NULL;
    if (wrong)
        log_error("cannot listen at %s: %s", *address, wrong);
    else if (*address)
        *address = found;
    return !wrong;
}

static bool find_addresses(struct serve *serve)
{
    struct bus_options *options = &serve->options;
    bool ok = find_address(&options->tcp, serve->tcp) && find_address(&options->rfc2217, serve->rfc2217) &&
              find_address(&options->control_tcp, serve->control_tcp);
    for (unsigned at = 0; ok && at < DEVICE_SERVICES_MAX; at++)
        ok = find_address(&options->service[at].address, serve->service[at]);
    return ok;
}

static bool start_serve(struct serve *serve)
{
    const struct bus_options *options = &serve->options;
    if (!start_signals(serve)) /* before anything is made that would have to be removed */
        return false;
    if (is_coverage_wanted(serve))
        options->device.kind->coverage->begin(&serve->coverage, &options->device.config);
    serve->idle.data = serve;
    if (!check_uv("make a timer", uv_timer_init(&serve->loop, &serve->idle)) || !start_watch(serve) || !start_buses(serve) ||
        !reserve_files(serve) || !start_control(serve) || !start_window(serve) || !run_buses(serve))
        return false;
    serve_sandbox_files(options, serve->bus, control_path(serve->control));
    log_start_thread();
    log_flush(LOG_WAIT_MS); /* before READY, for readers of both */
    if (!serve_report_ready(options, serve->bus, serve->control))
        return false;
    if (serve->window >= 0)
        serve_window_show(serve->window);
    serve_sandbox_calls(options);
    on_presence(serve);
    return true;
}

/* ---- End ------------------------------------------------------------------------------------------------------------ */

static void close_handle(uv_handle_t *handle, void *unused)
{
    (void)unused;
    if (!uv_is_closing(handle))
        uv_close(handle, NULL);
}

static void report_coverage(struct serve *serve)
{
    const struct bus_options *options = &serve->options;
    double percent = coverage_percent(&serve->coverage);
    if (options->coverage && !coverage_write(&serve->coverage, &serve->coverage_files))
        serve->status = STATUS_FAILURE;
    log_at(bus_present(serve->bus[0]), "coverage of the protocol: %.1f %%", percent);
    if (options->min_coverage >= 0 && (int)(percent * 10 + 0.5) < options->min_coverage) {
        log_error("clients have exercised %.1f %% of the protocol: expected at least %d.%d %%", percent,
                  options->min_coverage / 10, options->min_coverage % 10);
        if (serve->status == STATUS_SUCCESS)
            serve->status = STATUS_COVERAGE;
    }
}

static void end_serve(struct serve *serve)
{
    control_close(serve->control);
    if (serve->window >= 0)
        close(serve->window);
    for (unsigned i = 0; i < serve->options.lines; i++)
        if (serve->bus[i] && !bus_end(serve->bus[i]))
            serve->status = STATUS_FAILURE;
    coverage_close(&serve->coverage_files);
    control_hang_up(serve->control);
    uv_walk(&serve->loop, close_handle, NULL);
    uv_run(&serve->loop, UV_RUN_DEFAULT);
    uv_loop_close(&serve->loop);
    control_free(serve->control);
    for (unsigned i = 0; i < serve->options.lines; i++)
        if (serve->bus[i])
            bus_free(serve->bus[i]);
    line_watch_close(&serve->watch);
}

static enum exit_status run_serve(struct serve *serve)
{
    serve->status = STATUS_FAILURE;
    serve->window = -1;
    if (!serve_allow_files(&serve->options) || !read_plant(&serve->options) || !find_addresses(serve) ||
        !check_uv("make an event loop", uv_loop_init(&serve->loop)))
        return STATUS_FAILURE;
    if (start_serve(serve)) {
        serve->status = STATUS_SUCCESS;
        uv_run(&serve->loop, UV_RUN_DEFAULT);
        notify_stopping();
        for (unsigned i = 0; i < serve->options.lines; i++)
            serve_report_end(serve->bus[i]);
        if (is_coverage_wanted(serve))
            report_coverage(serve);
    } else {
        output_files_undo();
    }
    end_serve(serve);
    free(serve->options.plant_text);
    device_arguments_free(&serve->options.device);
    return serve->status;
}

int serve_main(int argc, char **argv)
{
    static struct serve serve; /* too large for the stack of some systems */
    serve.watch.fd = -1;
    serve_options_read(&serve.options, argc, argv);
    signal(SIGPIPE, SIG_IGN);
    log_begin();
    enum exit_status status = run_serve(&serve);
    log_start_thread();
    log_flush(LOG_WAIT_MS);
    return (int)status;
}
