/* SPDX-License-Identifier: MIT */
#include "window_page.h"

#include <libwebsockets.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "window_control.h"

struct page *page_open(struct pages *pages, struct lws *socket)
{
    struct page *page = pages->count < PAGES_MAX ? calloc(1, sizeof *page) : NULL;
    if (page == NULL)
        return NULL;
    *page = (struct page){.next = pages->first, .pages = pages, .socket = socket, .number = ++pages->last,
                          .allowance = 2 * PAGE_RATE, .counted = uv_now(pages->loop)};
    pages->first = page;
    pages->count++;
    return page;
}

void page_close(struct page *page)
{
    struct page **at = &page->pages->first;
    while (*at != page)
        at = &(*at)->next;
    *at = page->next;
    page->pages->count--;
    while (page->first != NULL)
        page_written(page);
    page->pages->closed(page);
    free(page->message);
    free(page);
}

void page_detach(struct page *page)
{
    if (page->control != NULL && page->leave != NULL)
        window_control_send(page->control, page->leave, strlen(page->leave)); /* written at once, but to a clogged socket */
    free(page->leave);
    page->leave = NULL;
    window_control_close(page->control);
    page->control = NULL;
}

struct page *page_find(const struct pages *pages, uint64_t number)
{
    struct page *page = pages->first;
    while (page != NULL && page->number != number)
        page = page->next;
    return page;
}

/* ---- In --------------------------------------------------------------------------------------------------------------- */

static bool is_too_fast(struct page *page)
{
    uint64_t now = uv_now(page->pages->loop);
    page->allowance += (double)(now - page->counted) * PAGE_RATE / 1000.0;
    if (page->allowance > 2 * PAGE_RATE)
        page->allowance = 2 * PAGE_RATE;
    page->counted = now;
    page->allowance -= 1;
    return page->allowance < 0;
}

static void take_message(struct page *page)
{
    json_error_t wrong;
    json_t *request = json_loadb((const char *)page->message, page->length, JSON_REJECT_DUPLICATES, &wrong);
    if (request == NULL)
        page_refuse(page, NULL, "invalid JSON: %s", wrong.text);
    else
        page->pages->request(page, request);
    json_decref(request);
}

bool page_receive(struct page *page, const void *bytes, size_t length, bool last)
{
    if (page->message == NULL)
        page->message = malloc(PAGE_MESSAGE_MAX);
    if (page->message == NULL || length > PAGE_MESSAGE_MAX - page->length)
        return false;
    memcpy(page->message + page->length, bytes, length);
    page->length += length;
    if (!last)
        return true;
    if (is_too_fast(page))
        return false;
    take_message(page);
    page->length = 0;
    return !page->failed;
}

/* ---- Out -------------------------------------------------------------------------------------------------------------- */

static void ask_to_write(struct page *page)
{
    if (page->socket != NULL)
        lws_callback_on_writable(page->socket);
}

void page_send_text(struct page *page, const char *text, size_t length, bool frame)
{
    if (page->failed || (frame && page->waiting > PAGE_FRAMES_MAX))
        return;
    struct page_text *made = page->waiting + length <= PAGE_WAITING_MAX ? malloc(sizeof *made + LWS_PRE + length) : NULL;
    if (made == NULL) {
        page->failed = true;
        ask_to_write(page);
        return;
    }
    *made = (struct page_text){.length = length};
    memcpy(made->bytes + LWS_PRE, text, length);
    if (page->last != NULL)
        page->last->next = made;
    else
        page->first = made;
    page->last = made;
    page->waiting += length;
    ask_to_write(page);
}

void page_send(struct page *page, json_t *object)
{
    char *text = object != NULL ? json_dumps(object, JSON_COMPACT) : NULL;
    if (text != NULL)
        page_send_text(page, text, strlen(text), false);
    free(text);
    json_decref(object);
}

void pages_send(struct pages *pages, json_t *object)
{
    char *text = object != NULL ? json_dumps(object, JSON_COMPACT) : NULL;
    for (struct page *page = pages->first; text != NULL && page != NULL; page = page->next)
        page_send_text(page, text, strlen(text), false);
    free(text);
    json_decref(object);
}

void page_answer(struct page *page, const json_t *request, json_t *answer)
{
    json_t *id = json_object_get(request, "id");
    if (answer != NULL)
        json_object_set(answer, "id", id != NULL ? id : json_null());
    page_send(page, answer);
}

void page_refuse(struct page *page, const json_t *request, const char *format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    json_t *said = json_string(text);
    page_answer(page, request, json_pack("{s:o}", "error", said != NULL ? said : json_string("refused")));
}

struct page_text *page_next(struct page *page)
{
    return page->first;
}

void page_written(struct page *page)
{
    struct page_text *done = page->first;
    page->first = done->next;
    if (page->first == NULL)
        page->last = NULL;
    page->waiting -= done->length;
    free(done);
}
