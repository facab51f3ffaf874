#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <velum/weather.h>

#include "weather/metar_decode.h"

static metar_report good(const char *body) {
    char text[256], reason[96];
    size_t offset;
    metar_report report;
    snprintf(text, sizeof(text), "EDDF 180750Z %s", body);
    const int got = metar_decode(text, strlen(text), &report, reason, &offset);
    if (!got) {
        print_error("%s: %s\n", text, reason);
    }
    assert_true(got);
    return report;
}

static void bad(const char *text, const char *expected) {
    char reason[96];
    size_t offset;
    metar_report report;
    assert_false(metar_decode(text, strlen(text), &report, reason, &offset));
    if (!strstr(reason, expected)) {
        print_error("%s: found '%s', expected '%s'\n", text, reason, expected);
    }
    assert_non_null(strstr(reason, expected));
    assert_true(offset <= strlen(text));
}

static void near_to(double found, double expected, double tolerance) {
    if (!(fabs(found - expected) <= tolerance)) {
        print_error("found %g, expected %g\n", found, expected);
    }
    assert_true(fabs(found - expected) <= tolerance);
}

static void wind_in_three_units_with_gusts(void **state) {
    (void)state;
    metar_report report = good("24015G27KT");
    near_to(report.wind_from_deg, 240, 0);
    near_to(report.wind_m_s, 15 * 1852.0 / 3600.0, 1e-4);
    near_to(report.gust_m_s, 27 * 1852.0 / 3600.0, 1e-4);
    near_to(good("04006MPS").wind_m_s, 6, 0);
    near_to(good("36018KMH").wind_m_s, 5, 1e-5);
    near_to(good("270P99KT").wind_m_s, 99 * 1852.0 / 3600.0, 1e-3);
    near_to(good("270102G115KT").gust_m_s, 115 * 1852.0 / 3600.0, 1e-3);
    report = good("VRB03KT");
    assert_true(report.is_variable);
    assert_true(good("00000KT").has_wind);
    assert_false(good("/////KT 9999").has_wind);
    assert_false(good("0000000KT 9999").has_wind);
    bad("EDDF 180750Z 36115KT", "wind direction");
    bad("EDDF 180750Z 270999KT", "wind speed");
    bad("EDDF 180750Z 27010G400KT", "wind speed");
}

static void visibility_in_metres_and_miles(void **state) {
    (void)state;
    near_to(good("0350").visibility_m, 350, 0);
    near_to(good("4000 2000NE").visibility_m, 4000, 0);
    near_to(good("0300NDV").visibility_m, 300, 0);
    near_to(good("9999").visibility_m, 30000, 0);
    near_to(good("CAVOK").visibility_m, 30000, 0);
    near_to(good("10SM").visibility_m, 30000, 0);
    near_to(good("3SM").visibility_m, 3 * 1609.344, 0.1);
    near_to(good("1 3/4SM").visibility_m, 1.75 * 1609.344, 0.1);
    near_to(good("1/4SM").visibility_m, 0.25 * 1609.344, 0.1);
    near_to(good("M1/4SM").visibility_m, 0.125 * 1609.344, 0.1);
    near_to(good("P6SM").visibility_m, 9 * 1609.344, 0.1);
    near_to(good("0000").visibility_m, 50, 0);
    assert_false(good("//// 05/04").has_visibility);
    assert_false(good("R24/0550 05/04").has_visibility);
    bad("EDDF 180750Z 1/0SM", "visibility");
}

static void sky_groups(void **state) {
    (void)state;
    metar_report report = good("FEW005 SCT017TCU BKN045CB OVC100");
    assert_int_equal(report.cloud_count, 4);
    near_to(report.clouds[0].height_m, 500 * 0.3048, 0.01);
    assert_int_equal(report.clouds[0].amount, METAR_FEW);
    assert_int_equal(report.clouds[1].genus, VELUM_GENUS_CU);
    assert_true(report.clouds[1].towering);
    assert_int_equal(report.clouds[2].genus, VELUM_GENUS_CB);
    assert_int_equal(report.clouds[3].amount, METAR_OVC);
    assert_int_equal(report.clouds[3].genus, 0);
    static const char *const clear[] = {"SKC", "CLR", "NSC", "NCD", "CAVOK"};
    for (int i = 0; i < 5; ++i) {
        report = good(clear[i]);
        assert_true(report.has_sky);
        assert_int_equal(report.cloud_count, 0);
    }
    report = good("BKN///");
    assert_int_equal(report.cloud_count, 1);
    assert_true(isnan(report.clouds[0].height_m));
    report = good("BKN010///");
    near_to(report.clouds[0].height_m, 304.8, 0.01);
    report = good("VV002");
    assert_true(report.is_obscured);
    near_to(report.vertical_visibility_m, 60.96, 0.01);
    assert_true(isnan(good("VV///").vertical_visibility_m));
    assert_false(good("////// 10/08").has_sky);
    assert_false(good("BKNE000 10/08").has_sky);
    bad("EDDF 180750Z OVC999", "height of cloud");
}

