#include "metar_decode.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <velum/weather.h>

#define FOOT_M 0.3048f
#define MILE_M 1609.344f
#define KNOT_M_S 0.514444f

/* Open-ended visibilities ("10 km or more"). */
static const float unlimited_m = 30000.0f;

typedef struct token {
    const char *text;
    size_t size;
} token;

static int is_digit(char c) {
    return c >= '0' && c <= '9';
}

static int is_upper(char c) {
    return c >= 'A' && c <= 'Z';
}

static int starts(token group, const char *text) {
    const size_t size = strlen(text);
    return group.size >= size && memcmp(group.text, text, size) == 0;
}

static int equals(token group, const char *text) {
    return group.size == strlen(text) && starts(group, text);
}

static int ends(token group, const char *text) {
    const size_t size = strlen(text);
    return group.size >= size && memcmp(group.text + group.size - size, text, size) == 0;
}

static int all_digits(const char *text, size_t size) {
    for (size_t i = 0; i < size; ++i) {
        if (!is_digit(text[i])) {
            return 0;
        }
    }
    return size > 0;
}

static int number(const char *text, size_t size) {
    int value = 0;
    for (size_t i = 0; i < size && i < 6; ++i) {
        value = value * 10 + (text[i] - '0');
    }
    return value;
}

static int next_token(const char *text, size_t size, size_t *position, token *group) {
    size_t i = *position;
    while (i < size && (text[i] == ' ' || text[i] == '\t' || text[i] == '\r' || text[i] == '\n')) {
        ++i;
    }
    const size_t from = i;
    while (i < size && text[i] != ' ' && text[i] != '\t' && text[i] != '\r' && text[i] != '\n' && text[i] != '=') {
        ++i;
    }
    *group = (token){text + from, i - from};
    *position = i;
    return group->size > 0;
}

/* A group's reading: 0 it is none of this kind, 1 taken, -1 it is, but its value cannot be. */
enum { NOT_THIS = 0, TAKEN = 1, WRONG = -1 };

static int wrong(char reason[96], const char *what, token group, const char *expected) {
    snprintf(reason, 96, "%s: found %.*s, expected %s", what, (int)(group.size < 20 ? group.size : 20), group.text,
             expected);
    return WRONG;
}

static int take_wind(metar_report *report, token group, char reason[96]) {
    float unit = 0.0f;
    size_t size = group.size;
    if (ends(group, "KMH")) {
        unit = 1.0f / 3.6f;
        size -= 3;
    } else if (ends(group, "MPS")) {
        unit = 1.0f;
        size -= 3;
    } else if (ends(group, "KT")) {
        unit = KNOT_M_S;
        size -= 2;
    }
    const char *text = group.text;
    if (unit == 0.0f || size < 5 || report->has_wind) {
        return NOT_THIS;
    }
    const int is_variable = memcmp(text, "VRB", 3) == 0;
    if (!is_variable && !all_digits(text, 3)) {
        return NOT_THIS;
    }
    size_t at = 3;
    at += text[at] == 'P';
    size_t end = at;
    while (end < size && is_digit(text[end])) {
        ++end;
    }
    if (end - at < 2 || end - at > 3) {
        return NOT_THIS;
    }
    const int speed = number(text + at, end - at);
    int gust = 0;
    if (end < size) {
        at = end + 1;
        at += at < size && text[at] == 'P';
        if (text[end] != 'G' || at >= size || size - at > 3 || size - at < 2 || !all_digits(text + at, size - at)) {
            return NOT_THIS;
        }
        gust = number(text + at, size - at);
    }
    const int direction = is_variable ? 0 : number(text, 3);
    if (direction > 360) {
        return wrong(reason, "wind direction", group, "000 to 360 degrees");
    }
    if ((float)speed * unit > 110.0f || (float)gust * unit > 150.0f) {
        return wrong(reason, "wind speed", group, "at most 110 m/s, in gusts 150 m/s");
    }
    report->has_wind = 1;
    report->is_variable = is_variable;
    report->wind_from_deg = (float)direction;
    report->wind_m_s = (float)speed * unit;
    report->gust_m_s = (float)gust * unit;
    return TAKEN;
}

