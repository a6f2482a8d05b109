// Bare loops of MuJoCo, and the C++ side of the Python module: a run's additional cost to them is
// that of Breakwater.
//
// bare replay RUN_FOLDER [whole]: mj_step replays a run of arm_wall_contact or robot_wall_contact.
//   It has the same model, the recorded torques, the run's friction, and the engine's contact with
//   the wall and its switch. The model is the part that physics needs, or the whole one.
// bare render RUN_FOLDER fast|full FRAMES: mjr_render over the frames of `breakwater video`.
//   The same scene, size and look on one core. Smooth edges, captions, chart, colours and encoding
//   are left out.
// bare points CASE DURATION_S N: only the simulations of a sweep. These are runs of a case of
//   motor_estimation with seeds 1 … N, all prepared before the clock starts.
// bare run SCENARIO SECONDS: a controller that commands a constant.
// bare filter SAMPLES: a loop that filters a record.
// The last three print their processor time [s].
#include <mujoco/mujoco.h>

#include <toml++/toml.h>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include <breakwater/experiment/runner.h>
#include <breakwater/observers/stf.h>
#include <breakwater/pictures/staging.h>
#include <breakwater/plants/damped_inertia.h>
#include <breakwater/program/program.h>
#include <breakwater/record/hdf5_log.h>
#include <breakwater/render/offscreen.h>
#include <breakwater/render/scene_view.h>
#include <breakwater/rigs/arm_parts.h>
#include <breakwater/rigs/axis_parts.h>
#include <breakwater/shell/paths.h>
#include <breakwater/signals/thread_time.h>
#include <breakwater/sim/contact.h>
#include <breakwater/sim/joint_friction.h>
#include <breakwater/sim/model.h>

using namespace breakwater;

