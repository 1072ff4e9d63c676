// Short windows of a log, each started from its own state and driven by the logged voltages, for many candidate arms at
// a time. greywhale.identify prepares the windows and compares the outcome with the log; use that, not this.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "closed_loop/experiment.h"
#include "windows/windows.h"

namespace nb = nanobind;
using namespace nb::literals;
namespace arm = greywhale::arm;
namespace loop = greywhale::loop;
namespace windows = greywhale::windows;

namespace {

using arm::kJoints;
using greywhale::bind::Array;
using greywhale::bind::In;

using Rows = In<double, nb::shape<-1, kJoints>>;
using Plants = In<double, nb::shape<-1, loop::kPlantColumns>>;

// Where a window begins and how the arm stands there; the arrays are Python's and outlive the call.
struct Windows {
  In<std::int64_t, nb::shape<-1>> first;  // row
  Rows angles, velocities;                // of the links, rad and rad/s
  Rows sides, places;                     // -1..1, where each motor stands in its gap, each joint in its pot's play
  std::size_t rows;                       // of every window
};

// The log on the integration's grid: `substeps` voltages for every row, and the time from a row to the next.
struct Drive {
  Rows volts;
  In<double, nb::shape<-1>> spacing;
  std::size_t substeps;
};

// By how many rows before each window the log leads the links, and where these are in every row of it.
struct Lead {
  In<std::int64_t, nb::shape<-1>> rows;
  Rows angles, velocities, places;
};

// `offsets`: by how much each candidate's potentiometers read other angles than the log's.
void check(const Windows& w, const Drive& drive, const Lead* lead, const Plants& plants, const Rows& offsets,
           std::size_t every) {
  const std::size_t rows = drive.spacing.shape(0);
  if (every == 0 || drive.substeps == 0) throw std::invalid_argument("every and substeps must be 1 or more.");
  if (drive.volts.shape(0) != rows * drive.substeps)
    throw std::invalid_argument("volts must hold `substeps` rows for every spacing.");
  const std::size_t count = w.first.shape(0);
  if (w.angles.shape(0) != count || w.velocities.shape(0) != count || w.sides.shape(0) != count ||
      w.places.shape(0) != count) {
    throw std::invalid_argument("first, angles, velocities, sides and places differ in length.");
  }
  if (offsets.shape(0) != plants.shape(0)) throw std::invalid_argument("offsets need a row for every plant.");
  for (std::size_t n = 0; n < count; ++n) {
    if (w.first(n) < 0 || static_cast<std::size_t>(w.first(n)) + w.rows > rows) {
      throw std::invalid_argument("a window reaches beyond the log.");
    }
  }
  if (lead == nullptr) return;
  if (lead->angles.shape(0) != rows || lead->velocities.shape(0) != rows || lead->places.shape(0) != rows)
    throw std::invalid_argument("log_angles, log_velocities and log_places need a row for every spacing.");
  if (lead->rows.shape(0) != count) throw std::invalid_argument("led needs a number for every window.");
  for (std::size_t n = 0; n < count; ++n) {
    if (lead->rows(n) < 0 || lead->rows(n) > w.first(n)) throw std::invalid_argument("led reaches before the log.");
  }
}

// Every (candidate, window) pair once.
nb::object run(const Windows& w, const Drive& drive, const Lead* lead, const Plants& plants, const Rows& offsets,
               std::size_t every, int threads) {
  check(w, drive, lead, plants, offsets, every);
  const std::size_t candidates = plants.shape(0), count = w.first.shape(0), kept = (w.rows + every - 1) / every;
  const std::size_t size = kept * kJoints;
  Array<double> values({candidates, count, kept, kJoints});
  {
    const nb::gil_scoped_release free;
    windows::Windows given{
        w.first.data(),       w.angles.data(), w.velocities.data(), w.sides.data(), w.places.data(), drive.volts.data(),
        drive.spacing.data(), w.rows,          drive.substeps,      every};
    if (lead != nullptr) {
      given.led = lead->rows.data();
      given.log_angles = lead->angles.data();
      given.log_velocities = lead->velocities.data();
      given.log_places = lead->places.data();
    }
    std::vector<windows::Task> tasks;
    tasks.reserve(candidates * count);
    for (std::size_t window = 0; window < count; ++window) {
      for (std::size_t n = 0; n < candidates; ++n) {
        tasks.push_back({&plants(n, 0), &offsets(n, 0), window, values.data() + (n * count + window) * size});
      }
    }
    windows::simulate(given, tasks, threads);
  }
  return values.numpy();
}

}  // namespace

void bind_identify(nb::module_& m) {
  m.def(
      "simulate_windows",
      [](const Plants& plants, const Rows& offsets, const In<std::int64_t, nb::shape<-1>>& first, const Rows& angles,
         const Rows& velocities, const Rows& sides, const Rows& places, std::size_t rows, const Rows& volts,
         const In<double, nb::shape<-1>>& spacing, std::size_t substeps, std::size_t every,
         const std::optional<In<std::int64_t, nb::shape<-1>>>& led, const std::optional<Rows>& log_angles,
         const std::optional<Rows>& log_velocities, const std::optional<Rows>& log_places, int threads) {
        std::optional<Lead> lead;
        if (led && log_angles && log_velocities && log_places)
          lead = Lead{*led, *log_angles, *log_velocities, *log_places};
        return run({first, angles, velocities, sides, places, rows}, {volts, spacing, substeps},
                   lead ? &*lead : nullptr, plants, offsets, every, threads);
      },
      nb::kw_only(), "plants"_a.noconvert(), "offsets"_a.noconvert(), "first"_a.noconvert(), "angles"_a.noconvert(),
      "velocities"_a.noconvert(), "sides"_a.noconvert(), "places"_a.noconvert(), "rows"_a, "volts"_a.noconvert(),
      "spacing"_a.noconvert(), "substeps"_a, "every"_a, "led"_a.noconvert() = nb::none(),
      "log_angles"_a.noconvert() = nb::none(), "log_velocities"_a.noconvert() = nb::none(),
      "log_places"_a.noconvert() = nb::none(), "threads"_a = 0,
      "Angles (candidates, windows, rows kept, 4) of candidate arms under logged voltages. The GIL is released.");
}
