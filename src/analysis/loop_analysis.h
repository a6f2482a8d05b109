// Frequency responses of loops of one axis, designed and measured.
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
  double to_rad_s = 0.0;  ///< 0: 0.9 of the Nyquist frequency
  int points = 25;        ///< number of measured frequencies; 0: no measurement
  /// Amplitude of the force probe. 0: 1, but at most a tenth of the drive's limit.
  double force_amplitude = 0.0;
  double noise_amplitude = 0.0;  ///< sensor probe; 0: three counts of the encoder, or 1e-3
  double settle_s = 5.0;
  std::size_t jobs = 0;  ///< 0: all cores
  bool quiet = true;     ///< no progress on stderr
  const std::atomic<bool>* stop = nullptr;
};

/// The responses at one frequency. d opposes the drive, as a disturbance does; n is added to the
/// measured position.
struct LoopPoint {
  double omega_rad_s = 0.0;
  std::complex<double> d_hat_over_d;
  std::complex<double> noise_to_d_hat;
  std::complex<double> noise_to_v_hat;
  std::complex<double> sensitivity;    ///< S = 1/(1 + L), with the loop opened at the plant's input
  std::complex<double> complementary;  ///< T = L/(1 + L): the drive's reaction to d, divided by d
  std::complex<double> loop_gain;      ///< L = T/S
  double spread = 0.0;                 ///< spread of a measured T between windows, relative to |T|
  double saturated = 0.0;              ///< share of samples with the drive at its limit
};

/// A designed or measured loop. If `points` is empty, `reason` says why.
struct LoopCurve {
  std::vector<LoopPoint> points;
  std::string reason;        ///< why there are no points
  bool is_unstable = false;  ///< then there is no measurement either
  double bandwidth_rad_s;    ///< |d̂/d| falls below 1/√2 here; NaN: nowhere, or no estimator
  LoopMargins margins;
};

/// The name of a loop. `axis` is empty if the plant has one driven axis.
struct LoopName {
  std::string case_name;
  std::string axis = {};

  std::string label() const { return axis.empty() ? case_name : case_name + ", " + axis; }
};

struct LoopAnalysis {
  LoopName name;
  bool estimates = false;  ///< there is an estimator
  LoopCurve designed;
  LoopCurve measured;
  std::vector<std::string> hints = {};  ///< limits of the numbers
};

/// One loop to analyse.
struct AnalysedLoop {
  LoopName name;
  AxisOfPlant axis;
};

/// Throws std::invalid_argument if the frequency range or the amplitude is invalid for a loop.
std::vector<LoopAnalysis> analyse(const std::vector<AnalysedLoop>& loops,
                                  const AnalysisOptions& options);

}  // namespace breakwater
