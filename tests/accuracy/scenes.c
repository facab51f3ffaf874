#include "scenes.h"

#include <stddef.h>
#include <string.h>

const scene_row scene_rows[] = {
    {"slab_thin", "uniform slab of optical depth 1 from below, sun 40 deg high ahead", false, false},
    {"slab_thick", "uniform slab of optical depth 64 from above, sun behind the eye", false, false},
    {"slab_thick_below", "what comes through a uniform slab of optical depth 64", false, false},
    {"slab_low_sun", "uniform slab of optical depth 8 from above, towards a sun 3 deg high", false, false},
    {"cumulus_behind_eye", "one cumulus, sun behind the eye", false, false},
    {"cumulus_side", "one cumulus, sun at the right", false, true},
    {"cumulus_behind_cloud", "one cumulus, sun behind the cloud", false, false},
    {"cumulus_low_sun", "few cumulus, sun 12 deg high behind the eye", false, false},
    {"broken_below", "broken cumulus from below", false, false},
    {"broken_between", "broken cumulus from between", false, true},
    {"broken_above", "broken cumulus from above", false, true},
    {"noon_above", "cumulus from above, sun 75 deg high", false, false},
    {"noon_below", "stratocumulus from below, sun 75 deg high", false, false},
    {"sheet_above", "closed nimbostratus from above", false, false},
    {"in_cloud", "inside stratocumulus", false, false},
    {"thunderstorm", "thunderstorm with anvil, 30 km ahead", false, false},
    {"cirrus_sun", "cirrus before the sun", false, false},
    {"overcast_below", "overcast stratocumulus from below", false, false},
    {"fog", "fog of 600 m visibility, no cloud", false, false},
    {"sunset", "cumulus and altocumulus, sun 2 deg high ahead", false, false},
    {"high_11km", "cumulus and cirrus from 11 km", false, false},
    {"low_orbit", "broken cloud from 400 km", false, false},
    {"weather_frankfurt", "GFS and METAR over Frankfurt", true, false},
    {"weather_tropics", "GFS over the equatorial Atlantic", true, false},
    {"weather_philadelphia", "GFS and METAR over Philadelphia", true, false},
    {NULL, NULL, false, false},
};

const scene_row *scene_find(const char *name) {
    for (const scene_row *row = scene_rows; row->name; row++) {
        if (strcmp(row->name, name) == 0) {
            return row;
        }
    }
    return NULL;
}
