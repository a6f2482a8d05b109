// All broken scenario files and models, each with the real program.
#include <breakwater/shell/all_cores.h>
#include "cli/mutated_input.h"

namespace breakwater::mutated_input_study {
using testing::MutatedInput;

TEST_F(MutatedInput, IsHandledByTheProgram) {
  const std::vector<testing::Mutant> mutants = testing::all_mutants();
  on_all_cores(mutants.size(), [&](std::size_t i) { run_program_on(mutants[i], i); });
}

}  // namespace breakwater::mutated_input_study
