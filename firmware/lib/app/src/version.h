// The firmware's version, as hello reports it.
#pragma once
#include <stdint.h>

namespace app {

constexpr uint8_t version_major = 0, version_minor = 1, version_patch = 0;

}  // namespace app
