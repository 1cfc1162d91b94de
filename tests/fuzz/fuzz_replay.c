/* SPDX-License-Identifier: MIT */
/* fuzz_replay.c: runs a fuzz target on the files given, and on all files of the folders given. No file at all is a failure. */
#include <dirent.h>
#include <stdbool.h>
#include <string.h>
#include <sys/stat.h>

#include "fuzz.h"

static const char *present = "";
static unsigned long files;

/* The one line that matters if a target aborts: what it was run on. */
static void tell(void)
{
    fprintf(stderr, "input: %s\n", present);
}

void __asan_on_error(void);
void __asan_on_error(void)
{
    tell();
}

static bool run_file(const char *path, size_t size)
{
    FILE *in = fopen(path, "rb");
    uint8_t *data = malloc(size + (size == 0)); /* of just this size, so that a read after its end is noticed */
    bool ok = in && data && fread(data, 1, size, in) == size;
    if (in)
        fclose(in);
    if (ok) {
        present = path;
        LLVMFuzzerTestOneInput(data, size);
        files++;
    }
    free(data);
    return ok;
}

static bool run(const char *path);

static bool run_folder(const char *path)
{
    struct dirent **list;
    bool ok = true;
    int count = scandir(path, &list, NULL, alphasort);
    for (int i = 0; i < count; i++) {
        char *inside = NULL;
        if (list[i]->d_name[0] != '.' && asprintf(&inside, "%s/%s", path, list[i]->d_name) > 0) {
            ok = run(inside) && ok;
            free(inside);
        }
        free(list[i]);
    }
    if (count >= 0)
        free(list);
    return ok && count >= 0;
}

static bool run(const char *path)
{
    struct stat status;
    if (stat(path, &status) != 0)
        return false;
    return S_ISDIR(status.st_mode) ? run_folder(path) : run_file(path, (size_t)status.st_size);
}

int main(int count, char **paths)
{
    bool ok = count > 1;
    for (int i = 1; i < count; i++) {
        if (!run(paths[i])) {
            fprintf(stderr, "cannot read %s\n", paths[i]);
            ok = false;
        }
    }
    printf("%lu inputs\n", files);
    return ok && files > 0 ? 0 : 1;
}
