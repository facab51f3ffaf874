/* The line of figures: text as bits, 8 x 8 a character. */
#ifndef HOST_TEXT_H
#define HOST_TEXT_H

#include <stdint.h>

#define TEXT_BITS_SIZE(characters) ((characters)*8u)

/* Draws at most `most` characters and returns how many: row y of character c is byte 8 c + y, its top bit leftmost.
 * Letters come out upper case, what the font lacks as '?'. */
uint32_t text_draw(const char *text, uint32_t most, uint8_t *bits);

#endif
