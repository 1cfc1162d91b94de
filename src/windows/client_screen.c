/* SPDX-License-Identifier: MIT */
/* client_screen.c: the console, by the control sequences that it knows from Windows 10 on. */
#include "client/client_screen.h"

#include <err.h>
#include <windows.h>

#include "client/client_socket.h"

#define LOOK_MS 20 /* between two looks at the keyboard: it and a socket cannot be waited for together */

static HANDLE in, out;
static DWORD in_mode, out_mode;
static UINT code_page;
static COORD known;
static bool coloured, is_changed;
static volatile LONG told_to_end;

static BOOL WINAPI on_control(DWORD what)
{
    (void)what;
    InterlockedExchange(&told_to_end, 1);
    return TRUE;
}

static void write_text(const char *text)
{
    DWORD written;
    WriteConsoleA(out, text, (DWORD)strlen(text), &written, NULL);
}

bool client_screen_open(void)
{
    const char *no_color = getenv("NO_COLOR");
    in = GetStdHandle(STD_INPUT_HANDLE);
    out = GetStdHandle(STD_OUTPUT_HANDLE);
    if (!GetConsoleMode(in, &in_mode) || !GetConsoleMode(out, &out_mode) ||
        !SetConsoleMode(out, out_mode | ENABLE_PROCESSED_OUTPUT | ENABLE_VIRTUAL_TERMINAL_PROCESSING)) {
        warnx("watch: the console cannot show a panel: use --once");
        return false;
    }
    SetConsoleMode(in, ENABLE_PROCESSED_INPUT | ENABLE_WINDOW_INPUT);
    SetConsoleCtrlHandler(on_control, TRUE);
    code_page = GetConsoleOutputCP();
    SetConsoleOutputCP(CP_UTF8);
    coloured = no_color == NULL || no_color[0] == '\0';
    write_text("\033[?1049h\033[?25l"); /* another screen, without a cursor */
    return true;
}

void client_screen_close(void)
{
    write_text("\033[0m\033[?25h\033[?1049l");
    SetConsoleOutputCP(code_page);
    SetConsoleMode(out, out_mode);
    SetConsoleMode(in, in_mode);
    SetConsoleCtrlHandler(on_control, FALSE);
}

bool client_screen_is_plain(void)
{
    return false;
}

bool client_screen_size(int *rows, int *columns)
{
    CONSOLE_SCREEN_BUFFER_INFO info = {0};
    bool changed = is_changed;
    if (GetConsoleScreenBufferInfo(out, &info)) {
        const SMALL_RECT *window = &info.srWindow;
        COORD size = {(SHORT)(window->Right - window->Left + 1), (SHORT)(window->Bottom - window->Top + 1)};
        changed = changed || size.X != known.X || size.Y != known.Y;
        known = size;
    }
    is_changed = false;
    *rows = known.Y;
    *columns = known.X;
    return changed;
}

static const char *style_of(unsigned char style)
{
    static const char *const colours[PANEL_STYLES] = {
        [PANEL_PLAIN] = "\033[0m",     [PANEL_TITLE] = "\033[0;7m", [PANEL_HEAD] = "\033[0;4m",
        [PANEL_LIT] = "\033[0;1;32m",  [PANEL_DARK] = "\033[0m",    [PANEL_WRONG] = "\033[0;1;31m",
    };
    if (!coloured && (style == PANEL_LIT || style == PANEL_WRONG))
        return "\033[0;1m";
    return colours[style];
}

/* Draw a row: its cells, and nothing behind them. */
static void draw_row(const struct panel *panel, int row)
{
    char text[PANEL_COLUMNS * 16 + 32];
    int length = snprintf(text, sizeof text, "\033[%d;1H", row + 1), style = -1;
    for (int column = 0; row < panel->rows && column < panel->columns; column++) {
        const struct panel_cell *cell = &panel->cell[row][column];
        if (cell->style != style)
            length += snprintf(text + length, sizeof text - (size_t)length, "%s", style_of(cell->style));
        style = cell->style;
        length += WideCharToMultiByte(CP_UTF8, 0, &cell->character, 1, text + length, 4, NULL, NULL);
    }
    snprintf(text + length, sizeof text - (size_t)length, "\033[0m\033[K");
    write_text(text);
}

void client_screen_draw(const struct panel *panel)
{
    for (int row = 0; row < known.Y; row++)
        draw_row(panel, row);
}

static bool has_input(void)
{
    DWORD count = 0;
    return GetNumberOfConsoleInputEvents(in, &count) && count > 0;
}

bool client_screen_wait(int fd, int timeout_ms)
{
    ULONGLONG end = GetTickCount64() + (ULONGLONG)timeout_ms;
    while (told_to_end == 0 && !has_input() && !client_socket_wait(fd, LOOK_MS) && GetTickCount64() < end)
        ;
    return told_to_end == 0;
}

static enum client_key key_of(const KEY_EVENT_RECORD *key)
{
    switch (key->wVirtualKeyCode) {
    case 'Q':
        return CLIENT_KEY_QUIT;
    case VK_TAB:
        return (key->dwControlKeyState & SHIFT_PRESSED) != 0 ? CLIENT_KEY_BEFORE : CLIENT_KEY_NEXT;
    case 'N':
    case VK_RIGHT:
    case VK_DOWN:
        return CLIENT_KEY_NEXT;
    case 'P':
    case VK_LEFT:
    case VK_UP:
        return CLIENT_KEY_BEFORE;
    default:
        return CLIENT_KEY_NONE;
    }
}

enum client_key client_screen_key(void)
{
    INPUT_RECORD record;
    DWORD count;
    while (has_input() && ReadConsoleInputW(in, &record, 1, &count) && count == 1) {
        enum client_key key = CLIENT_KEY_NONE;
        if (record.EventType == WINDOW_BUFFER_SIZE_EVENT)
            is_changed = true;
        else if (record.EventType == KEY_EVENT && record.Event.KeyEvent.bKeyDown)
            key = key_of(&record.Event.KeyEvent);
        if (key != CLIENT_KEY_NONE)
            return key;
    }
    return CLIENT_KEY_NONE;
}

void client_screen_raise(void)
{
}
