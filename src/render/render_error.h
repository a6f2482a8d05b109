// A picture that could not be made.
#pragma once

#include <stdexcept>

namespace breakwater {

/// One line: no OpenGL, no encoder, a drawing process that died. The run it was to show is whole.
class RenderError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace breakwater
