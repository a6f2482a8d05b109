// Bootstrap confidence intervals of a statistic.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <breakwater/statistics/confidence_interval.h>
#include <breakwater/statistics/quantile.h>

namespace breakwater {

/// A statistic of a sample that does not depend on its order. It may reorder its argument.
using Statistic = std::function<double(std::vector<double>&)>;

/// The mean. sample_median() is the median.
double sample_mean(std::vector<double>& values);

/// The statistic of samples drawn from `values` with replacement, each as large as `values`. The
/// draws depend only on the seed and the size, and are the same on every processor.
std::vector<double> bootstrap_replicates(const std::vector<double>& values,
                                         const Statistic& statistic,
                                         const BootstrapSettings& settings);

/// The bias-corrected and accelerated (BCa) interval of a statistic θ from its replicates θ*:
///     [Q(α₁), Q(α₂)] of the θ*,  α = Φ(z₀ + (z₀ + z)/(1 − a (z₀ + z))),  z = ±Φ⁻¹((1 + level)/2)
///     z₀ = Φ⁻¹(share of θ* below θ, those equal to it by half)
///     a  = Σ dᵢ³ / (6 (Σ dᵢ²)^1.5),  dᵢ = mean of θ₍ⱼ₎ − θ₍ᵢ₎,  θ₍ᵢ₎ without value i
/// Nothing if all replicates lie on one side of θ.
///
/// Source: B. Efron, J. Amer. Statist. Assoc. 82 (1987) 171–185.
std::optional<ConfidenceInterval> bca_interval(const std::vector<double>& values,
                                               const Statistic& statistic,
                                               std::vector<double> replicates, double level);

}  // namespace breakwater
