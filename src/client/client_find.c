/* SPDX-License-Identifier: MIT */
#include "client_find.h"

#include <dirent.h>
#include <err.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "client_rpc.h"
#include "client_socket.h"

#define ENDING ".control"
#define ANSWER_MS 500

/* Is `path` a socket, or a file as control files are, of this user that ends like a control socket? */
static bool is_candidate(const char *path)
{
    struct stat found;
    size_t length = strlen(path), end = sizeof ENDING - 1;
    return length > end && strcmp(path + length - end, ENDING) == 0 && stat(path, &found) == 0 &&
           (S_ISSOCK(found.st_mode) || S_ISREG(found.st_mode)) && found.st_uid == geteuid();
}

static bool is_known(const struct client_found *found, size_t count, const char *path)
{
    for (size_t i = 0; i < count; i++)
        if (strcmp(found[i].control, path) == 0)
            return true;
    return false;
}

/* Its bus, as --port takes it. */
static void put_port(char port[PATH_MAX], const json_t *ready)
{
    static const char *const members[] = {"link", "pty", "port", "tcp"};
    port[0] = '\0';
    if (json_object_get(ready, "lines") != NULL)
        return;
    for (size_t i = 0; i < sizeof members / sizeof members[0] && port[0] == '\0'; i++) {
        const char *value = json_string_value(json_object_get(ready, members[i]));
        if (value != NULL)
            snprintf(port, PATH_MAX, "%s%s", strcmp(members[i], "tcp") == 0 ? "tcp:" : "", value);
    }
}

/* Ask who listens there. Returns false if it is no emulator, or says nothing. */
static bool ask(struct client_found *found, const char *path)
{
    struct client_rpc rpc = {.quiet = true};
    json_t *ready = NULL;
    if (!client_rpc_open(&rpc, path))
        return false;
    bool answered = client_rpc_call(&rpc, "ready", NULL, ANSWER_MS, &ready) == CLIENT_RPC_RESULT;
    client_rpc_close(&rpc);
    if (answered) {
        snprintf(found->control, sizeof found->control, "%s", path);
        put_port(found->port, ready);
    }
    json_decref(ready);
    return answered;
}

/* Add those with a control file in `folder` to `count` that are known. Returns their number. */
static size_t find_in_folder(struct client_found found[CLIENT_FOUND_MAX], size_t count, const char *folder)
{
    DIR *opened = opendir(folder);
    const struct dirent *entry;
    char path[PATH_MAX];
    while (opened != NULL && count < CLIENT_FOUND_MAX && (entry = readdir(opened)) != NULL)
        if (snprintf(path, sizeof path, "%s/%s", folder, entry->d_name) < (int)sizeof path && is_candidate(path) &&
            !is_known(found, count, path))
            count += ask(&found[count], path);
    if (opened != NULL)
        closedir(opened);
    return count;
}

/* Unix sockets wherever they are; control files in the folders of default links. */
size_t client_find(struct client_found found[CLIENT_FOUND_MAX])
{
    FILE *sockets = fopen("/proc/net/unix", "re");
    char line[PATH_MAX + 128], folder[PATH_MAX];
    size_t count = 0;
    while (sockets != NULL && count < CLIENT_FOUND_MAX && fgets(line, sizeof line, sockets) != NULL) {
        char *path = strchr(line, '/');
        if (path == NULL)
            continue;
        path[strcspn(path, "\n")] = '\0';
        if (is_candidate(path) && !is_known(found, count, path))
            count += ask(&found[count], path);
    }
    if (sockets != NULL)
        fclose(sockets);
    for (unsigned i = 0; client_socket_folder(i, folder); i++)
        count = find_in_folder(found, count, folder);
    return count;
}

/* What follows the host in the name of a TCP port of this machine; NULL: it is another port. */
static const char *local_number(const char *port)
{
    static const char *const hosts[] = {"tcp:localhost:", "tcp:127.0.0.1:"};
    for (size_t i = 0; i < sizeof hosts / sizeof hosts[0]; i++)
        if (strncmp(port, hosts[i], strlen(hosts[i])) == 0)
            return port + strlen(hosts[i]);
    return NULL;
}

static bool is_same_port(const char *one, const char *other)
{
    char file[PATH_MAX], other_file[PATH_MAX];
    const char *number = local_number(one), *other_number = local_number(other);
    if (number != NULL && other_number != NULL)
        return strcmp(number, other_number) == 0;
    return strcmp(one, other) == 0 ||
           (realpath(one, file) != NULL && realpath(other, other_file) != NULL && strcmp(file, other_file) == 0);
}

bool client_find_pair(const char *port, const char *control, struct client_found *pair)
{
    static struct client_found found[CLIENT_FOUND_MAX];
    char beside[PATH_MAX];
    if (control != NULL)
        return ask(pair, control);
    int length = snprintf(beside, sizeof beside, "%s" ENDING, port);
    if (length > 0 && (size_t)length < sizeof beside && access(beside, F_OK) == 0 && ask(pair, beside))
        return true;
    for (size_t i = client_find(found); i-- > 0;)
        if (is_same_port(found[i].port, port)) {
            *pair = found[i];
            return true;
        }
    return false;
}

const struct client_found *client_find_one(const char *option)
{
    static struct client_found found[CLIENT_FOUND_MAX];
    const bool is_port = strcmp(option, "--port") == 0;
    size_t count = client_find(found);
    if (count == 1 && (!is_port || found[0].port[0] != '\0'))
        return &found[0];
    if (count == 0)
        warnx("no emulator of yours is running: expected %s, or a running `rkm04 serve'", option);
    else
        warnx("%s: choose one of these with %s:", count > 1 ? "several emulators are running" : "the emulator has several buses",
              option);
    for (size_t i = 0; i < count; i++) {
        if (is_port && found[i].port[0] == '\0')
            fprintf(stderr, "  a bus of the emulator with the control socket %s\n", found[i].control);
        else
            fprintf(stderr, "  %s %s\n", option, is_port ? found[i].port : found[i].control);
    }
    return NULL;
}