namespace {

void replay(const std::string& run, bool is_whole) {
  const toml::table config = toml::parse_file(run + "/config.toml");
  const auto number = [&](const char* key) { return config.at_path(key).value<double>().value(); };
  const bool is_planar = config.at_path("wall.distance_m").is_number();
  const auto logged = [&](const std::string& signal) {
    return read_hdf5_signal(run + "/log.h5", "control/" + signal);
  };
  std::vector<LoggedSignal> torques;
  if (is_planar) torques.push_back(logged("torque_applied_Nm"));
  const LoggedSignal qpos = logged("qpos");

  const double timestep_s = number("physics.timestep_s");
  const std::string mjcf =
      find_file(config.at_path("model.mjcf").value<std::string>().value(), run).value().string();
  Model model = is_whole ? Model::load(mjcf) : Model::load_physics(mjcf, {"tip", "wall"});
  model.set_physics(timestep_s, Integrator::euler);
  author_friction(model);
  const int wall = model.id(mjOBJ_GEOM, "wall");
  mjModel& m = *model.get();
  const int tip = model.id(mjOBJ_GEOM, "tip");
  if (is_planar) m.geom_pos[3 * wall] = 0.45 + number("wall.distance_m");
  const std::string contact = is_planar ? "contact." : "contact.wall.";
  m.geom_condim[tip] = m.geom_condim[wall] = 1;
  author_contact(
      model, tip, wall,
      {number((contact + "stiffness_N_m").c_str()), number((contact + "damping_Ns_m").c_str())});
  m.geom_contype[wall] = m.geom_conaffinity[wall] = 0;
  for (int i = 1; !is_planar && i <= m.nu; ++i) {
    torques.push_back(logged("joint" + std::to_string(i) + "_applied_Nm"));
  }

  const auto steps = std::llround(number("run.duration_s") / timestep_s);
  const auto steps_per_sample = std::llround(number("control.period_s") / timestep_s);
  const auto solid = is_planar ? std::llround(number("wall.solid_from_s") / timestep_s) : 0;
  mjData* d = mj_makeData(&m);
  std::copy_n(qpos.row(0), m.nq, d->qpos);
  for (long long k = 0; k < steps; ++k) {
    if (k == solid) m.geom_contype[wall] = m.geom_conaffinity[wall] = 1;
    if (k % steps_per_sample == 0) {
      mjtNum* next = d->ctrl;
      for (const LoggedSignal& one : torques) {
        next =
            std::copy_n(one.row(static_cast<std::size_t>(k / steps_per_sample)), one.width, next);
      }
    }
    mj_step(&m, d);
  }
  // A correct replay ends at the run's last state.
  const double* last = qpos.row(qpos.rows - 1);
  const double difference = std::abs(d->qpos[0] - last[0]);
  std::printf("steps %lld, end differs by %.1e rad\n", steps, difference);
  mj_deleteData(d);
  if (difference >= 1e-3) throw std::runtime_error("the replay is not the run");
}

void render(const std::string& folder, const std::string& look, const std::string& count) {
  setenv("LP_NUM_THREADS", "0", 1);
  std::vector<FinishedRun> runs;
  runs.emplace_back(standard_catalogue(), SavedRun(folder));
  const ShotList shots = shot_list(runs.front().shots_file());
  const Window window = choose_window(runs, shots, {});
  const long frames = std::stol(count);
  PictureRun run = stage(runs.front(), shots, "");

  Offscreen offscreen(shots.style.width, shots.style.height);
  SceneView view(offscreen, run.model, run.camera, look == "fast" ? kFastLook : kFullLook);
  const auto rows = static_cast<double>(run.qpos.rows - 1);
  const double per_s = rows / (run.times_s.back() - run.times_s.front());
  for (long k = 0; k < frames; ++k) {
    const double part = static_cast<double>(k) / static_cast<double>(frames);
    const double time_s = window.from_s + part * (window.to_s - window.from_s);
    const auto row = static_cast<std::size_t>((time_s - run.times_s.front()) * per_s);
    run.animate(run.model, time_s);
    view.pose({run.qpos.row(row), run.qpos.width});
    std::vector<SceneArrow> arrows;
    for (const ArrowTrack& track : run.arrows) arrows.push_back(arrow_at(track, time_s));
    view.draw({0, 0, shots.style.width, shots.style.height}, arrows);
    offscreen.finish();
  }
  std::printf("frames %ld, %s\n", frames, offscreen.renderer().c_str());
}

double points_s(const std::string& case_name, const std::string& duration,
                const std::string& count) {
  const SharedModels shared;
  const Catalogue catalogue = standard_catalogue();
  const std::string scenario = "motor_estimation";
  const ScenarioFile file(catalogue.get<ScenarioKind>(scenario).file().string(), scenario);
  const int runs = std::stoi(count);
  RunControl control;
  control.logs = false;
  double seconds = 0.0;
  for (int seed = 1; seed <= runs; ++seed) {
    const PreparedRun run =
        prepare_point(catalogue, scenario, file, case_name,
                      {"run.duration_s=" + duration, "run.seed=" + std::to_string(seed)});
    const double begin = thread_time_s();
    run.scenario->run(control);
    seconds += thread_time_s() - begin;
  }
  return seconds;
}

class Constant final : public Controller {
 public:
  void reset(const Sample&) override {}
  void update(const Sample&, Eigen::Ref<Eigen::VectorXd> u) override { u.setZero(); }
};

struct Nothing {};
void bind_nothing(Fields&, Nothing&) {}

double run_s(const std::string& scenario, const std::string& duration) {
  Catalogue catalogue = standard_catalogue();
  catalogue.add(ArmControllerKind(
      "constant", "no torque", bind_nothing,
      +[](const Nothing&, const ArmSetup&) -> std::unique_ptr<Controller> {
        return std::make_unique<Constant>();
      }));
  catalogue.add(AxisControllerKind(
      "constant", "no force", bind_nothing,
      +[](const Nothing&, const AxisTask&, std::shared_ptr<DisturbanceEstimator>)
          -> std::unique_ptr<Controller> { return std::make_unique<Constant>(); }));
  double elapsed_s = 0.0;
  for (int turn = 0; turn < 2; ++turn) {  // the first one warms up the caches
    const double begin = thread_time_s();
    const ScenarioFile file(catalogue.get<ScenarioKind>(scenario).file().string(), scenario);
    const PreparedRun run = prepare_run(catalogue, scenario, file, file.default_case(),
                                        {"controller.name=constant", "run.duration_s=" + duration});
    if (run.scenario->run({}).failure) std::exit(1);
    elapsed_s = thread_time_s() - begin;
  }
  return elapsed_s;
}

double filter_s(int samples) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  std::vector<double> u(samples);
  std::vector<double> y(samples);
  for (int k = 0; k < samples; ++k) {
    u[k] = normal(random);
    y[k] = (k > 0 ? y[k - 1] : 0.0) + 1e-3 * normal(random);
  }
  const SensorError error{Eigen::VectorXd::Constant(1, 1e-3), Eigen::VectorXd::Zero(1)};
  const ExtendedPlant plant =
      extend_by_disturbance_model(zero_order_hold(damped_inertia(1.0, 0.0), 1e-3), 0, 1e-3);
  Stf stf(stf_design(plant, error, 1e-3), error);
  std::vector<double> estimates(5 * static_cast<std::size_t>(samples));
  const double begin = thread_time_s();
  stf.reset(Eigen::Vector2d(y[0], 0.0));
  double* next = estimates.data();
  for (int k = 0; k < samples; ++k) {
    const Eigen::Map<const Eigen::VectorXd> held(&u[k > 0 ? k - 1 : 0], 1);
    stf.update(held, Eigen::Map<const Eigen::VectorXd>(&y[k], 1));
    *next++ = stf.state()(0);
    *next++ = stf.state()(1);
    *next++ = stf.disturbance()(0);
    *next++ = stf.innovation()(0);
    *next++ = stf.lambda();
  }
  return thread_time_s() - begin;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  words.resize(4);
  try {
    if (words[0] == "replay") {
      replay(words[1], words[2] == "whole");
    } else if (words[0] == "render") {
      render(words[1], words[2], words[3]);
    } else if (words[0] == "points") {
      std::printf("%.6f\n", points_s(words[1], words[2], words[3]));
    } else if (words[0] == "run") {
      std::printf("%.6f\n", run_s(words[1], words[2]));
    } else {
      std::printf("%.6f\n", filter_s(std::stoi(words[1])));
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bare: %s\n", error.what());
    return 1;
  }
  return 0;
}
