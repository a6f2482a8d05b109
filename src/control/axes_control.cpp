#include <breakwater/control/axes_control.h>

#include <utility>

namespace breakwater {

AxesControl::AxesControl(std::vector<AxisControl> axes, Eigen::Index entries)
    : axes_(std::move(axes)), entries_(entries), ignored_(Eigen::VectorXd::Zero(1)) {
  for (const AxisControl& axis : axes_) {
    for (Signal signal : axis.controller->signals()) {
      signal.name = axis.name + "_" + signal.name;
      publish(std::move(signal));
    }
  }
}

const Sample& AxesControl::part(const Sample& y, Eigen::Index axis) {
  own_.time_s = y.time_s;
  for (Eigen::Index i = 0; i < entries_; ++i) {
    own_.y(i) = y.y(i * static_cast<Eigen::Index>(axes_.size()) + axis);
  }
  const Eigen::Index shared = own_.y.size() - entries_;
  own_.y.tail(shared) = y.y.tail(shared);
  return own_;
}

void AxesControl::reset(const Sample& first) {
  const Eigen::Index shared = first.y.size() - entries_ * static_cast<Eigen::Index>(axes_.size());
  own_.y.setZero(entries_ + shared);
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    axes_[i].controller->reset(part(first, static_cast<Eigen::Index>(i)));
  }
}

void AxesControl::update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) {
  Eigen::Index driven = 0;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const Sample& own = part(y, static_cast<Eigen::Index>(i));
    if (axes_[i].is_driven) {
      axes_[i].controller->update(own, u.segment<1>(driven++));
    } else {
      axes_[i].controller->update(own, ignored_);
    }
  }
}

void AxesControl::set_watched(bool is_watched) {
  for (AxisControl& axis : axes_) axis.controller->set_watched(is_watched);
}

}  // namespace breakwater
