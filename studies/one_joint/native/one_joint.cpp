// One joint with its motor inside any linear controller, or under logged voltages, for many candidate plants at a time.
// studies.one_joint prepares experiments and compares the outcome with a record; use that, not this.
//
// Motor, friction, gear and stops are those of the arm (sim/arm/conditions.h), with one body behind the gear instead of
// four links. To these come what a foreign rig may have: gravity about any angle, a constant pull, a gear whose
// friction grows with the torque that it passes on, and delays.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <vector>

#include "arm/conditions.h"
#include "share_out.h"

namespace nb = nanobind;
using namespace nb::literals;
namespace arm = greywhale::arm;

namespace {

template <class... Shape>
using In = nb::ndarray<const double, Shape..., nb::c_contig, nb::device::cpu>;
using Vector = In<nb::shape<-1>>;
using Matrix = In<nb::shape<-1, -1>>;
using Indices = nb::ndarray<const std::int64_t, nb::shape<-1>, nb::c_contig, nb::device::cpu>;

constexpr int kPasses = 8;

// A candidate. `from` takes its columns in the order in which studies.one_joint names them.
constexpr std::size_t kColumns = 19;
struct Plant {
  double link_inertia;  // kg m^2, behind the gear
  double weight;        // N m, gravity's torque a quarter turn from where the link hangs
  double hanging;       // rad, where the link hangs
  double pull;          // N m, constant
  arm::Joint<double> joint;
  double load_friction;  // share of the torque that the gear passes on
  double delay;          // s, from a controller's reading to its voltage
  double leader_delay;   // s, from the leader to the controller

  static Plant from(const double* c) {
    constexpr double kNoMatter = 1.0;  // ohm; the supply does not sag here
    return {
        c[0],
        c[1],
        c[2],
        c[3],
        {{c[4], c[5], c[6], kNoMatter}, {c[7], c[8], c[9], 0.0, 0.0}, {c[10], c[11], c[12], c[13]}, {c[14], c[15]}, {}},
        c[16],
        c[17],
        c[18]};
  }
};

struct Motion {
  arm::State<double> s{};  // joint 0 of it
  double passed = 0.0;     // N m, torque that the gear passed on in the last step
};

double outside_torque(const Plant& p, double angle, double load) {
  return load + p.pull - p.weight * std::sin(angle - p.hanging);
}

// One step, everything stiff implicit as in sim/arm/step.h; load friction is taken from the step before.
void advance(const Plant& p, Motion& m, double volts, double load, double dt) {
  arm::State<double>& s = m.s;
  const double outside = outside_torque(p, s.q[0], load);
  const double momentum = p.link_inertia * s.v[0] + dt * outside;
  arm::Terms<double> terms = arm::terms_of<false>(p.joint, s, 0, volts, dt);
  if (p.load_friction > 0.0) {
    // Sliding and breaking away both grow, in the proportion that they have without a load.
    const double coulomb = p.joint.friction.coulomb, more = p.load_friction * std::fabs(m.passed);
    const double factor = coulomb > 0.0 ? 1.0 + more / coulomb : 1.0;
    terms.friction *= factor;
    terms.breakaway *= factor;
  }
  arm::Sides<double> side = arm::first_guess(p.joint, s, 0, dt), used = side;
  double v = 0.0;
  for (int pass = 0; pass < kPasses; ++pass) {
    used = side;
    const arm::Row<double> row = arm::link_row<false>(terms, side);
    const double inertia = p.link_inertia + row.diagonal;
    const double stop = side.stop > 0.0 ? p.joint.stops.max : p.joint.stops.min;
    v = side.stop != 0.0 ? (stop - s.q[0]) / dt : (momentum + row.right) / inertia;
    const double motor_v = arm::motor_velocity<false>(terms, side, v);
    side.mesh = arm::corrected_mesh(p.joint.gear, terms, used.mesh, motor_v - v, dt);
    side.slip = arm::corrected_slip(terms, used, motor_v, motor_v - v);
    side.stop = arm::corrected_stop(p.joint.stops, used.stop, s.q[0] + dt * v, inertia * v - momentum - row.right);
    if (side.mesh == used.mesh && side.slip == used.slip && side.stop == used.stop) break;
  }
  const double before = s.v[0];
  s.motor_q[0] += dt * arm::motor_velocity<false>(terms, used, v);
  s.q[0] = std::clamp(s.q[0] + dt * v, p.joint.stops.min, p.joint.stops.max);
  if (used.stop != 0.0) v = 0.0;
  const double motor_v = arm::motor_velocity<false>(terms, used, v);
  s.motor_v[0] = used.slip * motor_v < 0.0 ? 0.0 : motor_v;
  s.v[0] = v;
  m.passed = p.link_inertia * (v - before) / dt - outside;
}

// Rows of a record and what happens between them.
struct Record {
  Vector spacing;  // s, from each row to the next
  Vector leader;   // rad
  Vector load;     // N m on the link, from outside
  Vector volts;    // as logged
  std::size_t substeps;
  bool leader_lines, volts_lines;  // straight between rows, or held until the next
};

// x' = A x + B (leader, follower); u = C x + D (leader, follower), cut to +-limit. With a hysteresis it is a relay:
// +-limit beyond +-hysteresis, else what it was.
struct Law {
  Matrix a, b;
  Vector c, d;
  double limit, hysteresis, resolution;  // V, V, rad of a reading (0: exact)
  std::size_t every;                     // substeps
  bool closed;                           // false: the logged voltages drive the motor
};

struct Windows {
  Indices first;
  Vector angles, velocities;
  Matrix states;  // of the law, where each window starts
  std::size_t rows, kept_every;
};

class Controller {
 public:
  Controller(const Law& law, const double* state, double volts)
      : law_(law), x_(state, state + law.c.shape(0)), next_(x_.size()), u_(volts) {}

