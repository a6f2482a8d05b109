// The common base of interfaces.
#pragma once

namespace breakwater {

/// An object that is not copied, and that a pointer to its interface may delete.
class Interface {
 public:
  Interface() = default;
  Interface(const Interface&) = delete;
  Interface& operator=(const Interface&) = delete;
  virtual ~Interface() = default;
};

}  // namespace breakwater
