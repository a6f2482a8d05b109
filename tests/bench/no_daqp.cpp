// In the place of daqp_contender.cpp where the build has no DAQP.
#include "qp_contender.h"

namespace breakwater {

std::unique_ptr<QpContender> make_daqp(const QpSequence& /*sequence*/, bool /*simple*/) {
  return nullptr;
}

}  // namespace breakwater
