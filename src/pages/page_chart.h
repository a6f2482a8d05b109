// Charts as pages have them.
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
  bool is_off = false;               ///< at first
  std::optional<Identity> identity;  ///< its look, if it is the first here with that
};

/// Time series over one time axis.
struct PageChart {
  std::string id;
  std::string group;  ///< charts of one group point at the same moment
  std::string axis;   ///< those of one axis show the same window of time
  std::string title;
  std::vector<ChartSeries> series;
  std::vector<double> lines;     ///< horizontal, dashed
  std::optional<double> from_s;  ///< the window of time that its axis shows at first; without: all
  std::optional<double> to_s;

  /// "title [unit]", if all series have one.
  std::string axis_title() const;
  /// What it shows, in words.
  std::string alternative_text() const;
  /// For the page's script: series decimated; times [µs] and values, in hundred-thousandths of
  /// their range, as differences, so that they can be compressed. Safe within <script>.
  std::string json() const;
};

}  // namespace breakwater
