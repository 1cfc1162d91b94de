/* SPDX-License-Identifier: MIT */
#include "window_server.h"

#include <err.h>
#include <libwebsockets.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "text/text.h"
#include "window_files.h"
#include "window_inside.h"

#define SECURITY_HEADERS \
    "content-security-policy: default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; " \
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'\r\n" \
    "x-content-type-options: nosniff\r\nreferrer-policy: no-referrer\r\ncross-origin-opener-policy: same-origin\r\n" \
    "cross-origin-resource-policy: same-origin\r\ncache-control: no-store\r\n"
#define CHUNK 16384u
#define CONNECTIONS_MAX 60u /* on Windows, libwebsockets has 64 events, and needs one itself */

struct http_session {
    const struct window_file *file;
    size_t sent;
};

static struct window *window_of(struct lws *socket)
{
    return lws_context_user(lws_get_context(socket));
}

/* ---- Who may come in -------------------------------------------------------------------------------------------------- */

static bool header(struct lws *socket, enum lws_token_indexes name, char *text, int size)
{
    int length = lws_hdr_copy(socket, text, size, name);
    return length > 0 && (size_t)length == strlen(text);
}

/* The address served, or localhost with the same port. */
static bool is_own_host(const struct window *window, const char *host)
{
    char local[32];
    snprintf(local, sizeof local, "localhost:%u", window->listens);
    return strcmp(host, window->host) == 0 || strcmp(host, local) == 0;
}

/* Takes the same time however much of the token is right. */
static bool is_token(const struct window *window, const char *text)
{
    return strlen(text) == WINDOW_TOKEN_SIZE - 1 && lws_timingsafe_bcmp(text, window->token, WINDOW_TOKEN_SIZE - 1) == 0;
}

/* Cookies do not know ports: each window has a name of its own. */
static bool has_cookie(struct lws *socket)
{
    const struct window *window = window_of(socket);
    char cookies[2048], name[32];
    if (!header(socket, WSI_TOKEN_HTTP_COOKIE, cookies, sizeof cookies))
        return false;
    snprintf(name, sizeof name, "rkm04-%u=", window->listens);
    char *rest = NULL;
    for (char *one = strtok_r(cookies, "; ", &rest); one != NULL; one = strtok_r(NULL, "; ", &rest))
        if (strncmp(one, name, strlen(name)) == 0 && is_token(window, one + strlen(name)))
            return true;
    return false;
}

static bool has_token(struct lws *socket)
{
    char argument[128];
    const char *token = lws_get_urlarg_by_name(socket, "token=", argument, sizeof argument);
    return token != NULL && is_token(window_of(socket), token);
}

static bool is_host_allowed(struct lws *socket)
{
    char host[128];
    return header(socket, WSI_TOKEN_HOST, host, sizeof host) && is_own_host(window_of(socket), host);
}

static bool is_origin_allowed(struct lws *socket)
{
    char origin[160], host[128];
    return header(socket, WSI_TOKEN_ORIGIN, origin, sizeof origin) && header(socket, WSI_TOKEN_HOST, host, sizeof host) &&
           strncmp(origin, "http://", 7) == 0 && strcmp(origin + 7, host) == 0;
}

/* ---- Files ------------------------------------------------------------------------------------------------------------ */

static int refuse(struct lws *socket, unsigned code, const char *text)
{
    return lws_return_http_status(socket, code, text) != 0 || lws_http_transaction_completed(socket) != 0 ? -1 : 0;
}

/* All headers of one answer; with the cookie. */
static bool write_headers(struct lws *socket, const struct window_file *file)
{
    const struct window *window = window_of(socket);
    unsigned char buffer[LWS_PRE + 2048], *at = buffer + LWS_PRE, *end = buffer + sizeof buffer - 1;
    char rest[1200];
    int length = snprintf(rest, sizeof rest, SECURITY_HEADERS "set-cookie: rkm04-%u=%s; Path=/; HttpOnly; SameSite=Strict\r\n",
                          window->listens, window->token);
    if (lws_add_http_common_headers(socket, HTTP_STATUS_OK, file->type, file->length, &at, end) != 0 ||
        length >= end - at - 4)
        return false;
    memcpy(at, rest, (size_t)length);
    at += length;
    return lws_finalize_write_http_header(socket, buffer + LWS_PRE, &at, end) == 0;
}

static int begin_file(struct lws *socket, struct http_session *session, const struct window_file *file)
{
    *session = (struct http_session){.file = file};
    if (!write_headers(socket, file))
        return -1;
    lws_callback_on_writable(socket);
    return 0;
}

