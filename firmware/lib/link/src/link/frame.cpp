// The frame codec. Encoding stuffs zeros in place while the CRC passes over the same bytes: one walk per frame.
#include "link/frame.h"

#include "link/crc16.h"

namespace wire {

bool Decoder::push(uint8_t byte) {
  if (byte == 0) return finish();
  if (!started_) {
    started_ = true;
    broken_ = false;
    size_ = 0;
    run_ = static_cast<uint8_t>(byte - 1);
    return false;
  }
  if (broken_) return false;
  // Only the first code byte is extra. Every later one stands where the data had a zero.
  const bool code = run_ == 0;
  if (size_ == max_frame) {
    broken_ = true;
    return false;
  }
  buffer_[size_++] = code ? uint8_t{0} : byte;
  run_ = static_cast<uint8_t>((code ? byte : run_) - 1);
  return false;
}

bool Decoder::finish() {
  if (!started_) return false;  // zeros between frames mean nothing
  started_ = false;
  if (!broken_ && run_ == 0 && size_ >= frame_overhead) {
    const uint8_t body = static_cast<uint8_t>(size_ - 2);
    if (crc_over(buffer_, body) == get_u16(buffer_ + body)) return true;
  }
  size_ = frame_overhead;  // payload_size() is then 0
  if (bad_ != UINT16_MAX) ++bad_;
  return false;
}

namespace {

// Replaces each zero of a frame by the distance to the next one.
struct Stuffer {
  uint8_t* code;  // the byte that will hold the distance
  uint8_t distance;

  void pass(uint8_t* at, uint8_t byte) {
    if (byte == 0) {
      *code = distance;
      code = at;
      distance = 0;
    }
    ++distance;
  }
};

}  // namespace

void Encoder::finish(uint8_t type, uint8_t seq, uint8_t payload_size) {
  buffer_[1] = type;
  buffer_[2] = seq;
  Stuffer stuffer{buffer_, 1};
  Crc16 crc;
  uint8_t* at = buffer_ + 1;
  for (uint8_t left = static_cast<uint8_t>(payload_size + 2); left != 0; --left, ++at) {
    const uint8_t byte = *at;
    crc.add(byte);
    stuffer.pass(at, byte);
  }
  at[0] = crc.low();
  stuffer.pass(at, crc.low());
  at[1] = crc.high();
  stuffer.pass(at + 1, crc.high());
  *stuffer.code = stuffer.distance;
  at[2] = 0;
  size_ = static_cast<uint8_t>(payload_size + frame_overhead + 2);
}

}  // namespace wire
