// See machine.h.
#include "machine.h"

#include <algorithm>

#include "must.h"

namespace attack {
namespace {

Frame frame_of(const wire::Decoder& decoder) {
  Frame frame;
  frame.type = decoder.type();
  frame.seq = decoder.seq();
  frame.size = decoder.payload_size();
  std::copy(decoder.payload(), decoder.payload() + frame.size, frame.payload.begin());
  return frame;
}

// A copy of the board has its own outputs and its own EEPROM; the real ones come back at the end.
class OtherWorld {
 public:
  OtherWorld() : kept_(board) {
    board.received.clear();
    board.sent.clear();
    board.tx_room = hal::tx_capacity;
    board.lost = 0;
    board.age_us = 0;
    board.late = false;
    board.elapsed = 1;
    board.samples_ready = true;
  }
  ~OtherWorld() { board = kept_; }
  OtherWorld(const OtherWorld&) = delete;
  OtherWorld& operator=(const OtherWorld&) = delete;

 private:
  hal::fake::FakeBoard kept_;
};

}  // namespace

std::vector<std::uint8_t> encode(const Frame& frame) {
  wire::Encoder encoder;
  std::copy(frame.payload.begin(), frame.payload.begin() + frame.size, encoder.payload());
  encoder.finish(frame.type, frame.seq, frame.size);
  return {encoder.data(), encoder.data() + encoder.size()};
}

void Machine::power_on(hal::ResetCause cause) {
  const auto counts = board.counts;
  const bool estop_low = board.estop_low;
  hal::fake::power_on();
  board.counts = counts;
  board.estop_low = estop_low;
  board.cause = cause;
  heard_ = wire::Decoder();
  in_frame_ = false;
  answers_ = wire::Decoder();
  app_ = std::make_unique<app::App>();
  app_->begin();
}

void Machine::send(const std::uint8_t* bytes, std::size_t count) {
  const std::size_t room = hal::rx_capacity - std::min<std::size_t>(board.received.size(), hal::rx_capacity);
  board.received.insert(board.received.end(), bytes, bytes + std::min(room, count));
  if (count > room && board.lost < 255) ++board.lost;
}

void Machine::tick() {
  if (!board.samples_ready) board.late = true;  // as the real interrupt has it
  hal::fake::start_tick();
  app_->tick();
}

Piece Machine::service() {
  Piece piece = {false, board.drivers, false, Frame(), {}};
  std::array<std::uint8_t, hal::rx_capacity> before;
  const std::size_t had = board.received.size();
  std::copy(board.received.begin(), board.received.end(), before.begin());
  piece.more = app_->service();
  const std::size_t taken = had - board.received.size();
  taken_ += taken;
  for (std::size_t i = 0; i < taken; ++i) {
    in_frame_ = before[i] != 0;
    if (!heard_.push(before[i])) continue;
    must(i + 1 == taken, "a piece of work ends with the frame that it has taken");
    piece.heard = true;
    piece.frame = frame_of(heard_);
  }
  for (const std::uint8_t byte : board.sent) {
    if (answers_.push(byte)) piece.sent.push_back(frame_of(answers_));
  }
  board.sent.clear();
  must(answers_.bad() == 0, "all that the board sends is whole frames");
  return piece;
}

// What has begun on the line must not become a frame in the copy.
void Machine::end_frame() const {
  if (!in_frame_) return;
  board.received.insert(board.received.end(), wire::max_wire, 1);
  board.received.push_back(0);
}

// The copy may have to finish something first, and that may take it some ticks.
template <class Reply, class Request>
Reply Machine::ask(app::App& copy, const Request& request) {
  constexpr int patience = 200;
  const std::vector<std::uint8_t> bytes = encode(make_frame(1, request));
  board.received.insert(board.received.end(), bytes.begin(), bytes.end());
  wire::Decoder answers;
  for (int waited = 0; waited < patience; ++waited) {
    for (int pieces = 0; copy.service(); ++pieces) must(pieces < 2000, "the work between ticks comes to rest");
    for (const std::uint8_t byte : board.sent) {
      Reply reply{};
      if (answers.push(byte) && frame_of(answers).read(reply)) {
        board.sent.clear();
        return reply;
      }
    }
    board.sent.clear();
    board.tx_room = hal::tx_capacity;
    hal::fake::start_tick();
    copy.tick();
  }
  must(false, "a request is answered");
  return Reply{};
}

wire::StatusReply Machine::status() const {
  const OtherWorld world;
  app::App copy(*app_);
  end_frame();
  return ask<wire::StatusReply>(copy, wire::StatusRequest{});
}

params::Table Machine::running() const {
  const OtherWorld world;
  app::App copy(*app_);
  end_frame();
  params::Table table;
  params::load_defaults(table);
  for (std::uint16_t i = 0; i < params::count; ++i) {
    const auto reply = ask<wire::ParamGetReply>(copy, wire::ParamGetRequest{i});
    must(reply.index == i, "a reply is about what was asked");
    must(params::set(table, i, reply.value) == params::Access::ok, "every running value is within its range");
    board.tx_room = hal::tx_capacity;
  }
  return table;
}

}  // namespace attack
