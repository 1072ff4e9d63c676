// A host that works with a board over a bad line: it uploads sets, saves them, moves the arm and stops it. It repeats
// every request until it is answered, as the link allows, and sends a stop twice, each after a zero.
#pragma once
#include <params/params.h>

#include <cstdint>
#include <vector>

#include "machine.h"
#include "sets.h"

namespace attack {

class Host {
 public:
  explicit Host(Random& random);

  // The frame to send now, and the bytes that carry it. The same again while it is not answered.
  const Frame& request();
  std::vector<std::vector<std::uint8_t>> messages();
  void hear(const Frame& reply);

  // The set that a param_apply of this host means.
  const params::Table& wanted() const { return wanted_; }

 private:
  void next();
  void next_of_upload();
  void next_of_motion();
  template <class Request>
  void say(const Request& request);

  Random& random_;
  params::Table wanted_, staged_;  // staged_: as the board has confirmed
  Frame request_;
  bool answered_ = true;
  std::uint8_t seq_ = 0;
  bool uploads_ = true;  // otherwise it moves the arm
  bool leads_ = false;
  bool all_again_ = true;  // the board's staged set is not known
  int left_ = 0;           // requests of this motion
  std::uint16_t at_ = 0;
  std::uint8_t next_point_ = 0;
};

}  // namespace attack
