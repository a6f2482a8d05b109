// A bare mj_step loop that replays a run of arm_wall_contact or robot_wall_contact. It has the
// same model, the recorded torques, the engine's contact with the wall and its switch. A run's
// additional cost is that of Breakwater. The model is the part that physics needs, or the whole
// one.
//
// Usage: bare_replay RUN_FOLDER [whole]
#include <mujoco/mujoco.h>

#include <toml++/toml.h>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <breakwater/record/hdf5_log.h>
#include <breakwater/shell/paths.h>
#include <breakwater/sim/contact.h>
#include <breakwater/sim/model.h>

using namespace breakwater;

int main(int argc, char** argv) {
  const bool is_whole = argc == 3 && std::string(argv[2]) == "whole";
  if (argc != 2 && !is_whole) {
    std::fputs("usage: bare_replay RUN_FOLDER [whole]\n", stderr);
    return 2;
  }
  const std::string run = argv[1];
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
  return difference < 1e-3 ? 0 : 1;
}
