/* The tables that velum_negotiate's get_table gives out. */
#ifndef PLUGIN_TABLES_H
#define PLUGIN_TABLES_H

#include <velum/standalone.h>
#include <velum/vulkan.h>
#include <velum/world.h>

extern const velum_world_api velum_world_table;
extern const velum_engine_api velum_engine_table;
extern const velum_vulkan_api velum_vulkan_table;
extern const velum_standalone_api velum_standalone_table;

#endif
