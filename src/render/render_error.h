// A picture that could not be made.
#pragma once

#include <stdexcept>

namespace breakwater {

/// An error of one line: no OpenGL, no encoder, a dead drawing process. The run is not affected.
class RenderError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace breakwater
