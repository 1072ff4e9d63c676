// Words of the rules: numbers in sentences, and what potentiometers are called.
#pragma once

#include <cstdarg>
#include <cstddef>
#include <cstdio>
#include <string>

#include "calibrate/rules.h"

namespace greywhale::calibrate {

// A text as printf writes it; Python's formats write numbers the same way.
[[gnu::format(printf, 1, 2)]] inline std::string text(const char* format, ...) {
  char room[512];  // the longest sentence has 300 letters
  va_list values;
  va_start(values, format);
  std::vsnprintf(room, sizeof room, format, values);
  va_end(values);
  return room;
}

inline std::string pot_name(std::size_t pot) {
  return text("%s potentiometer %d", pot < kJoints ? "leader" : "follower", static_cast<int>(pot % kJoints));
}

// The same at the beginning of a sentence.
inline std::string pot_first(std::size_t pot) {
  std::string name = pot_name(pot);
  name[0] = pot < kJoints ? 'L' : 'F';
  return name;
}

inline void add_line(std::string& words, const std::string& sentence) {
  words += (words.empty() ? "" : "\n") + sentence;
}

}  // namespace greywhale::calibrate
