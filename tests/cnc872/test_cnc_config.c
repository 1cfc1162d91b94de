/* SPDX-License-Identifier: MIT */
/* CONFIG.xml (NJ1 to NJ3), and the fragments of the documentation (8.2.5, 8.3.5). */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "text_rig.h"

static struct cnc_config config;

static void read_well(const char *text)
{
    bool is_right = text_read_config(text, &config);
    ck_assert_msg(is_right, "%s", text_reported);
    ck_assert_str_eq(text_reported, "");
}

static void check_wrong(const char *text, const char *expected)
{
    ck_assert_msg(!text_read_config(text, &config), "accepted: %s", text);
    ck_assert_str_eq(text_reported, expected);
}

START_TEST(nj2_defaults_of_an_axis)
{
    read_well("<ChannelConfig><Axis Name=\"Y\"/></ChannelConfig>");
    const struct cnc_axis_config *y = &config.axis[1];
    ck_assert_uint_eq(config.axes, 2);
    ck_assert(y->is_configured && !config.axis[0].is_configured);
    ck_assert(!y->needs_reference && !y->is_rotary && !y->searches_plus && !y->has_sls_minus && !y->has_sls_plus);
    ck_assert_uint_eq(y->feed, 2000000);
    ck_assert_uint_eq(y->feed_rapid, 12000000);
    ck_assert_uint_eq(y->feed_slow, 300000);
    ck_assert_uint_eq(y->feed_reference, 300000);
    ck_assert_int_eq(y->acceleration[CNC_SET_NORMAL], 32768); /* W1 */
    ck_assert_int_eq(y->acceleration[CNC_SET_RAPID], 65536);
    ck_assert_int_eq(y->acceleration[CNC_SET_EMERGENCY], 131072);
    ck_assert_int_eq(y->linear[CNC_SET_NORMAL], 32768);
    ck_assert_int_eq(y->linear[CNC_SET_EMERGENCY], 131072);
    ck_assert_uint_eq(y->parabolic[CNC_SET_NORMAL], 10000);
    ck_assert_uint_eq(y->parabolic[CNC_SET_EMERGENCY], 40000);
    for (unsigned set = 0; set < CNC_SETS; set++)
        ck_assert_uint_eq(y->smoothing[set], 50);
    ck_assert_int_eq(y->max_difference, 5 * CNC_U_PER_UM);
    ck_assert_uint_eq(y->max_lag, 0);
    ck_assert_uint_eq(y->lag, 1);
    ck_assert_uint_eq(y->reference_method, 0);
    ck_assert_int_eq(y->null_point + y->length_correction + y->offset1 + y->offset2, 0);
}
END_TEST

START_TEST(w1_conversions)
{
    ck_assert_int_eq(cnc_speed_of(1000000), 1092266);
    ck_assert_int_eq(cnc_speed_of(300000), 327680);
    ck_assert_int_eq(cnc_speed_of(12000000), 13107200);
    ck_assert_int_eq(cnc_acceleration_of(500000), 32768);
    ck_assert_int_eq(cnc_acceleration_of(1000000000), 65536000);
    ck_assert_int_eq(cnc_acceleration_of(1), 1); /* never 0 */
    ck_assert_int_eq(cnc_acceleration_of(23), 2); /* 1.507: the nearest */
}
END_TEST

START_TEST(nj2_what_a_text_leaves_out)
{
    static const char *const texts[] = {"<ChannelConfig/>", "<MFunctions></MFunctions>"};
    for (unsigned i = 0; i < 2; i++) {
        read_well(texts[i]);
        ck_assert_uint_eq(config.axes, 7);
        ck_assert(config.gear[1].is_configured && !config.gear[2].is_configured);
        ck_assert_uint_eq(config.gear[1].min_speed, 0);
        ck_assert_uint_eq(config.gear[1].max_speed, 4000000);
        ck_assert(!config.is_parabolic && !config.manual_by_man);
        ck_assert_uint_eq(config.no_license, 0);
        for (unsigned g = 0; g < 3; g++)
            ck_assert_uint_eq(config.geometry[g], g);
    }
    struct cnc_config clear;
    cnc_config_clear(&clear);
    ck_assert_mem_eq(&clear, &config, sizeof config);
}
END_TEST

