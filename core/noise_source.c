/* Run while Velum is built: writes the noises as a source file. Arguments: that file. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "noise_make.h"

enum { WORDS = sizeof(core_noise) / sizeof(uint64_t), A_LINE = 16 };
_Static_assert(sizeof(core_noise) % (A_LINE * sizeof(uint64_t)) == 0, "whole lines");

/* Words and not bytes: compilers take a second for each million of numbers. */
typedef union {
    core_noise noise;
    uint64_t words[WORDS];
} noise_words;

static void write_source(FILE *file, const uint64_t *words) {
    fprintf(
        file,
        "#include \"core/noise.h\"\n\n#if __BYTE_ORDER__ != %d\n#error Made for another order of bytes.\n#endif\n\n",
        __BYTE_ORDER__);
    fputs("static const union {\n    uint64_t words[sizeof(core_noise) / sizeof(uint64_t)];\n    core_noise noise;\n"
          "} built = {{\n",
          file);
    for (size_t i = 0; i < WORDS; i++) {
        fprintf(file, "0x%" PRIx64 "u,%c", words[i], i % A_LINE == A_LINE - 1 ? '\n' : ' ');
    }
    fputs("}};\n\nconst core_noise *core_noise_built(void) {\n    return &built.noise;\n}\n", file);
}

int main(int argc, char **argv) {
    noise_words *made = malloc(sizeof *made);
    FILE *file = argc == 2 ? fopen(argv[1], "w") : NULL;
    bool ok = made && file && core_noise_make(&made->noise);
    if (ok) {
        write_source(file, made->words);
        ok = !ferror(file);
    }
    ok = (!file || fclose(file) == 0) && ok;
    free(made);
    if (!ok) {
        fprintf(stderr, "noise-source: cannot write the noises to %s\n", argc == 2 ? argv[1] : "the file named first");
    }
    return ok ? 0 : 1;
}