  double operator()(double leader, double angle) {
    const double follower = law_.resolution > 0.0 ? law_.resolution * std::floor(angle / law_.resolution + 0.5) : angle;
    double u = law_.d(0) * leader + law_.d(1) * follower;
    for (std::size_t i = 0; i < x_.size(); ++i) {
      u += law_.c(i) * x_[i];
      next_[i] = law_.b(i, 0) * leader + law_.b(i, 1) * follower;
      for (std::size_t k = 0; k < x_.size(); ++k) next_[i] += law_.a(i, k) * x_[k];
    }
    x_.swap(next_);
    if (law_.hysteresis <= 0.0) return u_ = std::clamp(u, -law_.limit, law_.limit);
    if (std::fabs(u) > law_.hysteresis) u_ = std::copysign(law_.limit, u);
    return u_;
  }

 private:
  const Law& law_;
  std::vector<double> x_, next_;
  double u_;
};

// A signal's value at a share of the way from one row to the next.
double between(const Vector& values, std::size_t row, double share, bool lines) {
  const std::size_t next = std::min(row + 1, values.shape(0) - 1);
  return lines ? values(row) + share * (values(next) - values(row)) : values(row);
}

// The integration's grid over the whole record: times of the substeps' edges, and the logged voltage integrated up to
// there. Differences of the integral give a delayed voltage that changes smoothly with the delay.
struct Grid {
  std::vector<double> time, integral;

  explicit Grid(const Record& r) {
    const std::size_t rows = r.spacing.shape(0);
    time.assign(rows * r.substeps + 1, 0.0);
    integral.assign(time.size(), 0.0);
    for (std::size_t k = 0; k + 1 < time.size(); ++k) {
      const std::size_t row = k / r.substeps;
      const double share = (static_cast<double>(k % r.substeps) + 0.5) / static_cast<double>(r.substeps);
      const double dt = r.spacing(row) / static_cast<double>(r.substeps);
      time[k + 1] = time[k] + dt;
      integral[k + 1] = integral[k] + dt * between(r.volts, row, share, r.volts_lines);
    }
  }
};

// A quantity on the grid at a moment that only ever moves forwards.
class Follow {
 public:
  Follow(const std::vector<double>& time, std::size_t from) : time_(time), at_(from) {}

