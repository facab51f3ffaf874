/* Where the sun stands, from the time alone. */
#ifndef VELUM_WEATHER_SUN_H
#define VELUM_WEATHER_SUN_H

/* Apparent geocentric direction towards the sun, ECEF, unit; UTC in seconds since 1970. Good to 0.01 degree from 1900
 * to 2200 (UT1 is taken to be UTC). The same time gives the same bits. */
void sun_direction(double unix_s, double direction[3]);

#endif
