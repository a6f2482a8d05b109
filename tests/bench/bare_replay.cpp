// A bare mj_step loop that replays a run of arm_wall_contact: the same model, the recorded torques
// and the wall's switch. A run's additional cost is that of Breakwater. The model is the part that
// physics needs, or the whole one.
//
// Usage: bare_replay RUN_FOLDER [whole]
#include <mujoco/mujoco.h>

#include <toml++/toml.h>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

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
  const LoggedSignal torque = read_hdf5_signal(run + "/log.h5", "control/torque_applied_Nm");
  const LoggedSignal qpos = read_hdf5_signal(run + "/log.h5", "control/qpos");

  const double timestep_s = number("physics.timestep_s");
  const std::string mjcf =
      find_file(config.at_path("model.mjcf").value<std::string>().value(), run).value().string();
  Model model = is_whole ? Model::load(mjcf) : Model::load_physics(mjcf, {"tip", "wall"});
  model.set_physics(timestep_s, Integrator::euler);
  const int wall = model.id(mjOBJ_GEOM, "wall");
  mjModel& m = *model.get();
  m.geom_pos[3 * wall] = 0.45 + number("wall.distance_m");
  author_contact(model, model.id(mjOBJ_GEOM, "tip"), wall,
                 {number("contact.stiffness_N_m"), number("contact.damping_Ns_m")});
  m.geom_contype[wall] = m.geom_conaffinity[wall] = 0;

  const auto steps = std::llround(number("run.duration_s") / timestep_s);
  const auto steps_per_sample = std::llround(number("control.period_s") / timestep_s);
  const auto solid = std::llround(number("wall.solid_from_s") / timestep_s);
  mjData* d = mj_makeData(&m);
  std::copy_n(qpos.row(0), m.nq, d->qpos);
  for (long long k = 0; k < steps; ++k) {
    if (k == solid) m.geom_contype[wall] = m.geom_conaffinity[wall] = 1;
    if (k % steps_per_sample == 0) {
      std::copy_n(torque.row(static_cast<std::size_t>(k / steps_per_sample)), m.nu, d->ctrl);
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
