// Estimators of single axes, combined into an estimator of all axes.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/math/refuse_unless.h>
#include <breakwater/observers/disturbance_estimator.h>

namespace breakwater {

/// n decoupled axes, each with its own estimator: x̂ = [q (n); q̇ (n)], d̂ (n), y = q (n).
/// The scalar signals of the axes with one name form a signal of n values. Signals of several
/// values stay separate: NAME_q1, NAME_q2, …
class StackedEstimator final : public DisturbanceEstimator {
 public:
  /// Throws std::invalid_argument if there is no estimator, or one is not for a single axis.
  explicit StackedEstimator(std::vector<std::unique_ptr<DisturbanceEstimator>> axes)
      : axes_(std::move(axes)), estimate_(Eigen::VectorXd::Zero(3 * size())) {
    refuse_unless(!axes_.empty(), "stacked estimators: needs at least one");
    const auto of_first = axes_.front()->signals();
    published_.setZero(size(), static_cast<Eigen::Index>(of_first.size()));
    for (Eigen::Index i = 0; i < size(); ++i) {
      const DisturbanceEstimator& axis = *axes_[static_cast<std::size_t>(i)];
      refuse_unless(axis.state().size() == 2 && axis.disturbance().size() == 1 &&
                        axis.signals().size() == of_first.size(),
                    "stacked estimators: each must be for one axis, and all of one kind");
      copies_.push_back({axis.state().data(), &estimate_(i)});
      copies_.push_back({axis.state().data() + 1, &estimate_(size() + i)});
      copies_.push_back({axis.disturbance().data(), &estimate_(2 * size() + i)});
    }
    for (std::size_t k = 0; k < of_first.size(); ++k) {
      const bool is_number = std::ranges::all_of(
          axes_, [&](const auto& axis) { return axis->signals()[k].values.size() == 1; });
      double* column = published_.col(static_cast<Eigen::Index>(k)).data();
      for (std::size_t i = 0; i < axes_.size(); ++i) {
        const Signal& of_axis = axes_[i]->signals()[k];
        if (is_number) {
          copies_.push_back({of_axis.values.data(), column + i});
        } else {
          signals_.push_back(of_axis);
          signals_.back().name += "_q" + std::to_string(i + 1);
        }
      }
      if (!is_number) continue;
      signals_.push_back(of_first[k]);
      signals_.back().values = {column, axes_.size()};
    }
  }

  void reset(const Vector& x) override {
    for (Eigen::Index i = 0; i < size(); ++i) {
      axes_[static_cast<std::size_t>(i)]->reset(Eigen::Vector2d(x(i), x(size() + i)));
    }
    gather();
  }
  void update(const Vector& held_input, const Vector& y) override {
    for (Eigen::Index i = 0; i < size(); ++i) {
      axes_[static_cast<std::size_t>(i)]->update(held_input.segment<1>(i), y.segment<1>(i));
    }
    gather();
  }

  View state() const override { return {estimate_.data(), 2 * size()}; }
  View disturbance() const override { return {estimate_.data() + 2 * size(), size()}; }

 private:
  Eigen::Index size() const { return static_cast<Eigen::Index>(axes_.size()); }
  void gather() {
    for (const auto& [from, to] : copies_) *to = *from;
  }

  std::vector<std::unique_ptr<DisturbanceEstimator>> axes_;
  Eigen::VectorXd estimate_;                               // [q; q̇; d]
  Eigen::MatrixXd published_;                              // one column per signal
  std::vector<std::pair<const double*, double*>> copies_;  // (from, to) of each scalar
};

}  // namespace breakwater
