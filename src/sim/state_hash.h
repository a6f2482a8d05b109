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
  ~StateHash() = default;

  void update(std::span<const double> values);
  std::uint64_t digest() const;

 private:
  struct Delete {
    void operator()(XXH3_state_s* state) const;
  };
  std::unique_ptr<XXH3_state_s, Delete> state_;
};

}  // namespace breakwater
