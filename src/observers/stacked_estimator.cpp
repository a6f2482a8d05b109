#include <breakwater/observers/stacked_estimator.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include <breakwater/math/refuse_unless.h>

namespace breakwater {

StackedEstimator::StackedEstimator(std::vector<std::unique_ptr<DisturbanceEstimator>> axes)
    : axes_(std::move(axes)), estimate_(Eigen::VectorXd::Zero(3 * size())) {
  if (axes_.empty()) throw std::invalid_argument("stacked estimators: needs at least one");
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
    const Signal& first = of_first[k];
    const bool is_number = std::all_of(axes_.begin(), axes_.end(), [&](const auto& axis) {
      return axis->signals()[k].values.size() == 1;
    });
    const auto column = published_.col(static_cast<Eigen::Index>(k));
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      const Signal& of_axis = axes_[i]->signals()[k];
      if (is_number) {
        copies_.push_back({of_axis.values.data(), &published_(static_cast<Eigen::Index>(i),
                                                              static_cast<Eigen::Index>(k))});
      } else {
        signals_.push_back(of_axis);
        signals_.back().name += "_q" + std::to_string(i + 1);
      }
    }
    if (is_number) {
      signals_.push_back(
          {first.name, first.unit, first.description, {column.data(), axes_.size()}});
    }
  }
}

void StackedEstimator::reset(const Vector& x) {
  for (Eigen::Index i = 0; i < size(); ++i) {
    axes_[static_cast<std::size_t>(i)]->reset(Eigen::Vector2d(x(i), x(size() + i)));
  }
  gather();
}

void StackedEstimator::update(const Vector& held_input, const Vector& y) {
  for (Eigen::Index i = 0; i < size(); ++i) {
    axes_[static_cast<std::size_t>(i)]->update(held_input.segment<1>(i), y.segment<1>(i));
  }
  gather();
}

void StackedEstimator::gather() {
  for (const Copy& copy : copies_) *copy.to = *copy.from;
}

}  // namespace breakwater
