// A shared library that is loaded when it is first used.
#pragma once

#include <string>

namespace breakwater {

/// It is not linked: a program that does not use it starts without it, and runs where it is
/// missing.
class LoadedLibrary {
 public:
  /// With `is_global`, other libraries find its functions too.
  LoadedLibrary(std::string file, const std::string& debian_package, bool is_global = false);

  bool is_there() const { return handle_ != nullptr; }
  /// The loader's error if the library is missing, with the package that has it.
  const std::string& complaint() const { return complaint_; }

  /// The function or variable with this name in it or in a library that it needs. Throws `Error` if
  /// there is none.
  template <typename Error, typename Symbol>
  Symbol* symbol(const char* name) const {
    void* const address = is_there() ? find(name) : nullptr;
    if (address == nullptr) throw Error(is_there() ? file_ + " has no " + name : complaint_);
    return reinterpret_cast<Symbol*>(address);
  }

 private:
  void* find(const char* name) const;

  std::string file_;
  void* handle_;
  std::string complaint_;
};

}  // namespace breakwater

/// Defines `name` as a function of `library`, a function that returns a LoadedLibrary. In a
/// namespace it stands before the declared one with the same name.
#define BREAKWATER_LOADED(library, Error, name)                                   \
  constexpr auto name = [](auto... arguments) {                                   \
    static auto* const loaded = library().symbol<Error, decltype(::name)>(#name); \
    return loaded(arguments...);                                                  \
  };