static int continue_file(struct lws *socket, struct http_session *session)
{
    unsigned char buffer[LWS_PRE + CHUNK];
    const struct window_file *file = session->file;
    if (file == NULL)
        return 0;
    size_t left = file->length - session->sent, length = left < CHUNK ? left : CHUNK;
    memcpy(buffer + LWS_PRE, file->bytes + session->sent, length);
    session->sent += length;
    bool last = session->sent == file->length;
    if (lws_write(socket, buffer + LWS_PRE, length, last ? LWS_WRITE_HTTP_FINAL : LWS_WRITE_HTTP) < (int)length)
        return -1;
    if (last) {
        session->file = NULL;
        return lws_http_transaction_completed(socket) != 0 ? -1 : 0;
    }
    lws_callback_on_writable(socket);
    return 0;
}

/* A file that the emulator has written for this window. */
static int send_download(struct lws *socket, const char *name)
{
    const struct window *window = window_of(socket);
    static const char headers[] = SECURITY_HEADERS "content-disposition: attachment\r\n";
    char path[PATH_MAX];
    if (window->folder[0] == '\0' || name[0] == '.' || name[strspn(name, "abcdefghijklmnopqrstuvwxyz0123456789.-")] != '\0' ||
        snprintf(path, sizeof path, "%s/%s", window->folder, name) >= PATH_MAX || access(path, R_OK) != 0)
        return refuse(socket, HTTP_STATUS_NOT_FOUND, "There is no such file.");
    int sent = lws_serve_http_file(socket, path, "application/octet-stream", headers, sizeof headers - 1);
    return sent < 0 || (sent > 0 && lws_http_transaction_completed(socket) != 0) ? -1 : 0;
}

static int serve_request(struct lws *socket, struct http_session *session, const char *path)
{
    static const char download[] = "/download/";
    bool first = strcmp(path, "/") == 0;
    if (!is_host_allowed(socket))
        return refuse(socket, HTTP_STATUS_FORBIDDEN, "Open the address that the program has printed.");
    if (lws_hdr_total_length(socket, WSI_TOKEN_GET_URI) <= 0)
        return refuse(socket, HTTP_STATUS_METHOD_NOT_ALLOWED, "Expected GET.");
    if (!has_cookie(socket) && !(first && has_token(socket)))
        return refuse(socket, HTTP_STATUS_FORBIDDEN, "Open the whole address that the program has printed, with its token.");
    if (strncmp(path, download, sizeof download - 1) == 0)
        return send_download(socket, path + sizeof download - 1);
    const struct window_file *file = window_file_find(first ? "/index.html" : path);
    return file != NULL ? begin_file(socket, session, file) : refuse(socket, HTTP_STATUS_NOT_FOUND, "There is no such page.");
}

static int on_http(struct lws *socket, enum lws_callback_reasons reason, void *user, void *in, size_t length)
{
    switch (reason) {
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION: /* a WebSocket of no protocol of ours */
        return -1;
    case LWS_CALLBACK_HTTP:
        return serve_request(socket, user, in);
    case LWS_CALLBACK_HTTP_WRITEABLE:
        return continue_file(socket, user);
    case LWS_CALLBACK_HTTP_FILE_COMPLETION:
        return lws_http_transaction_completed(socket) != 0 ? -1 : 0;
    default:
        return lws_callback_http_dummy(socket, reason, user, in, length);
    }
}

/* ---- WebSocket -------------------------------------------------------------------------------------------------------- */

static int write_page(struct lws *socket, struct page *page)
{
    if (page->failed)
        return -1;
    struct page_text *text = page_next(page);
    if (text == NULL)
        return 0;
    int written = lws_write(socket, text->bytes + LWS_PRE, text->length, LWS_WRITE_TEXT);
    page_written(page);
    if (written < 0)
        return -1;
    if (page_next(page) != NULL)
        lws_callback_on_writable(socket);
    return 0;
}

/* Does what has come end a message? */
static bool is_whole(struct lws *socket)
{
    return lws_is_final_fragment(socket) && lws_remaining_packet_payload(socket) == 0;
}

static int on_socket(struct lws *socket, enum lws_callback_reasons reason, void *user, void *in, size_t length)
{
    struct page **page = user;
    switch (reason) {
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:
        return is_host_allowed(socket) && is_origin_allowed(socket) && has_cookie(socket) ? 0 : -1;
    case LWS_CALLBACK_ESTABLISHED:
        *page = page_open(&window_of(socket)->pages, socket);
        return *page != NULL ? 0 : -1;
    case LWS_CALLBACK_RECEIVE:
        return *page != NULL && page_receive(*page, in, length, is_whole(socket)) ? 0 : -1;
    case LWS_CALLBACK_SERVER_WRITEABLE:
        return *page != NULL ? write_page(socket, *page) : -1;
    case LWS_CALLBACK_CLOSED:
        if (*page != NULL)
            page_close(*page);
        *page = NULL;
        return 0;
    default:
        return 0;
    }
}

