/* SPDX-License-Identifier: MIT */
#include "client_screen.h"

#include <curses.h>
#include <langinfo.h>
#include <locale.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "client_terminal.h"

static SCREEN *screen;
static bool coloured;
static volatile sig_atomic_t told_to_end, resized;

static void on_signal(int number)
{
    if (number == SIGWINCH)
        resized = 1;
    else
        told_to_end = number;
}

static const struct {
    attr_t attributes;
    short pair, colour;
} styles[PANEL_STYLES] = {
    [PANEL_PLAIN] = {A_NORMAL, 0, 0},        [PANEL_TITLE] = {A_REVERSE, 0, 0},
    [PANEL_HEAD] = {A_UNDERLINE, 0, 0},      [PANEL_LIT] = {A_BOLD, 1, COLOR_GREEN},
    [PANEL_DARK] = {A_NORMAL, 0, 0},         [PANEL_WRONG] = {A_BOLD, 2, COLOR_RED},
};

static void handle_signals(void)
{
    static const int signals[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGWINCH};
    struct sigaction action = {.sa_handler = on_signal};
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++)
        sigaction(signals[i], &action, NULL);
}

bool client_screen_open(void)
{
    const char *no_color = getenv("NO_COLOR");
    handle_signals();
    screen = client_terminal_is_usable() ? newterm(NULL, stdout, stdin) : NULL;
    if (screen == NULL)
        return false;
    cbreak();
    noecho();
    nonl();
    keypad(stdscr, TRUE);
    nodelay(stdscr, TRUE);
    curs_set(0);
    coloured = has_colors() && (no_color == NULL || no_color[0] == '\0') && start_color() == OK && use_default_colors() == OK;
    for (size_t i = 0; coloured && i < PANEL_STYLES; i++) {
        if (styles[i].pair > 0)
            init_pair(styles[i].pair, styles[i].colour, -1);
    }
    return true;
}

void client_screen_close(void)
{
    endwin();
    delscreen(screen);
}

bool client_screen_is_plain(void)
{
    setlocale(LC_CTYPE, "");
    return strcmp(nl_langinfo(CODESET), "UTF-8") != 0;
}

/* Everything is painted again: what the terminal showed may be gone, even if the size is what it was. */
static void redraw(void)
{
    struct winsize size;
    resized = 0;
    if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_row > 0 && size.ws_col > 0)
        resizeterm(size.ws_row, size.ws_col);
    clearok(curscr, TRUE);
}

bool client_screen_size(int *rows, int *columns)
{
    const bool changed = resized;
    if (changed)
        redraw();
    *rows = LINES;
    *columns = COLS;
    return changed;
}

void client_screen_draw(const struct panel *panel)
{
    erase();
    for (int row = 0; row < panel->rows; row++) {
        for (int column = 0; column < panel->columns; column++) {
            const struct panel_cell *cell = &panel->cell[row][column];
            wchar_t text[2] = {cell->character, L'\0'};
            cchar_t character;
            short pair = coloured ? styles[cell->style].pair : 0;
            setcchar(&character, text, styles[cell->style].attributes, pair, NULL);
            mvadd_wch(row, column, &character);
        }
    }
    refresh();
}

bool client_screen_wait(int fd, int timeout_ms)
{
    struct pollfd ready[] = {{.fd = STDIN_FILENO, .events = POLLIN}, {.fd = fd, .events = POLLIN}};
    poll(ready, 2, timeout_ms);
    return told_to_end == 0 && (ready[0].revents & (POLLHUP | POLLERR | POLLNVAL)) == 0;
}

enum client_key client_screen_key(void)
{
    for (int key; (key = getch()) != ERR;) {
        switch (key) {
        case 'q':
        case 'Q':
            return CLIENT_KEY_QUIT;
        case '\t':
        case 'n':
        case KEY_RIGHT:
        case KEY_DOWN:
            return CLIENT_KEY_NEXT;
        case KEY_BTAB:
        case 'p':
        case KEY_LEFT:
        case KEY_UP:
            return CLIENT_KEY_BEFORE;
        case '\f':
            resized = 1;
            return CLIENT_KEY_REDRAW;
        default:
            break;
        }
    }
    return CLIENT_KEY_NONE;
}

void client_screen_raise(void)
{
    if (told_to_end != 0 && told_to_end != SIGINT) { /* Ctrl-C is as good as q */
        signal(told_to_end, SIG_DFL);
        raise(told_to_end);
    }
}
