// The one exception of the simulated board: a sentence that says what is wrong, where, and what to do.
#pragma once

#include <stdexcept>

namespace board {

class BoardError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace board
