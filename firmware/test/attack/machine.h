// The whole firmware on the fake board, one piece of its work at a time: what a piece took from the line, what it sent.
//
// A question to the board would change it. So a copy of the board is asked, in a world of its own.
#pragma once
#include <app.h>
#include <fake/fake_hal.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

namespace attack {

using hal::fake::board;

struct Frame {
  std::uint8_t type = 0, seq = 0, size = 0;
  std::array<std::uint8_t, wire::max_payload> payload = {};

  bool operator==(const Frame& other) const {
    return type == other.type && seq == other.seq && size == other.size &&
           std::memcmp(payload.data(), other.payload.data(), size) == 0;
  }
  // The request or reply in it; false when it is another one or has a wrong length.
  template <class Message>
  bool read(Message& out) const {
    return type == Message::type && Message::decode(payload.data(), size, out);
  }
};

// A type, a sequence number and a payload of at most max_payload bytes, as they go over the line.
std::vector<std::uint8_t> encode(const Frame& frame);

template <class Request>
Frame make_frame(std::uint8_t seq, const Request& request) {
  Frame frame;
  frame.type = Request::type;
  frame.seq = seq;
  frame.size = Request::size;
  request.encode(frame.payload.data());
  return frame;
}

// What the firmware did in one piece of its work.
struct Piece {
  bool more;                // there is more to do
  bool drivers_were_on;     // before it
  bool heard;               // it took a whole frame from the line
  Frame frame;              // that one
  std::vector<Frame> sent;  // replies and samples
};

class Machine {
 public:
  // A reset. What is in EEPROM stays, and so do the potentiometers and the button.
  void power_on(hal::ResetCause cause);
  // Bytes on the line. The receiver holds rx_capacity; the rest is lost, and counted once.
  void send(const std::uint8_t* bytes, std::size_t count);
  // The timer's interrupt and the tick, without the work in between.
  void tick();
  Piece service();

  std::uint64_t taken() const { return taken_; }  // bytes from the line, since the board was made

  // --- what a copy of the board says when it is asked
  wire::StatusReply status() const;
  params::Table running() const;

 private:
  template <class Reply, class Request>
  static Reply ask(app::App& copy, const Request& request);

  void end_frame() const;

  std::unique_ptr<app::App> app_;
  wire::Decoder heard_;  // takes what the firmware takes
  std::uint64_t taken_ = 0;
  bool in_frame_ = false;  // it has taken a part of a frame
  wire::Decoder answers_;  // takes what it sends
};

}  // namespace attack
