// The serial port at 1 Mbaud, both ways at once, with a wire from TX to RX and the ADC chain running.
#include <hal.h>

#include "../report.h"

namespace {

constexpr uint16_t bytes = 20000;
constexpr uint8_t burst = 100;
constexpr uint8_t in_chip = 2;  // bytes behind the receive register; a third one is overwritten

struct Result {
  uint16_t received, wrong, lost, late, milliseconds;
};

uint8_t pattern(uint16_t i) {
  const uint8_t byte = static_cast<uint8_t>(i * 7 + (i >> 8));
  return byte < 0x80 ? static_cast<uint8_t>(byte | 0x80) : byte;  // nothing that the report's reader takes for text
}

// Waits until the wire has been quiet for 5 ms.
void drain() {
  hal::rx_lost();
  for (uint8_t quiet_ms = 0; quiet_ms < 5;) {
    if (hal::rx_available()) {
      hal::rx_read();
      quiet_ms = 0;
    }
    if (!hal::tick_pending()) continue;
    finish_tick();
    ++quiet_ms;
  }
  catch_up();
}

// Bursts as fast as the wire carries them; what has not come back yet fits the receiver's ring.
Result bursts() {
  Result r = {};
  uint8_t out[burst];
  uint16_t sent = 0, idle_ms = 0;
  while (r.received < bytes && idle_ms < 50) {
    if (sent < bytes && sent == r.received) {
      for (uint8_t i = 0; i < burst; ++i) out[i] = pattern(static_cast<uint16_t>(sent + i));
      hal::tx_write(out, burst);
      sent = static_cast<uint16_t>(sent + burst);
    }
    if (hal::rx_available()) {
      r.wrong += hal::rx_read() != pattern(r.received);
      ++r.received;
      idle_ms = 0;
    }
    if (!hal::tick_pending()) continue;
    r.late += finish_tick();
    ++r.milliseconds;
    ++idle_ms;
  }
  r.lost = hal::rx_lost();
  return r;
}

// More than the ring holds, with nobody reading: the ring and the chip keep what they have, and the loss is told.
Result overflow() {
  Result r = {};
  uint8_t out[burst];
  for (uint8_t part = 0; part < 3; ++part) {
    for (uint8_t i = 0; i < burst; ++i) out[i] = pattern(static_cast<uint16_t>(part * burst + i));
    while (hal::tx_free() < burst) {
    }
    hal::tx_write(out, burst);
  }
  while (hal::tx_free() != hal::tx_capacity) {
  }
  __builtin_avr_delay_cycles(1000);
  while (hal::rx_available()) {
    const bool kept = r.received < hal::rx_capacity + in_chip;
    r.wrong += hal::rx_read() != pattern(r.received) && kept;
    ++r.received;
  }
  r.lost = hal::rx_lost();
  return r;
}

}  // namespace

int main() {
  hal::begin();
  drain();
  const Result full = bursts();
  drain();
  const Result over = overflow();
  drain();
  const Result again = bursts();
  drain();
  hal::tx_write(reinterpret_cast<const uint8_t*>("\n"), 1);
  EQUAL("every_byte_comes_back", full.received, bytes);
  EQUAL("as_it_was_sent", full.wrong, 0);
  EQUAL("none_is_lost", full.lost, 0);
  EQUAL("no_tick_is_late", full.late, 0);
  WITHIN("at_nearly_the_speed_of_the_wire", full.milliseconds, bytes / 100, bytes / 100 * 2);
  WITHIN("ring_and_chip_keep_what_they_have", over.received, hal::rx_capacity + in_chip,
         hal::rx_capacity + in_chip + 1);
  EQUAL("in_order", over.wrong, 0);
  EQUAL("and_the_loss_is_told", over.lost, 1);
  EQUAL("afterwards_bytes_come_again", again.wrong == 0 && again.received == bytes, true);
  report::end();
}
