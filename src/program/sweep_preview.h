// A few runs tell of a study before all are made, and those that were made tell of the rest.
#pragma once

#include <cstddef>
#include <string>

#include <breakwater/study/sweep.h>

namespace breakwater {

/// Counts the runs, and says how long they will take on `jobs` (0: all) cores, from one of each
/// candidate; warns of what these show. Throws Interrupted.
void print_preview(const Sweep& sweep, std::size_t jobs);

/// A metric that is asked for by a name that is nearly another's is most likely a slip of the pen:
/// it is found by a first and a last run of each candidate, before all others are made for it. One
/// that those lack and that is like none of theirs may be in others. Throws std::invalid_argument.
void check_asked_metrics(const Sweep& sweep);

/// "3 of 40 points are done; of these 1 failed".
std::string counted(const ShardIndex& index);

/// Processor time of the points that are not done, each as long as its candidate's others.
double time_to_go_s(const Plan& plan, const ShardIndex& index);

}  // namespace breakwater
