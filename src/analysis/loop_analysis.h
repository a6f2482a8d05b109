// Frequency responses of loops of one axis, designed and measured.
#pragma once

#include <atomic>
#include <complex>
#include <limits>
#include <string>
#include <vector>

#include <breakwater/rigs/axis_scenario.h>

namespace breakwater {

/// Margins of a loop gain L(jω) with negative feedback. NaN: there is no such crossing.
struct LoopMargins {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  double crossover_rad_s = kNone;        ///< the last frequency at which |L| = 1
  double phase_margin_rad = kNone;       ///< the smallest distance of arg L from −π at |L| = 1
  double gain_margin = kNone;            ///< the smallest factor above 1 that makes it unstable
  double gain_reduction_margin = kNone;  ///< the largest factor below 1 that makes it unstable
  double delay_margin_s = kNone;         ///< the smallest additional delay that makes it unstable
  /// M_s = max |1/(1 + L)|; 1/M_s is the smallest distance of L from −1
  double sensitivity_peak = kNone;
  double complementary_peak = kNone;  ///< M_t = max |L/(1 + L)|
};

/// `omega_rad_s` (increasing) and `loop_gain` have equal length. Crossings are interpolated, so log
/// |L| and arg L must be nearly straight over log ω between two points. Throws
/// std::invalid_argument if there are fewer than two.
///
/// Source: K. J. Åström, R. M. Murray, Feedback Systems, Princeton 2008, section 9.3.
LoopMargins loop_margins(const std::vector<double>& omega_rad_s,
                         const std::vector<std::complex<double>>& loop_gain);

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

/// A measured point counts if its windows agree, and the drive reacts to the probe.
bool is_reliable(const LoopPoint& point);

/// A designed or measured loop. If `points` is empty, `reason` says why. Bandwidth and margins of
/// a measured one are those of its reliable points.
struct LoopCurve {
  std::vector<LoopPoint> points;
  std::string reason;        ///< why there are no points
  bool is_unstable = false;  ///< then there is no measurement either
  /// |d̂/d| falls below 1/√2 here; NaN: nowhere, or no estimator
  double bandwidth_rad_s = LoopMargins::kNone;
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
