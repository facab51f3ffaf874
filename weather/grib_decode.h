/* The values of one GRIB2 field, through ecCodes. What ecCodes gets is a message of our own making around the checked
 * packing, bitmap and data sections, so hostile bytes meet our checks first. */
#ifndef VELUM_WEATHER_GRIB_DECODE_H
#define VELUM_WEATHER_GRIB_DECODE_H

#include "grib_message.h"

/* values: columns * rows floats in the file's order; missing values become NaN. */
velum_result grib_field_decode(const grib_field *field, const char *name, const grib_grid *grid, float *values,
                               velum_weather_error *error);

#endif
