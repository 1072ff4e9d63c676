// The rules of a calibration for the page. Numbers go in and out through buffers, and so do words.
#include <cstddef>

#include "calibrate/rules.h"

#define EXPORT(name) __attribute__((export_name(#name)))
#define RULE(name) \
  EXPORT(name) void exported_##name() { answer = name({given.data(), given.size()}); }

namespace greywhale::calibrate {
namespace {

std::vector<double> given;
Answer answer;

}  // namespace

extern "C" {

// Where so many numbers are to be put.
EXPORT(give) double* exported_give(unsigned count) {
  given.resize(count);
  return given.data();
}

// The answer of the last rule.
EXPORT(numbers) const double* exported_numbers() { return answer.numbers.data(); }
EXPORT(numbers_count) unsigned exported_numbers_count() { return static_cast<unsigned>(answer.numbers.size()); }
EXPORT(words) const char* exported_words() { return answer.words.data(); }
EXPORT(words_length) unsigned exported_words_length() { return static_cast<unsigned>(answer.words.size()); }

RULE(counts)
RULE(sweep)
RULE(held)
RULE(solve)
RULE(match)
RULE(slipped)
RULE(apart)
RULE(raw)
RULE(motor)
RULE(pulse)
RULE(remarks)
RULE(turn_asked)
RULE(ready_asked)

}  // extern "C"

}  // namespace greywhale::calibrate
