// The rules of a calibration by hand: numbers go in, numbers and words come out. Python and the page ask the same ones.
//
// Potentiometers are numbered leader 0..3, follower 4..7; counts are those of the 10-bit converter. A caller keeps to
// the order of the numbers that stands at each rule.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

namespace greywhale::calibrate {

constexpr std::size_t kJoints = 4, kPots = 2 * kJoints;
constexpr double kFullScale = 1023.0;  // counts of the converter
constexpr double kMargin = 0.03;       // rad, kept from both ends of what the person showed
// The voltages, as shares of the supply, that a motor is tried with one after the other.
constexpr double kPulseShares[] = {0.1, 0.17, 0.25, 0.35};

// What a rule is given, read in order.
class Given {
 public:
  Given(const double* numbers, std::size_t count) : at_(numbers), end_(numbers + count) {}
  const double* some(std::size_t count) {
    if (left() < count) throw std::out_of_range("a rule of the calibration needs more numbers.");
    return (at_ += count) - count;
  }
  double next() { return *some(1); }
  std::size_t left() const { return static_cast<std::size_t>(end_ - at_); }

 private:
  const double *at_, *end_;
};

// Words are what is wrong, or what a person is told: sentences, a line each. Beside a mistake the numbers mean nothing.
struct Answer {
  std::vector<double> numbers;
  std::string words;
};

// The parameters scale and zero of eight potentiometers, and rows of eight angles as in a sample -> rows of counts.
Answer counts(Given given);

// A potentiometer, and rows of counts while its joint is turned to both ends, the positive one first -> 1 where the
// reading grows towards the positive end, else -1; its least and its most.
Answer sweep(Given given);

// Rows of counts, one a millisecond, of arms that are held still -> their means.
Answer held(Given given);

// Four times whether a joint is in use; of the eight potentiometers the directions of their sweeps, the least and the
// most; a pose of known angles, four and eight counts; then a second such pose, or the tracks' length in rad -> eight
// zeros in counts, eight scales in rad a count, and by joint the lower and the upper limit in rad.
Answer solve(Given given);

// The same joints, directions, least and most; eight zeros and scales; the pose of known angles (4 + 8), and eight
// counts of another one, the same for both arms -> zeros, scales and limits by which the follower agrees with the
// leader there.
Answer match(Given given);

// Two poses (4 + 4), and four times whether a joint is in use: words where no scale can be told from them.
Answer require_apart(Given given);

// Eight counts of a pose, and eight of the same pose held again: words that name those that are elsewhere.
Answer slipped(Given given);

// Four times whether a joint is in use, eight zeros and scales, and eight counts of a pose from which nothing was
// worked out -> how far the arms are apart at each joint, rad.
Answer apart(Given given);

// A value in physical units, the least and the greatest raw value of its parameter, the size of a raw unit, and whether
// the value is to be brought into the range -> the raw value. Words go on after the parameter's name.
Answer raw(Given given);

// A joint, the supply in V, and rows of how far each joint went (4, rad) in the pulses so far -> voltage and way, 1 or
// -1, of the next pulse; at the end the motor's sign, the voltage that moved it, and the way (rad).
Answer motor(Given given);

// A joint, and the voltage of its pulse -> ms until the firmware turns the motors off, ms to be watched afterwards, ms
// that the follower must have rested before, ms to wait for that; the step in which the joint is led, and what counts
// as rest, rad. Words are the set with which the pulse runs: a line a parameter, its name and its physical value.
Answer pulse(Given given);

// The supply in V, and rows of joint, voltage and way of motors that have moved: words about motors that needed much.
Answer remarks(Given given);

// A joint: words for its positive way.
Answer positive_way(Given given);

// A joint: words that ask a person for its sweep.
Answer turn_asked(Given given);

// Words that ask a person to make ready for pulses of the motors.
Answer ready_asked(Given given);

}  // namespace greywhale::calibrate