/* "3", "1/4", with `whole` miles before it. */
static int take_miles(metar_report *report, token group, int whole, char reason[96]) {
    if (!ends(group, "SM") || group.size < 3 || group.size > 8) {
        return NOT_THIS;
    }
    const char *text = group.text;
    size_t at = 0;
    const int is_less = text[0] == 'M', is_more = text[0] == 'P';
    at += is_less || is_more;
    const size_t size = group.size - 2;
    size_t end = at;
    while (end < size && is_digit(text[end])) {
        ++end;
    }
    if (end == at) {
        return NOT_THIS;
    }
    float miles = (float)number(text + at, end - at);
    if (end < size) {
        if (text[end] != '/' || !all_digits(text + end + 1, size - end - 1)) {
            return NOT_THIS;
        }
        const int below = number(text + end + 1, size - end - 1);
        if (below == 0) {
            return wrong(reason, "visibility", group, "a fraction of miles");
        }
        miles /= (float)below;
    }
    miles += (float)whole;
    if (miles > 100.0f) {
        return wrong(reason, "visibility", group, "at most 100 miles");
    }
    report->has_visibility = 1;
    report->visibility_m = fmaxf(miles * MILE_M * (is_less ? 0.5f : 1.0f), 50.0f);
    if (miles >= 10.0f) {
        report->visibility_m = fmaxf(report->visibility_m, unlimited_m);
    } else if (is_more) {
        report->visibility_m *= 1.5f;
    }
    return TAKEN;
}

static int take_metres(metar_report *report, token group) {
    const int is_plain = group.size == 4 || (group.size == 7 && ends(group, "NDV"));
    if (report->has_visibility || !is_plain || !all_digits(group.text, 4)) {
        if (!report->has_visibility && group.size >= 3 && group.size <= 4 && ends(group, "KM") &&
            all_digits(group.text, group.size - 2)) {
            const int km = number(group.text, group.size - 2);
            report->has_visibility = 1;
            report->visibility_m =
                km >= 10 ? fmaxf((float)km * 1000.0f, unlimited_m) : fmaxf((float)km * 1000.0f, 50.0f);
            return TAKEN;
        }
        return NOT_THIS;
    }
    const int metres = number(group.text, 4);
    report->has_visibility = 1;
    report->visibility_m = metres == 9999 ? unlimited_m : fmaxf((float)metres, 50.0f);
    return TAKEN;
}

static int32_t genus_of_suffix(const char *text, size_t size, int *towering) {
    static const struct {
        const char *name;
        int32_t genus;
    } names[] = {{"CB", VELUM_GENUS_CB}, {"TCU", VELUM_GENUS_CU}, {"CU", VELUM_GENUS_CU}, {"SC", VELUM_GENUS_SC},
                 {"ST", VELUM_GENUS_ST}, {"NS", VELUM_GENUS_NS},  {"AS", VELUM_GENUS_AS}, {"AC", VELUM_GENUS_AC},
                 {"CI", VELUM_GENUS_CI}, {"CS", VELUM_GENUS_CS},  {"CC", VELUM_GENUS_CC}};
    *towering = size == 3 && memcmp(text, "TCU", 3) == 0;
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); ++i) {
        if (size == strlen(names[i].name) && memcmp(text, names[i].name, size) == 0) {
            return names[i].genus;
        }
    }
    return 0;
}

