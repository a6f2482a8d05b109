// The places of a program's files, from its catalogue.
#pragma once

#include <breakwater/experiment/catalogue.h>

namespace breakwater {

/// Sets the search order of files: the folders of the catalogue's scenarios first, `installation`
/// last if not empty. Also tells the shell how to detect that a model is being compiled.
void set_places(const Catalogue& catalogue, const char* installation);

}  // namespace breakwater
