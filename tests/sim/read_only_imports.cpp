// A library that calls a function of another one.
#include <cmath>

extern "C" double tangent(double x) {
  return std::tan(x);
}