  // Value of a piecewise linear function given at the edges; before the record it goes on as it begins.
  double operator()(const std::vector<double>& values, double moment) {
    locate(moment);
    const double share = (moment - time_[at_]) / (time_[at_ + 1] - time_[at_]);
    return values[at_] + share * (values[at_ + 1] - values[at_]);
  }

  // The edge at or before a moment, and the way from it to the next.
  std::size_t locate(double moment) {
    while (at_ > 0 && time_[at_] > moment) --at_;
    while (at_ + 2 < time_.size() && time_[at_ + 1] <= moment) ++at_;
    return at_;
  }

 private:
  const std::vector<double>& time_;
  std::size_t at_;
};

double leader_at(const Record& r, const Grid& grid, Follow& follow, double moment) {
  if (moment <= 0.0) return r.leader(0);
  const std::size_t row = follow.locate(moment) / r.substeps;
  return between(r.leader, row, (moment - grid.time[row * r.substeps]) / r.spacing(row), r.leader_lines);
}

void simulate(const Record& r, const Grid& grid, const Law& law, const Windows& w, const Plant& p, std::size_t window,
              double* angles, double* volts) {
  const auto first = static_cast<std::size_t>(w.first(window));
  const std::size_t start = first * r.substeps;
  Motion m;
  m.s.q[0] = w.angles(window);
  m.s.v[0] = m.s.motor_v[0] = w.velocities(window);
  m.passed = -outside_torque(p, m.s.q[0], r.load(first));
  m.s.motor_q[0] = m.s.q[0] + p.joint.gear.half_gap * arm::sign(m.passed);
  Controller control(law, law.c.shape(0) ? &w.states(window, 0) : nullptr, r.volts(first));
  // Until the window begins the motor got what was logged; from there on the controller writes the history.
  std::vector<double> integral;
  if (law.closed) integral.assign(grid.integral.begin(), grid.integral.end());
  const std::vector<double>& history = law.closed ? integral : grid.integral;
  Follow drive(grid.time, start), drive_end(grid.time, start), lead(grid.time, start);
  double u = r.volts(first);
  for (std::size_t k = start; k < start + w.rows * r.substeps; ++k) {
    const std::size_t row = k / r.substeps, n = k % r.substeps;
    const double now = grid.time[k], dt = grid.time[k + 1] - now;
    const double share = (static_cast<double>(n) + 0.5) / static_cast<double>(r.substeps);
    if (law.closed && (k - start) % law.every == 0)
      u = control(leader_at(r, grid, lead, now - p.leader_delay), m.s.q[0]);
    if (law.closed) integral[k + 1] = integral[k] + dt * u;
    if (n == 0 && (row - first) % w.kept_every == 0) {
      *angles++ = m.s.q[0];
      *volts++ = law.closed ? u : r.volts(row);
    }
    const double given = (drive_end(history, now + dt - p.delay) - drive(history, now - p.delay)) / dt;
    advance(p, m, given, between(r.load, row, share, true), dt);
  }
}

void check(const Record& r, const Law& law, const Windows& w, const Matrix& plants) {
  const std::size_t rows = r.spacing.shape(0), order = law.c.shape(0), count = w.first.shape(0);
  if (plants.shape(1) != kColumns) throw std::invalid_argument("a plant has 19 columns.");
  if (rows == 0 || r.substeps == 0 || law.every == 0 || w.kept_every == 0)
    throw std::invalid_argument("nothing to simulate.");
  if (r.leader.shape(0) != rows || r.load.shape(0) != rows || r.volts.shape(0) != rows) {
    throw std::invalid_argument("spacing, leader, load and volts differ in length.");
  }
  if (law.a.shape(0) != order || law.a.shape(1) != order || law.b.shape(0) != order || law.b.shape(1) != 2 ||
      law.d.shape(0) != 2) {
    throw std::invalid_argument("the controller's matrices do not fit together.");
  }
  if (w.angles.shape(0) != count || w.velocities.shape(0) != count || w.states.shape(0) != count ||
      w.states.shape(1) != order) {
    throw std::invalid_argument("first, angles, velocities and states differ in length.");
  }
  for (std::size_t n = 0; n < count; ++n) {
    if (w.first(n) < 0 || static_cast<std::size_t>(w.first(n)) + w.rows > rows)
      throw std::invalid_argument("a window reaches beyond the record.");
  }
}

nb::object as_array(std::unique_ptr<double[]> values, std::size_t candidates, std::size_t windows, std::size_t kept) {
  double* raw = values.release();
  nb::capsule owner(raw, [](void* p) noexcept { delete[] static_cast<double*>(p); });
  return nb::cast(nb::ndarray<nb::numpy, double, nb::c_contig>(raw, {candidates, windows, kept}, owner));
}

// Every (candidate, window) pair once, from as many threads as there are cores or as asked; the order does not matter.
nb::tuple run(const Record& r, const Law& law, const Windows& w, const Matrix& plants, int threads) {
  check(r, law, w, plants);
  const std::size_t candidates = plants.shape(0), windows = w.first.shape(0),
                    kept = (w.rows + w.kept_every - 1) / w.kept_every;
  auto angles = std::make_unique<double[]>(candidates * windows * kept),
       volts = std::make_unique<double[]>(candidates * windows * kept);
  {
    const nb::gil_scoped_release free;
    const Grid grid(r);
    greywhale::share_out(candidates * windows, threads, [&](std::size_t task) {
      const Plant plant = Plant::from(&plants(task / windows, 0));
      simulate(r, grid, law, w, plant, task % windows, &angles[task * kept], &volts[task * kept]);
    });
  }
  return nb::make_tuple(as_array(std::move(angles), candidates, windows, kept),
                        as_array(std::move(volts), candidates, windows, kept));
}

}  // namespace

