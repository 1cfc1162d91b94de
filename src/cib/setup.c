/* SPDX-License-Identifier: MIT */
#include "cib.h"
#include "phase.h"

#define DRIVE_DEFAULT {20, 100, 1000, CIB_ACCELERATION_MAX, CIB_ACCELERATION_MAX, 1}
#define SETUP_DEFAULT                                                                                                          \
    {                                                                                                                          \
        {CIB_USE_DRIVE, CIB_USE_DRIVE, CIB_USE_DRIVE}, {1000, 1000, 1000}, 0, 0xff, {DRIVE_DEFAULT, DRIVE_DEFAULT}             \
    }

const struct cib_setup cib_default_setup = SETUP_DEFAULT;
const struct cib_config cib_default_config = {.setup = SETUP_DEFAULT, .firmware = CIB_FIRMWARE_1_2, .acc_unit = 1};

static bool lies_in(uint32_t value, uint32_t least, uint32_t most)
{
    return value >= least && value <= most;
}

/* Uses that may be (BU5, BU6). Returns the place of the first wrong one; CIB_USES: all are good. */
static unsigned wrong_use(const uint16_t use[CIB_USES], uint16_t firmware)
{
    for (unsigned i = 0; i < CIB_USES; i++) {
        if (use[i] > CIB_USE_DRIVE || (i > 0 && use[i] == CIB_USE_PWM && firmware < CIB_FIRMWARE_1_2))
            return i;
        if (i == 1 && (use[0] == CIB_USE_DRIVE) != (use[1] == CIB_USE_DRIVE))
            return i;
    }
    return CIB_USES;
}

/* May these outputs be bipolar? (BU4) DO are unipolar, and DO1-4 are the same. */
static bool polarity_is_good(const struct cib_setup *setup)
{
    const unsigned bipolar = setup->bipolar;
    if (bipolar > 7)
        return false;
    if (setup->use[0] == CIB_USE_PWM && setup->use[1] == CIB_USE_PWM)
        return bipolar % 4 == 0 || bipolar % 4 == 3;
    return !(setup->use[0] == CIB_USE_PWM && (bipolar & 1) != 0) && !(setup->use[1] == CIB_USE_PWM && (bipolar & 2) != 0);
}

/* Returns the place of the first wrong word of a drive; 6: all are good. */
static unsigned wrong_word(const struct cib_drive_setup *drive)
{
    if (!phase_has_mode(drive->mode))
        return 0;
    if (!lies_in(drive->start_speed, CIB_SPEED_MIN, CIB_SPEED_MAX))
        return 1;
    if (!lies_in(drive->speed_max, CIB_SPEED_MIN, CIB_SPEED_MAX))
        return 2;
    if (!lies_in(drive->acceleration_max, CIB_ACCELERATION_MIN, CIB_ACCELERATION_MAX))
        return 3;
    if (!lies_in(drive->deceleration_max, CIB_ACCELERATION_MIN, CIB_ACCELERATION_MAX))
        return 4;
    return drive->ramps > 1 ? 5 : 6;
}

uint16_t cib_check_setup(const struct cib_setup *setup, uint16_t firmware)
{
    const unsigned use = wrong_use(setup->use, firmware);
    if (use < CIB_USES)
        return (uint16_t)(0x101 + use);
    for (unsigned i = 0; i < CIB_USES; i++)
        if (!lies_in(setup->period[i], CIB_PERIOD_MIN, CIB_PERIOD_MAX))
            return (uint16_t)(0x104 + 2 * i);
    if (!polarity_is_good(setup))
        return 0x10a;
    if (setup->active > 0xff)
        return 0x10b;
    for (unsigned i = 0; i < CIB_DRIVES; i++) {
        const unsigned word = wrong_word(&setup->drive[i]);
        if (word < 6)
            return (uint16_t)(0x110 + 0x10 * i + word);
    }
    return 0;
}
