/* SPDX-License-Identifier: MIT */
#include "window_port.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "window_page.h"
#include "window_port_work.h"
#include "window_system.h"

struct port_job *port_job_new(enum port_kind kind, uint64_t page, json_t *request)
{
    struct port_job *job = calloc(1, sizeof *job);
    if (job == NULL)
        return NULL;
    job->kind = kind;
    job->page = page;
    job->request = json_incref(request);
    job->asked = client_now();
    return job;
}

void port_job_free(struct port_job *job)
{
    json_decref(job->request);
    json_decref(job->result);
    free(job->text);
    free(job);
}

json_t *window_port_json(const struct window_port *port)
{
    json_t *name = port->shown[0] != '\0' ? json_string(port->shown) : NULL;
    return json_pack("{s:s, s:o, s:s?}", "event", "port", "port", name != NULL ? name : json_null(), "framing",
                     port->framing != NULL ? port->framing->name : NULL);
}

/* ---- Jobs ------------------------------------------------------------------------------------------------------------- */

static void start_next(struct window_port *port);

/* Tell who has asked, and the other pages what they may want to know. */
static void report_job(const struct window_port *port, struct port_job *job)
{
    struct page *page = page_find(port->pages, job->page);
    json_t *answer = job->result != NULL ? json_incref(job->result) : json_pack("{s:s}", "outcome", "cancelled");
    json_t *trouble = job->trouble[0] != '\0' ? json_string(job->trouble) : NULL;
    if (trouble != NULL)
        json_object_set_new(answer, "trouble", trouble);
    json_object_set(answer, "asked", job->request);
    if (!job->poll) {
        json_t *heard = json_copy(answer);
        json_object_set_new(heard, "event", json_string("answer"));
        json_object_set_new(heard, "page", json_integer((json_int_t)job->page));
        pages_send(port->pages, heard);
    }
    if (page != NULL)
        page_answer(page, job->request, answer);
    else
        json_decref(answer);
    if (job->kind == PORT_OPEN || job->kind == PORT_CLOSE || port->shown[0] == '\0')
        pages_send(port->pages, window_port_json(port));
}

static void on_work(uv_work_t *work)
{
    struct window_port *port = work->data;
    port_work(port, port->present);
}

static void on_done(uv_work_t *work, int status)
{
    struct window_port *port = work->data;
    struct port_job *job = port->present;
    (void)status;
    port->present = NULL;
    strcpy(port->shown, port->name);
    port->framing = port->client.framing;
    report_job(port, job);
    port_job_free(job);
    start_next(port);
}

static void start_next(struct window_port *port)
{
    if (port->present != NULL || port->first == NULL)
        return;
    port->present = port->first;
    port->first = port->first->next;
    if (port->first == NULL)
        port->last = NULL;
    port->waiting--;
    atomic_store(&port->sent, 0);
    atomic_store(&port->total, 0);
    port->work.data = port;
    uv_queue_work(port->pages->loop, &port->work, on_work, on_done);
}

static void on_progress(uv_async_t *handle)
{
    struct window_port *port = handle->data;
    pages_send(port->pages, json_pack("{s:s, s:I, s:I}", "event", "progress", "sent", (json_int_t)atomic_load(&port->sent),
                                       "total", (json_int_t)atomic_load(&port->total)));
}

static void cancel_all(struct window_port *port)
{
    while (port->first != NULL) {
        struct port_job *job = port->first;
        port->first = job->next;
        report_job(port, job);
        port_job_free(job);
    }
    port->last = NULL;
    port->waiting = 0;
    if (port->present != NULL && port->present->kind != PORT_STOP)
        window_cancel_set(port->cancel);
}

bool window_port_do(struct window_port *port, struct port_job *job)
{
    if (job->kind == PORT_STOP)
        cancel_all(port);
    if (port->waiting >= PORT_JOBS_MAX) {
        port_job_free(job);
        return false;
    }
    if (port->last != NULL)
        port->last->next = job;
    else
        port->first = job;
    port->last = job;
    port->waiting++;
    start_next(port);
    return true;
}

/* ---- Begin, end ------------------------------------------------------------------------------------------------------- */

bool window_port_begin(struct window_port *port, struct pages *pages)
{
    port->pages = pages;
    port->client = (struct client){.fd = -1, .framing = &rkm04_hdlc, .cancel = &port->cancel};
    port->cancel = window_cancel_open();
    port->progress.data = port;
    return port->cancel >= 0 && uv_async_init(pages->loop, &port->progress, on_progress) == 0;
}

void window_port_end(struct window_port *port)
{
    cancel_all(port);
}

void window_port_close(struct window_port *port)
{
    port_work_close(port);
    window_cancel_close(port->cancel);
}
