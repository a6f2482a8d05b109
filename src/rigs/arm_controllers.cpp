// Breakwater's controllers of the arm: their keys, and the functions that make them.
#include <breakwater/control/implicit_force_pfc.h>
#include <breakwater/control/soft_contact.h>
#include <breakwater/control/workspace_control.h>
#include <breakwater/rigs/arm_parts.h>

namespace breakwater {
namespace {

// The settings of the PFC, and of the positioning before force control.
struct PfcSettings {
  Positioning positioning = Positioning::joint;
  std::vector<double> t_ref_s;
  int coincidence_points = 0;
  int basis_functions = 0;

  void bind(Fields& fields) {
    fields.choice(
        "controller.positioning", positioning,
        {{"joint", Positioning::joint}, {"workspace", Positioning::workspace}},
        "hold of the start pose before force control: each joint, or the tip (workspace)");
    fields.numbers("controller.t_ref_s", t_ref_s, positive(),
                   "target response time of each joint's PFC [s]");
    fields.count("controller.coincidence_points", coincidence_points, between(1, 100),
                 "n: number of coincidence points of the PFC");
    fields.count("controller.basis_functions", basis_functions, between(1, 3),
                 "basis functions of the PFC: 1 step; 2 step and ramp; 3 step, ramp and parabola");
  }
  PfcDesign design(double response_time_s, double period_s) const {
    return {response_time_s, period_s, coincidence_points, basis_functions};
  }
  std::vector<PfcDesign> joints(double period_s) const {
    std::vector<PfcDesign> designs;
    for (const double response_time_s : t_ref_s) {
      designs.push_back(design(response_time_s, period_s));
    }
    return designs;
  }
  void check(const ArmSetup& arm) const {
    if (t_ref_s.size() != static_cast<std::size_t>(arm.chain.joints())) {
      throw WrongKey("controller.t_ref_s", "must have one entry for each of the URDF's " +
                                               std::to_string(arm.chain.joints()) + " joints");
    }
    blame("controller.t_ref_s", [&] {
      for (const PfcDesign& joint : joints(arm.period_s)) Pfc pfc(joint);
    });
  }
};

struct ProposedSettings {
  PfcSettings pfc;
  std::vector<double> ik_weights;
  double ik_damping = 0.0;
  LmForm ik_form = LmForm::printed;

