// The loop allocates nothing after the first sample. The test counts calls of malloc.
#include <dlfcn.h>

#include <atomic>
#include <cstdlib>

#include <breakwater/observers/fakfd.h>
#include <breakwater/observers/gsf.h>
#include <breakwater/observers/idob.h>
#include <breakwater/observers/immkf.h>
#include <breakwater/observers/kfd.h>
#include <breakwater/observers/mckf.h>
#include <breakwater/observers/mdob.h>
#include <breakwater/observers/multiple_model_estimator.h>
#include <breakwater/observers/qvff.h>
#include <breakwater/observers/state_observer.h>
#include <breakwater/observers/stf.h>
#include <breakwater/observers/vbakf.h>
#include <breakwater/plants/damped_inertia.h>
#include "linear/random_qp.h"
#include "regression/run_case.h"

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

namespace breakwater {
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
  EXPECT_GT(reports, 10);
  EXPECT_FALSE(run.failure);
  return counted;
}

// The slowest case touches the wall 5 s after the switch.
std::vector<std::string> noisy_impact() {
  std::vector<std::string> sets = testing::switched_at_10_s(17);
  sets.push_back("sensor.angle_noise_rad=1e-6");
  return sets;
}

TEST(Allocation, CounterCounts) {
  counting = true;
  const long before = allocations;
  void* volatile p = std::malloc(10);
  counting = false;
  std::free(p);
  EXPECT_EQ(allocations, before + 1);
}

// Includes the switch to force control, the impact, and the log at the physics rate.
TEST(Allocation, WallContactLoopDoesNotAllocate) {
  for (const char* name : {"proposed-2N", "hpfc-2N", "drac-2N", "tlsc-2N", "energy-2N",
                           "impact-qp-2N", "contact-mpc-2N"}) {
    EXPECT_EQ(allocations_in_loop("arm_wall_contact", name, noisy_impact()), 0) << name;
  }
}

// The loop writes the log too. HDF5 writes only the headers, at the first sample.
TEST(Allocation, AStreamedLogDoesNotAllocate) {
  const testing::TemporaryPath folder("stream");
  std::filesystem::create_directory(folder);
  LogStream stream(folder, "", "{}");
  EXPECT_EQ(allocations_in_loop("arm_wall_contact", "proposed-2N", noisy_impact(), &stream), 0);
  EXPECT_GT(written_rows(folder / "log.h5", "control"), 32U);
}

TEST(Allocation, AContactLawDoesNotAllocate) {
  for (const char* law :
       {"kelvin_voigt_clipped", "hertz", "hunt_crossley", "layered", "standard_linear_solid"}) {
    EXPECT_EQ(allocations_in_loop(
                  "impact_test", law,
                  {"run.duration_s=1.2", "wall.motion=free", "wall.mass_kg=2",
                   "wall.stiffness_N_m=1e3", "wall.damping_Ns_m=1", "sensor.force_resonance_Hz=500",
                   "sensor.force_delay_s=1e-3", "sensor.force_drift_N_sqrt_s=0.1"}),
              0)
        << law;
  }
}

TEST(Allocation, ADriveAsItIsDoesNotAllocate) {
  const std::vector<std::string> motor = {"drive.current_bandwidth_rad_s=500",
                                          "drive.current_damping_ratio=0.7",
                                          "drive.voltage_limit_V=100",
                                          "drive.resistance_ohm=1",
                                          "drive.inductance_H=1e-3",
                                          "drive.cogging_Nm=0.1",
                                          "control.delay_s=1.5e-3",
                                          "control.jitter_s=3e-3",
                                          "control.drop_probability=0.1",
                                          "encoder.eccentricity_rad=1e-4",
                                          "plant.coulomb_friction_Nm=0.5",
                                          "run.duration_s=120"};
  const std::vector<std::vector<std::string>> laws = {
      {"friction.law=load_dependent", "friction.load_ratio=0.1"},
      {"friction.law=lugre", "friction.static_ratio=1.5", "friction.stribeck_velocity=0.05",
       "friction.bristle_stiffness=1e4", "friction.bristle_damping=10"}};
  for (std::vector<std::string> sets : laws) {
    sets.insert(sets.end(), motor.begin(), motor.end());
    EXPECT_EQ(allocations_in_loop("motor_estimation", "vfakfd", sets), 0) << sets.front();
  }
}

TEST(Allocation, AnElasticDriveDoesNotAllocate) {
  EXPECT_EQ(allocations_in_loop("arm_push", "proposed-link2",
                                {"run.duration_s=12", "transmission.stiffness_Nm_rad=1e4",
                                 "transmission.backlash_rad=1e-4", "friction.law=load_dependent",
                                 "friction.load_ratio=0.1"}),
            0);
}

TEST(Allocation, PushLoopDoesNotAllocate) {
  for (const char* observer : {"idob", "kfd", "qvff", "stf", "qbank"}) {
    EXPECT_EQ(allocations_in_loop("arm_push", "proposed-link2",
                                  {"run.duration_s=12", "observer.name=" + std::string(observer)}),
              0)
        << observer;
  }
}

// They have active limits, the disturbance, and problems that need softening.
struct PredictiveLoop {
  const char* scenario;
  const char* name;
  std::vector<std::string> sets;
};

class PredictiveLoops : public ::testing::TestWithParam<PredictiveLoop> {};

TEST_P(PredictiveLoops, DoNotAllocate) {
  const auto& [scenario, name, sets] = GetParam();
  EXPECT_EQ(allocations_in_loop(scenario, name, sets), 0);
}