static void temperatures(void **state) {
    (void)state;
    metar_report report = good("M07/M08");
    near_to(report.temperature_k, 266.15, 1e-3);
    near_to(report.dew_point_k, 265.15, 1e-3);
    report = good("02/M06");
    near_to(report.temperature_k, 275.15, 1e-3);
    near_to(report.dew_point_k, 267.15, 1e-3);
    report = good("12///");
    assert_true(report.has_temperature && !report.has_dew_point);
    assert_true(good("12/").has_temperature);
    assert_false(good("///// 9999").has_temperature);
    bad("EDDF 180750Z 75/10", "temperature");
}

static void present_weather(void **state) {
    (void)state;
    metar_report light = good("-RA"), moderate = good("RA"), heavy = good("+RA");
    assert_int_equal(light.precipitation, VELUM_PRECIPITATION_RAIN);
    assert_true(light.precipitation_mm_h < moderate.precipitation_mm_h);
    assert_true(moderate.precipitation_mm_h < heavy.precipitation_mm_h);
    assert_true(light.precipitation_mm_h <= 2.5f && heavy.precipitation_mm_h > 7.6f);
    assert_int_equal(good("-DZ").precipitation, VELUM_PRECIPITATION_DRIZZLE);
    assert_int_equal(good("SHSN").precipitation, VELUM_PRECIPITATION_SNOW);
    assert_int_equal(good("-RASN").precipitation, VELUM_PRECIPITATION_SLEET);
    assert_int_equal(good("+TSRAGR").precipitation, VELUM_PRECIPITATION_HAIL);
    assert_int_equal(good("PL").precipitation, VELUM_PRECIPITATION_SLEET);
    assert_int_equal(good("UP M03/M05").precipitation, VELUM_PRECIPITATION_SNOW);
    assert_true(good("+TSRAGR").weather & METAR_THUNDER);
    assert_true(good("TS 9999").weather & METAR_THUNDER);
    assert_false(good("VCTS 9999").weather & METAR_THUNDER);
    assert_true(good("VCSH RERA 9999").precipitation_mm_h == 0.0f);
    assert_true(good("BLSN 9999").precipitation_mm_h == 0.0f);
    assert_true(good("0400 FZFG").weather & METAR_FOG);
    assert_true(good("2000 MIFG").weather & METAR_SHALLOW);
    assert_true(good("2000 BR").weather & METAR_MIST);
    assert_true(good("2000 HZ").weather & METAR_HAZE);
}

static void trends_and_remarks_say_nothing_about_now(void **state) {
    (void)state;
    static const char *const tails[] = {"NOSIG",         "BECMG OVC002 0100 FG",  "TEMPO +TSRA BKN010CB",
                                        "RMK OVC002 FG", "FM0900 +TSRA BKN010CB", "PROB30 FG",
                                        "= OVC002"};
    for (int i = 0; i < 7; ++i) {
        char text[128];
        snprintf(text, sizeof(text), "9999 FEW030 10/08 %s", tails[i]);
        const metar_report report = good(text);
        assert_int_equal(report.cloud_count, 1);
        assert_int_equal(report.weather, 0);
        near_to(report.visibility_m, 30000, 0);
    }
}

static void heads(void **state) {
    (void)state;
    char reason[96];
    size_t offset;
    metar_report report;
    const char *text = "METAR COR EDDF 180750Z COR AUTO 9999=";
    assert_true(metar_decode(text, strlen(text), &report, reason, &offset));
    assert_string_equal(report.station, "EDDF");
    assert_int_equal(report.minute_of_month, 17 * 1440 + 7 * 60 + 50);
    bad("", "expected a report");
    bad("METAR", "expected a report");
    bad("EDDF", "time");
    bad("EDDF 320750Z 9999", "time");
    bad("EDDF 182450Z 9999", "time");
    bad("EDDF 180760Z 9999", "time");
    bad("ED 180750Z 9999", "station");
    bad("eddf 180750Z 9999", "station");
    bad("EDDF NIL", "NIL");
    bad("EDDF 180750Z NIL", "NIL");
    bad("EDDF 180750Z AUTO Q1013", "no group of use");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wind_in_three_units_with_gusts),
        cmocka_unit_test(visibility_in_metres_and_miles),
        cmocka_unit_test(sky_groups),
        cmocka_unit_test(temperatures),
        cmocka_unit_test(present_weather),
        cmocka_unit_test(trends_and_remarks_say_nothing_about_now),
        cmocka_unit_test(heads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
