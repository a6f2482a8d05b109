// The motor behind an encoder: Table 4.8 over phases. Its bounds are in cases.txt.
#include <breakwater/thesis/printed_results.h>
#include "regression/run_case.h"

namespace breakwater::motor_estimation_test {

using testing::median;
using testing::Sets;
using testing::operator+;

// `breakwater reproduce` uses 20.
constexpr int kPhases = 9;

std::string text(double value) {
  std::ostringstream stream;
  stream.precision(17);
  stream << value;
  return stream.str();
}

// A cell of Table 4.8. The physics step equals the control period, where RK4 is exact too.
Sets cell(const std::string& period_s, int bits) {
  return {"control.period_s=" + period_s, "physics.timestep_s=" + period_s,
          "encoder.bits=" + std::to_string(bits)};
}

double metric(const std::string& case_name, const Sets& sets,
              const std::string& name = "rmse_velocity_rad_s") {
  const Recording run =
      testing::completed_run("motor_estimation", case_name, sets, testing::kWithoutLog);
  return run.metric(name).value_or(NAN);
}

struct Medians {
  double velocity;
  double peak;
  double transient;
};

// Medians over encoder phases that divide a count evenly.
Medians over_phases(const std::string& case_name, const Sets& sets, int bits) {
  const double quantum = 2.0 * M_PI / std::exp2(bits);
  std::vector<double> velocity, peak, transient;
  for (int i = 0; i < kPhases; ++i) {
    const double phase = quantum * ((i + 0.5) / kPhases - 0.5);
    const Recording run = testing::completed_run("motor_estimation", case_name,
                                                 sets + Sets{"encoder.phase_rad=" + text(phase)},
                                                 testing::kWithoutLog);
    velocity.push_back(run.metric("rmse_velocity_rad_s").value_or(NAN));
    peak.push_back(run.metric("peak_position_rad").value_or(NAN));
    transient.push_back(run.metric("transient_rmse_disturbance_Nm").value_or(NAN));
  }
  return {median(velocity), median(peak), median(transient)};
}

struct Row {
  const char* period_s;
  int bits;
  double idob, dkf, fakfd_095, vfakfd;  // measured with another implementation
};
constexpr Row kRows[] = {{"1e-2", 4, 0.879, 0.805, 0.238, 0.109},
                         {"1e-2", 8, 0.0576, 0.0612, 0.0547, 0.0061},
                         {"1e-2", 12, 3.62e-3, 3.78e-3, 0.0511, 1.13e-3},
                         {"1e-3", 4, 1.02, 1.28, 1.37, 0.0937},
                         {"1e-3", 8, 0.0744, 0.0911, 0.115, 5.2e-3},
                         {"1e-3", 12, 3.93e-3, 5.7e-3, 7.3e-3, 4.59e-4}};

class QuantisedRow : public ::testing::TestWithParam<Row> {};

// All quantised cells of Table 4.8, and the order of its methods.
TEST_P(QuantisedRow, IsReproducedWithATruncatingEncoder) {
  const Row& row = GetParam();
  const Sets sets = cell(row.period_s, row.bits);
  const auto is_printed = [&row](int column, double measured) {
    const std::string path = "motor_estimation.table_4_8.Ts_" + std::string(row.period_s) + ".n" +
                             std::to_string(row.bits) + "[" + std::to_string(column) + "]";
    const PrintedResults& printed = printed_results();
    EXPECT_EQ(judge(measured, printed.find(path).value(), printed.standard(path)),
              Verdict::reproduced)
        << path << ": " << measured;
  };
  const auto is_measured = [&](const char* name, int column, double elsewhere) {
    const double here = metric(name, sets);
    is_printed(column, here);
    EXPECT_NEAR(here, elsewhere, 0.02 * elsewhere) << name;
    return here;
  };
  const double idob = is_measured("idob", 1, row.idob);
  const double dkf = is_measured("dkf", 3, row.dkf);
  const double fakfd_095 = is_measured("fakfd-095", 4, row.fakfd_095);
  const double vfakfd = is_measured("vfakfd", 6, row.vfakfd);
  is_printed(0, metric("mdob", sets, "rmse_raw_velocity_rad_s"));
  is_printed(2, metric("kfd", sets));
  const auto [lowest, highest] = std::minmax({idob, dkf, fakfd_095});
  EXPECT_LT(vfakfd, lowest);
  const double fakfd_0998 = metric("fakfd-0998", sets);
  is_printed(5, fakfd_0998);
  EXPECT_LT(highest, fakfd_0998);
}

// In every row, for two encoders: one counts from its start, so the shaft stops within a count. The
// other knows the true 0, so the loop oscillates between two counts. With a truncating encoder QVFF
// has the better transients, but not always the smaller error at rest.
TEST_P(QuantisedRow, StfBeatsVfakfdWithEveryEncoderAndQvffWithARoundingOne) {
  const Row& row = GetParam();
  for (const char* rounding : {"nearest", "truncate"}) {
    for (const char* origin : {"counted", "calibrated"}) {
      SCOPED_TRACE(std::string(rounding) + ", " + origin);
      const bool rounds = rounding == std::string("nearest");
      const Sets sets =
          cell(row.period_s, row.bits) +
          Sets{"encoder.origin=" + std::string(origin), "encoder.rounding=" + std::string(rounding),
               "controller.kd=" + text(rounds ? std::sqrt(10.0) : 5.0)};
      const Medians vfakfd = over_phases("vfakfd", sets, row.bits);
      const Medians qvff = over_phases("qvff", sets, row.bits);
      const Medians stf = over_phases("stf", sets, row.bits);
      if (rounds) {
        EXPECT_LT(qvff.velocity, vfakfd.velocity);
      }
      EXPECT_LT(stf.velocity, vfakfd.velocity);
      EXPECT_LT(qvff.peak, vfakfd.peak);
      EXPECT_LT(stf.peak, qvff.peak);
      EXPECT_LT(qvff.transient, vfakfd.transient);
      EXPECT_LT(stf.transient, qvff.transient);
    }
  }
}

// Without a parameter that depends on the row.
TEST_P(QuantisedRow, TheMultipleModelEstimatorBeatsVfakfdAndHoldsTheShaftBest) {
  const Row& row = GetParam();
  const Sets sets = cell(row.period_s, row.bits);
  const Medians bank = over_phases("qbank", sets, row.bits);
  const Medians vfakfd = over_phases("vfakfd", sets, row.bits);
  const Medians stf = over_phases("stf", sets, row.bits);
  EXPECT_LT(bank.velocity, vfakfd.velocity);
  EXPECT_LT(bank.peak, 0.7 * stf.peak);
  EXPECT_LT(bank.transient, stf.transient);
}

INSTANTIATE_TEST_SUITE_P(MotorEstimation, QuantisedRow, ::testing::ValuesIn(kRows),
                         [](const auto& row) {
                           return std::string(row.param.period_s[3] == '2' ? "T10ms" : "T1ms") +
                                  "_n" + std::to_string(row.param.bits);
                         });

}  // namespace breakwater::motor_estimation_test
