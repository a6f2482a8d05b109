// A running hash of a simulation's states.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

struct XXH3_state_s;

namespace breakwater {

/// XXH3 (64 bits) over the bits of all states: runs with equal hashes have equal states.
class StateHash {
 public:
  StateHash();
  StateHash(const StateHash& other);
  StateHash& operator=(const StateHash&) = delete;

  void update(std::span<const double> values);
  std::uint64_t digest() const;

 private:
  std::shared_ptr<XXH3_state_s> state_;  // no copy shares it
};

}  // namespace breakwater
