// The frequency responses of several loops of one axis, as designed and as measured.
#pragma once

#include <atomic>
#include <complex>
#include <memory>
#include <string>
#include <vector>

#include <breakwater/analysis/loop_margins.h>
#include <breakwater/rigs/axis_scenario.h>

namespace breakwater {

struct AnalysisOptions {
  double from_rad_s = 0.1;
  double to_rad_s = 0.0;         ///< 0: 0.9 of the Nyquist frequency
  int points = 25;               ///< that are measured; 0: nothing is
  double force_amplitude = 1.0;  ///< of the probes
  double noise_amplitude = 0.0;  ///< 0: three counts of the encoder, or 1e-3
  double settle_s = 5.0;
  std::size_t jobs = 0;  ///< 0: all cores
  const std::atomic<bool>* stop = nullptr;
};

/// What is seen at one frequency. d opposes the drive, as a disturbance does; n is added to the
/// measured position.
struct LoopPoint {
  double omega_rad_s = 0.0;
  std::complex<double> d_hat_over_d;
  std::complex<double> noise_to_d_hat;
  std::complex<double> noise_to_v_hat;
  std::complex<double> sensitivity;    ///< S = 1/(1 + L), of the loop opened at the plant's input
  std::complex<double> complementary;  ///< T = L/(1 + L): what the drive does against d, over d
  std::complex<double> loop_gain;      ///< L = T/S
  double spread = 0.0;                 ///< of a measured T, between windows, over its amount
  double saturated = 0.0;              ///< share of samples with the drive at its limit
};

/// One loop by one way: designed or measured. `points` is empty where it could not be had, with
/// the reason.
struct LoopCurve {
  std::vector<LoopPoint> points;
  std::string reason;
  double bandwidth_rad_s;  ///< where |d̂/d| falls below 1/√2; NaN: nowhere, or there is no estimator
  LoopMargins margins;
};

struct LoopAnalysis {
  std::string label;
  bool estimates = false;  ///< there is an estimator
  LoopCurve designed;
  LoopCurve measured;
};

/// One loop to analyse: a scenario, read and checked, by its label.
struct AnalysedLoop {
  std::string label;
  const AxisScenario* scenario;
};

/// Throws std::invalid_argument if the range of frequencies is none for one of them.
std::vector<LoopAnalysis> analyse(const std::vector<AnalysedLoop>& loops,
                                  const AnalysisOptions& options);

}  // namespace breakwater
