// Replaces daqp_contender.cpp in a build without DAQP.
#include "qp_contender.h"

namespace breakwater {

std::unique_ptr<QpContender> make_daqp(const QpSequence& /*sequence*/, bool /*simple*/) {
  return nullptr;
}

}  // namespace breakwater
