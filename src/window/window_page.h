/* SPDX-License-Identifier: MIT */
/* window_page.h: an open page: what it sends and what it gets, within limits. Work for a page keeps its number, which no later
 * page has: there is none when the page has gone. */
#ifndef RKM04_WINDOW_PAGE_H
#define RKM04_WINDOW_PAGE_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <uv.h>

#define PAGES_MAX 16u
#define PAGE_MESSAGE_MAX (256u * 1024u)     /* bytes of a message from a page */
#define PAGE_WAITING_MAX (4u * 1024u * 1024u) /* bytes that wait for a page; beyond that it is closed */
#define PAGE_FRAMES_MAX (256u * 1024u)      /* with more waiting, states are left out */
#define PAGE_RATE 200u                      /* messages a second; twice as many at once */

struct lws;
struct page;

/* All pages that are open. */
struct pages {
    uv_loop_t *loop;
    struct page *first;
    size_t count;
    uint64_t last; /* number given to the newest page */
    void (*request)(struct page *page, json_t *request); /* a message has come */
    void (*closed)(struct page *page);                   /* a page is about to go: no longer in the list */
    void *context;
};

struct page_text {
    struct page_text *next;
    size_t length;
    unsigned char bytes[]; /* LWS_PRE free bytes, then the text */
};

struct page {
    struct page *next;
    struct pages *pages;
    struct lws *socket; /* NULL: none, in tests */
    uint64_t number;
    unsigned char *message; /* what has come of one, of PAGE_MESSAGE_MAX */
    size_t length;
    double allowance;       /* messages it may send now */
    uint64_t counted;       /* loop time of that, ms */
    struct page_text *first, *last;
    size_t waiting;         /* bytes */
    bool failed;            /* is to be closed */
    bool watching;          /* wants the states of units */
    bool busy;              /* a job of the program tools is under way, */
    struct tools_job *later; /* and this one comes next */
    struct window_control *control; /* its connection to the emulator; NULL: none */
    char *leave;            /* a line that goes there before that connection ends; NULL: none */
};

/* NULL: there are too many, or no memory. */
struct page *page_open(struct pages *pages, struct lws *socket);
void page_close(struct page *page);
struct page *page_find(const struct pages *pages, uint64_t number);

/* Bytes of a message have come; `last` ends it. Returns false if the page is to be closed. */
bool page_receive(struct page *page, const void *bytes, size_t length, bool last);

/* End the page's connection to the emulator, which is sent `leave` before: what was held in the page is let go. */
void page_detach(struct page *page);

/* Send an object; takes the reference. A `frame` is left out if the page is slow. */
void page_send(struct page *page, json_t *object);
void page_send_text(struct page *page, const char *text, size_t length, bool frame);
void pages_send(struct pages *pages, json_t *object);

/* Answer a request of the page: `answer` gets its id. Takes the reference to answer. */
void page_answer(struct page *page, const json_t *request, json_t *answer);
void page_refuse(struct page *page, const json_t *request, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* The next text to be written is at *bytes with LWS_PRE free bytes before it; NULL: none. page_written() ends it. */
struct page_text *page_next(struct page *page);
void page_written(struct page *page);

#endif
