// Scenario files and models, each broken at one place.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace breakwater::testing {

/// One file with one thing wrong, and the scenario that is to read it.
struct Mutant {
  std::string scenario;
  std::string option;  ///< "--config", or the key that names the file: "model.mjcf"
  std::string file;    ///< its name, with the extension that it had
  std::string place;   ///< what was changed: a key, "<geom> size"; "" for the file as a whole
  std::string change;  ///< how
  std::string text;    ///< what is in the file now

  std::string name() const { return scenario + " " + option + " " + place + ": " + change; }
};

/// Every key of every scenario file and every attribute of every model, broken in every way that
/// comes to mind; and every file as a whole.
std::vector<Mutant> all_mutants();

/// Why some mutants are good input.
struct Legal {
  const char* option;
  const char* place;
  const char* change;
  const char* reason;
};

std::span<const Legal> legal_reasons();
/// Why that one is; nullptr if it is not.
const Legal* find_legal(const Mutant& mutant);

}  // namespace breakwater::testing
