// Scenario files and models with one error each.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace breakwater::testing {

/// One file with one error, and the scenario that reads it.
struct Mutant {
  std::string scenario;
  std::string option;  ///< "--config", or the key that names the file: "model.mjcf"
  std::string file;    ///< its name, with the original extension
  std::string place;   ///< the changed place: a key, "<geom> size"; "" for the whole file
  std::string change;  ///< kind of change
  std::string text;    ///< present text of the file

  std::string name() const { return scenario + " " + option + " " + place + ": " + change; }
};

/// Every key of every scenario file and every attribute of every model, with each kind of error;
/// and damages to whole files.
std::vector<Mutant> all_mutants();

/// The reason why some mutants are valid input.
struct Legal {
  std::string option, place, change, reason;
};

const std::vector<Legal>& legal_reasons();
/// The reason for one mutant; nullptr if it is invalid.
const Legal* find_legal(const Mutant& mutant);

}  // namespace breakwater::testing
