// The three bytes by which a bootloader tells which chip it runs on.
#pragma once
#include <avr/io.h>

namespace hal {

constexpr uint8_t chip_signature[] = {SIGNATURE_0, SIGNATURE_1, SIGNATURE_2};

}  // namespace hal
