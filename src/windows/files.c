/* SPDX-License-Identifier: MIT */
/* files.c: files by path and descriptor. */
#include <errno.h>
#include <stdarg.h>
#include <stdbool.h>
#include <sys/file.h>
#include <windows.h>

#include <sddl.h>

#undef stat
#undef fstat
#undef open
#undef fopen
#undef fclose

/* Returns -1, with errno as POSIX has it. */
static int fail(void)
{
    switch (GetLastError()) {
    case ERROR_FILE_NOT_FOUND:
    case ERROR_PATH_NOT_FOUND:
    case ERROR_INVALID_NAME:
    case ERROR_BAD_PATHNAME:
        errno = ENOENT;
        break;
    case ERROR_ACCESS_DENIED:
    case ERROR_WRITE_PROTECT:
        errno = EACCES;
        break;
    case ERROR_SHARING_VIOLATION:
    case ERROR_LOCK_VIOLATION:
        errno = EBUSY;
        break;
    case ERROR_FILE_EXISTS:
    case ERROR_ALREADY_EXISTS:
        errno = EEXIST;
        break;
    case ERROR_DISK_FULL:
        errno = ENOSPC;
        break;
    case ERROR_TOO_MANY_OPEN_FILES:
        errno = EMFILE;
        break;
    default:
        errno = EIO;
        break;
    }
    return -1;
}

#define WIDE_MAX 4096 /* characters of a path */

/* A path in UTF-8, as the system has it; in that of the process's code page where it is no UTF-8 (arguments before Windows 10,
 * version 1903). A process that is not ours, as Python, may have any code page. Returns `wide`; NULL: errno says why. */
static wchar_t *native(const char *path, wchar_t wide[WIDE_MAX])
{
    const char *name = strcmp(path, "/dev/null") == 0 ? "NUL" : path;
    if (MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, name, -1, wide, WIDE_MAX) > 0)
        return wide;
    if (GetLastError() == ERROR_NO_UNICODE_TRANSLATION && MultiByteToWideChar(CP_ACP, 0, name, -1, wide, WIDE_MAX) > 0)
        return wide;
    errno = ENAMETOOLONG;
    return NULL;
}

/* Of a file for this user alone: nothing is inherited from its folder. NULL: the system does not say who the user is. */
static SECURITY_ATTRIBUTES *private_attributes(void)
{
    static SECURITY_ATTRIBUTES attributes = {.nLength = sizeof attributes};
    HANDLE token;
    union {
        TOKEN_USER user;
        char bytes[sizeof(TOKEN_USER) + SECURITY_MAX_SID_SIZE];
    } own;
    char text[256], *sid;
    DWORD length;
    if (attributes.lpSecurityDescriptor || !OpenProcessToken(GetCurrentProcess(), TOKEN_QUERY, &token))
        return attributes.lpSecurityDescriptor ? &attributes : NULL;
    bool known = GetTokenInformation(token, TokenUser, &own, sizeof own, &length) &&
                 ConvertSidToStringSidA(own.user.User.Sid, &sid);
    CloseHandle(token);
    if (!known)
        return NULL;
    snprintf(text, sizeof text, "D:P(A;;FA;;;%.200s)", sid); /* all access to files, for this one */
    LocalFree(sid);
    known = ConvertStringSecurityDescriptorToSecurityDescriptorA(text, SDDL_REVISION_1, &attributes.lpSecurityDescriptor, NULL);
    return known ? &attributes : NULL;
}

/* A name such as `con' or `aux.txt' in any folder, which is none of a file. Reading it may wait for ever. */
static bool is_device(const wchar_t *path)
{
    static const wchar_t begin[] = L"\\\\.\\";
    wchar_t full[WIDE_MAX];
    DWORD length = GetFullPathNameW(path, WIDE_MAX, full, NULL);
    return length > 0 && length < WIDE_MAX && wcsncmp(full, begin, 4) == 0 && _wcsicmp(full + 4, L"NUL") != 0 &&
           _wcsnicmp(full + 4, L"pipe\\", 5) != 0;
}

