// The whole firmware on a fake board: time, pots, a plant of pure integrators, and a host at the other end of the link.
#pragma once
#include <app.h>
#include <doctest/doctest.h>
#include <fake/fake_hal.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <vector>

namespace bench {

using hal::fake::board;
using hal::fake::full_duty;

constexpr double count_per_rad = 1023.0 / (300.0 * 3.14159265358979 / 180.0);

inline int joint_max(const std::array<int, 4>& duty) {
  int most = 0;
  for (const int d : duty) most = std::max(most, std::abs(d));
  return most;
}

struct Frame {
  std::uint8_t type, seq;
  std::vector<std::uint8_t> payload;
};

inline params::Table defaults() {
  params::Table table;
  params::load_defaults(table);
  return table;
}

// The defaults for an arm that stays where it is, or jumps: without the checks of its motion.
inline params::Table unwatched() {
  params::Table table = defaults();
  table.speed_limit = table.runaway_limit = table.stall_volts = 0;
  return table;
}

class Bench {
 public:
  Bench() {
    hal::fake::board = hal::fake::FakeBoard();  // a blank EEPROM
    power_on();
  }
  // An arm that has booted and runs this set.
  explicit Bench(const params::Table& table) : Bench() { boot_with(table); }

  // A power cycle: what is in EEPROM stays.
  void power_on(hal::ResetCause cause = hal::ResetCause::power_on) {
    hal::fake::power_on();
    board.cause = cause;
    board.counts = counts;
    app_ = std::make_unique<app::App>();
    app_->begin();
    frames.clear();
    samples.clear();
  }

  Bench& run(unsigned ticks) {
    while (ticks--) tick();
    return *this;
  }
  Bench& boot() { return run(30); }
  Bench& boot_with(const params::Table& table) {
    boot().apply_ok(table);
    return run(2);
  }

  void tick() {
    move_plant();
    hal::fake::start_tick();
    app_->tick();
    service();
    collect();
    ++ticks;
    CHECK(board.tx_misuse == 0);
  }

  void service() {
    int pieces = 0;
    while (app_->service()) REQUIRE(++pieces < 1000);  // it must come to rest
  }

  void send_raw(const std::vector<std::uint8_t>& bytes) {
    board.received.insert(board.received.end(), bytes.begin(), bytes.end());
  }

  template <class Request>
  static std::vector<std::uint8_t> frame(const Request& request, std::uint8_t seq) {
    wire::Encoder encoder;
    encoder.encode(seq, request);
    return {encoder.data(), encoder.data() + encoder.size()};
  }

  // Sends a request and waits for the frame that answers it.
  template <class Request>
  Frame ask(const Request& request) {
    std::vector<std::uint8_t> payload(Request::size);
    request.encode(payload.data());
    return ask_raw(Request::type, payload);
  }

  // The same for any type and payload.
  Frame ask_raw(std::uint8_t type, const std::vector<std::uint8_t>& payload) {
    constexpr unsigned patience = 40;  // ticks
    const std::uint8_t seq = ++seq_;
    wire::Encoder encoder;
    std::copy(payload.begin(), payload.end(), encoder.payload());
    encoder.finish(type, seq, static_cast<std::uint8_t>(payload.size()));
    frames.clear();
    send_raw({encoder.data(), encoder.data() + encoder.size()});
    service();  // a reply need not wait for the next tick
    collect();
    for (unsigned waited = 0; frames.empty() && waited < patience; ++waited) tick();
    REQUIRE(frames.size() == 1);
    CHECK(frames[0].seq == seq);
    return frames[0];
  }

  template <class Reply, class Request>
  Reply get(const Request& request) {
    const Frame answer = ask(request);
    const auto expected = static_cast<unsigned>(Reply::type);
    REQUIRE(unsigned(answer.type) == expected);
    Reply reply{};
    REQUIRE(Reply::decode(answer.payload.data(), static_cast<std::uint8_t>(answer.payload.size()), reply));
    return reply;
  }

  template <class Request>
  wire::Nack refused(const Request& request) {
    const wire::Nack nack = get<wire::Nack>(request);
    const auto type = static_cast<unsigned>(Request::type);
    CHECK(unsigned(nack.request) == type);
    return nack;
  }

