// A reference as a function of time.
#pragma once

#include <limits>

#include <breakwater/math/functions.h>
#include <breakwater/math/table_function.h>

namespace breakwater {

enum class ReferenceShape { hold, step, sine, csv };

/// `before` until `from_s`, and from then on, with τ = t − from_s,
///     hold: before;  step: value, and −value from `reversed_from_s`;  sine: before + value·sin ωτ;
///     csv: a table's value at τ.
struct Reference {
  double value = 0.0;
  double from_s = 0.0;
  double reversed_from_s = std::numeric_limits<double>::infinity();
  ReferenceShape kind = ReferenceShape::step;
  double before = 0.0;
  double frequency_rad_s = 0.0;  ///< ω of a sine
  math::TableFunction table;     ///< the table of a csv

  double at(double time_s) const {
    if (!(time_s >= from_s)) return before;
    switch (kind) {
      case ReferenceShape::sine:
        return before + value * math::sin(frequency_rad_s * (time_s - from_s));
      case ReferenceShape::csv:
        return table.at(time_s - from_s).value;
      case ReferenceShape::hold:
        return before;
      case ReferenceShape::step:
        break;
    }
    return time_s >= reversed_from_s ? -value : value;
  }
};

}  // namespace breakwater
