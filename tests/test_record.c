/* test_record.c */
#include "rig.h"

int main(int argc, char **argv)
{
    (void)argc;
    return rig_run(suite_create("record"), argv[0]);
}
