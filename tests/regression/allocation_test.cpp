// The loop allocates nothing after the first sample. The test counts calls of malloc.
#include <dlfcn.h>
#include <atomic>
#include <set>

#include <breakwater/observers/fakfd.h>
#include <breakwater/observers/gsf.h>
#include <breakwater/observers/idob.h>
#include <breakwater/observers/immkf.h>
#include <breakwater/observers/kfd.h>
#include <breakwater/observers/mckf.h>
#include <breakwater/observers/mdob.h>
#include <breakwater/observers/multiple_model_estimator.h>
#include <breakwater/observers/state_observer.h>
#include <breakwater/observers/stf.h>
#include <breakwater/observers/vbakf.h>
#include <breakwater/observers/vfakfd.h>
#include <breakwater/plants/damped_inertia.h>
#include "linear/random_qp.h"
#include "regression/run_case.h"
#include "tables.h"

namespace {

std::atomic<long> allocations = 0;
thread_local bool counting = false;

}  // namespace

// glibc's own entry points; operator new and Eigen both end in malloc.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t n, std::size_t size);
void* __libc_realloc(void* p, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) {
  if (counting) ++allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t n, std::size_t size) {
  if (counting) ++allocations;
  return __libc_calloc(n, size);
}
void* realloc(void* p, std::size_t size) {
  if (counting) ++allocations;
  return __libc_realloc(p, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  if (counting) ++allocations;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** p, std::size_t alignment, std::size_t size) {
  if (counting) ++allocations;
  *p = __libc_memalign(alignment, size);
  return *p == nullptr;
}
}

