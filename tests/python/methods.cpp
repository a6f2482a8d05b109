// Methods that `bw` does not show, for tests in Python: build/tests/methods.so.
#include "methods.h"

#include <random>

#include <breakwater/math/error_function.h>
#include <breakwater/math/functions.h>
#include <breakwater/statistics/paired_comparison.h>
#include <breakwater/statistics/ranking.h>
#include <breakwater/statistics/sensitivity.h>
#include <breakwater/statistics/signed_rank.h>
#include <breakwater/study/comparison_table.h>
#include <breakwater/study/sampling.h>

namespace breakwater::python_methods {
Eigen::MatrixXd points(Method method, std::uint64_t n, Eigen::Index d, std::uint64_t seed,
                       const std::optional<std::vector<std::uint64_t>>& which) {
  const Sampler sampler = make_sampler(method, n, d, seed);
  const std::size_t count = which ? which->size() : sampler.size;
  Eigen::MatrixXd all(count, d);
  for (std::size_t i = 0; i < count; ++i) all.row(i) = sampler.point(which ? (*which)[i] : i);
  return all;
}

void bind_statistics(py::module_& module) {
  choice<Goal>(module, "Goal none min max");
  choice<Method>(module, "SamplingMethod random latin_hypercube sobol saltelli");
  choice<ComparisonVerdict>(
      module, "ComparisonVerdict better worse smaller larger no_difference_shown too_few_blocks");
  choice<DistributionKind>(module, "DistributionKind uniform log_uniform normal");
  record(module, "ConfidenceInterval lower upper", &ConfidenceInterval::lower,
         &ConfidenceInterval::upper);
  record(module, "EstimatedValue value interval", &EstimatedValue::value,
         &EstimatedValue::interval);
  using R = PairedResults;
  record(module, "PairedResults candidates baseline metrics goals values failed samples runs",
         &R::candidates, &R::baseline, &R::metrics, &R::goals, &R::values, &R::failed, &R::samples,
         &R::runs);
  using C = PairComparison;
  record(
      module,
      "PairComparison candidate pairs blocks failures reference_failures smaller larger median "
      "reference_median difference p least_p_holm probability_smaller probability_better verdict",
      &C::candidate, &C::pairs, &C::blocks, &C::failures, &C::reference_failures, &C::smaller,
      &C::larger, &C::median, &C::reference_median, &C::difference, &C::p, &C::least_p_holm,
      &C::probability_smaller, &C::probability_better, &C::verdict);
  using A = CandidateComparison;
  record(module, "CandidateComparison metrics failures reached never", &A::metrics, &A::failures,
         &A::reached, &A::never);
  record(module, "Bound metric min max", &Bound::metric, &Bound::min, &Bound::max);
  using I = SensitivityIndices;
  record(module, "SensitivityIndices first_order total rows dropped_rows", &I::first_order,
         &I::total, &I::rows, &I::dropped_rows);
  module.def("compare_candidates", [](const R& results) { return compare_candidates(results); });
  module.def("comparison_text", comparison_text);
  module.def("comparison_csv",
             [](const CandidateComparison& all) { return csv_table(comparison_rows(all)); });
  module.def("ranking_text", [](const R& results, const char* metric, Goal goal,
                                const std::vector<Bound>& bounds, std::size_t width) {
    return ranking_text(rank_candidates(results, metric, goal, {bounds}), width);
  });
  py::class_<SignedRank>(module, "SignedRank")
      .def(py::init<std::vector<double>>())
      .def("p", &SignedRank::p)
      .def("pseudo_median", &SignedRank::pseudo_median)
      .def("interval", &SignedRank::interval)
      .def("share_above", &SignedRank::share_above);
  module.def("differences_needed", differences_needed);
  module.def("holm", holm);
  module.def("holm_levels", holm_levels);
  module.def("binomial_cdf", binomial_cdf);
  module.def("mcnemar_exact", mcnemar_exact);
  module.def("share_interval", share_interval);
  module.def("quantile_interval", quantile_interval);
  module.def("estimated_median", estimated_median);
  module.def("quantile", quantile);
  module.def("sensitivity_indices", sensitivity_indices, py::arg(), py::arg("replicates") = 1000);
  module.def("quantiles",
             [](DistributionKind kind, double first, double second, const std::vector<double>& u) {
               const Distribution distribution(kind, first, second);
               std::vector<double> all;
               for (const double share : u) all.push_back(distribution.quantile(share));
               return all;
             });
  module.def("mersenne_twister", [](std::uint64_t seed, int n) {
    std::mt19937_64 engine(seed);
    std::vector<std::uint64_t> all(n);
    std::generate(all.begin(), all.end(), engine);
    return all;
  });
  module.def("points", points, py::arg(), py::arg(), py::arg(), py::arg(),
             py::arg("which") = py::none());
  module.def("sobol", [](Eigen::Index d, const std::vector<std::uint64_t>& which) {
    const auto points = sobol_points(d);
    Eigen::Matrix<std::uint64_t, Eigen::Dynamic, Eigen::Dynamic> all(which.size(), d);
    for (std::size_t i = 0; i < which.size(); ++i) {
      const std::vector<std::uint64_t> point = points(which[i]);
      for (Eigen::Index j = 0; j < d; ++j) all(i, j) = point[j];
    }
    return all;
  });
}

void bind_functions(py::module_& module) {
  using Function = double (*)(double);
  const std::pair<const char*, Function> functions[] = {{"sin", math::sin},
                                                        {"cos", math::cos},
                                                        {"tan", math::tan},
                                                        {"asin", math::asin},
                                                        {"acos", math::acos},
                                                        {"exp", math::exp},
                                                        {"expm1", math::expm1},
                                                        {"log", math::log},
                                                        {"tanh", math::tanh},
                                                        {"erfc", math::erfc},
                                                        {"mills_ratio", math::mills_ratio}};
  for (const auto& [name, function] : functions) module.def(name, py::vectorize(function));
  module.def("atan2", py::vectorize(math::atan2));
  module.def("pow", py::vectorize(math::pow));
  using Complex = std::complex<double>;
  module.def("sincos", py::vectorize([](double x) {
               const auto [sine, cosine] = math::sincos(x);
               return Complex(cosine, sine);
             }));
  module.def("complex_exp", [](const Complex& z) { return math::exp(z); });
  module.def("complex_log", [](const Complex& z) { return math::log(z); });
}

}  // namespace breakwater::python_methods

PYBIND11_MODULE(methods, module) {
  breakwater::python_methods::bind_statistics(module);
  breakwater::python_methods::bind_identification(module);
  breakwater::python_methods::bind_functions(module);
  breakwater::python_methods::bind_predictive_control(module);
  breakwater::python_methods::bind_waves(module);
  breakwater::python_methods::bind_quadrotor(module);
}
