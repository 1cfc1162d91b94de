/* test_replay.c */
#include "rig.h"

int main(int argc, char **argv)
{
    (void)argc;
    return rig_run(suite_create("replay"), argv[0]);
}
