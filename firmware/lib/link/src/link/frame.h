// Frames on the wire: COBS( type | seq | payload | CRC-16 little-endian ), then a zero byte. docs/link.md defines them.
// Frames are shorter than 254 bytes, so one COBS code byte in front is all the overhead there is.
#pragma once

#include <stdint.h>

#include "link/schema.h"

namespace wire {

constexpr uint8_t frame_overhead = 4;  // type, seq, CRC
constexpr uint8_t max_frame = max_payload + frame_overhead;
constexpr uint8_t max_wire = max_frame + 2;  // code byte in front, zero behind
static_assert(max_frame < 254, "longer frames would need more than one COBS code byte");

// Takes bytes as they come. Whatever they are, it neither overflows nor stalls. It counts what is not a frame once, and
// starts afresh after the next zero byte.
class Decoder {
 public:
  // True when this byte completes a frame. type(), seq() and payload() are then valid until the next push.
  bool push(uint8_t byte);

  uint8_t type() const { return buffer_[0]; }
  uint8_t seq() const { return buffer_[1]; }
  const uint8_t* payload() const { return buffer_ + 2; }
  uint8_t payload_size() const { return static_cast<uint8_t>(size_ - frame_overhead); }

  // How many runs of bytes between zeros were no frame; stops at 65535.
  uint16_t bad() const { return bad_; }

 private:
  bool finish();

  uint8_t buffer_[max_frame] = {};
  uint8_t size_ = 0;      // bytes decoded; kept after a frame for payload_size()
  uint8_t run_ = 0;       // bytes left of the current COBS block
  bool started_ = false;  // something came since the last zero
  bool broken_ = false;   // what came cannot become a frame any more
  uint16_t bad_ = 0;
};

// Builds one frame at a time in its own buffer, ready for the wire.
class Encoder {
 public:
  template <class Message>
  void encode(uint8_t seq, const Message& message) {
    static_assert(Message::size <= max_payload, "a message must fit a frame");
    message.encode(payload());
    finish(Message::type, seq, Message::size);
  }

  // For payloads written by hand: fill payload(), at most max_payload bytes, then finish.
  uint8_t* payload() { return buffer_ + 3; }
  void finish(uint8_t type, uint8_t seq, uint8_t payload_size);

  const uint8_t* data() const { return buffer_; }
  uint8_t size() const { return size_; }

 private:
  uint8_t buffer_[max_wire] = {};
  uint8_t size_ = 0;
};

}  // namespace wire
