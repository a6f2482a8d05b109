// A result that could not be written.
#pragma once

#include <stdexcept>

namespace breakwater {

/// `FILE: cannot be … (reason)`: a full disk, a folder that may not be written.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace breakwater
