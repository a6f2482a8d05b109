#include <breakwater/sim/state_hash.h>

#include <xxhash.h>

namespace breakwater {

StateHash::StateHash() : state_(XXH3_createState(), XXH3_freeState) {
  XXH3_64bits_reset(state_.get());
}

StateHash::StateHash(const StateHash& other) : StateHash() {
  XXH3_copyState(state_.get(), other.state_.get());
}

void StateHash::update(std::span<const double> values) {
  XXH3_64bits_update(state_.get(), values.data(), values.size_bytes());
}

std::uint64_t StateHash::digest() const {
  return XXH3_64bits_digest(state_.get());
}

}  // namespace breakwater