int windows_open(const char *path, int flags, ...)
{
    static const DWORD accesses[] = {GENERIC_READ, GENERIC_WRITE, GENERIC_READ | GENERIC_WRITE};
    unsigned mode = 0666;
    if (flags & O_CREAT) {
        va_list values;
        va_start(values, flags);
        mode = va_arg(values, unsigned);
        va_end(values);
    }
    wchar_t wide[WIDE_MAX];
    if (!native(path, wide))
        return -1;
    if (is_device(wide)) {
        errno = ENODEV;
        return -1;
    }
    DWORD how = (flags & O_EXCL) ? CREATE_NEW : (flags & O_CREAT) ? OPEN_ALWAYS : OPEN_EXISTING;
    HANDLE file = CreateFileW(wide, accesses[flags & (O_WRONLY | O_RDWR)],
                              FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE,
                              (mode & 077) == 0 ? private_attributes() : NULL, how, FILE_ATTRIBUTE_NORMAL, NULL);
    if (file == INVALID_HANDLE_VALUE) {
        DWORD error = GetLastError(), found = GetFileAttributesW(wide);
        if (found != INVALID_FILE_ATTRIBUTES && (found & FILE_ATTRIBUTE_DIRECTORY)) {
            errno = EISDIR;
            return -1;
        }
        SetLastError(error);
        return fail();
    }
    int fd = _open_osfhandle((intptr_t)file, _O_BINARY | (flags & _O_NOINHERIT));
    if (fd < 0)
        CloseHandle(file);
    else if (flags & O_TRUNC)
        _chsize_s(fd, 0);
    return fd;
}

FILE *windows_fopen(const char *path, const char *mode)
{
    bool reads = mode[0] == 'r', both = strchr(mode, '+') != NULL;
    int flags = both ? O_RDWR : reads ? O_RDONLY : O_WRONLY;
    int fd = windows_open(path, flags | (reads ? 0 : O_CREAT) | (mode[0] == 'w' ? O_TRUNC : 0) | O_CLOEXEC, 0666);
    FILE *file = fd >= 0 ? _fdopen(fd, both ? "r+b" : reads ? "rb" : "wb") : NULL;
    if (!file && fd >= 0)
        _close(fd);
    if (file && mode[0] == 'a')
        fseek(file, 0, SEEK_END);
    return file;
}

static int stat_handle(HANDLE file, struct windows_stat *status)
{
    BY_HANDLE_FILE_INFORMATION found;
    DWORD type = GetFileType(file);
    *status = (struct windows_stat){.st_mode = type == FILE_TYPE_PIPE ? S_IFIFO : S_IFCHR};
    if (type != FILE_TYPE_DISK)
        return 0;
    if (!GetFileInformationByHandle(file, &found))
        return fail();
    bool folder = found.dwFileAttributes & FILE_ATTRIBUTE_DIRECTORY;
    status->st_dev = found.dwVolumeSerialNumber;
    status->st_ino = (uint64_t)found.nFileIndexHigh << 32 | found.nFileIndexLow;
    status->st_mode = (folder ? S_IFDIR : S_IFREG) | 0644;
    status->st_nlink = found.nNumberOfLinks;
    status->st_size = (int64_t)((uint64_t)found.nFileSizeHigh << 32 | found.nFileSizeLow);
    return 0;
}

int windows_fstat(int fd, struct windows_stat *status)
{
    HANDLE file = (HANDLE)_get_osfhandle(fd);
    if (file == INVALID_HANDLE_VALUE) {
        errno = EBADF;
        return -1;
    }
    return stat_handle(file, status);
}

int windows_stat(const char *path, struct windows_stat *status)
{
    wchar_t wide[WIDE_MAX];
    if (!native(path, wide))
        return -1;
    HANDLE file = CreateFileW(wide, 0, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE, NULL, OPEN_EXISTING,
                              FILE_FLAG_BACKUP_SEMANTICS, NULL);
    if (file == INVALID_HANDLE_VALUE)
        return fail();
    int result = stat_handle(file, status);
    CloseHandle(file);
    return result;
}

int windows_rename(const char *from, const char *to)
{
    wchar_t wide_from[WIDE_MAX], wide_to[WIDE_MAX];
    if (!native(from, wide_from) || !native(to, wide_to))
        return -1;
    return MoveFileExW(wide_from, wide_to, MOVEFILE_REPLACE_EXISTING) ? 0 : fail();
}

int windows_unlink(const char *path)
{
    wchar_t wide[WIDE_MAX];
    if (!native(path, wide))
        return -1;
    return DeleteFileW(wide) ? 0 : fail();
}

