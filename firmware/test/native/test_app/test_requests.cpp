// Every type of request in every length: a declared one is answered by its own reply, all else is refused and changes
// nothing.
#include <array>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <type_traits>
#include <vector>

#include "../messages.h"
#include "bench.h"

using bench::Bench;
using bench::board;
using bench::Booted;

namespace {

// Type -> length of every request that shared/link declares.
std::map<std::uint8_t, std::size_t> declared() {
  std::map<std::uint8_t, std::size_t> requests;
  wire::for_each_message([&](const std::string& name, const auto& message) {
    using Message = std::decay_t<decltype(message)>;
    const std::string ending = "Request";
    if (name.size() < ending.size() || name.substr(name.size() - ending.size()) != ending) return;
    const std::uint8_t type = Message::type;
    requests[type] = Message::size;
  });
  return requests;
}

struct Odd {
  std::uint8_t type;
  std::vector<std::uint8_t> payload;
  wire::NackCode code;
};

// Every type and length but those that belong together, with random payloads.
std::vector<Odd> odd_ones() {
  const auto requests = declared();
  std::mt19937 random(1022);
  std::vector<Odd> frames;
  for (unsigned type = 0; type < 256; ++type) {
    const auto found = requests.find(static_cast<std::uint8_t>(type));
    for (std::size_t size = 0; size <= wire::max_payload; ++size) {
      if (found != requests.end() && found->second == size) continue;
      std::vector<std::uint8_t> payload(size);
      for (auto& byte : payload) byte = static_cast<std::uint8_t>(random());
      const auto code = found == requests.end() ? wire::NackCode::unknown_type : wire::NackCode::bad_length;
      frames.push_back({static_cast<std::uint8_t>(type), payload, code});
    }
  }
  return frames;
}

template <class Message>
void add(std::vector<int>& trace, const Message& message) {
  std::uint8_t bytes[Message::size];
  message.encode(bytes);
  trace.insert(trace.end(), bytes, bytes + sizeof bytes);
}

// All that can be seen of an arm: its outputs, its EEPROM and its samples tick by tick; then its counters, its running
// and its staged set. Before each tick it gets one of the frames, if any.
std::vector<int> life(const std::function<void(Bench&)>& begin, const std::vector<Odd>& frames, bool send) {
  Bench arm;
  begin(arm);
  params::Table staged = bench::defaults();
  staged.soft_start_ms = 777;  // place 3 of the table
  arm.get<wire::ParamSetReply>(wire::ParamSetRequest{3, 777});
  arm.get<wire::TelemetryReply>(wire::TelemetryRequest{1});
  arm.samples.clear();
  int wrong = 0;
  std::vector<int> trace;
  for (const Odd& odd : frames) {
    if (send) {
      const bench::Frame answer = arm.ask_raw(odd.type, odd.payload);
      const int detail = odd.code == wire::NackCode::bad_length ? static_cast<int>(odd.payload.size()) : odd.type;
      wire::Nack nack{};
      wrong += answer.type != wire::Nack::type || answer.payload.size() != wire::Nack::size;
      wire::Nack::decode(answer.payload.data(), static_cast<std::uint8_t>(answer.payload.size()), nack);
      wrong += nack.request != odd.type || nack.code != odd.code || nack.detail != detail;
    }
    arm.tick();
    trace.insert(trace.end(), board.duty.begin(), board.duty.end());
    trace.insert(trace.end(), {board.drivers, board.led, static_cast<int>(board.eeprom_writes)});
  }
  CHECK(wrong == 0);
  REQUIRE(arm.samples.size() == frames.size());
  for (const wire::Sample& sample : arm.samples) add(trace, sample);
  add(trace, arm.status());
  add(trace, arm.get<wire::HelloReply>(wire::HelloRequest{}));
  arm.stop();
  arm.get<wire::ParamApplyReply>(wire::ParamApplyRequest{params::crc(staged)});
  return trace;
}

}  // namespace

TEST_CASE("an undeclared type in any length, and a declared one in a wrong length, is refused and changes nothing") {
  const std::map<std::string, std::function<void(Bench&)>> lives = {
      {"disabled", [](Bench& arm) { arm.boot(); }},
      {"in fault",
       [](Bench& arm) {
         arm.power_on(hal::ResetCause::watchdog);
         arm.boot();
         REQUIRE(arm.state() == wire::State::fault);
       }},
      {"following",
       [](Bench& arm) {
         arm.set_leader(1, 0.1);
         arm.follow();
       }},
      {"led by the host",
       [](Bench& arm) {
         arm.boot();
         const auto lead = arm.get<wire::LeadReply>(wire::LeadRequest{65535});
         arm.get<wire::LeadPointReply>(wire::LeadPointRequest{lead.next, {100, 0, -100, 0}});
         arm.run(1100);
       }},
  };
  const std::vector<Odd> frames = odd_ones();
  REQUIRE(frames.size() == 256 * 49 - declared().size());
  for (const auto& one : lives) {
    CAPTURE(one.first);
    const bool unchanged = life(one.second, frames, true) == life(one.second, frames, false);
    CHECK(unchanged);
  }
}

TEST_CASE("every declared request is answered by its own reply") {
  Booted arm;
  std::map<std::uint8_t, std::size_t> asked;
  const auto answers = [&](const auto& request) {
    using Request = std::decay_t<decltype(request)>;
    const std::uint8_t type = Request::type, size = Request::size;
    CAPTURE(int(type));
    CHECK(int(arm.ask(request).type) == (type | wire::reply_bit));
    asked[type] = size;
  };
  params::Table table = bench::defaults();
  answers(wire::HelloRequest{});
  answers(wire::StatusRequest{});
  answers(wire::ParamGetRequest{0});
  answers(wire::ParamSetRequest{0, 2});
  answers(wire::ParamDefaultsRequest{});
  answers(wire::ParamApplyRequest{params::crc(table)});
  answers(wire::ParamSaveRequest{});
  answers(wire::TelemetryRequest{0});
  answers(wire::ClearFaultRequest{});
  answers(wire::EnableRequest{500});
  answers(wire::RenewRequest{500});
  answers(wire::StopRequest{});
  answers(wire::LeadRequest{500});
  answers(wire::LeadPointRequest{0, {0, 0, 0, 0}});
  answers(wire::ClutchRequest{wire::ClutchAction::disengage});
  CHECK(asked == declared());
}
