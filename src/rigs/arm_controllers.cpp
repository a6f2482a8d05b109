// Breakwater's controllers of the arm: their keys, and the functions that make them.
#include <breakwater/control/contact_mpc.h>
#include <breakwater/control/energy_admittance.h>
#include <breakwater/control/impact_qp.h>
#include <breakwater/control/implicit_force_pfc.h>
#include <breakwater/control/soft_contact.h>
#include <breakwater/control/workspace_control.h>
#include <breakwater/rigs/arm_parts.h>
#include <breakwater/rigs/loop_parts.h>

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
                   "target response time of each joint's PFC, or one for all");
    fields.count("controller.coincidence_points", coincidence_points, between(1, 100),
                 "n: number of coincidence points of the PFC");
    fields.count("controller.basis_functions", basis_functions, between(1, 3),
                 "basis functions of the PFC: 1 step; 2 step and ramp; 3 step, ramp and parabola");
  }
  Pfc make(const char* key, double response_time_s, const ArmSetup& arm) const {
    return blame(key, [&] {
      return Pfc({response_time_s, arm.period_s, coincidence_points, basis_functions});
    });
  }
  std::vector<Pfc> joints(const ArmSetup& arm) const {
    std::vector<Pfc> made;
    for (const double response_time_s :
         spread("controller.t_ref_s", t_ref_s, arm.chain->joints(), "joint")) {
      made.push_back(make("controller.t_ref_s", response_time_s, arm));
    }
    return made;
  }
};

struct Proposed {
  PfcSettings pfc;
  std::vector<double> ik_weights;
  LmDesign ik;

  void bind(Fields& fields) {
    pfc.bind(fields);
    fields.numbers(
        "controller.ik_weights", ik_weights, positive(),
        "W_e: weights of the inverse kinematics for each coordinate of the tip, as x, y and phi");
    fields.number("controller.ik_damping", ik.damping, positive(),
                  "lambda: damping of the inverse kinematics");
    fields.choice("controller.ik_form", ik.form,
                  {{"printed", LmForm::printed},
                   {"sugihara_damping", LmForm::sugihara_damping},
                   {"sugihara", LmForm::sugihara}},
                  "form of the inverse kinematics: printed (Eqs. 2.66, 2.68; three joints), "
                  "sugihara_damping (Eq. 2.66 with Sugihara's W_n), or sugihara (any number)");
  }
  std::unique_ptr<Controller> make(const ArmSetup& arm) const {
    std::vector<Pfc> joints = pfc.joints(arm);
    LmDesign kinematics = ik;
    kinematics.weights = spread("controller.ik_weights", ik_weights, arm.chain->held(),
                                "of " + arm.chain->names() + ", which the arm can hold");
    blame("controller.ik_form", [&] { LmInverseKinematics(kinematics, arm.chain->joints()); });
    return std::make_unique<ImplicitForcePfc>(
        arm, ImplicitForcePfcDesign{std::move(joints), kinematics, pfc.positioning});
  }
};

template <WorkspaceLaw law>
struct WorkspaceSettings {
  WorkspaceControlDesign design{.law = law};

  void bind(Fields& fields) {
    fields.number("controller.k_position", design.k_p, not_negative(),
                  "K_p: position gain K_phx or K_px; the velocity gain is 2 sqrt(K_p) [1/s^2]");
    fields.number("controller.singular_value_floor", design.singular_value_floor, not_negative(),
                  "singular values below this count as 0 in the pseudo-inverse");
    if (law == WorkspaceLaw::drac) return;
    fields.number("controller.k_force", design.k_f, not_negative(), "K_phf: force gain");
  }
  std::unique_ptr<Controller> make(const ArmSetup& arm) const {
    return std::make_unique<WorkspaceControl>(arm, design);
  }
};

// The settings of a controller that reaches the wall on a path.
struct PathSettings {
  PfcSettings pfc;
  double hold_s = 0.0;
  double across_s = 0.0;
  double approach_s = 0.0;  // 0: the controller has no such key
  ImpactModel impact;

  void bind(Fields& fields, bool approaches = true) {
    pfc.bind(fields);
    fields.number("controller.t_hold_s", hold_s, positive(),
                  "target response time of x at the start pose, for positioning workspace");
    fields.number("controller.t_across_s", across_s, positive(),
                  "target response time of y and phi");
    fields.number("controller.design_stiffness_N_m", impact.stiffness_N_m, positive(),
                  "K_d: design stiffness, the contact stiffness for which the speed is limited");
    fields.number("controller.peak_margin_N", impact.peak_margin_N, positive(),
                  "allowed excess of the filtered peak force over the reference at K_d");
    if (!approaches) return;
    fields.number("controller.t_approach_s", approach_s, positive(),
                  "target response time of the speed towards the wall");
  }
  PathDesign design(const ArmSetup& arm) const {
    return {pfc.positioning,
            pfc.joints(arm),
            pfc.make("controller.t_hold_s", hold_s, arm),
            pfc.make("controller.t_across_s", across_s, arm),
            approach_s > 0.0 ? pfc.make("controller.t_approach_s", approach_s, arm) : Pfc(),
            impact};
  }
};

