// libFuzzer over the whole firmware: the input is a list of deeds of a host, an arm and bad luck. See watcher.h for
// what must hold.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "machine.h"
#include "must.h"
#include "sets.h"
#include "watcher.h"

namespace attack {
namespace {

class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : at_(data), left_(size) {}
  bool more() const { return left_ != 0; }
  std::uint8_t u8() {
    if (left_ == 0) return 0;
    --left_;
    return *at_++;
  }
  std::uint16_t u16() {
    const unsigned low = u8();
    return static_cast<std::uint16_t>(low | unsigned{u8()} << 8);
  }
  std::int32_t i32() {
    const std::uint32_t low = u16();
    return static_cast<std::int32_t>(low | std::uint32_t{u16()} << 16);
  }

 private:
  const std::uint8_t* at_;
  std::size_t left_;
};

// The index of a parameter and a value, within its range if the input says so.
wire::ParamSetRequest choose_value(Input& in) {
  wire::ParamSetRequest request = {static_cast<std::uint16_t>(in.u8() % (params::count + 1)), 0};
  const bool within = in.u8() % 8 != 0;
  request.value = in.i32();
  if (within && request.index < params::count) {
    const params::Field& field = field_of(request.index);
    const std::int64_t span = std::int64_t{field.maximum} - field.minimum + 1;
    request.value = static_cast<std::int32_t>(field.minimum + static_cast<std::uint32_t>(request.value) % span);
  }
  return request;
}

class Story {
 public:
  explicit Story(Input in) : in_(in), watcher_(machine_) {}

  void tell() {
    boot(hal::ResetCause::power_on, false);
    ask(wire::TelemetryRequest{1});
    ticks(25);
    while (in_.more() && budget_ != 0) {
      deed();
      service();
    }
    watcher_.at_end();
  }

 private:
  void boot(hal::ResetCause cause, bool damaged) {
    machine_.power_on(cause);
    watcher_.after_boot(damaged);
  }

  void service() {
    int pieces = 0;
    while (watcher_.service()) must(++pieces < 500, "the work between ticks comes to rest");
    if (wire_free_) board.tx_room = hal::tx_capacity;
  }

  void ticks(unsigned count) {
    for (; count != 0 && budget_ != 0; --count, --budget_) {
      move_arm();
      watcher_.tick();
      service();
    }
  }

  // Followers that go where their motors turn them, or that somebody shakes.
  void move_arm() {
    ++time_;
    for (std::uint8_t i = 0; i < hal::joint_count; ++i) {
      const auto pot = static_cast<std::size_t>(i + hal::joint_count);
      if (arm_moves_ && board.drivers) {
        place_[i] += board.duty[i] * speed_;
        place_[i] = std::min(std::max(place_[i], 0), 1023 * place_per_count);
        board.counts[pot] = static_cast<std::uint16_t>(place_[i] / place_per_count);
      } else {
        place_[i] = board.counts[pot] * place_per_count;
      }
    }
    if (shaken_ == 0 || time_ % shake_ticks_ != 0) return;
    std::uint16_t& count = board.counts[static_cast<std::size_t>(joint_shaken_ + hal::joint_count)];
    count = static_cast<std::uint16_t>(std::min(std::max(count + (shake_up_ ? shaken_ : -shaken_), 0), 1023));
    shake_up_ = !shake_up_;
  }

  template <class Request>
  void ask(const Request& request) {
    send(encode(make_frame(++seq_, request)));
  }
  void send(const std::vector<std::uint8_t>& bytes) { machine_.send(bytes.data(), bytes.size()); }

  void send_any_frame() {
    Frame frame;
    frame.type = in_.u8();
    frame.seq = ++seq_;
    frame.size = in_.u8() % (wire::max_payload + 1);
    for (std::uint8_t i = 0; i < frame.size; ++i) frame.payload[i] = in_.u8();
    send(encode(frame));
  }

