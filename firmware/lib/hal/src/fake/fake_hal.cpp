// See fake_hal.h.
#ifndef __AVR__
#include "fake_hal.h"

namespace hal {
namespace fake {

FakeBoard board;

FakeBoard::FakeBoard() {
  counts.fill(512);
  eeprom.fill(0xff);
}

void power_on() {
  const auto kept = board.eeprom;
  board = FakeBoard();
  board.eeprom = kept;
}

void start_tick() {
  board.pending = true;
  if (board.late) board.drivers = false;  // as the interrupt does
  if (board.eeprom_busy_ticks) --board.eeprom_busy_ticks;
}

}  // namespace fake

Board board_id() { return Board::native; }
ResetCause reset_cause() { return fake::board.cause; }
void begin() {}

bool tick_pending() { return fake::board.pending; }

TickStart tick_begin() {
  const TickStart start = {fake::board.elapsed, fake::board.late};
  fake::board.elapsed = 1;
  fake::board.late = false;
  return start;
}

void tick_end() { fake::board.pending = false; }
std::uint16_t tick_age_us() { return fake::board.age_us; }

const std::uint16_t* pot_sums() {
  static std::uint16_t sums[pot_count];
  for (std::uint8_t i = 0; i < pot_count; ++i) {
    const std::uint16_t count = fake::board.counts[i];
    const std::uint16_t mark = count < 4 || count >= 1020 ? rail_mark : 0;
    sums[i] = static_cast<std::uint16_t>((count + mark) * conversions_per_pot);
  }
  return fake::board.samples_ready ? sums : nullptr;
}

void release_pots(std::uint8_t probed) { fake::board.probed = probed; }
void end_pull_ups() {}

Probe last_probe() {
  const std::uint8_t pot = fake::board.probed;
  const int count = fake::board.counts[pot];
  const int probed = count + fake::board.probe_beyond[pot];
  return {pot, static_cast<std::uint8_t>(probed / 4), static_cast<std::uint8_t>(count / 4)};
}

bool has_driver(Driver driver) { return driver <= fake::board.last_driver; }
void choose_driver(Driver driver) { fake::board.driver = driver; }

std::uint16_t full_duty(std::uint8_t) { return fake::full_duty; }

void set_duty(std::uint8_t joint, bool positive, std::uint16_t size) {
  fake::board.duty.at(joint) = positive ? size : -static_cast<int>(size);
}

void set_drivers(bool on) { fake::board.drivers = on; }
void set_led(bool on) { fake::board.led = on; }
bool estop_low() { return fake::board.estop_low; }
bool clutch_low() { return fake::board.clutch_low; }

bool rx_available() { return !fake::board.received.empty(); }

std::uint8_t rx_read() {
  const std::uint8_t byte = fake::board.received.front();
  fake::board.received.pop_front();
  return byte;
}

std::uint8_t tx_free() { return fake::board.tx_room; }

void tx_write(const std::uint8_t* bytes, std::uint8_t count) {
  if (count == 0 || count > fake::board.tx_room) ++fake::board.tx_misuse;
  fake::board.drivers_when_sending = fake::board.drivers;
  fake::board.sent.insert(fake::board.sent.end(), bytes, bytes + count);
  fake::board.tx_room = static_cast<std::uint8_t>(fake::board.tx_room - count);
}

std::uint8_t rx_lost() {
  const std::uint8_t count = fake::board.lost;
  fake::board.lost = 0;
  return count;
}

bool eeprom_busy() { return fake::board.eeprom_busy_ticks != 0; }

std::uint8_t eeprom_read(std::uint16_t address) {
  if (eeprom_busy()) ++fake::board.eeprom_misuse;
  return fake::board.eeprom.at(address);
}

void eeprom_begin_write(std::uint16_t address, std::uint8_t value) {
  if (eeprom_busy()) ++fake::board.eeprom_misuse;
  fake::board.eeprom.at(address) = value;
  fake::board.eeprom_busy_ticks = fake::eeprom_write_ticks;
  ++fake::board.eeprom_writes;
}

void watchdog_start() { fake::board.watchdog_on = true; }
void watchdog_kick() { ++fake::board.watchdog_kicks; }
void idle() {}

}  // namespace hal
#endif  // __AVR__
