/* SPDX-License-Identifier: MIT */
/* sanitized overflow|shift|leak|nothing: makes this fault, for tests/system/sanitizers.sh. */
#include <stdlib.h>
#include <string.h>

int main(int argc, char **argv)
{
    const char *fault = argc > 1 ? argv[1] : "";
    if (!strcmp(fault, "overflow")) {
        volatile char *bytes = malloc(4);
        bytes[argc + 2] = 1;
        free((void *)bytes);
    } else if (!strcmp(fault, "shift")) {
        volatile int places = 40;
        return 1 << places;
    } else if (!strcmp(fault, "leak")) {
        void *volatile bytes = malloc(4);
        bytes = NULL;
        return bytes != NULL;
    }
    return 0;
}
