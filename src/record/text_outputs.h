// log.csv, metrics.json and plain text files of a run folder.
#pragma once

#include <string>
#include <vector>

#include <breakwater/record/output_error.h>
#include <breakwater/record/recording.h>

namespace breakwater {

/// Each throws OutputError `FILE: cannot be written …` if it cannot write all of it.

void write_text_file(const std::string& file, const std::string& text);

/// One line per row, one column per value; the header names them, NAME or NAME_1, NAME_2, ….
void write_csv_log(const std::string& file, const Track& track);

/// A flat object, finite numbers only.
void write_metrics(const std::string& file, const std::vector<Metric>& metrics);

}  // namespace breakwater