START_TEST(nj2_attributes)
{
    read_well("\xEF\xBB\xBF<?xml version=\"1.0\"?>\r\n<!-- a machine -->\n<ChannelConfig AccelerationType=\"1\"\n"
              " ManualEnable='MAN' NoLicense=\"FeaturePlc3 HwKeyConnected\">\n"
              "<Axis Name=\"X\" Feed=\"600.5\" FeedRT=\"1\" FeedSlow=\"2\" FeedRef=\"0.001\" Acceleration=\"1000\"\n"
              "  MaxLag=\"100\" LinearAccel=\"500\" ParabAccel=\"0.4\" LinearAccelRT=\"7\" ParabAccelRT=\"2\"\n"
              "  Geo=\"2\" Lag=\"20\" NeedRef=\"1\"/>\n"
              "<Axis Name = \"16\" SlsMinus=\"-5\" SlsPlus=\"12.345\" MachineNullPoint=\"-200000\" LengthCorrection=\"1\"\n"
              "  Offset1=\"2\" Offset2=\"-3.5\" MaxDifference=\"0.5\" Rotary=\"1\" RefDir=\"+\" RefMethod=\"2\"\n"
              "  AutNeedRef=\"1\"></Axis>\n"
              "<Gear No=\"3\" MinSpeed=\"10\" MaxSpeed=\"2000.5\"/></ChannelConfig>\n");
    const struct cnc_axis_config *x = &config.axis[0], *last = &config.axis[15];
    ck_assert(config.is_parabolic && config.manual_by_man);
    ck_assert_uint_eq(config.no_license, 1u << 4 | 1u);
    ck_assert_uint_eq(config.axes, 0x8001);
    ck_assert_uint_eq(config.geometry[2], 0);
    ck_assert_uint_eq(config.geometry[0], 0);
    ck_assert_uint_eq(x->feed, 600500);
    ck_assert_uint_eq(x->feed_reference, 1);
    ck_assert_int_eq(x->acceleration[CNC_SET_NORMAL], 65536);
    ck_assert_uint_eq(x->smoothing[CNC_SET_NORMAL], 1000); /* 1250 */
    ck_assert_uint_eq(x->smoothing[CNC_SET_RAPID], 4);     /* 3.5: the nearest */
    ck_assert(x->needs_reference);
    ck_assert_uint_eq(x->lag, 20);
    ck_assert_uint_eq(x->max_lag, 100);
    ck_assert(last->has_sls_minus && last->has_sls_plus && last->is_rotary && last->searches_plus && last->needs_reference);
    ck_assert_int_eq(last->sls_minus, INT64_C(-5) * CNC_U_PER_MM);
    ck_assert_int_eq(last->sls_plus, INT64_C(12345) * CNC_U_PER_UM);
    ck_assert_int_eq(last->null_point, INT64_C(-200000) * CNC_U_PER_MM);
    ck_assert_int_eq(last->length_correction, CNC_U_PER_MM);
    ck_assert_int_eq(last->offset1, INT64_C(2) * CNC_U_PER_MM);
    ck_assert_int_eq(last->offset2, INT64_C(-3500) * CNC_U_PER_UM);
    ck_assert_int_eq(last->max_difference, CNC_U_PER_UM / 2);
    ck_assert_uint_eq(last->reference_method, 2);
    ck_assert(!config.gear[1].is_configured && config.gear[3].is_configured);
    ck_assert_uint_eq(config.gear[3].min_speed, 10000);
    ck_assert_uint_eq(config.gear[3].max_speed, 2000500);
}
END_TEST

/* The listing of 8.3.5 as it is printed. */
/* Section 11 of the specification, from M0 on; what has no fixed group is in 14. */
START_TEST(ng2_fixed_groups)
{
    static const uint8_t wanted[CNC_M_MAX + 1] = {
        [0] = 1,  [1] = 1,  [2] = 1,  [30] = 1, [3] = 2,  [4] = 2,  [5] = 2,  [19] = 2, [41] = 3, [42] = 3, [43] = 3, [44] = 3,
        [40] = 3, [7] = 5,  [8] = 5,  [9] = 5,  [17] = 5, [50] = 6, [51] = 6, [52] = 6, [53] = 6, [10] = 7, [11] = 7, [48] = 8,
        [49] = 8, [6] = 9,  [60] = 9};
    cnc_config_clear(&config);
    for (unsigned m = 0; m <= CNC_M_MAX; m++) {
        ck_assert_uint_eq(cnc_fixed_group(m), wanted[m]);
        ck_assert_uint_eq(config.m[m].group, wanted[m] != 0 ? wanted[m] : 14);
        ck_assert_uint_eq(config.m[m].attributes, 0);
    }
}
END_TEST