static int take_sky(metar_report *report, token group, char reason[96]) {
    static const char *const amounts[] = {"FEW", "SCT", "BKN", "OVC"};
    if (equals(group, "SKC") || equals(group, "CLR") || equals(group, "NSC") || equals(group, "NCD")) {
        report->has_sky = 1;
        return TAKEN;
    }
    if (equals(group, "CAVOK")) {
        report->has_sky = 1;
        report->has_visibility = 1;
        report->visibility_m = unlimited_m;
        return TAKEN;
    }
    if (starts(group, "VV") && group.size == 5) {
        const char *height = group.text + 2;
        const int is_known = all_digits(height, 3);
        if (!is_known && memcmp(height, "///", 3) != 0) {
            return NOT_THIS;
        }
        report->is_obscured = 1;
        report->vertical_visibility_m = is_known ? fmaxf((float)number(height, 3) * 100.0f * FOOT_M, 15.0f) : NAN;
        return TAKEN;
    }
    metar_cloud cloud = {.height_m = NAN};
    for (int i = 0; i < 4; ++i) {
        if (starts(group, amounts[i])) {
            cloud.amount = METAR_FEW + i;
        }
    }
    if (!cloud.amount) {
        return NOT_THIS;
    }
    const char *text = group.text + 3;
    size_t left = group.size - 3;
    if (left >= 3 && all_digits(text, 3)) {
        const int hundreds = number(text, 3);
        if (hundreds > 600) {
            return wrong(reason, "height of cloud", group, "at most 60,000 ft");
        }
        cloud.height_m = fmaxf((float)hundreds * 100.0f * FOOT_M, 15.0f);
        text += 3;
        left -= 3;
    } else if (left >= 3 && memcmp(text, "///", 3) == 0) {
        text += 3;
        left -= 3;
    } else if (left) {
        return NOT_THIS;
    }
    if (left && memcmp(text, "///", left < 3 ? left : 3) != 0) {
        cloud.genus = genus_of_suffix(text, left, &cloud.towering);
        if (!cloud.genus) {
            return NOT_THIS;
        }
    }
    report->has_sky = 1;
    if (report->cloud_count < METAR_MAX_CLOUDS) {
        report->clouds[report->cloud_count++] = cloud;
    }
    return TAKEN;
}

static int take_temperature(metar_report *report, token group, char reason[96]) {
    float values[2] = {NAN, NAN};
    size_t at = 0;
    if (report->has_temperature) {
        return NOT_THIS;
    }
    for (int i = 0; i < 2; ++i) {
        const int is_minus = at < group.size && group.text[at] == 'M';
        const size_t digits = at + (size_t)is_minus;
        if (digits + 2 <= group.size && all_digits(group.text + digits, 2)) {
            values[i] = (float)(is_minus ? -number(group.text + digits, 2) : number(group.text + digits, 2));
            at = digits + 2;
        } else if (i == 0 || is_minus) {
            return NOT_THIS;
        } else if (group.size - at == 2 && memcmp(group.text + at, "//", 2) == 0) {
            at += 2;
        }
        if (i == 0 && (at >= group.size || group.text[at++] != '/')) {
            return NOT_THIS;
        }
    }
    if (at != group.size) {
        return NOT_THIS;
    }
    if (!(values[0] >= -90.0f && values[0] <= 60.0f)) {
        return wrong(reason, "temperature", group, "-90 to 60 degrees Celsius");
    }
    report->has_temperature = 1;
    report->temperature_k = values[0] + 273.15f;
    if (!isnan(values[1])) {
        report->has_dew_point = 1;
        report->dew_point_k = fminf(values[1], values[0]) + 273.15f;
    }
    return TAKEN;
}

/* Rates: within the classes of intensity of the AMS Glossary (rain: light to 2.5, moderate to 7.6 mm/h; drizzle: to
 * 0.3, to 0.5; snow by visibility, as water). Light, moderate, heavy. */
typedef struct phenomenon {
    const char *name;
    uint32_t weather;
    int32_t precipitation;
    float rate_mm_h[3];
} phenomenon;

static const phenomenon phenomena[] = {
    {"DZ", 0, VELUM_PRECIPITATION_DRIZZLE, {0.15f, 0.4f, 0.8f}},
    {"RA", METAR_STEADY, VELUM_PRECIPITATION_RAIN, {1.0f, 4.0f, 12.0f}},
    {"SN", METAR_STEADY, VELUM_PRECIPITATION_SNOW, {0.5f, 1.5f, 4.0f}},
    {"SG", 0, VELUM_PRECIPITATION_SNOW, {0.1f, 0.2f, 0.5f}},
    {"IC", 0, VELUM_PRECIPITATION_SNOW, {0.05f, 0.05f, 0.05f}},
    {"PL", METAR_STEADY, VELUM_PRECIPITATION_SLEET, {0.5f, 2.0f, 5.0f}},
    {"GR", 0, VELUM_PRECIPITATION_HAIL, {5.0f, 15.0f, 30.0f}},
    {"GS", 0, VELUM_PRECIPITATION_HAIL, {2.0f, 5.0f, 10.0f}},
    {"UP", METAR_UNKNOWN, VELUM_PRECIPITATION_RAIN, {0.5f, 0.5f, 0.5f}},
    {"BR", METAR_MIST, 0, {0.0f}},
    {"FG", METAR_FOG, 0, {0.0f}},
    {"FU", METAR_HAZE, 0, {0.0f}},
    {"VA", METAR_HAZE, 0, {0.0f}},
    {"DU", METAR_HAZE, 0, {0.0f}},
    {"SA", METAR_HAZE, 0, {0.0f}},
    {"HZ", METAR_HAZE, 0, {0.0f}},
    {"SS", METAR_HAZE, 0, {0.0f}},
    {"DS", METAR_HAZE, 0, {0.0f}},
    {"PY", 0, 0, {0.0f}},
    {"PO", 0, 0, {0.0f}},
    {"SQ", 0, 0, {0.0f}},
    {"FC", 0, 0, {0.0f}},
};