static const struct lws_protocols protocols[] = {
    {.name = "http", .callback = on_http, .per_session_data_size = sizeof(struct http_session)},
    {.name = "rkm04-window", .callback = on_socket, .per_session_data_size = sizeof(struct page *), .rx_buffer_size = 16384},
    {0},
};

/* ---- Calls ------------------------------------------------------------------------------------------------------------ */

static bool make_token(char token[WINDOW_TOKEN_SIZE])
{
    unsigned char random[(WINDOW_TOKEN_SIZE - 1) / 2];
    if (uv_random(NULL, NULL, random, sizeof random, 0, NULL) != 0)
        return false;
    for (size_t i = 0; i < sizeof random; i++)
        snprintf(token + 2 * i, 3, "%02x", random[i]);
    return true;
}

/* One address, which a browser can name: it is what Host has to be. Returns false if it is none. */
static bool read_address(const char *name, unsigned port, struct sockaddr_storage *address)
{
    struct sockaddr_in *four = (struct sockaddr_in *)address;
    struct sockaddr_in6 *six = (struct sockaddr_in6 *)address;
    *address = (struct sockaddr_storage){0};
    if (uv_ip4_addr(name, (int)port, four) == 0)
        return four->sin_addr.s_addr != INADDR_ANY;
    return strchr(name, '%') == NULL && uv_ip6_addr(name, (int)port, six) == 0 && !IN6_IS_ADDR_UNSPECIFIED(&six->sin6_addr);
}

static void on_connection(uv_stream_t *listener, int status)
{
    (void)listener;
    (void)status; /* its loop does not run */
}

/* Can the address be listened at now? libwebsockets would wait for an interface that has it. Returns 0 or an error of libuv. */
static int try_address(const struct sockaddr_storage *address)
{
    uv_loop_t loop;
    uv_tcp_t listener;
    int error = uv_loop_init(&loop);
    if (error != 0)
        return error;
    uv_tcp_init(&loop, &listener);
    error = uv_tcp_bind(&listener, (const struct sockaddr *)address, 0);
    if (error == 0)
        error = uv_listen((uv_stream_t *)&listener, 1, on_connection);
    uv_close((uv_handle_t *)&listener, NULL);
    uv_run(&loop, UV_RUN_DEFAULT);
    uv_loop_close(&loop);
    return error;
}

bool window_server_begin(struct window *window, const char *address)
{
    char name[64];
    const char *colon = strrchr(address, ':');
    const char *digits = address[0] == '[' ? address + 1 : address;
    uint64_t number;
    struct sockaddr_storage place;
    if (colon == NULL || !number_read(colon + 1, 0, UINT16_MAX, &number) || colon == address ||
        snprintf(name, sizeof name, "%.*s", (int)(colon - digits - (address[0] == '[')), digits) >= (int)sizeof name) {
        warnx("--http: expected ADDRESS:PORT, like 127.0.0.1:0, found '%s'", address);
        return false;
    }
    if (!read_address(name, (unsigned)number, &place)) {
        warnx("--http: expected one address of this machine in digits, like 127.0.0.1, found '%s'", name);
        return false;
    }
    int error = try_address(&place);
    if (error != 0) {
        warnx("cannot listen at %s: %s", address, uv_strerror(error));
        return false;
    }
    void *loops[] = {&window->loop};
    const uint64_t family = place.ss_family == AF_INET ? LWS_SERVER_OPTION_DISABLE_IPV6 : 0;
    const struct lws_context_creation_info info = {
        .iface = name, .port = (int)number, .protocols = protocols, .user = window, .foreign_loops = loops,
        .pcontext = &window->server,
        .fd_limit_per_thread = CONNECTIONS_MAX, .timeout_secs = 10, .keepalive_timeout = 10,
        .options = LWS_SERVER_OPTION_LIBUV | LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND | LWS_SERVER_OPTION_VALIDATE_UTF8 |
                   family,
        .vhost_name = "window",
    };
    lws_set_log_level(0, NULL);
    window->server = make_token(window->token) ? lws_create_context(&info) : NULL;
    struct lws_vhost *host = window->server != NULL ? lws_get_vhost_by_name(window->server, "window") : NULL;
    window->listens = host != NULL ? (unsigned)lws_get_vhost_listen_port(host) : 0;
    if (window->listens == 0) {
        warnx("cannot listen at %s", address);
        return false;
    }
    snprintf(window->host, sizeof window->host, address[0] == '[' ? "[%s]:%u" : "%s:%u", name, window->listens);
    return true;
}

void window_server_end(struct window *window)
{
    if (window->server != NULL)
        lws_context_destroy(window->server); /* sets it to NULL when all is closed */
}
