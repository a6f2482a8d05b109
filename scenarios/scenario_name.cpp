// The scenario of a program, which the build names.
namespace breakwater {
extern const char* const kScenario;
const char* const kScenario = BREAKWATER_SCENARIO;
}  // namespace breakwater