NB_MODULE(one_joint_native, m) {
  m.doc() = "One joint in any linear controller, or under logged voltages, for many candidates at a time.";
  m.attr("COLUMNS") = kColumns;
  m.def(
      "simulate",
      [](const Matrix& plants, const Vector& spacing, const Vector& leader, const Vector& load, const Vector& volts,
         std::size_t substeps, bool leader_lines, bool volts_lines, const Matrix& a, const Matrix& b, const Vector& c,
         const Vector& d, double limit, double hysteresis, double resolution, std::size_t control_every, bool closed,
         const Indices& first, const Vector& angles, const Vector& velocities, const Matrix& states, std::size_t rows,
         std::size_t every, int threads) {
        const Record record{spacing, leader, load, volts, substeps, leader_lines, volts_lines};
        const Law law{a, b, c, d, limit, hysteresis, resolution, control_every, closed};
        return run(record, law, {first, angles, velocities, states, rows, every}, plants, threads);
      },
      nb::kw_only(), "plants"_a.noconvert(), "spacing"_a.noconvert(), "leader"_a.noconvert(), "load"_a.noconvert(),
      "volts"_a.noconvert(), "substeps"_a, "leader_lines"_a, "volts_lines"_a, "a"_a.noconvert(), "b"_a.noconvert(),
      "c"_a.noconvert(), "d"_a.noconvert(), "limit"_a, "hysteresis"_a, "resolution"_a, "control_every"_a, "closed"_a,
      "first"_a.noconvert(), "angles"_a.noconvert(), "velocities"_a.noconvert(), "states"_a.noconvert(), "rows"_a,
      "every"_a, "threads"_a = 0,
      "Angles and voltages, both (candidates, windows, rows kept), of one joint in a linear controller or under logged "
      "voltages.");
}
