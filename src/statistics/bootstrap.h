// Bootstrap intervals of any statistic of a sample.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <breakwater/statistics/confidence_interval.h>
#include <breakwater/statistics/quantile.h>

namespace breakwater {

/// A number made of a sample, whose order does not matter. It may reorder its argument.
using Statistic = std::function<double(std::vector<double>&)>;

/// Beside sample_median().
double sample_mean(std::vector<double>& values);

/// The statistic of samples as large as `values`, drawn from it with replacement. The draws are a
/// function of the seed and the size alone, and the same on every processor.
std::vector<double> bootstrap_replicates(const std::vector<double>& values,
                                         const Statistic& statistic,
                                         const BootstrapSettings& settings);

/// The bias-corrected and accelerated interval of a statistic θ from its replicates θ*:
///     [Q(α₁), Q(α₂)] of the θ*,  α = Φ(z₀ + (z₀ + z)/(1 − a (z₀ + z))),  z = ±Φ⁻¹((1 + level)/2)
///     z₀ = Φ⁻¹(share of θ* below θ, those equal to it by half)
///     a  = Σ dᵢ³ / (6 (Σ dᵢ²)^1.5),  dᵢ = mean of θ₍ⱼ₎ − θ₍ᵢ₎,  θ₍ᵢ₎ without value i
/// If all replicates lie on one side of θ there is none.
///
/// Source: B. Efron, J. Amer. Statist. Assoc. 82 (1987) 171–185.
std::optional<ConfidenceInterval> bca_interval(const std::vector<double>& values,
                                               const Statistic& statistic,
                                               std::vector<double> replicates, double level);

}  // namespace breakwater
