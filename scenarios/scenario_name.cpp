// The name of the scenario of a program, given by the build.
namespace breakwater {
extern const char* const kScenario;
const char* const kScenario = BREAKWATER_SCENARIO;
}  // namespace breakwater
