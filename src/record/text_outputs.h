// log.csv, metrics.json and plain text files of a run folder.
#pragma once

#include <string>
#include <vector>

#include <breakwater/record/output_error.h>
#include <breakwater/record/recording.h>

namespace breakwater {

/// Each function throws OutputError `FILE: cannot be written …` if it cannot write the whole file.

void write_text_file(const std::string& file, const std::string& text);

/// One line per row and one column per value. The header has the names: NAME, or NAME_1, NAME_2, ….
void write_csv_log(const std::string& file, const Track& track);

/// Writes a flat JSON object with finite numbers only.
void write_metrics(const std::string& file, const std::vector<Metric>& metrics);

}  // namespace breakwater
