#include <breakwater/config/scenario_name.h>

#include <breakwater/config/toml_entry.h>
#include <breakwater/config/toml_file.h>

namespace breakwater {

std::string scenario_name_in(const std::string& file) {
  const toml::table table = parse_toml_file(file);
  return TomlEntry(table, file)["scenario"].text();
}

}  // namespace breakwater