START_TEST(nj3_groups_of_the_documentation)
{
    read_well(" <MFunctions> \n"
              "   <!-- Skupina 9 --> \n"
              "  <MFunc No=\"6\" GroupNo=\"9\" BreakCont=\"1\" ChangePos=\"1\"></MFunc> \n \n"
              "   <!-- Skupina 10 --> \n"
              "  <MFunc No=\"91\" GroupNo=\"10\" BreakCont=\"1\"></MFunc> \n"
              "  <MFunc No=\"92\" GroupNo=\"10\" BreakCont=\"1\"></MFunc> \n"
              "  <MFunc No=\"93\" GroupNo=\"10\" BreakCont=\"1\"></MFunc> \n"
              "  <MFunc No=\"94\" GroupNo=\"10\" BreakCont=\"1\"></MFunc> \n"
              "   <!-- Skupina 11 --> \n"
              "  <MFunc No=\"95\" GroupNo=\"11\" BreakContEnd=\"1\"></MFunc> \n"
              "  <MFunc No=\"96\" GroupNo=\"11\" BreakContEnd=\"1\"></MFunc> \n"
              "  <MFunc No=\"97\" GroupNo=\"11\" BreakContEnd=\"1\"></MFunc> \n"
              "  <MFunc No=\"98\" GroupNo=\"11\" BreakContEnd=\"1\"></MFunc> \n  \n </MFunctions> \n");
    for (unsigned m = 91; m <= 98; m++) {
        ck_assert_uint_eq(config.m[m].group, m < 95 ? 10 : 11);
        ck_assert_uint_eq(config.m[m].attributes, m < 95 ? CNC_M_BREAK_CONT : CNC_M_BREAK_CONT_END);
    }
    ck_assert_uint_eq(config.m[6].group, 9);
    ck_assert_uint_eq(config.m[6].attributes, CNC_M_BREAK_CONT | CNC_M_CHANGE_POS);
    ck_assert_uint_eq(config.m[30].group, 1);
    ck_assert_uint_eq(config.m[77].group, 14);
    ck_assert_uint_eq(config.m[100].group, 14);
}
END_TEST

/* The fragment of 8.2.5 is not closed as it is printed. */
START_TEST(nj3_fragment_that_is_not_closed)
{
    check_wrong("<MFunctions>\n<MFunc No=\"92\" GroupNo=\"12\" BreakCont=\"1\"> </MFunc>\n", "3:1: expected </MFunctions>\n");
    read_well("<MFunctions>\n<MFunc No=\"92\" GroupNo=\"12\" BreakCont=\"1\"> </MFunc>\n</MFunctions>");
    ck_assert_uint_eq(config.m[92].group, 12);
    read_well("<MFunctions><MFuncs No=\"50\" ChangePos=\"1\"/><MFuncs No=\"4\"></MFuncs></MFunctions>");
    ck_assert_uint_eq(config.m[50].group, 6); /* a fixed one keeps its group */
    ck_assert_uint_eq(config.m[50].attributes, CNC_M_CHANGE_POS);
}
END_TEST

