/* SPDX-License-Identifier: MIT */
#include "sandbox.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <linux/landlock.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#define ACCESS_READ (LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR)
#define ACCESS_FILE (LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_WRITE_FILE | ACCESS_TRUNCATE)
#define ACCESS_FOLDER \
    (ACCESS_FILE | ACCESS_READ | LANDLOCK_ACCESS_FS_REMOVE_FILE | LANDLOCK_ACCESS_FS_MAKE_REG | LANDLOCK_ACCESS_FS_MAKE_SYM | \
     ACCESS_REFER)
#define ACCESS_FIRST ((UINT64_C(1) << 13) - 1) /* all of the first version */
#define ACCESS_REFER (UINT64_C(1) << 13)       /* version 2; named here for older headers */
#define ACCESS_TRUNCATE (UINT64_C(1) << 14)    /* version 3 */

/* ---- Files ---------------------------------------------------------------------------------------------------------- */

/* All that this kernel can deny. */
static uint64_t known_access(void)
{
    long version = syscall(SYS_landlock_create_ruleset, NULL, 0, LANDLOCK_CREATE_RULESET_VERSION);
    if (version < 1)
        return 0;
    return ACCESS_FIRST | (version >= 2 ? ACCESS_REFER : 0) | (version >= 3 ? ACCESS_TRUNCATE : 0);
}

static void allow_path(struct sandbox *sandbox, const char *path, uint64_t access)
{
    struct stat found;
    struct landlock_path_beneath_attr rule = {.parent_fd = open(path, O_PATH | O_CLOEXEC)};
    if (rule.parent_fd < 0)
        return;
    if (fstat(rule.parent_fd, &found) == 0 && !S_ISDIR(found.st_mode))
        access &= ACCESS_FILE | LANDLOCK_ACCESS_FS_EXECUTE;
    rule.allowed_access = access & known_access();
    syscall(SYS_landlock_add_rule, sandbox->ruleset, LANDLOCK_RULE_PATH_BENEATH, &rule, 0);
    close(rule.parent_fd);
}

void sandbox_begin(struct sandbox *sandbox)
{
    struct landlock_ruleset_attr attributes = {.handled_access_fs = known_access()};
    sandbox->ruleset = -1;
    if (attributes.handled_access_fs != 0)
        sandbox->ruleset = (int)syscall(SYS_landlock_create_ruleset, &attributes, sizeof attributes, 0);
    if (sandbox->ruleset < 0)
        return;
    allow_path(sandbox, "/dev/pts", ACCESS_FILE); /* ptys that are made, and examined */
    allow_path(sandbox, "/dev/ptmx", ACCESS_FILE);
    allow_path(sandbox, "/dev/null", ACCESS_FILE);
    allow_path(sandbox, "/", LANDLOCK_ACCESS_FS_READ_DIR); /* libuv keeps it open to refuse clients without a descriptor */
#ifdef __SANITIZE_ADDRESS__ /* its reports name places in programs and libraries */
    allow_path(sandbox, "/", ACCESS_READ | LANDLOCK_ACCESS_FS_EXECUTE);
#endif
}

void sandbox_allow(struct sandbox *sandbox, const char *path)
{
    if (sandbox->ruleset >= 0)
        allow_path(sandbox, path, ACCESS_FOLDER);
}

void sandbox_allow_beside(struct sandbox *sandbox, const char *file)
{
    char folder[PATH_MAX] = ".";
    const char *slash = strrchr(file, '/');
    if (slash)
        snprintf(folder, sizeof folder, "%.*s", slash == file ? 1 : (int)(slash - file), file);
    sandbox_allow(sandbox, folder);
}

bool sandbox_close_files(struct sandbox *sandbox)
{
    if (sandbox->ruleset < 0) {
        errno = ENOSYS;
        return false;
    }
    bool closed = prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
                  syscall(SYS_landlock_restrict_self, sandbox->ruleset, 0) == 0;
    int why = errno;
    close(sandbox->ruleset);
    sandbox->ruleset = -1;
    errno = why;
    return closed;
}
