// Small models and controllers for the tests of sim/.
#pragma once

#include <breakwater/control/controller.h>
#include <breakwater/sim/model.h>
#include "support.h"

namespace breakwater::testing {

/// Compiles a model from a text.
inline Model model_of(const std::string& mjcf) {
  return Model::load(TemporaryPath("model.xml", mjcf).string());
}

/// A controller that calls a function.
class FunctionController final : public Controller {
 public:
  using Law = std::function<void(const Sample&, Eigen::Ref<Eigen::VectorXd>)>;
  explicit FunctionController(Law law) : law_(std::move(law)) {}

  void reset(const Sample&) override { ++resets; }
  void update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) override {
    ++updates;
    law_(y, u);
  }

  int resets = 0;
  int updates = 0;

 private:
  Law law_;
};

}  // namespace breakwater::testing