START_TEST(nj1_wrong_texts_are_refused)
{
    static const char *const wrong[][2] = {
        {"", "1:1: expected ChannelConfig or MFunctions\n"},
        {"<Axis Name=\"X\"/>", "1:1: expected ChannelConfig or MFunctions\n"},
        {"<ChannelConfig/><ChannelConfig/>", "1:17: expected the end of the file\n"},
        {"<ChannelConfig/>\nx", "2:1: expected the end of the file\n"},
        {"<ChannelConfig>text</ChannelConfig>", "1:16: expected Axis, Gear, MFunctions or </ChannelConfig>\n"},
        {"<ChannelConfig><MFunc No=\"1\"/></ChannelConfig>", "1:16: expected Axis, Gear, MFunctions or </ChannelConfig>\n"},
        {"<ChannelConfig></Axis>", "1:16: expected Axis, Gear, MFunctions or </ChannelConfig>\n"},
        {"<ChannelConfig></ChannelConfig x", "1:16: expected Axis, Gear, MFunctions or </ChannelConfig>\n"},
        {"<ChannelConfig Foo=\"1\"/>", "1:16: expected an attribute of ChannelConfig\n"},
        {"<MFunctions Foo=\"1\"/>", "1:13: expected an attribute of MFunctions\n"},
        {"<ChannelConfig AccelerationType=\"2\"/>", "1:34: expected 0 or 1\n"},
        {"<ChannelConfig AccelerationType=\"0\" AccelerationType=\"1\"/>", "1:37: expected each attribute once\n"},
        {"<ChannelConfig ManualEnable=\"X\"/>", "1:30: expected PI or MAN\n"},
        {"<ChannelConfig NoLicense=\"FeaturePlcX\"/>",
         "1:27: expected HwKeyConnected or FeaturePlc0 to FeaturePlc9, spaces between them\n"},
        {"<ChannelConfig NoLicense=\"FeaturePlc\"/>",
         "1:27: expected HwKeyConnected or FeaturePlc0 to FeaturePlc9, spaces between them\n"},
        {"<ChannelConfig NoLicense=\"FeaturePlc/\"/>",
         "1:27: expected HwKeyConnected or FeaturePlc0 to FeaturePlc9, spaces between them\n"},
        {"<ChannelConfig NoLicense=\"FeatureXyz1\"/>",
         "1:27: expected HwKeyConnected or FeaturePlc0 to FeaturePlc9, spaces between them\n"},
        {"</ChannelConfig>", "1:1: expected ChannelConfig or MFunctions\n"},
        {"<ChannelConfig><Axis Name=\"X\"></Gear></ChannelConfig>", "1:31: expected </Axis>\n"},
        {"<MFunctions><Gear/></MFunctions>", "1:13: expected MFunc or </MFunctions>\n"},
        {"<ChannelConfig AccelerationType\"2\"/>", "1:32: expected = behind the name of an attribute\n"},
        {"<ChannelConfig AccelerationType=2/>", "1:33: expected a value in quotes\n"},
        {"<ChannelConfig AccelerationType=\"2/>", "1:37: expected a quote behind the value\n"},
        {"<ChannelConfig AccelerationType=\"&lt;\"/>", "1:34: expected a value without < and &\n"},
        {"<ChannelConfig AccelerationType=\"1\"ManualEnable=\"PI\"/>", "1:36: expected an attribute, > or />\n"},
        {"<ChannelConfig", "1:15: expected an attribute, > or />\n"},
        {"<ChannelConfig><Axis Name=\"X\" =\"1\"/></ChannelConfig>", "1:31: expected an attribute, > or />\n"},
        {"<ChannelConfig><Axis Name=\"X\" {=\"1\"/></ChannelConfig>", "1:31: expected an attribute, > or />\n"},
        {"<ChannelConfig><Axis Name=\"X\" [=\"1\"/></ChannelConfig>", "1:31: expected an attribute, > or />\n"},
        {"<ChannelConfig><Axis Name=\"X\"Feed=\"1\"/></ChannelConfig>", "1:30: expected an attribute, > or />\n"},
        {"<ChannelConfig><Axis Name=\"X\" A_1=\"1\"/></ChannelConfig>", "1:31: expected an attribute of Axis\n"},
        {"<ChannelConfig><Axis Name=\"X\" Feed0=\"1\"/></ChannelConfig>", "1:31: expected an attribute of Axis\n"},
        {"<ChannelConfig><Axis Name=\"X\" Feed9=\"1\"/></ChannelConfig>", "1:31: expected an attribute of Axis\n"},
        {"<ChannelConfig AccelerationType=\"<\"/>", "1:34: expected a value without < and &\n"},
        {"<!-- ", "1:6: expected --> behind a comment\n"},
        {"<?xml ", "1:7: expected ?> behind the XML line\n"},
        {"<!DOCTYPE a>", "1:1: expected ChannelConfig or MFunctions\n"},
    };
    for (unsigned i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        check_wrong(wrong[i][0], wrong[i][1]);
}
END_TEST

START_TEST(nj1_wrong_values_are_refused)
{
    static const char *const wrong[][2] = {
        {"<ChannelConfig><Axis Feed=\"1\"/></ChannelConfig>", "1:17: expected Name\n"},
        {"<ChannelConfig><Axis Name=\"17\"/></ChannelConfig>", "1:28: expected X, Y, Z, or a number from 4 to 16\n"},
        {"<ChannelConfig><Axis Name=\"X\"/>\n<Axis Name=\"X\"/></ChannelConfig>", "2:13: expected each axis once\n"},
        {"<ChannelConfig><Axis Name=\"X\" Geo=\"1\"/><Axis Name=\"Y\" Geo=\"1\"/></ChannelConfig>",
         "1:60: expected each Geo once\n"},
        {"<ChannelConfig><Axis Name=\"X\" SlsPlus=\"1\" SlsMinus=\"1\"/></ChannelConfig>",
         "1:40: expected SlsPlus above SlsMinus\n"},
        {"<ChannelConfig><Axis Name=\"X\" Lag=\"1.5\" Feed=\"0\" FeedRT=\"1.2345\"\n"
         "RefDir=\"x\" SlsPlus=\"200000.001\"/></ChannelConfig>",
         "1:36: expected T from 1 to 1000000, whole\n"
         "1:47: expected a number from 0.001 to 1000000, up to three decimals\n"
         "1:58: expected a number from 0.001 to 1000000, up to three decimals\n"
         "2:9: expected + or -\n"
         "2:21: expected mm from -200000 to 200000, up to three decimals\n"},
        {"<ChannelConfig><Gear MaxSpeed=\"5\"/></ChannelConfig>", "1:17: expected No\n"},
        {"<ChannelConfig><Gear No=\"5\"/></ChannelConfig>", "1:17: expected MaxSpeed\n"},
        {"<ChannelConfig><Gear No=\"33\" MaxSpeed=\"5\"/></ChannelConfig>", "1:26: expected a number from 1 to 32\n"},
        {"<ChannelConfig><Gear No=\"1\" MaxSpeed=\"5\" MinSpeed=\"6\"/></ChannelConfig>",
         "1:39: expected MaxSpeed not below MinSpeed\n"},
        {"<ChannelConfig><Gear No=\"1\" MaxSpeed=\"5\"/><Gear No=\"1\" MaxSpeed=\"5\"/></ChannelConfig>",
         "1:53: expected each gear once\n"},
        {"<MFunctions><MFunc/></MFunctions>", "1:14: expected No\n"},
        {"<MFunctions><MFunc No=\"101\"/></MFunctions>", "1:24: expected a number from 0 to 100\n"},
        {"<MFunctions><MFunc No=\"3\" GroupNo=\"12\"/></MFunctions>", "1:36: expected GroupNo 2, which is fixed\n"},
        {"<MFunctions><MFunc No=\"77\"/><MFunc No=\"77\"/></MFunctions>", "1:40: expected each M function once\n"},
    };
    for (unsigned i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        check_wrong(wrong[i][0], wrong[i][1]);
}
END_TEST

START_TEST(nj1_numbers)
{
    static const char *const wrong[] = {"", "-", ".5", "5.", "1.2345", "1e3", "+1", "1 ", "--1", "1.2.3",
                                        "99999999999999999999", "0x1"};
    char text[200];
    for (unsigned i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        snprintf(text, sizeof text, "<ChannelConfig><Axis Name=\"X\" Offset1=\"%s\"/></ChannelConfig>", wrong[i]);
        check_wrong(text, "1:40: expected mm from -200000 to 200000, up to three decimals\n");
    }
}
END_TEST

START_TEST(nj1_licences_and_smoothing)
{
    read_well("<ChannelConfig\tNoLicense=\" FeaturePlc0\tFeaturePlc9\r\n HwKeyConnected \">"
              "<Axis Name=\"X\" LinearAccel=\"1\" ParabAccel=\"4\"/></ChannelConfig>");
    ck_assert_uint_eq(config.no_license, 1u | 1u << 1 | 1u << 10);
    ck_assert_uint_eq(config.axis[0].smoothing[CNC_SET_NORMAL], 1); /* 0.25 */
    read_well("<ChannelConfig NoLicense=\" FeaturePlc8  FeaturePlc1 \"/>");
    ck_assert_uint_eq(config.no_license, 1u << 9 | 1u << 2);
}
END_TEST

START_TEST(the_first_twenty_errors_are_reported)
{
    char text[4000] = "<ChannelConfig>";
    for (unsigned i = 0; i < 30; i++)
        strcat(text, "<Axis/>\n");
    strcat(text, "</ChannelConfig>");
    ck_assert(!text_read_config(text, &config));
    unsigned lines = 0;
    for (const char *at = text_reported; *at != '\0'; at++)
        lines += *at == '\n';
    ck_assert_uint_eq(lines, CNC_TEXT_ERRORS_MAX);
    ck_assert(!cnc_config_read(text, strlen(text), &config, NULL, NULL));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("cnc_config");
    TCase *all = tcase_create("config");
    tcase_add_test(all, nj2_defaults_of_an_axis);
    tcase_add_test(all, w1_conversions);
    tcase_add_test(all, nj2_what_a_text_leaves_out);
    tcase_add_test(all, nj2_attributes);
    tcase_add_test(all, ng2_fixed_groups);
    tcase_add_test(all, nj3_groups_of_the_documentation);
    tcase_add_test(all, nj3_fragment_that_is_not_closed);
    tcase_add_test(all, nj1_wrong_texts_are_refused);
    tcase_add_test(all, nj1_wrong_values_are_refused);
    tcase_add_test(all, nj1_numbers);
    tcase_add_test(all, nj1_licences_and_smoothing);
    tcase_add_test(all, the_first_twenty_errors_are_reported);
    suite_add_tcase(suite, all);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