namespace breakwater::allocation_test {
namespace {

// In a debug build Eigen stops the program with a backtrace if it allocates.
void allow_eigen_malloc([[maybe_unused]] bool allowed) {
#ifdef EIGEN_RUNTIME_NO_MALLOC
  Eigen::internal::set_is_malloc_allowed(allowed);
#endif
}

// Counts from the second progress report, after the first step, to the last one in the loop.
// Metrics after the loop may allocate.
long allocations_in_loop(const std::string& scenario, const std::string& case_name,
                         const std::vector<std::string>& sets, LogStream* stream = nullptr) {
  allocations = 0;
  long counted = 0;
  int reports = 0;
  double before = 0.0;
  RunControl control;
  control.stream = stream;
  control.progress = [&](double fraction) {
    counted = allocations;
    const bool is_last = 2.0 * fraction - before > 1.0 - 1e-9;
    before = fraction;
    if (++reports < 2) return;
    counting = true;
    allow_eigen_malloc(is_last);
  };
  const Recording run = testing::run_case(scenario, case_name, sets, control);
  counting = false;
  allow_eigen_malloc(true);
  EXPECT_GE(reports, 4);  // at the start, after the first step, and after 10 000 and 20 000
  EXPECT_FALSE(run.failure);
  return counted;
}

TEST(Allocation, CounterCounts) {
  counting = true;
  const long before = allocations;
  void* volatile p = std::malloc(10);
  counting = false;
  std::free(p);
  EXPECT_EQ(allocations, before + 1);
}

// The loop writes the log too. HDF5 writes only the headers, at the first sample.
TEST(Allocation, AStreamedLogDoesNotAllocate) {
  const testing::TemporaryPath folder("stream");
  std::filesystem::create_directory(folder);
  LogStream stream(folder, "", "{}");
  std::vector<std::string> sets = testing::switched_at_7_s(9);
  sets.emplace_back("sensor.angle_noise_rad=1e-6");
  EXPECT_EQ(allocations_in_loop("arm_wall_contact", "proposed-2N", sets, &stream), 0);
  EXPECT_GT(written_rows(folder / "log.h5", "control"), 32U);
}

class Loops : public ::testing::TestWithParam<testing::Table> {};

TEST_P(Loops, DoNotAllocate) {
  const std::vector<std::string> heading = testing::words_in(GetParam().heading);
  for (const testing::TableRow& row : GetParam().rows) {
    for (const std::string& name : testing::forms_of(row.cells.at(0))) {
      for (const std::string& form : testing::forms_of(row.cells.at(1))) {
        std::vector<std::string> sets = testing::words_in(form);
        sets.insert(sets.end(), heading.begin() + 1, heading.end());
        EXPECT_EQ(allocations_in_loop(heading.front(), name, sets), 0) << name << " " << form;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Allocation, Loops,
                         ::testing::ValuesIn(testing::tables_of("tests/regression/allocation.txt")),
                         testing::test_name);

// With ill-conditioned programs, dependent rows, equations and infeasible programs.
TEST(Allocation, QuadraticProgramsDoNotAllocate) {
  testing::Random random;
  allocations = 0;
  std::set<QpStatus> statuses;
  for (int k = 0; k < 200; ++k) {
    QpModel model = testing::random_qp_model(random, {2 + k % 23, 2 + k % 59});
    const Eigen::VectorXd scale = Eigen::VectorXd::LinSpaced(model.H.rows(), 0.0, -0.5 * (k % 9));
    const Eigen::ArrayXd units = Eigen::pow(10.0, scale.array());
    model.H = units.matrix().asDiagonal() * model.H * units.matrix().asDiagonal();
    for (Eigen::Index i = 2; i < model.Omega.rows(); i += 5) {  // near copies and sums
      model.Omega.row(i) = model.Omega.row(i - 1) + (i % 2 ? 1e-7 : 1.0) * model.Omega.row(i - 2);
    }
    QpInput input = testing::random_feasible_input(random, model);
    for (Eigen::Index i = 0; i < model.Omega.rows(); i += 5) {
      if (i < k % model.Omega.rows() && input.lower(i) > -INFINITY && input.upper(i) < INFINITY) {
        input.lower(i) = input.upper(i) = 0.5 * (input.lower(i) + input.upper(i));
      }
    }
    if (k % 2 == 1) testing::make_infeasible(random, model, input, std::pow(10.0, k % 7 - 6));
    const auto solver = make_qp_solver(QpSolverKind::active_set, model, 1);
    QpSolution solution(model.H.rows(), model.Omega.rows());
    for (const double softness : {0.0, 0.1}) {
      input.softness(0) = softness;
      counting = true;
      allow_eigen_malloc(false);
      solver->solve(input, solution);
      counting = false;
      allow_eigen_malloc(true);
      statuses.insert(solution.status);
    }
  }
  EXPECT_EQ(allocations, 0);
  EXPECT_TRUE(statuses.count(QpStatus::solved) && statuses.count(QpStatus::infeasible));
}

// Jitter, gaps with missing inputs, and uncertain times.
TEST(Allocation, EstimatorsDoNotAllocateWithVariableIntervals) {
  const double T = 1e-3;
  const StateSpace motor = damped_inertia(1e-3, 2e-4);
  const SensorError sensor{Eigen::VectorXd::Constant(1, 1e-3), Eigen::VectorXd::Zero(1)};
  const ExtendedPlant plant = sample_with_disturbance_model(motor, 1, T);
  const KalmanDesign design = stf_design(plant, sensor, T);
  std::vector<std::unique_ptr<DisturbanceEstimator>> estimators;
  estimators.push_back(std::make_unique<Stf>(design, sensor));
  estimators.push_back(std::make_unique<Kfd>(design));
  estimators.push_back(std::make_unique<Fakfd>(design, scalar_gamma(plant, 1.02)));
  estimators.push_back(
      std::make_unique<Vfakfd>(variable_forgetting_design(plant, 1e-6), qvff_design(sensor)));
  estimators.push_back(std::make_unique<Idob>(motor, std::vector<PoleGroup>{{-10, -20, -30}}, T));
  estimators.push_back(
      std::make_unique<StateObserver>(motor, std::vector<PoleGroup>{{{-10, 5}, {-10, -5}}}, T));
  estimators.push_back(std::make_unique<Mdob>(MdobDesign{1e-3, 50.0, 20.0}, T));
  estimators.push_back(
      std::make_unique<MultipleModelEstimator>(MultipleModelDesign{motor, T, sensor, 1.0}));
  const KalmanDesign known =
      known_sensor_design(plant, sensor, 1e-6, Eigen::VectorXd::Constant(4, 1e-6));
  for (const Likelihood likelihood : {Likelihood::gauss, Likelihood::code}) {
    estimators.push_back(
        sized_immkf(known, sensor, {.noise_ratio = 1e4, .likelihood = likelihood}));
    estimators.push_back(sized_mckf(known, sensor, {.likelihood = likelihood}));
  }
  estimators.push_back(sized_vbakf(known, {}));
  estimators.push_back(sized_gsf(known, sensor, 5));
  Eigen::VectorXd u = Eigen::VectorXd::Constant(1, 0.1);
  Eigen::VectorXd y = Eigen::VectorXd::Zero(1);
  for (std::size_t i = 0; i < estimators.size(); ++i) {
    allocations = 0;
    for (int k = 0; k < 100; ++k) {
      const double jitter = 1.0 + 0.01 * (k % 7);
      EXPECT_TRUE(estimators[i]->follow(
          {k % 10 == 9 ? 20.0 * T : jitter * T, 1e-6, k % 10 == 9 ? 0.1 : 0.0, 1e-3}));
      y(0) = 1e-3 * k;
      counting = k > 0;
      estimators[i]->update(u, y);
      counting = false;
    }
    EXPECT_EQ(allocations, 0) << i;
  }
}

}  // namespace

}  // namespace breakwater::allocation_test
