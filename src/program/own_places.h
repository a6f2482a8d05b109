// Where a program's files are, by its catalogue.
#pragma once

#include <breakwater/experiment/catalogue.h>

namespace breakwater {

/// Lets files be found in the folders of the catalogue's scenarios first, and in `installation`, if
/// it is not empty, last. Also tells the shell how to know that a model is being compiled.
void set_places(const Catalogue& catalogue, const char* installation);

}  // namespace breakwater
