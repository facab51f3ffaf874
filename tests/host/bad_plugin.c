/* Libraries that are no plugin for this host. */
#include <stddef.h>
#include <velum/abi.h>

#if defined(BAD_PLUGIN_99)
velum_result VELUM_CALL velum_negotiate(const velum_host_info *host, velum_plugin_info *out) {
    (void)host;
    out->abi = 0;
    out->abi_min = out->abi_max = 99;
    return VELUM_ERROR_VERSION;
}
#elif defined(BAD_PLUGIN_TABLES)
static const void *VELUM_CALL get_table(const char *id) {
    (void)id;
    return NULL;
}

velum_result VELUM_CALL velum_negotiate(const velum_host_info *host, velum_plugin_info *out) {
    (void)host;
    out->abi = out->abi_min = out->abi_max = VELUM_ABI_MAJOR;
    out->name = "hollow";
    out->get_table = get_table;
    return VELUM_OK;
}
#else
int velum_nothing(void);
int velum_nothing(void) {
    return 0;
}
#endif