char *realpath(const char *path, char *found)
{
    struct windows_stat status;
    wchar_t wide[WIDE_MAX], whole[WIDE_MAX];
    if (windows_stat(path, &status) != 0 || !native(path, wide) || !_wfullpath(whole, wide, WIDE_MAX))
        return NULL;
    int room = found ? PATH_MAX : WideCharToMultiByte(CP_UTF8, 0, whole, -1, NULL, 0, NULL, NULL);
    char *result = found ? found : malloc((size_t)room);
    if (result && WideCharToMultiByte(CP_UTF8, 0, whole, -1, result, room, NULL, NULL) > 0)
        return result;
    errno = result ? ENAMETOOLONG : ENOMEM;
    if (!found)
        free(result);
    return NULL;
}

/* The X at the end of the path become a name that is free. */
int mkostemp(char *path, int flags)
{
    static unsigned count;
    static const char digits[] = "0123456789abcdefghijklmnopqrstuvwxyz";
    size_t end = strlen(path);
    for (unsigned tries = 0; tries < 1000; tries++) {
        uint64_t number = (uint64_t)GetCurrentProcessId() * 1000003u + GetTickCount() + count++ * 7919u;
        for (size_t i = 1; i <= 6; i++, number /= 36)
            path[end - i] = digits[number % 36];
        int fd = windows_open(path, flags | O_RDWR | O_CREAT | O_EXCL, 0666);
        if (fd >= 0 || errno != EEXIST)
            return fd;
    }
    return -1;
}

FILE *windows_tmpfile(void)
{
    wchar_t folder[MAX_PATH], path[MAX_PATH];
    if (!GetTempPathW(MAX_PATH, folder) || !GetTempFileNameW(folder, L"rkm", 0, path)) {
        fail();
        return NULL;
    }
    HANDLE file = CreateFileW(path, GENERIC_READ | GENERIC_WRITE | DELETE, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE,
                              NULL, CREATE_ALWAYS, FILE_ATTRIBUTE_TEMPORARY | FILE_FLAG_DELETE_ON_CLOSE, NULL);
    int fd = file != INVALID_HANDLE_VALUE ? _open_osfhandle((intptr_t)file, _O_BINARY) : fail();
    return fd >= 0 ? _fdopen(fd, "w+b") : NULL;
}

ssize_t pread(int fd, void *bytes, size_t length, int64_t offset)
{
    int64_t before = _lseeki64(fd, 0, SEEK_CUR);
    if (before < 0 || _lseeki64(fd, offset, SEEK_SET) < 0)
        return -1;
    int got = _read(fd, bytes, (unsigned)length);
    _lseeki64(fd, before, SEEK_SET);
    return got;
}

static OVERLAPPED at(int64_t offset)
{
    return (OVERLAPPED){.Offset = (DWORD)offset, .OffsetHigh = (DWORD)((uint64_t)offset >> 32)};
}

ssize_t pwrite(int fd, const void *bytes, size_t length, int64_t offset)
{
    OVERLAPPED place = at(offset);
    DWORD written;
    if (!WriteFile((HANDLE)_get_osfhandle(fd), bytes, (DWORD)length, &written, &place))
        return fail();
    return (ssize_t)written;
}

#define LOCK_PLACE (INT64_C(1) << 62) /* far behind the end: others may read and copy the file */

int flock(int fd, int how)
{
    OVERLAPPED place = at(LOCK_PLACE);
    (void)how;
    if (LockFileEx((HANDLE)_get_osfhandle(fd), LOCKFILE_EXCLUSIVE_LOCK | LOCKFILE_FAIL_IMMEDIATELY, 0, 1, 0, &place))
        return 0;
    if (GetLastError() != ERROR_LOCK_VIOLATION && GetLastError() != ERROR_IO_PENDING)
        return fail();
    errno = EWOULDBLOCK;
    return -1;
}

/* Windows has no modes: a file that is there keeps its access. */
int fchmod(int fd, unsigned mode)
{
    (void)fd;
    (void)mode;
    return 0;
}

unsigned geteuid(void)
{
    return 0;
}

int fsync(int fd)
{
    return _commit(fd);
}

ssize_t getline(char **line, size_t *room, FILE *in)
{
    size_t length = 0;
    int byte;
    while ((byte = getc(in)) != EOF) {
        if (length + 2 > *room) {
            size_t more = *room < 256 ? 256 : 2 * *room;
            char *larger = realloc(*line, more);
            if (!larger)
                return -1;
            *line = larger;
            *room = more;
        }
        (*line)[length++] = (char)byte;
        (*line)[length] = '\0';
        if (byte == '\n')
            break;
    }
    return length > 0 ? (ssize_t)length : -1;
}