struct TlscSettings {
  PathSettings path;
  double contact_s = 0.0;

  void bind(Fields& fields) {
    path.bind(fields);
    fields.number("controller.t_contact_s", contact_s, positive(),
                  "target response time of the remaining distance in contact");
  }
  std::unique_ptr<Controller> make(const ArmSetup& arm) const {
    return std::make_unique<SoftContact>(
        arm, SoftContactDesign{path.design(arm),
                               path.pfc.make("controller.t_contact_s", contact_s, arm)});
  }
};

struct EnergySettings {
  PathSettings path;
  Admittance admittance;

  void bind(Fields& fields) {
    path.bind(fields);
    fields.optional_number("controller.admittance_mass_kg", admittance.mass_kg, positive(),
                           "M: mass of the admittance in contact");
    fields.optional_number("controller.admittance_damping_Ns_m", admittance.damping_Ns_m,
                           not_negative(), "D: damping of the admittance in contact");
  }
  std::unique_ptr<Controller> make(const ArmSetup& arm) const {
    return std::make_unique<EnergyAdmittance>(arm,
                                              EnergyAdmittanceDesign{path.design(arm), admittance});
  }
};

struct ImpactQpSettings : EnergySettings {
  ImpactQpDesign given;

  void bind(Fields& fields) {
    EnergySettings::bind(fields);
    fields.optional_number("controller.approach_speed_m_s", given.approach_speed_m_s, positive(),
                           "v^ref: wanted speed towards the wall, which the constraints reduce");
    fields.optional_number("controller.preview_s", given.preview_s, positive(),
                           "T_p: the constraints foresee an impact so long after the sample");
    fields.optional_number("controller.restitution", given.restitution, between(0.0, 1.0),
                           "e: restitution of the foreseen impact");
    fields.optional_number("controller.impact_expected_from_m", given.expected_from_m, any(),
                           "way from the start pose after which an impact is foreseen");
    fields.optional_number("controller.posture_weight", given.posture_weight, positive(),
                           "weight of the joint accelerations in the quadratic program");
  }
  std::unique_ptr<Controller> make(const ArmSetup& arm) const {
    ImpactQpDesign design = given;
    design.path = path.design(arm);
    design.admittance = admittance;
    return std::make_unique<ImpactQp>(arm, design);
  }
};

struct ContactMpcSettings {
  PathSettings path;
  ContactMpcDesign given;

  void bind(Fields& fields) {
    path.bind(fields, false);
    fields.optional_number(
        "controller.period_s", given.period_s, positive(),
        "time from one optimisation to the next, a multiple of control.period_s");
    fields.optional_count("controller.prediction_steps", given.prediction_steps, between(1, 200),
                          "N_p: number of predicted periods");
    fields.optional_number("controller.q_position", given.q_position, positive(),
                           "weight on the error of the depth [1/m^2]");
    fields.optional_number("controller.q_velocity", given.q_velocity, not_negative(),
                           "weight on the speed [s^2/m^2]");
    fields.optional_number("controller.r", given.r, positive(),
                           "weight on the path acceleration [s^4/m^2]");
    fields.optional_number("controller.path_acceleration_m_s2", given.acceleration_m_s2, positive(),
                           "bound of the predicted path acceleration");
    fields.optional_number("controller.wall_error_m", given.wall_error_m, any(),
                           "told place of the wall minus the true one");
    fields.optional_number(
        "controller.wall_correction_per_s", given.wall_correction_per_s, not_negative(),
        "gamma: rate at which the measured force corrects the wall's place [1/s]");
  }
  std::unique_ptr<Controller> make(const ArmSetup& arm) const {
    ContactMpcDesign design = given;
    design.path = path.design(arm);
    return std::make_unique<ContactMpc>(arm, design);
  }
};

}  // namespace

std::vector<ArmControllerKind> arm_controllers() {
  return {{"proposed", "implicit force control over torque-limited PFC joints (2.4.2)",
           &Proposed::make},
          {"hpfc", "hybrid position/force control by acceleration control (2.4.3.1)",
           &WorkspaceSettings<WorkspaceLaw::hpfc>::make},
          {"drac", "resolved acceleration control with implicit force control (2.4.3.1)",
           &WorkspaceSettings<WorkspaceLaw::drac>::make},
          {"tlsc", "torque-limited soft contact: as fast as the torques can still stop the arm",
           &TlscSettings::make},
          {"energy_admittance", "approach with the speed of an allowed impact, then admittance",
           &EnergySettings::make},
          {"impact_qp", "impact-aware quadratic program in the joint accelerations",
           &ImpactQpSettings::make},
          {"contact_mpc", "predictive control with a spring at the wall's known place",
           &ContactMpcSettings::make}};
}

}  // namespace breakwater
