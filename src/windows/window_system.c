/* SPDX-License-Identifier: MIT */
/* window_system.c: what the window asks of Windows. */
#include "window/window_system.h"

#include <err.h>
#include <objbase.h>
#include <shellapi.h>

#include "port.h"

#define ADDRESS_SIZE 256

/* Ctrl-C, Ctrl-Break, and the console that is closed. */
const int window_signals[WINDOW_SIGNALS] = {SIGINT, SIGBREAK, SIGHUP};
const char window_ended_by[] = "Ctrl-C, Ctrl-Break or the end of its console";
const char window_examples[] =
    "  rkmctl window --open\n"
    "  rkmctl window -p COM3\n"
    "  rkmctl window -p tcp:localhost:4001\n"
    "  rkmctl window -c bus.control\n";

const char *window_option_text(const char *name, const char *text)
{
    if (strcmp(name, "bound") == 0)
        return NULL;
    if (strcmp(name, "port") == 0)
        return "Open this port at the start: a COM port, as in COM3, or tcp:HOST:PORT; otherwise choose one in the page";
    if (strcmp(name, "control") == 0)
        return "Show the units of the emulator with this control file";
    return text;
}

void window_system_begin(void)
{
}

bool window_is_wanted(void)
{
    return true;
}

void window_watch_input(uv_loop_t *loop, uv_poll_t *input)
{
    (void)loop;
    (void)input;
}

/* A browser may take its time to begin: this is a thread of its own. */
static DWORD WINAPI show(void *address)
{
    wchar_t wide[ADDRESS_SIZE];
    SHELLEXECUTEINFOW about = {.cbSize = sizeof about, .fMask = SEE_MASK_NOASYNC | SEE_MASK_FLAG_NO_UI, .lpVerb = L"open",
                               .lpFile = wide, .nShow = SW_SHOWNORMAL};
    HRESULT begun = CoInitializeEx(NULL, COINIT_APARTMENTTHREADED | COINIT_DISABLE_OLE1DDE);
    if (MultiByteToWideChar(CP_UTF8, 0, address, -1, wide, ADDRESS_SIZE) == 0 || !ShellExecuteExW(&about))
        warnx("cannot start a browser: open the address yourself");
    if (SUCCEEDED(begun))
        CoUninitialize();
    return 0;
}

void window_show_in_browser(const char *address)
{
    static char kept[ADDRESS_SIZE];
    snprintf(kept, sizeof kept, "%s", address);
    HANDLE thread = CreateThread(NULL, 0, show, kept, 0, NULL);
    if (thread != NULL)
        CloseHandle(thread);
    else
        warnx("cannot start a browser: open the address yourself");
}

int window_stream_open(uv_loop_t *loop, union window_stream *stream, int fd)
{
    uv_tcp_init(loop, &stream->tcp);
    return uv_tcp_open(&stream->tcp, (uv_os_sock_t)fd);
}

int window_cancel_open(void)
{
    return CANCEL_FD;
}

void window_cancel_set(int cancel)
{
    (void)cancel;
    port_set_cancelled(true);
}

void window_cancel_clear(int cancel)
{
    (void)cancel;
    port_set_cancelled(false);
}

void window_cancel_close(int cancel)
{
    (void)cancel;
}