static const phenomenon *phenomenon_at(const char *text) {
    for (size_t i = 0; i < sizeof(phenomena) / sizeof(phenomena[0]); ++i) {
        if (memcmp(text, phenomena[i].name, 2) == 0) {
            return &phenomena[i];
        }
    }
    return NULL;
}

/* MI BC PR DR BL SH TS FZ */
static int take_descriptor(const char *text, uint32_t *weather, int *is_drifting) {
    static const char shallow[] = "MIBCPR";
    for (int i = 0; i < 6; i += 2) {
        if (memcmp(text, shallow + i, 2) == 0) {
            *weather |= METAR_SHALLOW;
            return 1;
        }
    }
    if (memcmp(text, "DR", 2) == 0 || memcmp(text, "BL", 2) == 0) {
        *is_drifting = 1;
        return 1;
    }
    if (memcmp(text, "SH", 2) == 0) {
        *weather |= METAR_SHOWER;
        return 1;
    }
    if (memcmp(text, "TS", 2) == 0) {
        *weather |= METAR_THUNDER;
        return 1;
    }
    return memcmp(text, "FZ", 2) == 0;
}

static void take_phenomenon(metar_report *report, const phenomenon *one, int intensity, uint32_t *mixed) {
    const float rate = one->rate_mm_h[intensity];
    if (!one->precipitation) {
        return;
    }
    *mixed |= 1u << one->precipitation;
    if (rate > report->precipitation_mm_h) {
        report->precipitation_mm_h = rate;
        report->precipitation = one->precipitation;
    }
    if ((*mixed & 1u << VELUM_PRECIPITATION_RAIN) && (*mixed & 1u << VELUM_PRECIPITATION_SNOW)) {
        report->precipitation = VELUM_PRECIPITATION_SLEET;
    }
}

static int take_weather(metar_report *report, token group) {
    size_t at = 0;
    int intensity = 1, is_vicinity = 0, is_drifting = 0;
    uint32_t weather = 0, mixed = 0;
    const phenomenon *found[4];
    uint32_t count = 0;
    if (starts(group, "RE") && group.size > 2) {
        return TAKEN;
    }
    if (starts(group, "+") || starts(group, "-")) {
        intensity = group.text[0] == '+' ? 2 : 0;
        at = 1;
    } else if (starts(group, "VC")) {
        is_vicinity = 1;
        at = 2;
    }
    if (group.size == at || (group.size - at) % 2 != 0) {
        return NOT_THIS;
    }
    for (; at < group.size; at += 2) {
        const phenomenon *one = phenomenon_at(group.text + at);
        if (one && count < 4) {
            found[count++] = one;
            weather |= one->weather;
        } else if (!take_descriptor(group.text + at, &weather, &is_drifting)) {
            return NOT_THIS;
        }
    }
    if (is_vicinity) {
        return TAKEN;
    }
    if (weather & (METAR_SHOWER | METAR_THUNDER)) {
        weather &= ~(uint32_t)METAR_STEADY;
    }
    if (is_drifting) {
        return TAKEN;
    }
    /* Patches beside fog over the station do not make that fog shallow. */
    if ((weather & METAR_FOG) && (report->weather & METAR_FOG) && !(report->weather & weather & METAR_SHALLOW)) {
        report->weather &= ~(uint32_t)METAR_SHALLOW;
        weather &= ~(uint32_t)METAR_SHALLOW;
    }
    report->weather |= weather;
    for (uint32_t i = 0; i < count; ++i) {
        take_phenomenon(report, found[i], intensity, &mixed);
    }
    return TAKEN;
}

