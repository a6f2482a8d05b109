// Settings that several estimators of an axis share.
#pragma once

#include <string>
#include <vector>

#include <breakwater/rigs/axis_parts.h>

namespace breakwater {

using Estimator = std::unique_ptr<DisturbanceEstimator>;

// The plant of all axes has other inputs, outputs and states than one axis.
inline bool is_whole(const NominalAxis& axis) {
  const StateSpace& plant = axis.plant;
  return plant.inputs() != 1 || plant.outputs() != 1 || (plant.states() != 2 && axis.E.size() == 0);
}

inline void need_one_axis(const NominalAxis& axis, const std::string& observer) {
  if (!is_whole(axis)) return;
  throw WrongKey("observer.name", observer +
                                      " estimates a single axis; a whole plant can have none, "
                                      "state_observer, idob, kfd, fakfd, qvff or stf");
}

inline void need_continuous(const NominalAxis& axis, const std::string& observer) {
  if (!axis.is_sampled) return;
  throw WrongKey("control.period_s",
                 "is missing: " + observer + " needs a plant in continuous time");
}

// The IDOB and the MDOB estimate a disturbance at the input.
inline void need_one_inertia(const NominalAxis& axis, const std::string& observer) {
  need_continuous(axis, observer);
  if (axis.E.size() == 0) return;
  throw WrongKey("nominal.model", "must be rigid or motor for " + observer +
                                      ": it finds no disturbance behind a spring");
}

inline void bind_low_pass(Fields& fields, double& cutoff_rad_s) {
  fields.number("observer.low_pass_cutoff_rad_s", cutoff_rad_s, positive(), "g_w");
}

struct DisturbanceModelKeys {
  int order = 0;

  void bind(Fields& fields) {
    fields.count("observer.disturbance_order", order, between(0, 2),
                 "disturbance model: step (0), ramp (1) or parabola (2)");
  }
  ExtendedPlant extend(const NominalAxis& axis) const {
    return axis.extended(order, axis.period_s);
  }
};

// The keys of all Kalman filters.
struct KalmanKeys {
  DisturbanceModelKeys model;
  double process_noise = 0.0;
  std::vector<double> initial_covariance = {1.0};

  void bind_process_noise(Fields& fields, const Range& range) {
    fields.number("observer.process_noise", process_noise, range, "Q: process noise");
  }
  void bind_initial_covariance(Fields& fields) {
    fields.numbers("observer.initial_covariance", initial_covariance, positive(),
                   "diagonal of the initial covariance P0 of position, velocity, d, ...; one "
                   "number: of all");
  }
  Eigen::VectorXd P0(const ExtendedPlant& plant) const {
    return spread("observer.initial_covariance", initial_covariance, plant.states(),
                  "extended state");
  }
};

}  // namespace breakwater
