// See channel.h.
#include "channel.h"

#include <algorithm>

namespace attack {

struct Channel::Work {
  const std::vector<std::uint8_t>& in;
  std::size_t at;  // the byte of `in` that a fault hits
  std::vector<std::uint8_t> out;
  std::vector<std::uint8_t> ahead;  // garbage between the frames
  std::size_t last_fault;           // in `out`
};

Channel::Channel(Random& random, double rate) : random_(random), gap_(rate) { draw(); }

void Channel::draw() { until_fault_ = gap_(random_); }

// Each of them leaves `at` behind the bytes that it has dealt with.
void Channel::harm(Damage kind, Work& work) {
  const std::size_t left = work.in.size() - work.at;
  const std::uint8_t byte = work.in[work.at++];
  switch (kind) {
    case Damage::bit: work.out.push_back(static_cast<std::uint8_t>(byte ^ 1 << between(random_, 0, 7))); break;
    case Damage::burst: {
      const auto count = std::min(left, static_cast<std::size_t>(between(random_, 2, 8)));
      for (std::size_t i = 0; i < count; ++i) work.out.push_back(any_byte());
      work.at += count - 1;
      break;
    }
    case Damage::lost: break;
    case Damage::doubled: work.out.insert(work.out.end(), 2, byte); break;
    case Damage::inserted:
      work.out.push_back(any_byte());
      work.out.push_back(byte);
      break;
    case Damage::swapped:
      if (left > 1) work.out.push_back(work.in[work.at++]);
      work.out.push_back(byte);
      break;
    case Damage::truncated: work.at = between(random_, 0, 1) ? work.in.size() : work.in.size() - 1; break;
    case Damage::spliced:
      work.at = work.in.size();
      cut_head_ = static_cast<std::size_t>(between(random_, 1, 10));
      break;
    case Damage::garbage:
      for (std::int64_t count = between(random_, 1, 40); count != 0; --count) work.ahead.push_back(any_byte());
      work.out.push_back(byte);
      break;
  }
}

Delivered Channel::pass(const std::vector<std::uint8_t>& sent) {
  Work work = {sent, std::min(cut_head_, sent.size()), {}, {}, 0};
  bool hit = work.at != 0;
  cut_head_ = 0;
  while (work.at < sent.size()) {
    const std::size_t left = sent.size() - work.at;
    if (until_fault_ >= left) {
      work.out.insert(work.out.end(), sent.begin() + static_cast<std::ptrdiff_t>(work.at), sent.end());
      until_fault_ -= until_fault_ == UINT64_MAX ? 0 : left;
      break;
    }
    work.out.insert(work.out.end(), sent.begin() + static_cast<std::ptrdiff_t>(work.at),
                    sent.begin() + static_cast<std::ptrdiff_t>(work.at + until_fault_));
    work.at += until_fault_;
    harm(static_cast<Damage>(between(random_, 0, damage_kinds - 1)), work);
    draw();
    ++faults_;
    hit = true;
    work.last_fault = work.out.size();
  }
  Delivered out = {std::move(work.ahead), work.out == sent, false, hit, work.out.size() - work.last_fault};
  out.after_zero = (out.bytes.empty() ? last_byte_ : out.bytes.back()) == 0;
  out.bytes.insert(out.bytes.end(), work.out.begin(), work.out.end());
  if (!out.bytes.empty()) last_byte_ = out.bytes.back();
  return out;
}

}  // namespace attack
