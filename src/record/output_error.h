// A result that could not be written.
#pragma once

#include <stdexcept>

namespace breakwater {

/// `FILE: cannot be … (reason)`, such as a full disk or a read-only folder.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace breakwater