std::vector<PredictiveLoop> predictive_loops() {
  std::vector<PredictiveLoop> loops = {{"cart_constrained", "lqr-obs-kfd", {"run.duration_s=120"}}};
  for (const std::string solver : {"active_set", "hildreth"}) {
    // From 15 s on each of Hildreth's programs meets the limit of iterations, and takes 8 ms. So
    // its run has fewer samples, and as many steps.
    const bool is_slow = solver == "hildreth";
    const std::string duration_s = is_slow ? "46" : "120", timestep_s = is_slow ? "5e-4" : "1e-3";
    loops.push_back({"cart_constrained",
                     "proposed-idob",
                     {"condition=C", "run.duration_s=" + duration_s, "disturbance.start_s=15",
                      "constraint.velocity_m_s=0.3", "physics.timestep_s=" + timestep_s,
                      "solver.name=" + solver}});
    loops.push_back({"cart_offset_free",
                     "proposed-kfd",
                     {"run.duration_s=120", "reference.start_s=15", "constraint.position_m=0.5",
                      "solver.name=" + solver}});
  }
  return loops;
}

INSTANTIATE_TEST_SUITE_P(Allocation, PredictiveLoops, ::testing::ValuesIn(predictive_loops()));

// Ill-conditioned programs, dependent constraints and infeasible programs reach all branches of the
// solver.
TEST(Allocation, QuadraticProgramsDoNotAllocate) {
  testing::Random random;
  allocations = 0;
  for (int k = 0; k < 200; ++k) {
    auto [model, input] =
        k % 2 == 0 ? testing::hard_feasible_qp(random) : testing::hard_infeasible_qp(random);
    const auto solver = make_qp_solver(QpSolverKind::active_set, model, 1);
    QpSolution solution(model.H.rows(), model.Omega.rows());
    for (const double softness : {0.0, 0.1}) {
      input.softness(0) = softness;
      counting = true;
      allow_eigen_malloc(false);
      solver->solve(input, solution);
      counting = false;
      allow_eigen_malloc(true);
    }
  }
  EXPECT_EQ(allocations, 0);
}

TEST(Allocation, EstimatorsDoNotAllocate) {
  for (const char* name :
       {"mdob", "idob", "kfd", "fakfd-095", "vfakfd", "qvff", "stf", "qbank", "immkf", "immkf-code",
        "mckf", "mckf-code", "eso", "eso-fal", "tracking_differentiator", "vbakf", "gsf", "mhe"}) {
    EXPECT_EQ(
        allocations_in_loop("motor_estimation", name,
                            {"run.duration_s=90", "disturbance.start_s=15", "noise.std_rad=1e-4",
                             "noise.input_std_Nm=0.1", "sensor.delay_samples=1"}),
        0)
        << name;
  }
  for (const char* form : {"symmetric", "printed"}) {
    EXPECT_EQ(allocations_in_loop(
                  "cart_position", "order2-gamma",
                  {"run.duration_s=120", "observer.covariance_form=" + std::string(form)}),
              0)
        << form;
  }
}

TEST(Allocation, ControllersOfTwoInertiasDoNotAllocate) {
  for (const char* name : {"pd", "rrc", "sf-kfd", "sf-stf", "sf-qbank", "lmpc"}) {
    EXPECT_EQ(allocations_in_loop("two_inertia", name, {"run.duration_s=60", "task.kind=reversal"}),
              0)
        << name;
  }
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
      counting = k > 0;
      const double jitter = 1.0 + 0.01 * (k % 7);
      EXPECT_TRUE(estimators[i]->follow(
          {k % 10 == 9 ? 20.0 * T : jitter * T, 1e-6, k % 10 == 9 ? 0.1 : 0.0, 1e-3}));
      y(0) = 1e-3 * k;
      estimators[i]->update(u, y);
      counting = false;
    }
    EXPECT_EQ(allocations, 0) << i;
  }
}

TEST(Allocation, ObserversOfSeveralOutputsDoNotAllocateWithVariableIntervals) {
  StateSpace joints{Eigen::MatrixXd::Zero(4, 4), Eigen::MatrixXd::Zero(4, 2),
                    Eigen::MatrixXd::Zero(2, 4)};
  joints.A.topRightCorner(2, 2).setIdentity();
  joints.B.bottomRows(2).setIdentity();
  joints.C.leftCols(2).setIdentity();
  Idob idob(joints, {{-10, -20, -30}, {-10, {-20, 5}, {-20, -5}}}, 1e-3);
  StateObserver observer(joints, {{-10, -20}, {-10, -10}}, 1e-3);
  const Eigen::VectorXd two = Eigen::VectorXd::Constant(2, 0.1);
  for (DisturbanceEstimator* estimator :
       {static_cast<DisturbanceEstimator*>(&idob), static_cast<DisturbanceEstimator*>(&observer)}) {
    allocations = 0;
    counting = true;
    for (int k = 1; k < 100; ++k) {
      estimator->follow({1e-3 * (1.0 + 0.01 * (k % 7))});
      estimator->update(two, two);
    }
    counting = false;
    EXPECT_EQ(allocations, 0);
  }
}

// The loop reports every 10 s, so its first 10 s count too.
TEST(Allocation, QuadrotorLoopDoesNotAllocate) {
  for (const char* name :
       {"resonator", "spectrum", "ukf-second", "ekf-second", "ukf-none", "spectrum-lead",
        "mpc-held", "mpc-forecast", "mpc-autoregressive", "mpc-upstream", "mpc-told"}) {
    EXPECT_EQ(allocations_in_loop("quadrotor_waves", name,
                                  {"run.duration_s=111", "estimator.wave_frequency=estimated"}),
              0)
        << name;
  }
}

}  // namespace
}  // namespace breakwater