  LmDesign inverse_kinematics() const {
    LmDesign design;
    design.weights = Eigen::Map<const Eigen::Vector3d>(ik_weights.data());
    design.damping = ik_damping;
    design.form = ik_form;
    return design;
  }
};

void bind_proposed(Fields& fields, ProposedSettings& settings) {
  settings.pfc.bind(fields);
  fields.numbers("controller.ik_weights", settings.ik_weights, positive(),
                 "W_e: weights of the inverse kinematics for x, y and phi");
  fields.number("controller.ik_damping", settings.ik_damping, positive(),
                "lambda: damping of the inverse kinematics");
  fields.choice("controller.ik_form", settings.ik_form,
                {{"printed", LmForm::printed}, {"sugihara", LmForm::sugihara}},
                "form of the inverse kinematics: printed (Eqs. 2.66, 2.68; three joints), or "
                "sugihara (any number)");
}

void check_proposed(const ProposedSettings& settings, const ArmSetup& arm) {
  if (settings.ik_weights.size() != 3) {
    throw WrongKey("controller.ik_weights", "must have 3 numbers, for x, y and phi");
  }
  settings.pfc.check(arm);
  blame("controller.ik_form",
        [&] { LmInverseKinematics(settings.inverse_kinematics(), arm.chain.joints()); });
}

std::unique_ptr<Controller> make_proposed(const ProposedSettings& settings, const ArmSetup& arm) {
  check_proposed(settings, arm);
  return std::make_unique<ImplicitForcePfc>(
      arm.chain, arm.acceleration, arm.task,
      ImplicitForcePfcDesign{settings.pfc.joints(arm.period_s), settings.inverse_kinematics(),
                             settings.pfc.positioning});
}

void bind_drac(Fields& fields, WorkspaceControlDesign& design) {
  fields.number("controller.k_position", design.k_p, not_negative(),
                "K_p: position gain K_phx or K_px; the velocity gain is 2 sqrt(K_p) [1/s^2]");
  fields.number("controller.singular_value_floor", design.singular_value_floor, not_negative(),
                "singular values below this count as 0 in the pseudo-inverse");
}

void bind_hpfc(Fields& fields, WorkspaceControlDesign& design) {
  bind_drac(fields, design);
  fields.number("controller.k_force", design.k_f, not_negative(), "K_phf: force gain");
}

std::unique_ptr<Controller> make_hpfc(const WorkspaceControlDesign& design, const ArmSetup& arm) {
  return std::make_unique<Hpfc>(arm.chain, arm.acceleration, arm.task, design);
}

std::unique_ptr<Controller> make_drac(const WorkspaceControlDesign& design, const ArmSetup& arm) {
  return std::make_unique<Drac>(arm.chain, arm.acceleration, arm.task, design);
}

struct SoftContactSettings {
  PfcSettings pfc;
  double hold_s = 0.0;
  double across_s = 0.0;
  double approach_s = 0.0;
  double contact_s = 0.0;
  double stiffness_N_m = 0.0;
  double margin_N = 0.0;
};

void bind_tlsc(Fields& fields, SoftContactSettings& settings) {
  settings.pfc.bind(fields);
  fields.number("controller.t_hold_s", settings.hold_s, positive(),
                "target response time of x at the start pose, for positioning workspace [s]");
  fields.number("controller.t_across_s", settings.across_s, positive(),
                "target response time of y and phi [s]");
  fields.number("controller.t_approach_s", settings.approach_s, positive(),
                "target response time of the speed towards the wall [s]");
  fields.number("controller.t_contact_s", settings.contact_s, positive(),
                "target response time of the remaining distance in contact [s]");
  fields.number(
      "controller.design_stiffness_N_m", settings.stiffness_N_m, positive(),
      "K_d: design stiffness, the contact stiffness for which the speed is limited [N/m]");
  fields.number("controller.peak_margin_N", settings.margin_N, positive(),
                "allowed excess of the filtered peak force over the reference at K_d [N]");
}

std::unique_ptr<Controller> make_tlsc(const SoftContactSettings& settings, const ArmSetup& arm) {
  settings.pfc.check(arm);
  const auto design_of = [&](const char* key, double response_time_s) {
    const PfcDesign design = settings.pfc.design(response_time_s, arm.period_s);
    blame(key, [&] { Pfc pfc(design); });
    return design;
  };
  SoftContactDesign design;
  design.positioning = settings.pfc.positioning;
  design.joints = settings.pfc.joints(arm.period_s);
  design.hold = design_of("controller.t_hold_s", settings.hold_s);
  design.across = design_of("controller.t_across_s", settings.across_s);
  design.approach = design_of("controller.t_approach_s", settings.approach_s);
  design.contact = design_of("controller.t_contact_s", settings.contact_s);
  design.wall_stiffness_N_m = settings.stiffness_N_m;
  design.peak_margin_N = settings.margin_N;
  return std::make_unique<SoftContact>(arm.chain, arm.acceleration, arm.task, design);
}

}  // namespace

std::vector<ArmControllerKind> arm_controllers() {
  return {{"proposed", "implicit force control over torque-limited PFC joints (2.4.2)",
           bind_proposed, make_proposed},
          {"hpfc", "hybrid position/force control by acceleration control (2.4.3.1)", bind_hpfc,
           make_hpfc},
          {"drac", "resolved acceleration control with implicit force control (2.4.3.1)", bind_drac,
           make_drac},
          {"tlsc", "torque-limited soft contact: as fast as the torques can still stop the arm",
           bind_tlsc, make_tlsc}};
}

}  // namespace breakwater
