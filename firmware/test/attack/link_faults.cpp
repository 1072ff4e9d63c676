// A host and a board over a line that damages bytes: link_faults session SEED FAULTS RATE, the rate in faults per
// million bytes. Prints what came of it. Or what a board sends, as it came: link_faults replies SEED FAULTS RATE.
// Writes a record for each frame: size and bytes of what was sent, size and bytes of what came, and 1 if the receiver
// must understand it.
#include <algorithm>
#include <cstdio>
#include <deque>
#include <string>

#include "channel.h"
#include "counts.h"
#include "host.h"
#include "machine.h"
#include "must.h"

namespace attack {
namespace {

constexpr std::uint64_t longest_recovery = 2 * wire::max_wire;  // bytes
constexpr std::size_t bytes_per_tick = 100;                     // at 1 Mbaud

struct Sent {
  Frame frame;
  std::uint64_t end;  // where it ended on the line
  bool whole;         // it must be understood
};

class Session {
 public:
  Session(Random& random, double rate, Counts& counts) : channel_(random, rate), host_(random), counts_(counts) {
    board = hal::fake::FakeBoard();
    machine_.power_on(hal::ResetCause::power_on);
    running_ = staged_ = machine_.running();
    for (int i = 0; i < 25; ++i) turn(false);
  }

  std::uint64_t run(std::uint64_t faults) {
    while (channel_.faults() < faults) turn(true);
    return channel_.faults();
  }

 private:
  void turn(bool host_speaks) {
    machine_.tick();
    if (host_speaks && board.received.empty()) speak();
    for (bool more = true; more;) {
      const Piece piece = machine_.service();
      board.tx_room = hal::tx_capacity;
      more = piece.more;
      if (piece.heard) hear(piece);
      for (const Frame& reply : piece.sent) {
        wire::ParamApplyReply applied;
        if (reply.read(applied)) judge_apply();
        host_.hear(reply);
      }
      forget();
    }
  }

  void speak() {
    const Frame& request = host_.request();
    for (const std::vector<std::uint8_t>& bytes : host_.messages()) {
      const Delivered delivered = channel_.pass(bytes);
      put(delivered.bytes);
      end_ += delivered.bytes.size();
      if (delivered.hit) last_fault_ = end_ - delivered.after;
      recovering_ = recovering_ || delivered.hit;
      if (bytes.size() == 1) continue;  // the zero before a stop
      sent_.push_back({request, end_, delivered.whole && delivered.after_zero});
      ++counts_["frames"];
      counts_["frames hit"] += delivered.hit;
    }
  }

  // Garbage takes its time on the line: no tick sees more than one millisecond of it.
  void put(const std::vector<std::uint8_t>& bytes) {
    for (std::size_t done = 0; done < bytes.size();) {
      if (board.received.size() >= bytes_per_tick) turn(false);
      const std::size_t some = std::min(bytes.size() - done, bytes_per_tick - board.received.size());
      machine_.send(bytes.data() + done, some);
      done += some;
    }
    must(board.lost == 0, "the receiver holds what comes in a tick");
  }

  // A frame that was sent may also be understood late, when its own closing zero was lost.
  bool was_sent(const Frame& frame) {
    const auto here = [&](const Sent& one) { return one.end == machine_.taken() && one.frame == frame; };
    const auto late = [&](const Sent& one) { return one.frame == frame; };
    auto found = std::find_if(sent_.begin(), sent_.end(), here);
    if (found == sent_.end()) found = std::find_if(sent_.begin(), sent_.end(), late);
    if (found == sent_.end()) return false;
    sent_.erase(found);
    return true;
  }

