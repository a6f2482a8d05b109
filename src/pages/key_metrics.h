// Metrics as pages show them: the few that say most apart, each with a name for people.
#pragma once

#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/pictures/shot_list.h>
#include <breakwater/record/recording.h>

namespace breakwater {

struct ShownMetric {
  Metric metric;
  std::string label;    ///< "Peak force, filtered"
  std::string about;    ///< its key and its definition, for a tooltip
  bool is_key = false;  ///< one of the four to six that say most
};

/// The key ones first: those of the shot list's page, else the scenario's main metrics and those
/// after them.
std::vector<ShownMetric> shown_metrics(const Catalogue& catalogue, const std::string& scenario,
                                       const ShotList& shots, const std::vector<Metric>& metrics);

/// Sets `name`, `unit` (not for a plain number) and `about` for a template.
void set_name(const ShownMetric& shown, PageData& row);

/// A scenario's shot list; an empty one where there is none that can be read.
ShotList shots_of(const Catalogue& catalogue, const std::string& scenario);

}  // namespace breakwater
