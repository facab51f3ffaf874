/* velum-host: a host of Velum. Exit status 0 only if everything that was asked for was done. */
#include "inspect.h"
#include "options.h"
#include "play.h"
#include "shadow_map.h"

#include <stdlib.h>

int main(int argc, char **argv) {
    struct options options;
    bool done = false;
    if (!options_parse(argc, argv, &options)) {
        return EXIT_FAILURE;
    }
    switch (options.command) {
    case COMMAND_PLAY: done = play(&options); break;
    case COMMAND_PROBE: done = inspect_probe(&options); break;
    case COMMAND_SHADOW: done = shadow_map(&options); break;
    case COMMAND_TILES: done = inspect_tiles(&options); break;
    case COMMAND_CHECK: done = inspect_check(&options); break;
    case COMMAND_HELP:
        options_print_usage();
        done = true;
        break;
    }
    return done ? EXIT_SUCCESS : EXIT_FAILURE;
}