static int is_trend(token group) {
    return equals(group, "RMK") || equals(group, "NOSIG") || equals(group, "BECMG") || equals(group, "TEMPO") ||
           equals(group, "INTER") || starts(group, "PROB") ||
           (starts(group, "FM") && group.size >= 6 && all_digits(group.text + 2, 4));
}

static int take_head(metar_report *report, const char *text, size_t size, size_t *position, char reason[96]) {
    token group;
    do {
        if (!next_token(text, size, position, &group)) {
            snprintf(reason, 96, "found nothing, expected a report");
            return 0;
        }
    } while (equals(group, "METAR") || equals(group, "SPECI") || equals(group, "COR"));
    int is_name = group.size == 4 && is_upper(group.text[0]);
    int is_numbered = group.size == 4;
    for (size_t i = 0; i < group.size && i < 4; ++i) {
        is_numbered = is_numbered && (is_upper(group.text[i]) || is_digit(group.text[i]));
    }
    is_name = is_name && is_numbered;
    if (!is_name) {
        *position -= group.size;
        wrong(reason, "station", group, "four letters or digits");
        return 0;
    }
    memcpy(report->station, group.text, 4);
    int got = next_token(text, size, position, &group);
    if (got && equals(group, "COR")) {
        got = next_token(text, size, position, &group);
    }
    if (got && equals(group, "NIL")) {
        snprintf(reason, 96, "no report (NIL)");
        return 0;
    }
    const int is_time = got && group.size == 7 && all_digits(group.text, 6) && group.text[6] == 'Z';
    const int day = is_time ? number(group.text, 2) : 0;
    const int hour = is_time ? number(group.text + 2, 2) : 0, minute = is_time ? number(group.text + 4, 2) : 0;
    if (!is_time || day < 1 || day > 31 || hour > 23 || minute > 59) {
        *position -= group.size;
        wrong(reason, "time", group, "day, hour and minute as DDHHMMZ");
        return 0;
    }
    report->minute_of_month = (uint32_t)((day - 1) * 1440 + hour * 60 + minute);
    return 1;
}

static int take_group(metar_report *report, token group, char reason[96]) {
    int taken = take_wind(report, group, reason);
    taken = taken ? taken : take_miles(report, group, 0, reason);
    taken = taken ? taken : take_metres(report, group);
    taken = taken ? taken : take_sky(report, group, reason);
    taken = taken ? taken : take_temperature(report, group, reason);
    return taken ? taken : take_weather(report, group);
}

int metar_decode(const char *text, size_t size, metar_report *report, char reason[96], size_t *offset) {
    size_t position = 0;
    token group;
    memset(report, 0, sizeof(*report));
    report->vertical_visibility_m = NAN;
    reason[0] = '\0';
    *offset = 0;
    if (!take_head(report, text, size, &position, reason)) {
        *offset = position;
        return 0;
    }
    const size_t body = position;
    while (next_token(text, size, &position, &group) && !is_trend(group)) {
        *offset = position - group.size;
        if (equals(group, "NIL")) {
            snprintf(reason, 96, "no report (NIL)");
            return 0;
        }
        int taken = NOT_THIS;
        if (group.size <= 2 && all_digits(group.text, group.size) && !report->has_visibility) {
            size_t after = position;
            token fraction;
            if (next_token(text, size, &after, &fraction) && memchr(fraction.text, '/', fraction.size)) {
                taken = take_miles(report, fraction, number(group.text, group.size), reason);
            }
            position = taken == TAKEN ? after : position;
        }
        taken = taken ? taken : take_group(report, group, reason);
        if (taken == WRONG) {
            return 0;
        }
    }
    if (report->weather & METAR_UNKNOWN && report->precipitation == VELUM_PRECIPITATION_RAIN &&
        report->has_temperature && report->temperature_k < 273.65f) {
        report->precipitation = VELUM_PRECIPITATION_SNOW;
    }
    if (!report->has_sky && !report->is_obscured && !report->has_visibility && !report->has_wind &&
        !report->has_temperature && !report->weather && !report->precipitation) {
        *offset = body;
        snprintf(reason, 96, "no group of use: expected wind, visibility, sky, weather or temperature");
        return 0;
    }
    return 1;
}
