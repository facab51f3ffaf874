#include "program.h"

int stability_run(program *p) {
    (void)p;
    return 1;
}
