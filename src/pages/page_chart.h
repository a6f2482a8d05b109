// The charts of pages.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <breakwater/record/series.h>
#include <breakwater/render/identity.h>

namespace breakwater {

struct ChartSeries {
  std::string label;
  std::string unit;
  std::string description;
  Series values;
  bool is_off = false;               ///< hidden at first
  std::optional<Identity> identity;  ///< its look, if it is the first here with that
};

/// Time series over one time axis.
struct PageChart {
  std::string id;
  std::string group;  ///< charts of one group mark the same moment
  std::string axis;   ///< charts of one axis show the same time window
  std::string title;
  std::vector<ChartSeries> series;
  std::vector<double> lines;     ///< horizontal, dashed
  std::optional<double> from_s;  ///< first time window of its axis; default: all
  std::optional<double> to_s;

  /// "title [unit]", if all series have one.
  std::string axis_title() const;
  /// A description in words.
  std::string alternative_text() const;
  /// The chart for the page's script: decimated; times [µs] and values, in hundred-thousandths of
  /// their range, as differences, so that they can be compressed. Safe inside
  /// <script>.
  std::string json() const;
};

}  // namespace breakwater
