// See web_hal.h.
#ifdef __wasm__
#include "web_hal.h"

namespace hal {
namespace web {
namespace {

constexpr unsigned eeprom_write_ticks = 4;

template <std::uint8_t capacity>
class Ring {
 public:
  bool empty() const { return count_ == 0; }
  std::uint8_t free() const { return static_cast<std::uint8_t>(capacity - count_); }
  void push(std::uint8_t byte) { bytes_[(first_ + count_++) % capacity] = byte; }
  std::uint8_t pop() {
    const std::uint8_t byte = bytes_[first_];
    first_ = static_cast<std::uint8_t>((first_ + 1) % capacity);
    --count_;
    return byte;
  }

 private:
  std::array<std::uint8_t, capacity> bytes_ = {};
  std::uint8_t first_ = 0, count_ = 0;
};

struct Duty {
  bool positive = false;
  std::uint16_t size = 0;
};

struct Board {
  ResetCause cause = ResetCause::power_on;
  bool pending = false;
  std::uint16_t age_us = 0;
  std::array<std::uint16_t, pot_count> filling = {}, sums = {};
  unsigned converted = 0;
  bool full = false;
  std::uint8_t probed = 0;
  std::uint8_t probe_count = 0;
  bool late = false;
  Driver driver = Driver::pwm_direction;
  bool drivers = false;
  std::array<Duty, joint_count> duty = {};
  Ring<rx_capacity> received;
  Ring<tx_capacity> sent;
  std::uint8_t lost = 0;
  unsigned eeprom_busy_ticks = 0;
  std::uint16_t eeprom_address = 0;
  std::uint8_t eeprom_value = 0;
};

Eeprom erased() {
  Eeprom memory;
  memory.fill(0xff);
  return memory;
}

Board board;
Eeprom memory = erased();
unsigned memory_writes = 0;
bool estop_pressed = false;
bool clutch_pressed = false;

}  // namespace

void power_on(ResetCause cause) {
  board = Board();
  board.cause = cause;
}

void power_off() { board = Board(); }

void start_tick() {
  if (board.converted == conversions && !board.full) {
    board.sums = board.filling;
    board.full = true;
  } else {
    board.late = true;
  }
  board.filling = {};
  board.converted = 0;
  board.pending = true;
  if (board.eeprom_busy_ticks && --board.eeprom_busy_ticks == 0) {
    memory.at(board.eeprom_address) = board.eeprom_value;
    ++memory_writes;
  }
}

void set_age(std::uint16_t us) { board.age_us = us; }

void convert(std::uint8_t pot, unsigned count) {
  const unsigned mark = count < 4 || count >= 1020 ? rail_mark : 0;
  board.filling.at(pot) = static_cast<std::uint16_t>(board.filling.at(pot) + count + mark);
  ++board.converted;
}

std::uint8_t probed() { return board.probed; }
void probe(unsigned count) { board.probe_count = static_cast<std::uint8_t>(count / 4); }

void press_estop(bool pressed) { estop_pressed = pressed; }

void press_clutch(bool pressed) { clutch_pressed = pressed; }

bool receive(std::uint8_t byte) {
  if (board.received.free()) {
    board.received.push(byte);
    return true;
  }
  if (board.lost < 255) ++board.lost;
  return false;
}

bool take_sent(std::uint8_t& byte) {
  if (board.sent.empty()) return false;
  byte = board.sent.pop();
  return true;
}

bool drivers_on() { return board.drivers; }

MotorPins motor_pins(std::uint8_t joint) {
  const Duty& duty = board.duty.at(joint);
  const bool positive = duty.positive;
  const std::uint16_t size = board.drivers ? duty.size : std::uint16_t{0};
  switch (board.driver) {
    case Driver::pwm_direction: return {size, 0, positive, false};
    case Driver::pwm_two_directions: return {size, 0, positive, !positive};
    case Driver::two_pwm_low: break;
    case Driver::two_pwm_high: {
      const std::uint16_t high = board.drivers ? full_duty : std::uint16_t{0};
      const auto other = static_cast<std::uint16_t>(high - size);
      return {positive ? high : other, positive ? other : high, false, false};
    }
  }
  return {positive ? size : std::uint16_t{0}, positive ? std::uint16_t{0} : size, false, false};
}

Eeprom& eeprom() { return memory; }
unsigned eeprom_writes() { return memory_writes; }

}  // namespace web

using web::board;

Board board_id() { return Board::native; }
ResetCause reset_cause() { return board.cause; }
void begin() {}

bool tick_pending() { return board.pending; }

TickStart tick_begin() {
  const TickStart start = {1, board.late};
  board.late = false;
  return start;
}

void tick_end() { board.pending = false; }
std::uint16_t tick_age_us() { return board.age_us; }

const std::uint16_t* pot_sums() { return board.full ? board.sums.data() : nullptr; }

void release_pots(std::uint8_t probed) {
  board.full = false;
  board.probed = probed;
}

void end_pull_ups() {}

Probe last_probe() {
  return {board.probed, board.probe_count, static_cast<std::uint8_t>(board.sums.at(board.probed) / 16)};
}

bool has_driver(Driver driver) { return driver <= Driver::two_pwm_high; }
void choose_driver(Driver driver) { board.driver = driver; }

std::uint16_t full_duty(std::uint8_t) { return web::full_duty; }
void set_duty(std::uint8_t joint, bool positive, std::uint16_t size) { board.duty.at(joint) = {positive, size}; }
void set_drivers(bool on) { board.drivers = on; }
void set_led(bool) {}  // the page shows the state itself
bool estop_low() { return web::estop_pressed; }
bool clutch_low() { return web::clutch_pressed; }

bool rx_available() { return !board.received.empty(); }
std::uint8_t rx_read() { return board.received.pop(); }
std::uint8_t tx_free() { return board.sent.free(); }

void tx_write(const std::uint8_t* bytes, std::uint8_t count) {
  for (; count; --count) board.sent.push(*bytes++);
}

std::uint8_t rx_lost() {
  const std::uint8_t count = board.lost;
  board.lost = 0;
  return count;
}

bool eeprom_busy() { return board.eeprom_busy_ticks != 0; }
std::uint8_t eeprom_read(std::uint16_t address) { return web::memory.at(address); }

// The cell is erased first.
void eeprom_begin_write(std::uint16_t address, std::uint8_t value) {
  web::memory.at(address) = 0xff;
  board.eeprom_address = address;
  board.eeprom_value = value;
  board.eeprom_busy_ticks = web::eeprom_write_ticks;
}

// A program that hangs hangs the page's worker: no watchdog looks here.
void watchdog_start() {}
void watchdog_kick() {}
void idle() {}

}  // namespace hal
#endif  // __wasm__
