// Names of signals and metrics as people read them. The keys are tooltips beside them.
#pragma once

#include <string>

#include <breakwater/record/hdf5_log.h>
#include <breakwater/record/recording.h>

namespace breakwater {

/// "force_true" of "force_true_N": a name without the unit that it ends with.
std::string without_unit(const std::string& name, const std::string& unit);

/// "Peak force, filtered" of "peak_force_filtered_N".
std::string metric_label(const std::string& metric, const std::string& unit);
/// The same with its unit: "Peak force, filtered [N]".
std::string metric_label_with_unit(const std::string& metric, const std::string& unit);

/// "contact stiffness [N/m]" of the key "contact.stiffness_N_m".
std::string key_label_with_unit(const std::string& key, const std::string& unit);

/// The name of a signal without its unit and its roles: "force" of "force_true_N".
std::string quantity_of(const LogEntry& entry);
/// Its roles: "true", "raw measured"; without any, the quantity.
std::string signal_label(const LogEntry& entry);

/// "Contact force": a first letter in capitals, unless the word is a symbol.
std::string capitalised(std::string text);

}  // namespace breakwater