  void hear(const Piece& piece) {
    ++counts_["understood"];
    if (recovering_ && machine_.taken() >= last_fault_) {
      auto& worst = counts_["worst recovery"];
      worst = std::max(worst, machine_.taken() - last_fault_);
      if (machine_.taken() - last_fault_ > longest_recovery) ++counts_["slow recovery"];
      recovering_ = false;
    }
    const bool sent = was_sent(piece.frame);
    if (!sent) hear_foreign(piece);
    wire::StopRequest stop;
    if (piece.frame.read(stop) && board.drivers) ++counts_["on after stop"];
    wire::ParamSetRequest one;
    wire::ParamDefaultsRequest all;
    if (piece.frame.read(one)) params::set(staged_, one.index, one.value);
    if (piece.frame.read(all)) params::load_defaults(staged_);
  }

  // Its CRC is right, but nobody has sent it.
  void hear_foreign(const Piece& piece) {
    ++counts_["passed by chance"];
    wire::Nack nack;
    const bool refused = piece.sent.empty() || piece.sent.front().read(nack);
    const auto type = static_cast<wire::RequestType>(piece.frame.type);
    const bool asks =
        type == wire::RequestType::hello || type == wire::RequestType::status || type == wire::RequestType::param_get;
    if (!refused && !asks) ++counts_["acted by chance"];
    if (board.drivers && !piece.drivers_were_on) ++counts_["started by chance"];
  }

  void judge_apply() {
    ++counts_["applied"];
    running_ = machine_.running();
    if (!same(running_, host_.wanted()) || !same(running_, staged_)) ++counts_["wrong set"];
  }

  // Frames that the board has passed.
  void forget() {
    while (!sent_.empty() && sent_.front().end + 2 * wire::max_wire < machine_.taken()) sent_.pop_front();
    for (Sent& one : sent_) {
      if (one.whole && one.end <= machine_.taken()) ++counts_["whole but not understood"];
      if (one.end <= machine_.taken()) one.whole = false;
    }
  }

  Machine machine_;
  Channel channel_;
  Host host_;
  Counts& counts_;
  params::Table running_, staged_;
  std::deque<Sent> sent_;
  std::uint64_t end_ = 0, last_fault_ = 0;
  bool recovering_ = false;
};

void run_sessions(Random& random, std::uint64_t faults, double rate, Counts& counts) {
  constexpr std::uint64_t faults_per_session = 2000;
  while (counts["faults"] < faults) {
    const std::uint64_t some = std::min(faults_per_session, faults - counts["faults"]);
    counts["faults"] += Session(random, rate, counts).run(some);
    ++counts["sessions"];
  }
}

void put(const std::vector<std::uint8_t>& bytes) {
  std::putchar(static_cast<int>(bytes.size()));
  std::fwrite(bytes.data(), 1, bytes.size(), stdout);
}

void send_replies(Random& random, std::uint64_t faults, double rate) {
  Channel channel(random, rate);
  while (channel.faults() < faults) {
    Frame frame;
    const bool sample = between(random, 0, 3) != 0;
    frame.type = sample ? wire::Sample::type : wire::StatusReply::type;
    frame.size = sample ? wire::Sample::size : wire::StatusReply::size;
    frame.seq = static_cast<std::uint8_t>(random());
    for (std::uint8_t i = 0; i < frame.size; ++i)
      frame.payload[i] = static_cast<std::uint8_t>(random() % 4 ? random() : 0);
    const std::vector<std::uint8_t> bytes = encode(frame);
    const Delivered delivered = channel.pass(bytes);
    put(bytes);
    put(delivered.bytes);
    std::putchar(delivered.whole && delivered.after_zero);
  }
}

int main(const std::string& what, std::uint64_t seed, std::uint64_t count, int how) {
  Random random(seed);
  Counts counts;
  if (what == "replies") send_replies(random, count, how * 1e-6);
  else run_sessions(random, count, how * 1e-6, counts);
  counts.print();
  return 0;
}

}  // namespace
}  // namespace attack

int main(int count, char** arguments) {
  if (count != 5) return 2;
  return attack::main(arguments[1], std::stoull(arguments[2]), std::stoull(arguments[3]), std::stoi(arguments[4]));
}
