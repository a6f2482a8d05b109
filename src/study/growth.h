// The growth of a study: a study that has begun goes on with more points.
#pragma once

#include <string>

#include <breakwater/study/study.h>

namespace breakwater {

/// A value as TOML such that equal numbers give equal texts: "0.50" and "5e-1" give "0.5".
std::string comparable(const std::string& value);
/// The same for KEY=VALUE.
std::string comparable_set(const std::string& set);

/// Empty if every run of the study `then` is also one of `now`, so that its results stay. `now` may
/// have more seeds, values, cases and samples. It may have other metrics, goals, baselines and
/// folders to keep. Otherwise the reason in one line. The points of a Latin hypercube depend on
/// their number.
std::string reason_against_growth(const Study& then, const Study& now);

}  // namespace breakwater
