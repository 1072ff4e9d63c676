// A line that damages what it carries, frame by frame, and knows what it has done.
#pragma once
#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include "sets.h"

namespace attack {

enum class Damage { bit, burst, lost, doubled, inserted, swapped, truncated, spliced, garbage };
constexpr int damage_kinds = 9;

struct Delivered {
  std::vector<std::uint8_t> bytes;
  bool whole;         // every byte of the frame came as it was sent, one behind the other
  bool after_zero;    // what came before the frame ends with a zero, so that the receiver knows its place
  bool hit;           // there was a fault
  std::size_t after;  // bytes that came after the last fault
};

class Channel {
 public:
  // rate: faults for each byte
  Channel(Random& random, double rate);
  // A frame with its closing zero, or any other bytes.
  Delivered pass(const std::vector<std::uint8_t>& sent);
  // No more faults from here on.
  void mend() { until_fault_ = UINT64_MAX; }

  std::uint64_t faults() const { return faults_; }

 private:
  struct Work;
  void harm(Damage kind, Work& work);
  void draw();
  std::uint8_t any_byte() { return static_cast<std::uint8_t>(random_()); }

  Random& random_;
  std::geometric_distribution<std::uint64_t> gap_;
  std::uint64_t until_fault_ = 0;  // bytes
  std::uint64_t faults_ = 0;
  std::size_t cut_head_ = 0;    // of the next frame: it was spliced to this one
  std::uint8_t last_byte_ = 0;  // that came out
};

}  // namespace attack