  void send_any_bytes() {
    std::vector<std::uint8_t> bytes(in_.u8() % 160);
    for (std::uint8_t& byte : bytes) byte = in_.u8();
    send(bytes);
  }

  void lead_on() {
    wire::LeadPointRequest point = {watcher_.next_point(), {}};
    if (in_.u8() == 255) ++point.number;
    for (std::int8_t& step : point.step) step = static_cast<std::int8_t>(in_.u8());
    ask(point);
  }

  void cut_power() {
    const std::uint8_t how = in_.u8();
    const bool damaged = how & 8;
    watcher_.before_cut();
    for (int k = how >> 4; damaged && k >= 0; --k) {
      std::uint8_t& cell = board.eeprom[in_.u16() % board.eeprom.size()];
      cell = in_.u8();
    }
    boot(static_cast<hal::ResetCause>(how % 5), damaged);
    ask(wire::TelemetryRequest{1});
  }

  void move_pot() {
    std::uint16_t& count = board.counts[in_.u8() % hal::pot_count];
    count = in_.u16() % 1024;
  }

  void shake() {
    joint_shaken_ = in_.u8() % hal::joint_count;
    shaken_ = in_.u8() % 128;
    shake_ticks_ = 1u + in_.u8();
  }

  void fail_next_tick() {
    const std::uint8_t how = in_.u8();
    board.samples_ready = (how & 3) != 0;
    board.late = (how & 4) != 0;
    board.elapsed = static_cast<std::uint8_t>(board.late ? 1 + how / 8 : 1);
    ticks(1);
    board.samples_ready = true;
  }

  void deed() {
    const std::uint8_t what = in_.u8() % 26;
    if (what < 14) request(what);
    else happening(what);
  }

  void request(std::uint8_t what) {
    switch (what) {
      case 0: return ask(wire::EnableRequest{in_.u16()});
      case 1: return ask(wire::LeadRequest{in_.u16()});
      case 2: return ask(wire::StopRequest{});
      case 3: return ask(wire::RenewRequest{in_.u16()});
      case 4: return ask(wire::ClearFaultRequest{});
      case 5: return ask(wire::TelemetryRequest{in_.u16()});
      case 6: return ask(choose_value(in_));
      case 7: service(); return ask(wire::ParamApplyRequest{params::crc(watcher_.staged())});
      case 8: return ask(wire::ParamSaveRequest{});
      case 9: return ask(wire::ParamDefaultsRequest{});
      case 10: service(); return lead_on();
      case 11: return send_any_frame();
      case 12: return send_any_bytes();
      case 13: return ask(wire::ParamGetRequest{in_.u8()});
    }
  }

  void happening(std::uint8_t what) {
    switch (what) {
      case 14: return ticks(in_.u8() % 64);
      case 15: return ticks(in_.u16() % 2000);
      case 16: return move_pot();
      case 17: return fail_next_tick();
      case 18: board.age_us = in_.u16() % 1100; return;
      case 19: return cut_power();
      case 20: board.lost = in_.u8(); return;
      case 21: board.estop_low = !board.estop_low; return;
      case 22: wire_free_ = !wire_free_; return;
      case 23:
        arm_moves_ = true;
        speed_ = static_cast<std::int8_t>(in_.u8());
        return;
      case 24: arm_moves_ = false; return;
      case 25: return shake();
    }
  }

  static constexpr int place_per_count = 1 << 16;

  Input in_;
  Machine machine_;
  Watcher watcher_;
  unsigned budget_ = 4000;  // ticks
  std::uint8_t seq_ = 0;
  bool wire_free_ = true;  // it takes what the board sends
  bool arm_moves_ = false;
  int speed_ = 0;
  std::array<int, hal::joint_count> place_ = {};
  unsigned time_ = 0, shake_ticks_ = 1;
  std::uint8_t joint_shaken_ = 0, shaken_ = 0;
  bool shake_up_ = false;
};

}  // namespace
}  // namespace attack

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  hal::fake::board = hal::fake::FakeBoard();
  attack::Story(attack::Input(data, size)).tell();
  return 0;
}