  wire::StatusReply status() { return get<wire::StatusReply>(wire::StatusRequest{}); }
  wire::State state() { return status().state; }
  wire::State enable(std::uint16_t lease_ms = 0) { return get<wire::EnableReply>(wire::EnableRequest{lease_ms}).state; }
  // The motors are off, because of this fault.
  bool stopped_by(wire::Fault fault, std::uint8_t where = supervisor::nowhere) {
    const auto now = status();
    return !board.drivers && joint_max(board.duty) == 0 && now.state == wire::State::fault && now.fault == fault &&
           now.fault_where == where && now.stop_reason == wire::StopReason::fault;
  }
  wire::State clear_fault() { return get<wire::ClearFaultReply>(wire::ClearFaultRequest{}).state; }
  wire::State stop() { return get<wire::StopReply>(wire::StopRequest{}).state; }

  void follow() {
    boot();
    REQUIRE(enable() == wire::State::soft_start);
    run(1001);
    REQUIRE(state() == wire::State::following);
  }

  // Stages values one by one.
  void stage(const params::Table& table) {
    for (std::uint8_t i = 0; i < params::count; ++i) {
      std::int32_t value = 0;
      REQUIRE(params::get(table, i, value) == params::Access::ok);
      const auto reply = get<wire::ParamSetReply>(wire::ParamSetRequest{i, value});
      CHECK(reply.index == i);
      CHECK(reply.value == value);
    }
  }
  Frame apply(const params::Table& table) {
    stage(table);
    return ask(wire::ParamApplyRequest{params::crc(table)});
  }
  void apply_ok(const params::Table& table) { REQUIRE(apply(table).type == 0x85); }

  void set_leader(std::uint8_t joint, double angle) { set(joint, angle); }
  void set_follower(std::uint8_t joint, double angle) {
    position_[joint] = angle;
    set(static_cast<std::uint8_t>(joint + 4), angle);
  }
  void set_count(std::uint8_t pot, std::uint16_t count) { counts[pot] = count; }
  double follower(std::uint8_t joint) const { return position_[joint]; }

  std::vector<Frame> frames;  // everything but samples
  std::vector<wire::Sample> samples;
  std::vector<std::uint8_t> sample_seqs;
  unsigned ticks = 0;
  double speed = 0;   // rad/s at full duty; 0: the arm does not move
  bool drain = true;  // the wire takes what is sent
  std::array<std::uint16_t, 8> counts = [] {
    std::array<std::uint16_t, 8> middle;
    middle.fill(512);
    return middle;
  }();

 private:
  void set(std::uint8_t pot, double angle) {
    counts[pot] = static_cast<std::uint16_t>(std::lround(511.5 + angle * count_per_rad));
  }

  void move_plant() {
    if (speed != 0) {
      for (std::uint8_t i = 0; i < 4; ++i) {
        if (board.drivers) position_[i] += speed * board.duty[i] / full_duty * 0.001;
        set(static_cast<std::uint8_t>(i + 4), position_[i]);
      }
    }
    board.counts = counts;
  }

  void collect() {
    for (const std::uint8_t byte : board.sent) {
      if (!decoder_.push(byte)) continue;
      if (decoder_.type() == wire::Sample::type) {
        wire::Sample sample{};
        REQUIRE(wire::Sample::decode(decoder_.payload(), decoder_.payload_size(), sample));
        samples.push_back(sample);
        sample_seqs.push_back(decoder_.seq());
      } else {
        frames.push_back(
            {decoder_.type(), decoder_.seq(), {decoder_.payload(), decoder_.payload() + decoder_.payload_size()}});
      }
    }
    board.sent.clear();
    if (drain) board.tx_room = hal::tx_capacity;
  }

  std::unique_ptr<app::App> app_;
  wire::Decoder decoder_;
  std::uint8_t seq_ = 0;
  std::array<double, 4> position_ = {};
};

struct Booted : Bench {
  Booted() { boot(); }
};

struct Following : Bench {
  Following() { follow(); }
};

}  // namespace bench
