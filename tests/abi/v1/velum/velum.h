/* Velum: weather for flight simulators. All stable headers but vulkan.h, which needs Vulkan's own. */
#ifndef VELUM_H
#define VELUM_H
#include "abi.h"
#include "engine.h"
#include "standalone.h"
#include "weather.h"
#include "world.h"
#endif
