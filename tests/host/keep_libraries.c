/* For LD_PRELOAD under LeakSanitizer: libraries stay loaded, so that what a driver leaks has a name by which
 * tests/lsan.supp knows it. */
int dlclose(void *library);

int dlclose(void *library) {
    (void)library;
    return 0;
}
